"""Renders pictures of a board at a plan's poses and holds what examples/corners_from_pictures.py finds against the truth.

    pip install opencv-python-headless numpy
    python corners_from_pictures.py [plan.json [corners.vnl]]

Without a plan the poses are made up. The camera is that of problems/servosila-engineer.toml: each pixel takes the
colour that its ray meets on the board's plane, averaged over 5 x 5 rays; a little blur and noise follow, as in a camera. The
truth is OpenCV's projection. With a second argument nothing is rendered: the corners as OpenCV projects them, with the
problem's noise, are written there, which made problems/examples/servosila-corners.vnl.
"""

import json
import pathlib
import subprocess
import sys
import tempfile
import tomllib

import cv2
import map_error
import numpy as np

map_error.cv2, map_error.np = cv2, np

ROOT = pathlib.Path(__file__).parents[2]
FINE = 5
NOISE = 2.0  # grey levels


def rotation(xyzw):
    x, y, z, w = xyzw
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def camera(problem):
    c = problem["camera"]
    width, height = c["width_px"], c["height_px"]
    centre = c.get("cx_px", (width - 1) / 2), c.get("cy_px", (height - 1) / 2)
    K = np.array([[c["fx_px"], 0, centre[0]], [0, c["fy_px"], centre[1]], [0, 0, 1.0]])
    D = np.array([c["distortion"].get(k, 0.0) for k in ("k1", "k2", "p1", "p2", "k3")])
    return K, D, (width, height)


def undistorted(pixels, K, D):
    """Normalised image points (n x 2) of the directions that pixels show, by fixed-point iteration."""
    k1, k2, p1, p2, k3 = D
    seen = (pixels - K[:2, 2]) / np.diag(K)[:2]
    m = seen
    for _ in range(30):
        x, y = m.T
        r2 = x * x + y * y
        shift = np.column_stack([2 * p1 * x * y + p2 * (r2 + 2 * x * x), p1 * (r2 + 2 * y * y) + 2 * p2 * x * y])
        m = (seen - shift) / (1 + r2 * (k1 + r2 * (k2 + r2 * k3)))[:, None]
    return m


def render(K, D, size, X_CT, board, rng):
    """Grey picture of the board, white around it, grey beyond."""
    width, height = size
    columns, rows, square = board
    # Nothing but the rectangle around the board's white rim is looked at.
    R, t = X_CT
    along = np.linspace(-1, 1, 50)
    rim = np.array([[x, y, 0] for x in along for y in along]) * [(columns + 3) / 2 * square, (rows + 3) / 2 * square, 1]
    pixels = cv2.projectPoints(rim, cv2.Rodrigues(R)[0], t, K, D)[0].reshape(-1, 2)
    left, top = np.clip(np.floor(pixels.min(axis=0)).astype(int) - 5, 0, [width, height])
    right, bottom = np.clip(np.ceil(pixels.max(axis=0)).astype(int) + 5, 0, [width, height])
    steps = (np.arange(FINE) + 0.5) / FINE - 0.5
    u = (np.arange(left, right)[:, None] + steps).ravel()
    v = (np.arange(height)[:, None] + steps).ravel()
    picture = np.full((height, width), 120.0)
    for j in range(top, bottom):
        grid = np.stack(np.meshgrid(u, v[j * FINE : (j + 1) * FINE]), axis=-1).reshape(-1, 2)
        m = undistorted(grid, K, D)
        rays = np.column_stack([m, np.ones(len(m))])
        # Rays in T: from the camera's centre along Rᵀray.
        centre, direction = -R.T @ t, rays @ R
        p = centre + direction * (-centre[2] / direction[:, 2])[:, None]
        i, k = np.floor(p[:, 0] / square + (columns + 1) / 2), np.floor(p[:, 1] / square + (rows + 1) / 2)
        on_board = (i >= 0) & (i <= columns) & (k >= 0) & (k <= rows)
        rim = (i >= -1) & (i <= columns + 1) & (k >= -1) & (k <= rows + 1)
        colour = np.where(on_board, np.where((i + k) % 2 == 0, 30.0, 225.0), np.where(rim, 225.0, 120.0))
        picture[j, left:right] = colour.reshape(FINE, right - left, FINE).mean(axis=(0, 2))
    picture = cv2.GaussianBlur(picture, (0, 0), 0.6) + rng.normal(0, NOISE, picture.shape)
    return np.clip(np.round(picture), 0, 255).astype(np.uint8)


def poses_of(plan, problem):
    """X_CT of the plan's poses: X_BC of plan.json against the board's place in the problem file."""
    pose = problem["target"]["pose"]
    p_BT = np.array(pose["position_mm"]) / 1e3
    roll, pitch, yaw = np.radians(pose["rpy_deg"])
    Rx = cv2.Rodrigues(np.array([roll, 0, 0.0]))[0]
    Ry = cv2.Rodrigues(np.array([0, pitch, 0.0]))[0]
    Rz = cv2.Rodrigues(np.array([0, 0, yaw]))[0]
    R_BT = Rz @ Ry @ Rx
    for planned in plan["poses"]:
        R_BC = rotation(planned["camera_in_base"]["quaternion_xyzw"])
        p_BC = np.array(planned["camera_in_base"]["position_m"])
        yield R_BC.T @ R_BT, R_BC.T @ (p_BT - p_BC)


def made_up(distance):
    for n in range(6):
        tilt = 0.5 * np.array([np.cos(2.4 * n), np.sin(2.4 * n), 0.1 * n])
        yield cv2.Rodrigues(tilt)[0] @ np.diag([1.0, -1, -1]), np.array([0.03 * n - 0.08, 0.02 * (n % 3), distance])


def simulate(poses, points, K, D, size, problem, rng):
    """A table of the corners at the poses with Gaussian noise, as the problem states it."""
    nominal, target, noise = map_error.Camera(problem["camera"]), problem["target"], problem["noise"]
    lines = [
        "## Simulated by tests/cross_check/corners_from_pictures.py: the views that the poses of a plan for",
        f"## problems/servosila-engineer.toml give of its board, with noise of {noise['sigma_px']} px. Of no real camera.",
        "# filename x y level",
    ]
    for n, (R, t) in enumerate(poses):
        rvec = cv2.Rodrigues(R)[0]
        pixels = cv2.projectPoints(points, rvec, t, K, D)[0].reshape(-1, 2)
        W = map_error.whiteners(target, nominal, points, rvec, t.reshape(3, 1), noise)
        for x, y in pixels + np.linalg.solve(W, rng.standard_normal(pixels.shape)[..., None])[..., 0]:
            inside = 0 <= x <= size[0] - 1 and 0 <= y <= size[1] - 1
            lines.append(f"view{n:02}.png {x:.3f} {y:.3f} 0" if inside else f"view{n:02}.png - - -")
    return "\n".join(lines) + "\n"


def main():
    problem = tomllib.loads((ROOT / "problems/servosila-engineer.toml").read_text())
    K, D, size = camera(problem)
    target = problem["target"]
    board = target["columns"], target["rows"], target["square_mm"] / 1e3
    columns, rows, square = board
    if len(sys.argv) > 1:
        plan = json.loads(pathlib.Path(sys.argv[1]).read_text())
        poses = list(poses_of(plan, problem))
    else:
        poses = list(made_up(columns * square * K[0, 0] / size[0] * 2.0))
    rng = np.random.default_rng(7)
    points = np.array(
        [[(i - (columns - 1) / 2) * square, (j - (rows - 1) / 2) * square, 0] for j in range(rows) for i in range(columns)]
    )
    if len(sys.argv) > 2:
        simulated = simulate(poses, points, K, D, size, problem, rng)
        pathlib.Path(sys.argv[2]).write_text(simulated)
        return
    with tempfile.TemporaryDirectory() as folder:
        names, truths = [], []
        for n, (R, t) in enumerate(poses):
            names.append(f"view{n:02}.png")
            cv2.imwrite(f"{folder}/{names[-1]}", render(K, D, size, (R, t), board, rng))
            truths.append(cv2.projectPoints(points, cv2.Rodrigues(R)[0], t, K, D)[0].reshape(rows, columns, 2))
        script = ROOT / "examples/corners_from_pictures.py"
        command = [sys.executable, script, f"{columns}x{rows}", *names]
        table = subprocess.run(command, cwd=folder, check=True, capture_output=True, text=True).stdout
    found = {}
    for line in table.splitlines()[1:]:
        name, x, y, _ = line.split()
        if x != "-":
            found.setdefault(name, []).append([float(x), float(y)])
    errors = []
    for name, truth in zip(names, truths):
        if name not in found:
            print(f"{name}: not found")
            continue
        corners = np.array(found[name]).reshape(rows, columns, 2)
        # The detector may begin at another corner of the board; that is the same board, turned or mirrored.
        turned = [truth, truth[::-1], truth[:, ::-1], truth[::-1, ::-1]]
        error = min((corners - other for other in turned), key=lambda e: (e**2).sum())
        errors.append(error.reshape(-1, 2))
        print(f"{name}: RMS {np.sqrt((errors[-1] ** 2).mean()):.4f} px a coordinate, worst {np.abs(errors[-1]).max():.3f}")
    errors = np.concatenate(errors)
    rms = np.sqrt((errors**2).mean())
    print(f"{len(found)} of {len(names)} boards found; RMS {rms:.4f} px a coordinate, mean {errors.mean(axis=0).round(4)}")
    assert len(found) >= len(names) - 1 and rms < 0.1 and np.abs(errors.mean(axis=0)).max() < 0.03


if __name__ == "__main__":
    main()

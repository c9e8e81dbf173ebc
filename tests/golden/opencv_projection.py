"""Writes opencv_projection.json: pixels, Jacobians and view information by OpenCV and NumPy.

Made with Python 3.11, opencv-python-headless 5.0.0.93 and numpy 2.4.6:

    python -m venv env
    env/bin/pip install opencv-python-headless==5.0.0.93 numpy==2.4.6
    env/bin/python opencv_projection.py

Every case is a random camera that looks at an 8 x 6 board from a random pose. Points are in the board's frame (m), pixels
in px. `by_intrinsics` is (2m x p) by fx fy cx cy and the lens's coefficients, `by_pose` (2m x 6) by OpenCV's rvec and tvec;
rows are u and v of each point in turn. `information` is (A'A - A'Q Q'A) / sigma^2, with A = by_intrinsics and Q the
orthonormal factor of by_pose, sigma = 0.3 px.
"""

import json
import pathlib

import cv2
import numpy as np

SIGMA = 0.3
COLUMNS, ROWS, SQUARE = 8, 6, 0.035
LENSES = ["none", "brown-conrady", "rational", "kannala-brandt"]
CASES = 40
# Jacobians of few points, spread over the board, keep the file small; the information is of all.
KEPT = [0, 7, 19, 28, 40, 47]

rng = np.random.default_rng(20240229)


def coefficients(lens):
    if lens == "none":
        return []
    if lens == "brown-conrady":
        return list(rng.normal(0, [0.2, 0.1, 0.002, 0.002, 0.05]))
    if lens == "rational":
        return list(rng.normal(0, [0.1, 0.05, 0.001, 0.001, 0.02, 0.1, 0.05, 0.02]))
    return list(rng.normal(0, [0.03, 0.01, 0.005, 0.001]))


def board():
    x = (np.arange(COLUMNS) - (COLUMNS - 1) / 2) * SQUARE
    y = (np.arange(ROWS) - (ROWS - 1) / 2) * SQUARE
    return np.array([[x[i], y[j], 0.0] for j in range(ROWS) for i in range(COLUMNS)])


def project(lens, points, rvec, tvec, intrinsics):
    """Pixels (m x 2), by_intrinsics (2m x p) and by_pose (2m x 6)."""
    fx, fy, cx, cy = intrinsics[:4]
    K = np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1.0]])
    D = np.array(intrinsics[4:])
    if lens == "kannala-brandt":
        # Columns: f (2), c (2), k (4), om (3), T (3), alpha (1).
        pixels, J = cv2.fisheye.projectPoints(points[None], rvec, tvec, K, D)[:2]
        return pixels.reshape(-1, 2), J[:, :8], J[:, 8:14]
    # Columns: rvec (3), tvec (3), f (2), c (2), dist.
    pixels, J = cv2.projectPoints(points, rvec, tvec, K, D if len(D) else None)
    return pixels.reshape(-1, 2), J[:, 6 : 6 + len(intrinsics)], J[:, :6]


def case(lens):
    points = board()
    width, height = 1280, 720
    while True:
        fx = rng.uniform(600, 1400)
        intrinsics = [fx, fx * rng.uniform(0.97, 1.03), rng.uniform(600, 680), rng.uniform(330, 390)]
        intrinsics += coefficients(lens)
        # Facing the board's +z side means turning by about 180 degrees around x.
        facing, _ = cv2.Rodrigues(np.array([np.pi, 0, 0]))
        turn, _ = cv2.Rodrigues(rng.normal(0, 0.4, 3))
        rvec = cv2.Rodrigues(turn @ facing)[0].ravel()
        tvec = np.array([rng.uniform(-0.2, 0.2), rng.uniform(-0.1, 0.1), rng.uniform(0.4, 1.0)])
        pixels, A, B = project(lens, points, rvec, tvec, intrinsics)
        # In the image, and not beyond a fold of the lens: there the image turns back.
        camera_points = points @ cv2.Rodrigues(rvec)[0].T + tvec
        slope = np.einsum("ij,ij->i", pixels - intrinsics[2:4], camera_points[:, :2])
        if (
            (pixels > 0).all()
            and (pixels < [width, height]).all()
            and (slope > 0).all()
            and abs(np.array(intrinsics[4:])).sum() < 0.5
        ):
            break
    Q, _ = np.linalg.qr(B)
    information = (A.T @ A - A.T @ Q @ Q.T @ A) / SIGMA**2
    rows = np.array([[2 * i, 2 * i + 1] for i in KEPT]).ravel()
    return {
        "lens": lens,
        "width": width,
        "height": height,
        "intrinsics": [float(x) for x in intrinsics],
        "rvec": rvec.tolist(),
        "tvec": tvec.tolist(),
        "points": points[KEPT].tolist(),
        "pixels": pixels[KEPT].tolist(),
        "by_intrinsics": A[rows].tolist(),
        "by_pose": B[rows].tolist(),
        "information": information.tolist(),
    }


cases = [case(LENSES[i % len(LENSES)]) for i in range(CASES)]
document = {
    "opencv": cv2.__version__,
    "numpy": np.__version__,
    "sigma_px": SIGMA,
    "columns": COLUMNS,
    "rows": ROWS,
    "square_m": SQUARE,
    "cases": cases,
}
path = pathlib.Path(__file__).with_suffix(".json")
path.write_text(json.dumps(document, indent=None).replace('{"lens"', '\n{"lens"') + "\n")

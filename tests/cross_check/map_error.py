"""A plan's predicted standard deviations and map error against OpenCV and NumPy.

    python tests/cross_check/map_error.py PROBLEM PLAN [PROBLEM PLAN ...]

From a plan's camera poses and its problem file alone: OpenCV's Jacobians of the corners by the intrinsics and by each view's
pose, which a QR eliminates, and of boards that may bulge differences by their heights; the covariance of the intrinsics, with
weights and without (the sandwich); the map error as an integral over the image's area by a product Gauss rule on OpenCV's
undistorted rays; and the plan's value by `v` or `d`; of a robust plan in each scenario. Makes a virtual environment with OpenCV
from PyPI (in $CROSS_CHECK_VENV, or a temporary folder). Exits with 1 where plan.json says otherwise by more than TOLERANCE.
"""

import json
import sys
import tomllib
from pathlib import Path

from environment import run_with

TOLERANCE = 1e-5
GAUSS_ORDER = 60
# Width of a sharp edge: the lens's blur and the pixel's own area.
SHARP_PX = 2 / 3
FISHEYE = "kannala-brandt"
COEFFICIENTS = {
    "none": [],
    "brown-conrady": ["k1", "k2", "p1", "p2", "k3"],
    "rational": ["k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"],
    FISHEYE: ["k1", "k2", "k3", "k4"],
}


def rotation(quaternion_xyzw):
    x, y, z, w = quaternion_xyzw
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ])


def from_rpy(rpy_deg):
    """Fixed axes: roll about x, then pitch about y, then yaw about z."""
    r, p, y = np.radians(rpy_deg)
    about_x = np.array([[1, 0, 0], [0, np.cos(r), -np.sin(r)], [0, np.sin(r), np.cos(r)]])
    about_y = np.array([[np.cos(p), 0, np.sin(p)], [0, 1, 0], [-np.sin(p), 0, np.cos(p)]])
    about_z = np.array([[np.cos(y), -np.sin(y), 0], [np.sin(y), np.cos(y), 0], [0, 0, 1]])
    return about_z @ about_y @ about_x


class Camera:
    def __init__(self, file):
        self.model = file.get("distortion", {}).get("model", "none")
        self.size = file["width_px"], file["height_px"]
        width, height = self.size
        self.fx, self.fy = file["fx_px"], file.get("fy_px", file["fx_px"])
        self.cx, self.cy = file.get("cx_px", (width - 1) / 2), file.get("cy_px", (height - 1) / 2)
        self.coefficients = [file.get("distortion", {}).get(name, 0.0) for name in COEFFICIENTS[self.model]]
        self.K = np.array([[self.fx, 0, self.cx], [0, self.fy, self.cy], [0, 0, 1.0]])
        self.D = np.array(self.coefficients, dtype=float)
        self.names = ["fx", "fy", "cx", "cy", *COEFFICIENTS[self.model]]

    def at(self, intrinsics):
        """The same camera with other intrinsics, all of them."""
        names = dict(zip(self.names, intrinsics))
        size = {"width_px": self.size[0], "height_px": self.size[1]}
        distortion = {"model": self.model, **{name: names[name] for name in COEFFICIENTS[self.model]}}
        return Camera({**size, **{f"{name}_px": names[name] for name in self.names[:4]}, "distortion": distortion})

    def jacobians(self, points, rvec, tvec):
        """By the intrinsics (2m x p) and by rvec and tvec (2m x 6)."""
        points = np.ascontiguousarray(points, dtype=float).reshape(-1, 1, 3)
        if self.model == FISHEYE:
            _, J = cv2.fisheye.projectPoints(points, rvec, tvec, self.K, self.D)
            # f, c, k, rvec, tvec, skew.
            return J[:, :8], J[:, 8:14]
        _, J = cv2.projectPoints(points, rvec, tvec, self.K, self.D if self.D.size else None)
        return J[:, 6:6 + len(self.names)], J[:, :6]

    def project(self, points, rvec, tvec):
        points = np.ascontiguousarray(points, dtype=float).reshape(-1, 1, 3)
        if self.model == FISHEYE:
            return cv2.fisheye.projectPoints(points, rvec, tvec, self.K, self.D)[0].reshape(-1, 2)
        return cv2.projectPoints(points, rvec, tvec, self.K, self.D if self.D.size else None)[0].reshape(-1, 2)

    def rays(self, pixels, iterations=500):
        pixels = pixels.reshape(-1, 1, 2)
        criteria = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, iterations, 1e-15)
        if self.model == FISHEYE:
            plane = cv2.fisheye.undistortPoints(pixels, self.K, self.D, criteria=criteria)
        elif self.D.size:
            plane = cv2.undistortPoints(pixels, self.K, self.D, None, None, None, criteria)
        else:
            plane = cv2.undistortPoints(pixels, self.K, None)
        return np.column_stack([plane.reshape(-1, 2), np.ones(len(pixels))])


def read_problem(path, plan):
    """The problem of a plan: the file with the values that were set in place of its own."""
    problem = tomllib.loads(Path(path).read_text())
    for text in plan["problem"].get("set", []):
        key, _, value = text.partition("=")
        *above, last = [name.strip() for name in key.split(".")]
        table = problem
        for name in above:
            table = table.setdefault(name, {})
        table[last] = tomllib.loads(f"value = {value}")["value"]
    return problem


def corners(target):
    """Of a checkerboard from the lower left; of a ChArUco board, which counts squares, from the upper left; of an AprilGrid the tags'."""
    if target.get("kind") == "aprilgrid":
        side = target["tag_mm"] / 1e3
        x, y = [np.add.outer((np.arange(n) - (n - 1) / 2) * (1 + target["tag_spacing"]) * side, [-side / 2, side / 2]).ravel()
                for n in (target["columns"], target["rows"])]
        return np.array([[a, b, 0.0] for b in y for a in x])
    columns, rows, square = target["columns"], target["rows"], target["square_mm"] / 1e3
    is_charuco = target.get("kind") == "charuco"
    columns, rows = (columns - 1, rows - 1) if is_charuco else (columns, rows)
    x = (np.arange(columns) - (columns - 1) / 2) * square
    y = (np.arange(rows) - (rows - 1) / 2) * square * (-1 if is_charuco else 1)
    return np.array([[a, b, 0.0] for b in y for a in x])


def board_in_camera(problem, pose):
    """Rotation and position of the board in the camera's frame at a plan's pose. Where a link carries the board, its frame is the base."""
    board = problem["target"]["pose"]
    R_BT, t_BT = from_rpy(board.get("rpy_deg", [0, 0, 0])), np.array(board["position_mm"]) / 1e3
    R_CB = rotation(pose["camera_in_base"]["quaternion_xyzw"]).T
    return R_CB @ R_BT, R_CB @ (t_BT - np.array(pose["camera_in_base"]["position_m"]))


def edge_mm(target):
    """How far the edges of a crossing go on: to the next corner, or over the small square at a tag's corner."""
    return target["tag_mm"] * target["tag_spacing"] if target.get("kind") == "aprilgrid" else target["square_mm"]


def blurred_width(camera, board, rvec, tvec, noise):
    """How wide an edge is at each corner, px, by its depth and the lens and speeds that the problem file states."""
    p = board @ cv2.Rodrigues(rvec)[0].T + np.ravel(tvec)
    depth = np.linalg.norm(p, axis=1) if camera.model == FISHEYE else p[:, 2]
    f, square = np.sqrt(camera.fx * camera.fy), np.full(len(board), SHARP_PX**2)
    if "focus_mm" in noise:
        # The circle of confusion of a thin lens.
        focus, aperture = noise["focus_mm"] / 1e3, noise["aperture_mm"] / 1e3
        square += (f * aperture * np.abs(depth - focus) / (depth * focus) / 4) ** 2
    seconds = noise.get("exposure_ms", 0) / 1e3
    turned = f * np.radians(noise.get("turning_deg_s", 0)) * seconds
    moved = f * noise.get("moving_mm_s", 0) / 1e3 * seconds / depth
    return np.sqrt(square + (turned**2 + moved**2) / 24)


def whiteners(target, camera, board, rvec, tvec, noise, width=None):
    """W (2 x 2) of each corner, W^T W its inverse covariance: by the two edges that a detector's square window sees of a crossing, and by
    their width."""
    if noise.get("model", "edges") == "constant":
        return np.broadcast_to(np.eye(2), (len(board), 2, 2)) / noise["sigma_px"]
    window, step = noise.get("window_px", 5), 1e-7
    places = [board, board + [step, 0, 0], board + [0, step, 0]]
    centre, *moved = [camera.project(points, rvec, tvec) for points in places]
    precision, normals = np.zeros((len(board), 2, 2)), []
    for along in moved:
        edge = (along - centre) / step * edge_mm(target) / 1e3
        length = np.linalg.norm(edge, axis=1)
        normal = np.column_stack([-edge[:, 1], edge[:, 0]]) / length[:, None]
        seen = np.minimum(window / np.abs(normal).max(axis=1), length)
        precision += np.einsum("ji,jk,j->jik", normal, normal, seen / window)
        normals.append(normal)
    width = blurred_width(camera, board, rvec, tvec, noise) if width is None else width
    # What a crossing of edges as wide, at their angle, tells in this window; of it the share that it tells if they are sharp.
    reach = window * np.abs(np.linalg.det(np.stack(normals, axis=1)))
    told = [np.exp(-3 * s / reach - 8 * (s / reach) ** 2) / s for s in (width, SHARP_PX)]
    precision *= (told[0] / told[1])[:, None, None]
    return np.transpose(np.linalg.cholesky(precision), (0, 2, 1)) / noise["sigma_px"]


def eliminated(A, B):
    """What of A the columns of B do not explain."""
    Q = np.linalg.qr(B)[0]
    return A - Q @ (Q.T @ A)


def by_heights(target, camera, board, rvec, tvec):
    """The corners by the two heights of a board that may bulge, z = w_x (1 - x^2/h_x^2) + w_y (1 - y^2/h_y^2) with the outermost corners
    at h, in their standard deviations (2m x 2); of a flat board no columns."""
    if "warp_mm" not in target:
        return np.empty((2 * len(board), 0))
    outermost, step = np.abs(corners(target)[:, :2]).max(axis=0), 1e-2
    rises = target["warp_mm"] / 1e3 * (1 - (board[:, :2] / outermost) ** 2)
    columns = []
    for rise in rises.T:
        up = np.column_stack([np.zeros((len(board), 2)), rise * step])
        columns.append((camera.project(board + up, rvec, tvec) - camera.project(board - up, rvec, tvec)).ravel() / (2 * step))
    return np.column_stack(columns)


def information(camera, problem, pose):
    """The information of one view on the heights of a board that may bulge and on all intrinsics, its pose eliminated; and of plain least
    squares, which weighs nothing and takes the board for flat, the normal matrix of the intrinsics, the scatter of its gradient, and the
    gradient by the heights."""
    target, noise = problem["target"], problem["noise"]
    board, (R, t) = corners(target), board_in_camera(problem, pose)
    seen = pose.get("corners_seen")
    rvec, tvec = cv2.Rodrigues(R)[0], t.reshape(3, 1)
    board = board if seen is None else board[seen]
    W = whiteners(target, camera, board, rvec, tvec, noise)
    A, B = camera.jacobians(board, rvec, tvec)
    C = by_heights(target, camera, board, rvec, tvec)

    def of_corners(matrices, rows):
        return np.einsum("jik,jkl->jil", matrices, rows.reshape(len(board), 2, -1)).reshape(2 * len(board), -1)

    weighted = eliminated(of_corners(W, np.hstack([C, A])), of_corners(W, B))
    plain = eliminated(A, B)
    covariances = np.linalg.inv(np.transpose(W, (0, 2, 1)) @ W)
    return weighted.T @ weighted, plain.T @ plain, plain.T @ of_corners(covariances, plain), plain.T @ C


def map_weight(camera, estimated):
    width, height = camera.size
    nodes, weights = np.polynomial.legendre.leggauss(GAUSS_ORDER)
    u, v = (nodes + 1) / 2 * width - 0.5, (nodes + 1) / 2 * height - 0.5
    pixels = np.array([[a, b] for b in v for a in u])
    share = np.array([p * q for q in weights for p in weights]) / 4
    J, by_pose = camera.jacobians(camera.rays(pixels), np.zeros((3, 1)), np.zeros((3, 1)))
    root = np.repeat(np.sqrt(share), 2)[:, None]
    J, R = J[:, estimated] * root, by_pose[:, :3] * root
    J = eliminated(J, R)
    return J.T @ J


def inverse(M):
    """Parameters in unlike units lose their digits otherwise."""
    unit = 1 / np.sqrt(np.diag(M))
    return np.linalg.inv(M * np.outer(unit, unit)) * np.outer(unit, unit)


def covariances(camera, problem, poses, estimated):
    """Of the intrinsics by weighted least squares, and without weights."""
    M, H, K, G = [sum(matrices) for matrices in zip(*(information(camera, problem, pose) for pose in poses))]
    heights = G.shape[1]
    M = M + np.diag([1.0] * heights + [0.0] * len(H))
    both = [*range(heights), *(heights + np.array(estimated))]
    weighted = inverse(M[np.ix_(both, both)])[heights:, heights:]
    # The heights are the same in all views: what they add to the gradients does not average out.
    H, K = [matrix[np.ix_(estimated, estimated)] for matrix in (H, K + G @ G.T)]
    return weighted, inverse(H) @ K @ inverse(H)


def accuracies(camera, problem, poses, estimated, weight):
    """Map error and standard deviations of the intrinsics by weighted least squares, and without weights."""
    return [accuracy(covariance, weight) for covariance in covariances(camera, problem, poses, estimated)]


def accuracy(covariance, weight):
    return np.sqrt(np.trace(weight @ covariance)), np.sqrt(np.diag(covariance))


def has_value(plan, found):
    """Whether the plan's value, by a criterion that is looked at, is the one of these map errors and covariances, one for each scenario."""
    is_worst = "robust" in plan and plan["robust"]["goal"] == "worst"
    if plan["criterion"] == "v":
        logs = [2 * np.log(map_error) for map_error, _ in found]
        value = np.exp(max(logs) if is_worst else np.mean(logs))
        off = abs(value / plan["value"] - 1)
    elif plan["criterion"] == "d":
        logs = [-np.linalg.slogdet(covariance)[1] for _, covariance in found]
        value = min(logs) if is_worst else np.mean(logs)
        off = abs(value - plan["value"])
    else:
        return True
    print(f"    value by {plan['criterion']} {plan['value']:.6f}, by OpenCV and NumPy {value:.6f}")
    return off <= TOLERANCE


def compare(problem_path, plan_path):
    plan = json.loads(Path(plan_path).read_text())
    problem = read_problem(problem_path, plan)
    camera = Camera(problem["camera"])
    estimated = [camera.names.index(name) for name in plan["intrinsics"]["names"]]
    weight = map_weight(camera, estimated)
    weighted, without_weights = covariances(camera, problem, plan["poses"], estimated)
    found, sigma = accuracy(weighted, weight)
    worst = max(abs(s / t - 1) for s, t in zip(sigma, plan["intrinsics"]["sigma"]))
    stated = plan["map_error_px"]
    print(f"{plan_path}: {len(plan['poses'])} poses; map error {stated:.6f} px, by OpenCV and NumPy {found:.6f}; "
          f"worst sigma off by {worst:.1e}")
    good = abs(found / stated - 1) <= TOLERANCE and worst <= TOLERANCE
    good &= withstands(problem, plan, camera, estimated) if "robust" in plan else has_value(plan, [(found, weighted)])
    plain = plan.get("unweighted")
    if plain is None:
        # Constant noise and a flat board: weights change nothing.
        return good and problem["noise"].get("model", "edges") == "constant" and "warp_mm" not in problem["target"]
    unweighted, sigma = accuracy(without_weights, weight)
    worst = max(abs(s / t - 1) for s, t in zip(sigma, plain["sigma"]))
    print(f"    without weights {plain['map_error_px']:.6f} px, by OpenCV and NumPy {unweighted:.6f}; worst sigma off by {worst:.1e}")
    return good and abs(unweighted / plain["map_error_px"] - 1) <= TOLERANCE and worst <= TOLERANCE


def withstands(problem, plan, camera, estimated):
    """Whether a robust plan's map errors in its scenarios are those of OpenCV and NumPy, and its value follows from them."""
    scenarios, found = plan["robust"]["scenarios"], []
    for scenario in scenarios:
        drawn = camera.at(scenario["intrinsics"])
        views = [view for view in scenario["views"] if view is not None]
        covariance, _ = covariances(drawn, problem, views, estimated)
        found.append((accuracy(covariance, map_weight(drawn, estimated))[0], covariance))
    worst = max(abs(map_error / scenario["map_error_px"] - 1) for (map_error, _), scenario in zip(found, scenarios))
    print(f"    {len(scenarios)} scenarios: map errors off by {worst:.1e}")
    return has_value(plan, found) and worst <= TOLERANCE


if __name__ == "__main__":
    run_with("numpy==2.4.6", "opencv-python-headless==5.0.0.93")
    import cv2
    import numpy as np

    pairs = sys.argv[1:]
    if not pairs or len(pairs) % 2:
        sys.exit(__doc__)
    good = [compare(*pair) for pair in zip(pairs[::2], pairs[1::2])]
    sys.exit(0 if all(good) else 1)

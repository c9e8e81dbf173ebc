"""A plan's poses off the grid against random restarts of SciPy's local search.

    python tests/cross_check/off_grid.py PROBLEM PLAN [--restarts N]

Of an arm that a Denavit-Hartenberg table describes and a checkerboard: NumPy's own kinematics, OpenCV's projection and Jacobians, the
tests of the problem file (limits with their margin, the optical axis in the zone, tilt, incidence, the picture's margin) and the
separation of pictures. From random views each pose in turn is moved by SciPy's Nelder and Mead, the others held, until that gains
nothing. Exits with 1 where the best of N such sets of poses has a variance `v` below that of the plan by more than SLACK, where the
plan's camera poses are not those of its joint values, or a pose fails a test. Makes a virtual environment with OpenCV and SciPy from
PyPI (in $CROSS_CHECK_VENV, or a temporary folder).
"""

import argparse
import json
import sys
from pathlib import Path

from environment import run_with

# Random restarts may be as much better, as a share.
SLACK = 0.03
CYCLES = 8
LEAST_GAIN = 1e-3
# First steps of a simplex, rad, and its most evaluations.
STEP = 0.06
EVALUATIONS = 200


def about_z_then_x(theta, d, a, alpha):
    """A row's transform in the standard convention: Rz(theta) Tz(d) Tx(a) Rx(alpha)."""
    ct, st, ca, sa = np.cos(theta), np.sin(theta), np.cos(alpha), np.sin(alpha)
    return np.array([[ct, -st * ca, st * sa, a * ct], [st, ct * ca, -ct * sa, a * st], [0, sa, ca, d], [0, 0, 0, 1]])


class Setting:
    """What poses are judged by."""

    def __init__(self, problem, plan):
        self.problem, self.camera = problem, checks.Camera(problem["camera"])
        self.estimated = [self.camera.names.index(name) for name in plan["intrinsics"]["names"]]
        self.weight = checks.map_weight(self.camera, self.estimated)
        self.rows = problem["robot"]["joints"]
        margin = problem["robot"].get("limit_margin_deg", 0.5)
        sets = problem["robot"]["limits"]
        limits = np.array([row["limits_deg"][sets] for row in self.rows], dtype=float) + [margin, -margin]
        self.limits = np.radians(limits)
        target = problem["target"]
        board = target["pose"]
        self.X_BT = transform(checks.from_rpy(board.get("rpy_deg", [0, 0, 0])), np.array(board["position_mm"]) / 1e3)
        self.board = checks.corners(target)
        printed = np.array([target["columns"] + 1, target["rows"] + 1]) * target["square_mm"] / 1e3
        self.outer = np.array([[x * printed[0] / 2, y * printed[1] / 2, 0] for x, y in [(-1, -1), (1, -1), (1, 1), (-1, 1)]])
        self.separation = problem.get("constraints", {}).get("picture_separation_px", 20)
        window = problem["noise"].get("window_px", 5)
        visibility = problem.get("visibility", {})
        self.margin = visibility.get("margin_px", window + 3)
        self.tilt, self.incidence = visibility.get("max_tilt_deg", 70), visibility.get("max_incidence_deg", 80)

    def camera_pose(self, q):
        X = np.eye(4)
        for value, row in zip(q, self.rows):
            theta = np.radians(row.get("theta_deg", 0)) + value
            X = X @ about_z_then_x(theta, row.get("d_mm", 0) / 1e3, row.get("a_mm", 0) / 1e3, np.radians(row.get("alpha_deg", 0)))
        # The camera looks along the end effector's x, its y up in the picture.
        return X @ transform(np.array([[0, 0, 1.0], [0, -1, 0], [1, 0, 0]]), np.zeros(3))

    def look(self, q):
        """The information of the view from q and its picture; None if it is no view."""
        if np.any(q < self.limits[:, 0] - 1e-9) or np.any(q > self.limits[:, 1] + 1e-9):
            return None
        X_BC = self.camera_pose(q)
        X_CT = np.linalg.inv(X_BC) @ self.X_BT
        R, t = X_CT[:3, :3], X_CT[:3, 3]
        # Where the axis meets the board's plane, in the board's frame.
        X_TC = np.linalg.inv(self.X_BT) @ X_BC
        along, origin = X_TC[:3, 2], X_TC[:3, 3]
        if along[2] * origin[2] >= 0:
            return None
        meets = origin - along * origin[2] / along[2]
        zone = self.problem["target"]["zone"]
        if abs(meets[0]) > zone["width_mm"] / 2e3 or abs(meets[1]) > zone["height_mm"] / 2e3:
            return None
        normal = R[:, 2]
        towards = -t / np.linalg.norm(t)
        # Best poses are at the very limit.
        least = [np.cos(np.radians(limit)) - 1e-12 for limit in (self.incidence, self.tilt)]
        if normal @ towards < least[0] or -normal[2] < least[1]:
            return None
        points = self.board @ R.T + t
        if points[:, 2].min() <= 0:
            return None
        rvec, tvec = cv2.Rodrigues(R)[0], t.reshape(3, 1)
        pixels = self.camera.project(self.board, rvec, tvec)
        size = np.array(self.camera.size) - 1 - self.margin
        # Rays that the lens model folds back to the picture are far off the axis.
        if np.any(pixels < self.margin) or np.any(pixels > size) or np.hypot(*(points[:, :2] / points[:, 2:]).T).max() > 1.2:
            return None
        W = checks.whiteners(self.problem["target"], self.camera, self.board, rvec, tvec, self.problem["noise"])
        A, B = self.camera.jacobians(self.board, rvec, tvec)
        A, B = [np.einsum("jik,jkl->jil", W, rows.reshape(len(self.board), 2, -1)).reshape(2 * len(self.board), -1)
                for rows in (A[:, self.estimated], B)]
        left = checks.eliminated(A, B)
        outer = self.outer @ R.T + t
        picture = outer / np.linalg.norm(outer, axis=1)[:, None] * (self.camera.fx + self.camera.fy) / 4
        return left.T @ left, picture.ravel()

    def value(self, M):
        try:
            return np.trace(self.weight @ checks.inverse(M))
        except np.linalg.LinAlgError:
            return np.inf

    def apart(self, picture, others):
        return all(np.linalg.norm(picture - other) >= self.separation for other in others)


def transform(R, t):
    X = np.eye(4)
    X[:3, :3], X[:3, 3] = R, t
    return X


def climbed(setting, count, rng):
    """A local optimum of `count` poses from random views: its value and joint values."""
    q, looks = [], []
    while len(q) < count:
        candidate = rng.uniform(setting.limits[:, 0], setting.limits[:, 1])
        look = setting.look(candidate)
        if look is not None and setting.apart(look[1], [picture for _, picture in looks]):
            q.append(candidate)
            looks.append(look)
    before = np.inf
    for _ in range(CYCLES):
        for i in range(count):
            others = [look for j, look in enumerate(looks) if j != i]
            rest = sum(M for M, _ in others)

            def cost(candidate):
                look = setting.look(candidate)
                if look is None or not setting.apart(look[1], [picture for _, picture in others]):
                    return np.inf
                return np.log(setting.value(rest + look[0]))

            simplex = np.vstack([q[i], q[i] + rng.choice([-STEP, STEP], size=len(q[i])) * np.eye(len(q[i]))])
            found = minimize(cost, q[i], method="Nelder-Mead", options={"initial_simplex": simplex, "maxfev": EVALUATIONS})
            if found.fun < cost(q[i]):
                q[i], looks[i] = found.x, setting.look(found.x)
        value = setting.value(sum(M for M, _ in looks))
        if before / value - 1 < LEAST_GAIN:
            break
        before = value
    return value, np.degrees(q)


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("problem")
    arguments.add_argument("plan")
    arguments.add_argument("--restarts", type=int, default=12)
    arguments = arguments.parse_args()
    plan = json.loads(Path(arguments.plan).read_text())
    setting = Setting(checks.read_problem(arguments.problem, plan), plan)
    good, looks = plan["criterion"] == "v", []
    for pose in plan["poses"]:
        q = np.array(pose["joints_rad"])
        look, X_BC = setting.look(q), setting.camera_pose(q)
        good &= np.allclose(X_BC[:3, 3], pose["camera_in_base"]["position_m"], atol=1e-9)
        good &= look is not None and setting.apart(look[1], [picture for _, picture in looks])
        looks.append(look)
        if look is None:
            sys.exit(f"pose {pose['id']} is no view")
    own = setting.value(sum(M for M, _ in looks))
    print(f"{arguments.plan}: v {plan['value']:.4f} by the plan, {own:.4f} by OpenCV and NumPy", flush=True)
    good &= abs(own / plan["value"] - 1) < 1e-5
    rng = np.random.default_rng(1)
    values = []
    for _ in range(arguments.restarts):
        values.append(climbed(setting, len(plan["poses"]), rng)[0])
        print(f"    {len(values)} random restarts: best {min(values):.4f}, median {np.median(values):.4f}", flush=True)
    print(f"    the plan's value is {own / min(values):.3f} times the best of them")
    return 0 if good and own <= (1 + SLACK) * min(values) else 1


if __name__ == "__main__":
    run_with("numpy==2.4.6", "opencv-python-headless==5.0.0.93", "scipy==1.16.3")
    import cv2
    import numpy as np
    from scipy.optimize import minimize

    import map_error as checks

    checks.np, checks.cv2 = np, cv2
    sys.exit(main())

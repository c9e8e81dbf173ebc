"""The bound of a plan over all its views, from its own matrix, prices and balls, by OpenCV and NumPy.

    python tests/cross_check/bound.py PROBLEM PLAN VIEWS [PROBLEM PLAN VIEWS ...]

VIEWS is views.csv of `calipose plan --views csv`. Of plans by `v` alone that see whole checkerboards, with no constraint but the separation
of pictures. Exits with 1 where two views of a ball are as far apart as two poses may be, where two poses of the plan are nearer, or where
the bound is another than plan.json states by more than TOLERANCE. Makes a virtual environment with OpenCV from PyPI (in $CROSS_CHECK_VENV,
or a temporary folder).
"""

import csv
import json
import sys
from pathlib import Path

from environment import run_with

TOLERANCE = 1e-5
# Where nothing is stated and poses leave the grid.
SEPARATION_PX = 20


def picture(camera, problem, pose):
    """The board in the picture, px: directions of its four outer corners, times half the focal length."""
    target = problem["target"]
    half = [(target[name] + 1) * target["square_mm"] / 2e3 for name in ("columns", "rows")]
    R, t = checks.board_in_camera(problem, pose)
    outer = np.array([[x * half[0], y * half[1], 0.0] for x in (-1, 1) for y in (-1, 1)]) @ R.T + t
    return (outer / np.linalg.norm(outer, axis=1)[:, None] * (camera.fx + camera.fy) / 4).ravel()


def root(C):
    values, vectors = np.linalg.eigh(C)
    return vectors * np.sqrt(np.maximum(values, 0)) @ vectors.T


def holds(problem_path, plan_path, views_path):
    plan = json.loads(Path(plan_path).read_text())
    problem = checks.read_problem(problem_path, plan)
    camera = checks.Camera(problem["camera"])
    estimated = [camera.names.index(name) for name in plan["intrinsics"]["names"]]
    certificate = plan["certificate"]["grid"]
    [term] = certificate["terms"]
    assert term["criterion"] == "v" and "prices" not in certificate and "warp_mm" not in problem["target"]
    poses, place = [], {}
    with open(views_path) as file:
        for row in csv.DictReader(file):
            place[int(row["id"])] = len(poses)
            position, quaternion = [[float(row[f"camera_{name}"]) for name in names.split()] for names in ("x_m y_m z_m", "qx qy qz qw")]
            poses.append({"camera_in_base": {"position_m": position, "quaternion_xyzw": quaternion}})
    least = problem.get("constraints", {}).get("picture_separation_px", SEPARATION_PX)
    pictures = np.array([picture(camera, problem, pose) for pose in poses])
    chosen = pictures[[place[pose["id"]] for pose in plan["poses"]]]
    apart = np.linalg.norm(chosen[:, None] - chosen, axis=2)[np.triu_indices(len(chosen), 1)].min()

    Y = np.array(term["matrix"])
    scores = np.empty(len(poses))
    for i, pose in enumerate(poses):
        M = checks.information(camera, problem, pose)[0]
        scores[i] = np.sum(Y * M[np.ix_(estimated, estimated)])
    paid, widest = 0.0, 0.0
    for ball in certificate.get("balls", []):
        a, b = [pictures[place[view]] for view in ball["between"]]
        members = np.flatnonzero(np.linalg.norm(pictures - (a + b) / 2, axis=1) < least / 2)
        distances = np.linalg.norm(pictures[members][:, None] - pictures[members], axis=2)
        widest = max(widest, distances.max())
        scores[members] -= ball["price"]
        paid += ball["price"]
        assert ball["price"] >= 0
    S = np.sort(scores)[-plan["count"]:].sum() + paid
    # Of tr(C M^-1), a variance: k views have at least (tr (C^1/2 Y C^1/2)^1/2)^2 / S of it.
    half = root(checks.map_weight(camera, estimated))
    bound = np.trace(root(half @ Y @ half)) ** 2 / S
    print(f"{plan_path}: {len(poses)} views; bound {certificate['bound']:.6f}, by OpenCV and NumPy {bound:.6f}; "
          f"{len(certificate.get('balls', []))} balls, no two views of one farther apart than {widest:.2f} px; poses {apart:.2f} px apart at least")
    return abs(bound / certificate["bound"] - 1) <= TOLERANCE and widest < least <= apart + 1e-9


def main():
    arguments = sys.argv[1:]
    if not arguments or len(arguments) % 3:
        sys.exit(__doc__)
    files = [arguments[i:i + 3] for i in range(0, len(arguments), 3)]
    sys.exit(not all([holds(*three) for three in files]))


if __name__ == "__main__":
    run_with("numpy==2.4.6", "opencv-python-headless==5.0.0.93")
    import cv2
    import numpy as np

    import map_error as checks

    checks.cv2, checks.np = cv2, np
    main()

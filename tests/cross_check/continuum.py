"""The bound of a plan over all joint values, from its own matrix, prices and balls, attacked by OpenCV, NumPy and SciPy.

    python tests/cross_check/continuum.py PROBLEM PLAN [--climbs N]

Of plans as `off_grid.py` takes them, by `v` alone, with a certificate for all joint values. Scores less prices are climbed by SciPy's
Nelder and Mead on NumPy's own kinematics: from the plan's poses, from the configurations of the balls, and from random views. Exits with
1 where a view scores more than plan.json states to be the most, where none comes near that (the bound would say little, or the climbs
would), where the bound does not follow from the score, or where two poses are nearer than the separation. Makes a virtual environment
with OpenCV and SciPy from PyPI (in $CROSS_CHECK_VENV, or a temporary folder).
"""

import argparse
import json
import sys
from pathlib import Path

from environment import run_with

TOLERANCE = 1e-5
# What the best climb may miss of the score, beside the tolerance to which it was to be known.
MISSED = 0.02
# First steps of climbs, rad, and their most evaluations.
STEPS = [0.1, 0.02]
EVALUATIONS = 400


class Scores:
    """Scores less the prices of the balls that the picture is in."""

    def __init__(self, setting, certificate):
        self.setting = setting
        [term] = certificate["terms"]
        assert term["criterion"] == "v" and "mixture" not in certificate
        self.Y = np.array(term["matrix"])
        self.balls = []
        for ball in certificate.get("balls", []):
            a, b = [setting.look(np.array(q))[1] for q in ball["between_rad"]]
            self.balls.append(((a + b) / 2, ball["price"]))
        self.paid = sum(price for _, price in self.balls)

    def of(self, q):
        look = self.setting.look(q)
        if look is None:
            return -np.inf
        M, picture = look
        near = [price for centre, price in self.balls if np.linalg.norm(picture - centre) < self.setting.separation / 2]
        return np.sum(self.Y * M) - sum(near)

    def climbed(self, q):
        best = self.of(q)
        for step in STEPS:
            for sign in (step, -step):
                simplex = np.vstack([q, q + sign * np.eye(len(q))])
                options = {"initial_simplex": simplex, "maxfev": EVALUATIONS}
                found = minimize(lambda q: -self.of(q), q, method="Nelder-Mead", options=options)
                if -found.fun > best:
                    q, best = found.x, -found.fun
        return best


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("problem")
    arguments.add_argument("plan")
    arguments.add_argument("--climbs", type=int, default=40)
    arguments = arguments.parse_args()
    plan = json.loads(Path(arguments.plan).read_text())
    problem = checks.read_problem(arguments.problem, plan)
    setting = Setting(problem, plan)
    certificate = plan["certificate"]["continuum"]
    scores = Scores(setting, certificate)

    poses = [np.array(pose["joints_rad"]) for pose in plan["poses"]]
    pictures = [setting.look(q)[1] for q in poses]
    apart = min(np.linalg.norm(a - b) for i, a in enumerate(pictures) for b in pictures[:i])
    starts = poses + [np.array(q) for ball in certificate.get("balls", []) for q in ball["between_rad"]]
    rng, given = np.random.default_rng(1), len(starts)
    while len(starts) < given + arguments.climbs:
        q = rng.uniform(setting.limits[:, 0], setting.limits[:, 1])
        if setting.look(q) is not None:
            starts.append(q)
    greatest = max(scores.climbed(q) for q in starts)

    # Of tr(C M^-1), a variance: k views have at least (tr (C^1/2 Y C^1/2)^1/2)^2 / S of it.
    half = root(setting.weight)
    S = certificate["count"] * certificate["score"] + scores.paid
    proven = np.trace(root(half @ scores.Y @ half)) ** 2 / S
    print(f"{arguments.plan}: no view scores more than {certificate['score']:.6f} less prices; {len(starts)} climbs found "
          f"{greatest:.6f}; bound {certificate['bound']:.6f}, by NumPy {proven:.6f}; {len(scores.balls)} balls, poses {apart:.2f} px apart")
    least = certificate["score"] / (1 + certificate["tolerance"]) * (1 - MISSED)
    return not (least <= greatest <= certificate["score"] * (1 + 1e-9) and abs(proven / certificate["bound"] - 1) <= TOLERANCE
                and apart >= setting.separation - 1e-9)


if __name__ == "__main__":
    run_with("numpy==2.4.6", "opencv-python-headless==5.0.0.93", "scipy==1.16.3")
    import cv2
    import numpy as np
    from scipy.optimize import minimize

    import bound
    import map_error as checks
    import off_grid
    from bound import root
    from off_grid import Setting

    checks.np, checks.cv2 = np, cv2
    bound.np = np
    off_grid.np, off_grid.cv2, off_grid.checks = np, cv2, checks
    sys.exit(main())

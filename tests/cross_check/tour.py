"""The order of a plan's poses, or polished ones, and its times by Ruckig and python-tsp.

    python tests/cross_check/tour.py PLAN PROBLEM [PLAN PROBLEM ...]

Ruckig (time-optimal trajectories) plans every move between two poses with all joints in phase, by the speeds, accelerations and jerks of the
problem file: its times must be those of `plan.json`. They may be shorter where one joint limits the speed and another the acceleration or the
jerk, for Ruckig then leaves the straight line; of such moves the share of the way, one joint whose limits are those of all, is planned too.
python-tsp finds the order of least time by its own dynamic programming. Of robots that a Denavit-Hartenberg table describes. Exits with 1 at the first disagreement. Makes a virtual environment with packages from PyPI (see
environment.py).
"""

import json
import sys
import tomllib
from pathlib import Path

from environment import run_with

# Times agree to this share.
SAME = 1e-6
# What python-tsp can do in a few seconds.
MOST_POSES = 13


def limits_of(problem):
    """Speeds, accelerations and jerks of the joints in rad or m, infinite where there is no limit, and whether all joints reach their speed in
    the same time, without a limit of jerk."""
    motion = problem.get("motion", {})
    share = motion.get("speed_percent", 100) / 100
    speeds, accelerations, jerks = [], [], []
    for joint in problem["robot"]["joints"]:
        turns = joint.get("kind", "revolute") == "revolute"
        unit = "deg" if turns else "mm"
        in_si = np.radians if turns else lambda mm: mm / 1e3
        usual = motion.get(f"default_speed_{unit}_s", 10 if turns else 50)
        speed = in_si(joint.get(f"max_speed_{unit}_s", usual))
        stated = motion.get(f"max_acceleration_{unit}_s2", {}).get(joint["name"])
        speeds.append(share * float(speed))
        accelerations.append(share * float(in_si(stated) if stated else speed))
        jerks.append(share * float(in_si(motion.get(f"max_jerk_{unit}_s3", {}).get(joint["name"], np.inf))))
    ratios = np.array(accelerations) / speeds
    in_one_time = bool(np.ptp(ratios) < 1e-12 * ratios.max()) and not np.isfinite(jerks).any()
    return (speeds, accelerations, jerks), in_one_time


def of_line(start, end, limits):
    """Ruckig's time for the share of the straight way, which keeps to the limits of all joints."""
    ways = np.abs(np.subtract(end, start))
    moving = ways > 0
    return duration([0], [1], [[(np.array(most)[moving] / ways[moving]).min()] for most in limits]) if moving.any() else 0.0


def duration(start, end, limits):
    """Ruckig's time for the move from rest to rest."""
    if np.allclose(start, end, rtol=0, atol=0):
        return 0.0
    move = ruckig.InputParameter(len(start))
    move.current_position, move.target_position = list(start), list(end)
    move.max_velocity, move.max_acceleration, move.max_jerk = limits
    move.synchronization = ruckig.Synchronization.Phase
    trajectory = ruckig.Trajectory(len(start))
    result = ruckig.Ruckig(len(start)).calculate(move, trajectory)
    if result not in (ruckig.Result.Working, ruckig.Result.Finished):
        raise SystemExit(f"Ruckig: {result}")
    return trajectory.duration


def check(plan_path, problem_path):
    plan = json.loads(Path(plan_path).read_text())
    problem = tomllib.loads(Path(problem_path).read_text())
    tour = plan["tour"]
    limits, in_one_time = limits_of(problem)
    of_id = {pose["id"]: pose["joints_rad"] for pose in plan["poses"]}
    assert sorted(tour["order"]) == sorted(of_id), "the tour is not of the plan's poses"
    way = [of_id[id] for id in tour["order"]]
    home = tour.get("home_rad")
    if home:
        way = [home, *way] + ([home] if tour["returns"] else [])
    moves = list(zip(tour["moves"], zip(way, way[1:]), strict=True))
    for move, (start, end) in moves:
        corners = [start, *move.get("via_rad", []), end]
        stated = move["seconds"]
        lines = sum(of_line(a, b, limits) for a, b in zip(corners, corners[1:]))
        found = sum(duration(a, b, limits) for a, b in zip(corners, corners[1:]))
        assert abs(stated - lines) <= SAME * stated, f"a straight move takes {lines} s by Ruckig, {stated} s by the plan"
        is_same = abs(stated - found) <= SAME * stated
        assert is_same or (not in_one_time and found < stated), f"a move takes {found} s by Ruckig, {stated} s by the plan"
    assert abs(tour["moving_s"] - sum(move["seconds"] for move in tour["moves"])) < 1e-9 * tour["moving_s"]

    line = f"{plan_path}: {len(of_id)} poses, {tour['moving_s']:.2f} s of moves, by id {tour['moving_by_id_s']:.2f} s"
    if len(of_id) > MOST_POSES or any("via_rad" in move for move in tour["moves"]):
        print(f"{line}; order not compared")
        return
    # A dummy at no cost from any stop opens the round, but from home it is between the last pose and home.
    stops = ([home] if home else []) + list(of_id.values())
    costs = np.array([[of_line(a, b, limits) for b in stops] for a in stops])
    if not home:
        costs = np.pad(costs, ((1, 0), (1, 0)))
    elif not tour["returns"]:
        costs[:, 0] = 0
    _, least = solve_tsp_dynamic_programming(costs)
    assert abs(tour["moving_s"] - least) <= SAME * least, f"python-tsp's order takes {least} s"
    assert abs(tour["least_moving_s"] - least) <= SAME * least
    print(f"{line}; python-tsp: {least:.2f} s")


if __name__ == "__main__":
    if len(sys.argv) < 3 or len(sys.argv) % 2 == 0:
        sys.exit(__doc__)
    run_with("numpy==2.4.6", "ruckig==0.19.4", "python-tsp==0.5.0")
    import numpy as np
    import ruckig
    from python_tsp.exact import solve_tsp_dynamic_programming

    for pair in zip(sys.argv[1::2], sys.argv[2::2]):
        check(*pair)

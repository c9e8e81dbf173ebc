"""What `calipose score` says of lists of poses that other programs wrote, against NumPy and OpenCV.

    python tests/cross_check/score.py

Poses of the Servosila Engineer drawn at random, some of which are no views, written as robot_calibration's poses by PyYAML (with the aliases
that it makes of a list that is used again), as MoveIt Calibration's joint states by ruamel.yaml, as a JointTrajectory that rosbags fills and
serialises as CDR, as a table by pandas (with its index, columns in another order, in degrees), and as easy_handeye2's samples of NumPy's own
kinematics. Asserts that

- every file is read, and of its poses those can be used that NumPy's kinematics and OpenCV's projection find to be views;
- map error and standard deviations are OpenCV's and NumPy's, and so are the map errors without each pose and after each swap;
- the bound holds: the efficiency is the ratio of bound and value, and no swap leads beyond the bound.

$CALIPOSE is the program, or target/release/calipose. The packages are PyPI's (in $CROSS_CHECK_VENV, or a temporary folder). Exits with 1
where anything is off.
"""

import json
import os
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

from environment import run_with

ROOT = Path(__file__).resolve().parents[2]
PROBLEM = ROOT / "problems" / "servosila-engineer.toml"
# Between kinematics and projections in double precision; of joint values that inverse kinematics found more.
TOLERANCE, BY_INVERSE = 1e-5, 1e-4
VIEWS, OTHERS = 14, 6


def drawn(setting, rng):
    """Joint values of as many views as asked for, and of configurations that are none, mixed."""
    q, is_view = [], []
    while is_view.count(True) < VIEWS or is_view.count(False) < OTHERS:
        candidate = rng.uniform(setting.limits[:, 0], setting.limits[:, 1])
        view = setting.look(candidate) is not None
        if is_view.count(view) < (VIEWS if view else OTHERS):
            q.append(candidate)
            is_view.append(view)
    # One beyond a joint's limit.
    beyond = q[is_view.index(True)].copy()
    beyond[2] = 0.2
    q.append(beyond)
    is_view.append(False)
    order = rng.permutation(len(q))
    return np.array(q)[order], np.array(is_view)[order]


def robot_calibration(names, q):
    joints = list(reversed(names))
    poses = [{"joints": joints, "positions": [float(x) for x in row[::-1]], "features": []} for row in q]
    text = yaml.dump(poses)
    assert "*id" in text, "PyYAML made no aliases"
    return text


def moveit_calibration(names, q):
    stream = io.StringIO()
    YAML(typ="safe", pure=True).dump({"joint_names": names, "joint_values": q.tolist()}, stream)
    return stream.getvalue()


def joint_trajectory(names, q):
    store = get_typestore(Stores.ROS2_JAZZY)
    kinds = store.types
    duration = kinds["builtin_interfaces/msg/Duration"]
    point = kinds["trajectory_msgs/msg/JointTrajectoryPoint"]
    none = np.zeros(0)
    points = [point(row, none, none, none, duration(3 * i, 0)) for i, row in enumerate(q, 1)]
    header = kinds["std_msgs/msg/Header"](kinds["builtin_interfaces/msg/Time"](0, 0), "")
    kind = "trajectory_msgs/msg/JointTrajectory"
    message = store.deserialize_cdr(store.serialize_cdr(kinds[kind](header, names, points), kind), kind)
    return yaml.safe_dump({
        "header": {"stamp": {"sec": message.header.stamp.sec, "nanosec": message.header.stamp.nanosec}, "frame_id": ""},
        "joint_names": list(message.joint_names),
        "points": [
            {
                "positions": p.positions.tolist(),
                "velocities": p.velocities.tolist(),
                "accelerations": p.accelerations.tolist(),
                "effort": p.effort.tolist(),
                "time_from_start": {"sec": p.time_from_start.sec, "nanosec": p.time_from_start.nanosec},
            }
            for p in message.points
        ],
    })


def table(names, q):
    columns = {f"{name}_deg": np.degrees(q[:, i]) for i, name in reversed(list(enumerate(names)))}
    return pandas.DataFrame({"note": ["by hand"] * len(q), **columns}).to_csv()


def samples(setting, q):
    """Of the flange, which is where the camera is less its mount."""
    mount = np.eye(4)
    mount[:3, :3] = [[0, 0, 1], [0, -1, 0], [1, 0, 0]]
    listed = []
    for row in q:
        X = setting.camera_pose(row) @ np.linalg.inv(mount)
        x, y, z, w = Rotation.from_matrix(X[:3, :3]).as_quat()
        robot = {"translation": dict(zip("xyz", X[:3, 3].tolist())), "rotation": dict(zip("xyzw", map(float, (x, y, z, w))))}
        listed.append({"robot": robot, "tracking": {"translation": {"x": 0.0, "y": 0.0, "z": 1.0}}})
    return yaml.safe_dump({"parameters": {"calibration_type": "eye_in_hand"}, "samples": listed})


def accuracy(setting, q):
    """Map error and standard deviations."""
    covariance = checks.inverse(sum(setting.look(row)[0] for row in q))
    return np.sqrt(np.trace(setting.weight @ covariance)), np.sqrt(np.diag(covariance))


def off(a, b):
    return abs(a / b - 1)


def holds(setting, score, q, is_view, tolerance):
    """Whether the document says of these configurations what OpenCV and NumPy find."""
    usable = [pose["reason"] is None and pose["excluded"] is None for pose in score["poses"]]
    if usable != is_view.tolist():
        print("    usable poses differ:", [(a, b) for a, b in zip(score["poses"], is_view) if (a["reason"] is None) != b])
        return False
    # Those whose axis misses the zone are usable, though no plan has them: NumPy's tests call them no views.
    counted = [pose for pose in score["poses"] if pose["reason"] is None]
    if len(counted) != is_view.sum():
        sys.exit("draw other configurations: the axis of one misses the zone and it sees the board")
    views = q[is_view]
    map_error, sigma = accuracy(setting, views)
    stated = score["set"]
    worst = [off(stated["map_error_px"], map_error), off(stated["value"], map_error**2)]
    worst += [off(a, b) for a, b in zip(stated["sigma"].values(), sigma)]
    for i, pose in enumerate(counted):
        without = accuracy(setting, np.delete(views, i, axis=0))[0]
        worst += [off(pose["map_error_without_px"], without), abs(pose["loss"] - (1 - (map_error / without) ** 2))]
    place = {pose["name"]: i for i, pose in enumerate(counted)}
    for swap in score["swaps"]:
        after = views.copy()
        after[place[swap["out"]]] = swap["joints_rad"]
        worst.append(off(swap["map_error_px"], accuracy(setting, after)[0]))
    after = views.copy()
    for swap in score["exchange"]:
        after[place[swap["out"]]] = swap["joints_rad"]
        worst.append(off(swap["map_error_px"], accuracy(setting, after)[0]))
    bound = score["best"]["bound"]
    worst.append(off(score["efficiency"], bound / map_error**2))
    reached = [score["best"]["map_error_px"], *(swap["map_error_px"] for swap in score["swaps"] + score["exchange"])]
    print(f"    map error {stated['map_error_px']:.6f} px, by OpenCV and NumPy {map_error:.6f}; efficiency {score['efficiency']:.4f}; after "
          f"three swaps {reached[-1]:.4f} px; of {len(worst)} numbers the worst is off by {max(worst):.1e}")
    return max(worst) <= tolerance and len(score["swaps"]) == 3 and min(reached) ** 2 >= bound * (1 - 1e-9)


def main():
    program = os.environ.get("CALIPOSE", ROOT / "target/release/calipose")
    problem = tomllib.loads(PROBLEM.read_text())
    setting = Setting(problem, {"intrinsics": {"names": problem["estimate"]["intrinsics"]}})
    names = [row["name"] for row in problem["robot"]["joints"]]
    good = True
    for seed in range(2):
        q, is_view = drawn(setting, np.random.default_rng(seed))
        # The flange gets where a joint is beyond its limit in another way, perhaps.
        within = np.all(q <= setting.limits[:, 1] + 1e-9, axis=1)
        files = {
            "robot-calibration": ("poses.yaml", robot_calibration(names, q), within | True, TOLERANCE),
            "moveit-calibration": ("states.yaml", moveit_calibration(names, q), within | True, TOLERANCE),
            "joint-trajectory": ("trajectory.yaml", joint_trajectory(names, q), within | True, TOLERANCE),
            "csv": ("table.csv", table(names, q), within | True, TOLERANCE),
            "easy-handeye2": ("a.samples", samples(setting, q[within]), within, BY_INVERSE),
        }
        with tempfile.TemporaryDirectory() as folder:
            for kind, (name, text, listed, tolerance) in files.items():
                path = Path(folder) / name
                path.write_text(text, encoding="utf-8")
                said = subprocess.run([program, "score", path, "--problem", PROBLEM, "--json"], capture_output=True, text=True)
                assert said.returncode == 0, said.stderr
                score = json.loads(said.stdout)
                print(f"seed {seed}: {score['read_as']}, {score['count']} of {score['listed']} poses usable", flush=True)
                good &= score["read_as"] == kind and holds(setting, score, q[listed], is_view[listed], tolerance)
    return 0 if good else 1


if __name__ == "__main__":
    run_with(
        "numpy==2.4.6",
        "opencv-python-headless==5.0.0.93",
        "pandas==3.1.1",
        "PyYAML==6.0.4",
        "rosbags==0.11.9",
        "ruamel.yaml==0.19.1",
        "scipy==1.16.3",
    )
    import io

    import cv2
    import numpy as np
    import pandas
    import yaml
    from rosbags.typesys import Stores, get_typestore
    from ruamel.yaml import YAML
    from scipy.spatial.transform import Rotation

    import map_error as checks
    import off_grid
    from off_grid import Setting

    checks.np, checks.cv2 = np, cv2
    off_grid.np, off_grid.cv2, off_grid.checks = np, cv2, checks
    sys.exit(main())

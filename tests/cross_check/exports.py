"""Files that `tests/tools/exports.rs` writes for robots' programs, read by foreign eyes.

    python tests/cross_check/exports.py [FOLDER]

Asserts that joint values survive (to the last bit in YAML, CSV and URScript; to the decimals that the file has in degrees) and that times are
right, in tours with odd names, with a track, with four joints, and that robots a format has not are refused:

- YAML: PyYAML's libyaml, which ROS's parameters are read with, and ruamel.yaml (YAML 1.2); JointTrajectory also through rosbags, which
  serialises it as CDR and reads it back; the cubics between its points, or where jerk is limited the quintics, sampled, keep to the joints' speeds, accelerations and jerks.
- CSV: pandas.
- RAPID: the grammar of rapidchecker.
- KRL: krllint, a checker of style, and a grammar of our own.
- URScript: Python's own parser, since what we write of it is Python but for `end`; and a grammar of our own.
- FANUC LS: a grammar of our own, after a file that a controller wrote (testdata/md/test.ls of onerobotics/go-fanuc); J3 against
  crx-kinematics, which takes the pendant's angles.

A grammar of our own is a strict regular expression after the vendor's manual, not a foreign reader. FOLDER has the files; they are written
anew when left out. The packages are PyPI's (in $CROSS_CHECK_VENV, or a temporary folder). Exits with 1 where anything is off.
"""

import ast
import io
import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from environment import run_with

ROOT = Path(__file__).resolve().parents[2]
ANGLE = 5.1e-7  # Half of the last decimal, deg and mm.
FANUC_ANGLE = 5.1e-5
NODE_MOVE = 4.0  # What the ROS 2 node gives each goal, s.
REFUSED = {"six": set(), "odd": set(), "tracked": {"urscript"}, "four": {"urscript"}, "seven": {"urscript", "rapid", "krl", "fanuc-ls"}, "eased": set()}
DECIMAL = r"-?\d+\.\d+"


class Tour:
    """What a folder's files must say."""

    def __init__(self, folder):
        said = json.loads((folder / "tour.json").read_text(encoding="utf-8"))
        self.folder, self.files = folder, said["files"]
        self.names = [joint["name"] for joint in said["joints"]]
        self.slides = np.array([joint["prismatic"] for joint in said["joints"]])
        self.speed = said["share"] * np.array([joint["speed"] for joint in said["joints"]])
        self.acceleration = np.array([joint["acceleration"] for joint in said["joints"]])
        # Infinite where there is no limit.
        self.jerk = np.array([joint["jerk"] or np.inf for joint in said["joints"]])
        self.dwell, self.share = said["dwell"], said["share"]
        pictures = [stop for stop in said["stops"] if stop["picture"]]
        self.stops = np.array([stop["q"] for stop in pictures])
        self.labels = [stop["label"] for stop in pictures]
        # Label, values, time of the move there, time there.
        self.visits = [
            (stop["label"], np.array(stop["q"]), stop["seconds"], self.dwell if stop["picture"] else 0.0) for stop in said["stops"]
        ]
        if said["home"]:
            home = np.array(said["home"]["q"])
            self.visits = [("home", home, 0.0, 0.0), *self.visits, ("home", home, said["home"]["seconds"], 0.0)]

    def read(self, kind):
        path = self.folder / self.files[kind]["file"]
        return path.read_bytes().decode()

    def axes(self, q):
        """The arm's values in degrees, the tracks' in mm."""
        return np.degrees(q[~self.slides]), 1e3 * q[self.slides]


def yaml_of(text):
    """The document, on which two readers agree."""
    document = yaml.load(text, yaml.CSafeLoader)
    assert document == YAML(typ="safe", pure=True).load(text), "PyYAML and ruamel.yaml differ"
    return document


def all_floats(values):
    assert all(type(value) is float for value in values), values
    return np.array(values)


def ros2_goals(tour):
    """As publisher_joint_trajectory_controller.py reads it."""
    (node, document), = yaml_of(tour.read("ros2-goals")).items()
    parameters = document["ros__parameters"]
    assert node == "/**" and parameters["joints"] == tour.names and parameters["check_starting_point"] is False
    wait = parameters["wait_sec_between_publish"]
    assert type(wait) is int and wait >= NODE_MOVE + tour.dwell
    goals = [all_floats(parameters[name]["positions"]) for name in parameters["goal_names"]]
    assert len(set(parameters["goal_names"])) == len(goals) == len(parameters) - 5
    assert all(re.fullmatch(r"[A-Za-z]\w*", name, re.ASCII) for name in parameters["goal_names"])
    at = -1
    for (_, q, seconds, _), before in zip(tour.visits, [None, *(visit[1] for visit in tour.visits)]):
        first = at + 1
        at = next(i for i in range(first, len(goals)) if np.array_equal(goals[i], q))
        if before is None:
            continue
        way = [before, *goals[first : at + 1]]
        for begin, end in zip(way, way[1:]):
            # Each part a share of the whole way, at no more than its mean speed.
            part = np.abs(end - begin) / NODE_MOVE
            assert np.all(part <= np.abs(q - before) / seconds * (1 + 1e-9) + 1e-12)
            assert abs(np.linalg.norm(begin - before) + np.linalg.norm(q - begin) - np.linalg.norm(q - before)) < 1e-9
    assert at == len(goals) - 1
    return f"{len(goals)} goals, every {wait} s"


def peaks(begin, end, seconds, eased):
    """Greatest speeds, accelerations and jerks of the cubic, or the quintic, at rest at both ends, sampled."""
    t = np.linspace(0, 1, 20001)
    share = np.polynomial.Polynomial([0, 0, 0, 10, -15, 6] if eased else [0, 0, 3, -2])
    rates = [np.abs(share.deriv(order)(t)).max() / seconds**order for order in (1, 2, 3)]
    return [rate * np.abs(end - begin) for rate in rates]


def joint_trajectory(tour):
    document = yaml_of(tour.read("joint-trajectory"))
    kinds = get_typestore(Stores.ROS2_HUMBLE)
    make = lambda name, **fields: kinds.types[name](**fields)
    stamp = make("builtin_interfaces/msg/Time", **document["header"]["stamp"])
    points = [
        make(
            "trajectory_msgs/msg/JointTrajectoryPoint",
            time_from_start=make("builtin_interfaces/msg/Duration", **point.pop("time_from_start")),
            **{key: all_floats(values) if values else np.array([]) for key, values in point.items()},
        )
        for point in document["points"]
    ]
    message = make(
        "trajectory_msgs/msg/JointTrajectory",
        header=make("std_msgs/msg/Header", stamp=stamp, frame_id=document["header"]["frame_id"]),
        joint_names=document["joint_names"],
        points=points,
    )
    kind = message.__msgtype__
    read = kinds.deserialize_cdr(kinds.serialize_cdr(message, kind), kind)
    assert read.joint_names == tour.names
    assert all(len(point.velocities) == len(tour.names) and not np.any(point.velocities) for point in read.points)
    assert all(0 <= point.time_from_start.nanosec < 1e9 for point in read.points)
    eased = bool(np.isfinite(tour.jerk).any())
    assert all(len(point.accelerations) == eased * len(tour.names) and not np.any(point.accelerations) for point in read.points)
    at = [(point.positions, point.time_from_start.sec + point.time_from_start.nanosec * 1e-9) for point in read.points]
    before, stretched = None, 0
    for label, q, seconds, dwell in tour.visits:
        arrival = at.pop(0)
        assert np.array_equal(arrival[0], q), label
        if before is None:
            assert arrival[1] >= 5
        else:
            takes = arrival[1] - before[1]
            greatest = peaks(before[0], q, takes, eased)
            used = max((peak / most).max() for peak, most in zip(greatest, (tour.speed, tour.acceleration, tour.jerk)))
            assert used <= 1 + 1e-6 and takes >= seconds - 2e-9, (label, used, takes)
            assert abs(takes - seconds) < 2e-9 or used > 0.999, f"{label} takes {takes} s, needlessly"
            stretched += takes > seconds + 1e-6
        before = arrival
        if dwell:
            before = at.pop(0)
            assert np.array_equal(before[0], q) and abs(before[1] - arrival[1] - dwell) < 2e-9
    assert not at
    return f"{len(read.points)} points, {stretched} moves longer than planned for the curve's sake"


def robot_calibration(tour):
    poses = yaml_of(tour.read("robot-calibration"))
    assert all(pose["joints"] == tour.names and pose["features"] == [] for pose in poses)
    assert np.array_equal([all_floats(pose["positions"]) for pose in poses], tour.stops)
    return f"{len(poses)} poses"


def moveit_calibration(tour):
    assert tour.files["moveit-calibration"]["file"].endswith(".yaml")
    document = yaml_of(tour.read("moveit-calibration"))
    assert document["joint_names"] == tour.names
    assert np.array_equal([all_floats(row) for row in document["joint_values"]], tour.stops)
    return f"{len(document['joint_values'])} rows"


def table(tour):
    rows = pandas.read_csv(io.StringIO(tour.read("csv"), newline=""))
    units = [("m", "mm") if slides else ("rad", "deg") for slides in tour.slides]
    first, second = [[f"joint_{name}_{unit[i]}" for name, unit in zip(tour.names, units)] for i in (0, 1)]
    assert list(rows.columns) == ["visit", "label", *first, *second, "seconds", "dwell"]
    assert list(rows["label"]) == [visit[0] for visit in tour.visits]
    places = np.array([visit[1] for visit in tour.visits])
    assert np.array_equal(rows[first], places)
    assert np.abs(rows[second] - np.where(tour.slides, 1e3 * places, np.degrees(places))).max(axis=None) < ANGLE
    assert list(rows["seconds"])[1:] == [visit[2] for visit in tour.visits[1:]] and rows["seconds"][0] == 0
    assert list(rows["dwell"]) == [visit[3] for visit in tour.visits]
    visits = iter(range(1, len(rows) + 1))
    assert list(rows["visit"]) == [next(visits) if visit[3] else 0 for visit in tour.visits]
    return f"{len(rows)} rows"


def ascii_only(text):
    assert text.isascii() and not re.search(r"[\x00-\x08\x0b-\x1f\x7f]", text), "a character that controllers do not show"


def in_order(lines, grammar, what):
    """Matches every line with one of the named expressions of `grammar`, and returns the names and matches."""
    found = []
    for line in lines:
        matches = [(name, match) for name, form in grammar.items() if (match := re.fullmatch(form, line))]
        assert len(matches) == 1, f"{what}: {line!r} is {[name for name, _ in matches]}"
        found.append(matches[0])
    return found


def urscript(tour):
    text = tour.read("urscript")
    ascii_only(text)
    grammar = {
        "def": r"def [a-zA-Z]\w*\(\):",
        "comment": r"  # .*",
        "textmsg": r'  textmsg\("[^"\\]*"\)',
        "movej": rf"  movej\(\[{DECIMAL}(, {DECIMAL}){{5}}\], a={DECIMAL}, v={DECIMAL}\)",
        "sleep": rf"  sleep\({DECIMAL}\)",
        "end": "end",
    }
    in_order(text.splitlines(), grammar, "URScript")
    assert text.endswith("\nend\n")
    function, = ast.parse(text.removesuffix("end\n")).body
    assert f"{function.name}.script" == tour.files["urscript"]["file"]
    calls = [(call.value.func.id, call.value) for call in function.body]
    before, moves = None, 0
    for label, q, _, dwell in tour.visits:
        name, message = calls.pop(0)
        assert name == "textmsg" and message.args[0].value.startswith(label)
        name, move = calls.pop(0)
        said = {word.arg: word.value.value for word in move.keywords}
        assert name == "movej" and np.array_equal(ast.literal_eval(move.args[0]), q), label
        if before is None:
            assert 0 < said["v"] <= 0.1
        else:
            # Every joint keeps step with the one with the longest way.
            share = np.abs(q - before) / np.abs(q - before).max()
            for key, most in (("v", tour.speed), ("a", tour.acceleration)):
                used = (said[key] * share / most).max()
                assert 1 - 1e-5 < used < 1 + 1e-5, (label, key, used)
        before, moves = q, moves + 1
        if dwell:
            name, sleep = calls.pop(0)
            assert name == "sleep" and sleep.args[0].value == dwell
    assert not calls
    return f"{moves} moves"


def rapid(tour):
    text = tour.read("rapid")
    ascii_only(text)
    assert not check_format(text), check_format(text)
    for there, broken in ((";", ""), ("ENDPROC\n", ""), ("fine, tool0;", "fine tool0;")):
        assert check_format(text.replace(there, broken, 1)), "rapidchecker takes anything"
    reset_level()
    words = [str(word) for word in module.parse_string(text, parse_all=True)]
    assert f"{words[1]}.mod" == tour.files["rapid"]["file"]
    declared = re.findall(r"CONST jointtarget (\w+)", text)
    names = [words[1], re.search(r"PROC (\w+)", text)[1], *declared]
    assert len({name.lower() for name in names}) == len(names) and all(len(name) <= 32 for name in names)
    targets = {}
    for i, word in enumerate(words):
        if word == "jointtarget":
            numbers = [float(x) for x in words[i + 3 : words.index("LOCAL" if "LOCAL" in words[i:] else "PROC", i)] if re.match(r"-?\d", x)]
            assert len(numbers) == 12
            targets[words[i + 1]] = np.array(numbers)
    assert list(targets) == declared
    moves = re.findall(r'TPWrite "(.*)";\n\s+MoveAbsJ (\w+)\\NoEOffs, v50(?:\\T:=(\d+\.\d+))?, fine, tool0;\n(?:\s+WaitTime\\InPos, (\S+);\n)?', text)
    assert len(moves) == len(tour.visits) == text.count("MoveAbsJ") and text.count("WaitTime") == len(tour.stops)
    for i, ((label, q, seconds, dwell), (message, name, time, wait)) in enumerate(zip(tour.visits, moves)):
        assert message.startswith(label) and name == declared[i]
        for values, six in zip(tour.axes(q), (targets[name][:6], targets[name][6:])):
            assert np.abs(six[: len(values)] - values).max(initial=0) < ANGLE and np.all(six[len(values) :] == 9e9)
        assert (time == "") if i == 0 else (0 <= float(time) - seconds < 1.001e-3)
        assert (float(wait) == dwell) if dwell else wait == ""
    return f"{len(moves)} moves"


def krl(tour):
    path = tour.folder / tour.files["krl"]["file"]
    text = tour.read("krl")
    ascii_only(text)
    said = subprocess.run([sys.executable, "-m", "krllint", path], capture_output=True, text=True, check=False)
    assert not said.stderr and len(re.findall(r"^0 ", said.stdout, re.M)) == 5, said.stdout + said.stderr
    grammar = {
        "attribute": r"&(ACCESS RVP|REL 1)",
        "def": r"DEF ([A-Za-z]\w{0,15})\(\)",
        "comment": r";.*",
        "nothing": "",
        "init": r"BAS\(#INITMOV, 0\)",
        "percent": r"\$(VEL|ACC)_(AXIS|EXTAX)\[([1-6])\] = (\d{1,2}|100)",
        "move": rf"PTP \{{([AE][1-6] {DECIMAL}(?:, [AE][1-6] {DECIMAL})*)\}}",
        "wait": r"WAIT SEC (\d+\.\d+)",
        "end": "END",
    }
    found = [(name, match) for name, match in in_order(text.splitlines(), grammar, "KRL") if name not in ("comment", "nothing")]
    kinds = [name for name, _ in found]
    assert kinds[:4] == ["attribute", "attribute", "def", "init"] and kinds[-1] == "end"
    assert f"{found[2][1][1]}.src" == path.name
    percents = [int(match[4]) for name, match in found if name == "percent"]
    axes = 2 * len(tour.names)
    assert percents == [5] * axes + [round(100 * tour.share)] * axes
    moves = [match[1] for name, match in found if name == "move"]
    assert len(moves) == len(tour.visits)
    for (label, q, _, _), move in zip(tour.visits, moves):
        values = {axis: float(value) for axis, value in (part.split(" ") for part in move.split(", "))}
        for letter, expected in zip("AE", tour.axes(q)):
            got = [values.pop(f"{letter}{i + 1}") for i in range(len(expected))]
            assert np.abs(got - expected).max(initial=0) < ANGLE, label
        assert not values
    order = [name for name in kinds if name in ("move", "wait")]
    assert order == [part for visit in tour.visits for part in (["move", "wait"] if visit[3] else ["move"])]
    assert all(float(match[1]) == tour.dwell for name, match in found if name == "wait")
    return f"{len(moves)} moves"


def fanuc_ls(tour):
    text = tour.read("fanuc-ls")
    ascii_only(text)
    whole = re.fullmatch(r"/PROG  ([A-Z][A-Z0-9_]{0,7})\n/ATTR\n(.*)\n/MN\n(.*)\n/POS\n(.*\n)/END\n", text, re.S)
    assert whole and f"{whole[1]}.LS" == tour.files["fanuc-ls"]["file"]
    lines = whole[3].splitlines()
    assert f"LINE_COUNT\t= {len(lines)};" in whole[2]
    assert [int(line[:4]) for line in lines] == list(range(1, len(lines) + 1))
    grammar = {
        "remark": r"  ![^;]{0,32} ;",
        "frame": r"  (UFRAME_NUM=0|UTOOL_NUM=1) ;",
        "move": r"J P\[(\d+)\] (\d{1,2}|100)% FINE ;",
        "wait": r"  WAIT +(\d+\.\d\d)\(sec\) ;",
    }
    found = in_order([line[5:] for line in lines], grammar, "LS")
    moves = [(int(match[1]), int(match[2])) for name, match in found if name == "move"]
    percent = round(100 * tour.share)
    assert moves == [(i + 1, min(percent, 5) if i == 0 else percent) for i in range(len(tour.visits))]
    waits = [match[1] for name, match in found if name == "wait"]
    assert [float(wait) for wait in waits] == [tour.dwell] * len(tour.stops)
    value = rf"\t[JE]\d= *{DECIMAL} (?:deg|mm)"
    block = rf"P\[(\d+)\]\{{\n   GP1:\n\tUF : 0, UT : 1,\n({value}(?:,\n?{value})*)\n\}};\n"
    assert re.fullmatch(f"(?:{block})+", whole[4])
    robot, forearm = crx_kinematics.Crx.crx10ia(), 0.0
    for (label, q, _, _), (_, rows) in zip(tour.visits, re.findall(block, whole[4]), strict=True):
        pairs = re.findall(rf"([JE]\d)= *({DECIMAL}) (deg|mm)", rows)
        assert all((unit == "deg") == (name[0] == "J") for name, _, unit in pairs)
        values = {name: float(value) for name, value, _ in pairs}
        arm, track = tour.axes(q)
        pendant = [values[f"J{i + 1}"] for i in range(len(arm))]
        # The forearm's tilt in a chain: J2 about y takes it down, J3 about -y up.
        chain = turn("z", arm[0]) @ turn("y", arm[1]) @ turn("y", -arm[2])
        tilt = robot.fk([*pendant[:3], 0, 0, 0])[:3, :3] @ robot.fk([0] * 6)[:3, :3].T
        forearm = max(forearm, np.abs(tilt - chain).max())
        others = [i for i in range(len(arm)) if i != 2]
        assert np.abs(np.array(pendant)[others] - arm[others]).max() < FANUC_ANGLE, label
        assert np.abs([values[f"E{i + 1}"] for i in range(len(track))] - track).max(initial=0) < FANUC_ANGLE
        assert len(values) == len(q)
    assert forearm < 4e-6, f"the forearm is turned by {forearm}"
    return f"{len(moves)} moves, forearm as in the chain within {np.degrees(forearm):.5f} deg"


def turn(axis, degrees):
    """The rotation about an axis of the base."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]] if axis == "z" else [[c, 0, s], [0, 1, 0], [-s, 0, c]])


CHECKS = {
    "ros2-goals": ros2_goals,
    "joint-trajectory": joint_trajectory,
    "robot-calibration": robot_calibration,
    "moveit-calibration": moveit_calibration,
    "urscript": urscript,
    "rapid": rapid,
    "krl": krl,
    "fanuc-ls": fanuc_ls,
    "csv": table,
}


def check(tour, wrong):
    assert set(tour.files) == set(CHECKS)
    refused = {kind for kind, said in tour.files.items() if "refused" in said}
    if refused != REFUSED[tour.folder.name]:
        wrong.append(f"{tour.folder.name}: refused by {sorted(refused)}")
    for kind, read in CHECKS.items():
        if kind in refused:
            continue
        try:
            print(f"{tour.folder.name}, {kind}: {read(tour)}")
        except Exception as error:
            wrong.append(f"{tour.folder.name}, {kind}: {type(error).__name__}: {error}")


def main():
    wrong = []
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(sys.argv[1] if len(sys.argv) > 1 else temporary)
        if len(sys.argv) < 2:
            subprocess.run(["cargo", "run", "--locked", "--quiet", "--example", "exports", "--", folder], cwd=ROOT, check=True)
        for name in REFUSED:
            check(Tour(folder / name), wrong)
    for fault in wrong:
        print(fault)
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    run_with(
        "crx-kinematics==0.1.2",
        "krllint==0.1.8",
        "numpy==2.4.6",
        "pandas==3.1.1",
        "PyYAML==6.0.4",
        "rapidchecker==0.1.5",
        "rosbags==0.11.9",
        "ruamel.yaml==0.19.1",
    )
    import crx_kinematics
    import numpy as np
    import pandas
    import yaml
    from rapidchecker.check import check_format
    from rapidchecker.parser.grammar import module
    from rapidchecker.parser.indent import reset_level
    from rosbags.typesys import Stores, get_typestore
    from ruamel.yaml import YAML

    main()

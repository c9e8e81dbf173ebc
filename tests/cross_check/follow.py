"""A robot's program that follows a plan by `calipose follow --json`, on rendered pictures and with OpenCV's detector.

    python tests/cross_check/follow.py [PROBLEM]

A plan of the problem (problems/servosila-engineer.toml, with constant noise, as OpenCV's calibrateCamera has it) is carried out as a script at
a robot would: it reads the poses that are announced, lets `calipose render` make the picture of each, adds the sensor's noise, lets OpenCV
detect the corners and writes them to the watched folder, slowly and in parts. On the way a lens cap is left on, the arm does not move, a file
is broken, and the program is killed; it must say so, and go on. Twice: with the accuracy that the plan promises for more noise than these
pictures have, where the tour must end early; and with one that the plan's poses do not reach, where poses must be added. Every joint value of
the ways must be within the limits, and the ways must hang together. In the end calipose's calibration must be that of cv2.calibrateCamera on the
same corners, and the true camera must be where its covariance says: the squared distance of the estimate from it, whitened, below the 99.99 %
point of chi-square. Every event, and follow.json, must be as its JSON Schema says. Makes a virtual environment with packages from PyPI (see environment.py); CALIPOSE is the program, else the release binary
of this tree. Exits with 1 where something is not so.
"""

import functools
import json
import os
import queue
import signal
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import board_detectors
import map_error
from environment import run_with

ROOT = Path(__file__).resolve().parents[2]
CALIPOSE = os.environ.get("CALIPOSE", ROOT / "target/release/calipose")
SETTINGS = ["noise.model=constant", "selection.off_grid=false", "motion.home=[0, 60, -100, 90]"]
# Grey values: so much that what is systematic in pictures hardly counts, and so little that the plan's promise is kept early.
SENSOR = 10.0
SEED = 3
# OpenCV ends where steps are short, and the optimum is flat: in standard deviations.
SAME = 0.002
# Of chi-square with nine degrees of freedom, 99.99 %.
FAR = 33.7
PATIENCE_S = 120


def calipose(*arguments, **options):
    run = [CALIPOSE, *map(str, arguments)]
    return subprocess.run(run, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, **{"check": True, **options}).stdout


@functools.cache
def validator(kind):
    return Draft202012Validator(json.loads(calipose("schema", "--for", kind)))


class Tour:
    """A process of `calipose follow`, its events and its stdin."""

    def __init__(self, *options):
        run = [CALIPOSE, "follow", *map(str, options), "--json", "--quiet"]
        self.process = subprocess.Popen(run, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.events = queue.Queue()
        threading.Thread(target=lambda: [self.events.put(json.loads(line)) for line in self.process.stdout], daemon=True).start()

    def next(self, *kinds):
        """The next event of these kinds; others are passed over."""
        while True:
            event = self.events.get(timeout=PATIENCE_S)
            validator("follow-event").validate(event)
            if event["event"] in kinds:
                return event

    def answer(self, line):
        self.process.stdin.write(line + "\n")
        self.process.stdin.flush()


class Robot:
    """An arm that stands somewhere, with a camera whose pictures are rendered."""

    def __init__(self, folder, problem_file, plan):
        self.folder, self.plan, self.problem_file = folder, plan, problem_file
        self.problem = map_error.read_problem(problem_file, plan)
        self.limits = [joint["limits_deg"] for joint in self.problem["robot"]["joints"]]
        which = self.problem["robot"].get("limits")
        self.limits = np.radians([limits[which] if isinstance(limits, dict) else limits for limits in self.limits])
        self.rng, self.at, self.stands, self.count = np.random.default_rng(SEED), {}, None, 0

    def go(self, pose):
        """By the turns to the pose, from where the way begins."""
        if pose["from"] is not None and self.stands is not None:
            assert pose["from"] == self.stands, f"the way begins at {pose['from']}, the arm stands at {self.stands}"
        way = np.array([*pose["turns_rad"], pose["joints_rad"]])
        assert (way >= self.limits[:, 0] - 1e-9).all() and (way <= self.limits[:, 1] + 1e-9).all(), way
        self.stands = pose["visit"]
        self.at = pose

    def picture(self):
        """What the camera sees where the arm stands."""
        pose = {key: self.at[key] for key in self.plan["poses"][0] if key in self.at}
        document = self.plan | {"poses": [pose], "count": 1}
        del document["tour"]
        here = self.folder / "here.json"
        here.write_text(json.dumps(document))
        calipose("render", here, "--problem", self.problem_file, "--noise", 0, "--output", self.folder / "here", "--quiet")
        clean = cv2.imread(str(self.folder / "here/pose-01.png"), cv2.IMREAD_GRAYSCALE).astype(float)
        return np.clip(np.rint(clean + self.rng.normal(0, SENSOR, clean.shape)), 0, 255).astype(np.uint8)

    def corners(self, picture):
        """By OpenCV; none where the board is not found."""
        target = self.problem["target"]
        size = target["columns"], target["rows"]
        smooth = cv2.GaussianBlur(picture, (0, 0), 1.0)
        found, corners = cv2.findChessboardCornersSB(smooth, size, flags=cv2.CALIB_CB_EXHAUSTIVE)
        if not found:
            found, corners = cv2.findChessboardCorners(smooth, size, flags=cv2.CALIB_CB_ADAPTIVE_THRESH)
        return board_detectors.refined(picture, corners) if found else None

    def detect(self, watched, picture=None):
        """Writes the corners that are found to the watched folder, in two parts, as vnl or as JSON; their name."""
        corners = self.corners(self.picture() if picture is None else picture)
        self.count += 1
        name = f"picture-{self.count}.png"
        if self.count % 2:
            lines = [f"{name} {u} {v} 0" for u, v in corners] if corners is not None else [f"{name} - -"]
            text, path = "\n".join(["# filename x y level", *lines, ""]), watched / f"{self.count}.vnl"
        else:
            board = self.problem["target"]["columns"] * self.problem["target"]["rows"]
            listed = [None] * board if corners is None else corners.tolist()
            width, height = (self.problem["camera"][f"{side}_px"] for side in ("width", "height"))
            document = {"format": "calipose.observations", "version": 1, "image": {"width_px": width, "height_px": height},
                        "views": [{"name": name, "corners": listed}]}
            text, path = json.dumps(document), watched / f"{self.count}.json"
        with path.open("w") as file:
            file.write(text[: len(text) // 3])
            file.flush()
            time.sleep(0.02)
            file.write(text[len(text) // 3 :])
        return name


def carried_out(robot, tour, again, watched):
    """Follows the tour to its end, with some mishaps; the events of its end, and how many poses were taken."""
    mishaps, taken = set(), 0
    while True:
        event = tour.next("pose", "end")
        if event["event"] == "end":
            return tour, event["end"], taken
        before = robot.at
        robot.go(event["pose"])
        if taken == 1 and "cap" not in mishaps:
            mishaps.add("cap")
            robot.detect(watched, np.zeros((720, 1280), np.uint8))
            doubt = tour.next("doubt")
            assert doubt["picture"]["doubts"] == ["the board was not found in it"], doubt
        elif taken == 2 and "still" not in mishaps:
            mishaps.add("still")
            robot.at = before
            robot.detect(watched)
            doubt = tour.next("doubt")
            assert "did the arm move" in doubt["message"], doubt
            tour.answer("again")
            robot.go(tour.next("pose")["pose"])
        elif taken == 3 and "killed" not in mishaps:
            mishaps.add("killed")
            (watched / "broken.vnl").write_text("nothing")
            assert "broken.vnl" in tour.next("unreadable")["message"]
            (watched / "broken.vnl").unlink()
            tour.process.send_signal(signal.SIGKILL)
            tour.process.wait()
            tour = again()
            same = tour.next("pose")["pose"]
            assert same["joints_rad"] == event["pose"]["joints_rad"], "another pose after the kill"
        name = robot.detect(watched)
        counted = tour.next("picture", "doubt")
        if counted["event"] == "doubt":
            # The detector did not find the whole board in the noise: this pose is left out.
            assert counted["picture"]["doubts"] == ["the board was not found in it"], counted
            tour.answer("skip")
            continue
        assert counted["picture"]["name"] == name
        taken += 1


def opencv(robot, corners_file):
    """K, D and the residuals' RMS by cv2.calibrateCamera, of the corners of a table."""
    board, views = map_error.corners(robot.problem["target"]).astype(np.float32), {}
    for line in corners_file.read_text().splitlines()[1:]:
        name, u, v, _ = line.split()
        views.setdefault(name, []).append((float(u), float(v)))
    pixels = [np.array(view, np.float32).reshape(-1, 1, 2) for view in views.values()]
    size = tuple(robot.problem["camera"][f"{side}_px"] for side in ("width", "height"))
    until = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 1000, 1e-14)
    rms, K, D, *_ = cv2.calibrateCamera([board] * len(pixels), pixels, size, None, None, criteria=until)
    return [K[0, 0], K[1, 1], K[0, 2], K[1, 2], *D.ravel()[:5]], rms


def check(folder, robot, watched, state, *options):
    plan_file, camera = folder / "plan/plan.json", folder / f"camera-{state}"
    watched.mkdir()
    arguments = [plan_file, "--watch", watched, "--output", camera, *options]
    tour, end, taken = carried_out(robot, Tour(*arguments, "--restart"), lambda: Tour(*arguments), watched)
    tour.process.stdin.close()
    code = tour.process.wait()
    found = json.loads((camera / "calibration.json").read_text())
    assert found["intrinsics"]["names"] == found["estimated"] == ["fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3"]
    assert taken == end["taken"] == len(found["views"])
    estimate, sigma = np.array(found["intrinsics"]["values"]), np.array(found["intrinsics"]["sigma"])
    theirs, rms = opencv(robot, camera / "corners.vnl")
    apart = np.abs((np.array(theirs) - estimate) / sigma).max()
    true = map_error.Camera(robot.problem["camera"])
    off = estimate - np.array([true.fx, true.fy, true.cx, true.cy, *true.coefficients])
    distance = off @ np.linalg.solve(np.array(found["covariance"]), off)
    validator("follow").validate(json.loads((folder / "plan/follow.json").read_text()))
    print(f"{state}: {end['taken']} poses taken, {end['skipped']} left out, {end['left']} saved; ended by `{end['why']}`, code {code}; map error "
          f"{found['map_error_px']['rms']:.3f} px; OpenCV's camera within {apart:.4f} sigma, RMS {rms:.4f} and {found['rms_px']:.4f} px; "
          f"the true one at {distance:.1f} of chi-square 9")
    assert apart < SAME and abs(rms / found["rms_px"] - 1) < 1e-4, "OpenCV finds another camera"
    assert distance < FAR, "the true camera is not where the covariance says"
    return end, code, found


def main():
    problem_file = Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "problems/servosila-engineer.toml").resolve()
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        sets = [word for setting in SETTINGS for word in ("--set", setting)]
        # Those that the tests' detectors find: not the steepest.
        calipose("plan", problem_file, *sets, "--set", "visibility.max_tilt_deg=55", "--trials", 0, "--output", folder / "plan", "--quiet")
        plan = json.loads((folder / "plan/plan.json").read_text())
        robot = Robot(folder, problem_file, plan)
        end, code, found = check(folder, robot, folder / "first", "promised")
        assert (end["why"], code) == ("accuracy", 0) and end["left"] > 0, "it does not end early"
        assert found["map_error_px"]["rms"] <= plan["map_error_px"]
        assert end["home_rad"] is not None and end["way"]["seconds"] > 0, "no way home"
        # Better than what the plan's poses reach in such noise.
        tight = 0.25 * plan["map_error_px"]
        robot = Robot(folder, problem_file, plan)
        end, code, found = check(folder, robot, folder / "second", "more", "--until", f"map_error_px={tight}", "--more", 8)
        added = end["taken"] + end["skipped"] + end["left"] - plan["count"]
        assert added > 0, "no poses are added"
        reached = found["map_error_px"]["rms"] <= tight
        assert code == (0 if reached else 4) and (end["why"] == "accuracy") == reached and reached, "the accuracy is not reached"
        print(f"{added} poses were added")


if __name__ == "__main__":
    run_with("jsonschema==4.23.0", "numpy==2.4.6", "opencv-python-headless==5.0.0.93")
    import cv2
    import numpy as np
    from jsonschema import Draft202012Validator

    for module in (board_detectors, map_error):
        module.cv2, module.np = cv2, np
    main()

"""What OpenCV's detectors find of checkerboards, tags and circles, against what calipose says of their corners.

    python tests/cross_check/detectors.py [--seeds N]

A camera goes round each board from square-on to 60 degrees of tilt, at two distances; `calipose plan` takes all these views and
`calipose render` their pictures. Printed is how far the corners that OpenCV finds are from where calipose says on clean pictures, and how
they scatter under the sensor's noise over N seeds: square-on, as the model of the noise says it of every view, and how far the single views
are from that. Circles' centres are held against the centres of their ellipses too. $CALIPOSE is the program, or target/release/calipose.
The packages are PyPI's (in $CROSS_CHECK_VENV, or a temporary folder). Exits with 1 where corners are farther off than is stated in
docs/src/validation.md, or scatter otherwise than the model says.
"""

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import board_detectors
import map_error
from board_detectors import WINDOW_PX, refined, tags
from environment import run_with
from map_error import Camera, rotation

ROOT = Path(__file__).resolve().parents[2]
GREY_NOISE = 8.0
DISTANCES_MM = (300, 600)
TILTS_DEG = list(range(0, 61, 10))
# The tilt is about an axis that is slanted to rows and columns.
TURN_DEG = 20
EDGE_POINTS = 256

BOARDS = {
    "checkerboard": 'columns = 6\nrows = 5\nsquare_mm = 20',
    "aprilgrid": 'kind = "aprilgrid"\ncolumns = 4\nrows = 3\ntag_mm = 30\ntag_spacing = 0.3',
    "circles": 'kind = "circles"\ncolumns = 6\nrows = 5\nspacing_mm = 20\ndiameter_mm = 12',
    "asymmetric-circles": 'kind = "asymmetric-circles"\ncolumns = 4\nrows = 7\nspacing_mm = 36\ndiameter_mm = 15',
}
# Most that corners may be off (RMS of a view, px), circles' from the ellipses' centres; and how far the scatter of views may be from the
# model's.
MOST_OFF = 0.05
AGREE = 0.15

PROBLEM = """name = "Round the board"

[[robot.joints]]
name = "tilt"
a_mm = -{distance}
limits_deg = [0, 60]

[camera]
mount = "optical-axis-x"
width_px = 1280
height_px = 720
fx_px = 1000
fy_px = 1000

[target]
pose = {{ position_mm = [0, 0, 0], quaternion_xyzw = [{quaternion}] }}
{board}

[sweep]
step_deg = 10

[visibility]
max_tilt_deg = 70

[noise]
sigma_px = 0.3
window_px = {window}

[selection]
count = {count}
off_grid = false
"""


def run(*arguments):
    return json.loads(subprocess.run([PROGRAM, *arguments, "--json", "--quiet"], check=True, capture_output=True, text=True).stdout)


class Views:
    """The pictures of a board from all tilts at one distance, and where calipose says that its corners are."""

    def __init__(self, folder, board, distance):
        self.kind = board
        parameters = cv2.SimpleBlobDetector_Params()
        parameters.maxArea, parameters.minDistBetweenBlobs = 20_000, 3
        self.blobs = cv2.SimpleBlobDetector_create(parameters)
        # About -x, then z out of the board towards -x: the camera at tilt 0.
        a, b = np.radians(TURN_DEG) / 2, np.radians(45)
        quaternion = [-np.sin(a) * np.cos(b), -np.cos(a) * np.sin(b), np.sin(a) * np.sin(b), np.cos(a) * np.cos(b)]
        path = folder / "problem.toml"
        path.write_text(PROBLEM.format(distance=distance, quaternion=", ".join(map(str, quaternion)), board=BOARDS[board],
                                       window=WINDOW_PX, count=len(TILTS_DEG)))
        self.pattern = run("board", path, "-o", folder / "board")["pattern"]
        plan = run("plan", path, "-o", folder / "plan", "--trials", "0")
        poses = sorted(plan["poses"], key=lambda pose: pose["joints_rad"][0])
        assert np.allclose(np.degrees([pose["joints_rad"][0] for pose in poses]), TILTS_DEG), "not all views were taken"
        # By subpixels as fine as those of a large sensor, for circles' centres are averages over many.
        rendered = run("render", folder / "plan" / "plan.json", "-o", folder / "pictures", "--noise", "0", "--supersampling", "16")
        files = {entry["pose"]: entry["file"] for entry in rendered["pictures"]}
        self.pictures = [cv2.imread(str(folder / "pictures" / files[pose["id"]]), cv2.IMREAD_GRAYSCALE) for pose in poses]
        self.camera = Camera({"width_px": 1280, "height_px": 720, "fx_px": 1000, "fy_px": 1000})
        self.corners = np.column_stack([np.array(self.pattern["corners_mm"]) / 1e3, np.zeros(len(self.pattern["corners_mm"]))])
        self.counted = [pose.get("corners_seen") or list(range(len(self.corners))) for pose in poses]
        R_BT = rotation(quaternion)
        self.poses = []
        for pose in poses:
            R_CB = rotation(pose["camera_in_base"]["quaternion_xyzw"]).T
            self.poses.append((R_CB @ R_BT, -R_CB @ np.array(pose["camera_in_base"]["position_m"])))

    def project(self, view, points):
        R, t = self.poses[view]
        return self.camera.project(points, cv2.Rodrigues(R)[0], t.reshape(3, 1))

    def slopes(self, view):
        """Derivative of every corner's pixel by its place on the board, 2 x 2, px per m."""
        step = 1e-6
        x, y = [(self.project(view, self.corners + by) - self.project(view, self.corners - by)) / (2 * step)
                for by in ([step, 0, 0], [0, step, 0])]
        return np.stack([x, y], axis=2)

    def whiteners(self, view):
        """W of every corner, 2 x 2, for a standard deviation of 1 px square-on."""
        J = self.slopes(view)
        if "diameter_mm" in self.pattern:
            angles = 2 * np.pi * np.arange(EDGE_POINTS) / EDGE_POINTS
            radius = self.pattern["diameter_mm"] / 2e3
            tangents = radius * np.column_stack([-np.sin(angles), np.cos(angles)]) * (2 * np.pi / EDGE_POINTS)
            share = lambda normals, lengths: lengths
        else:
            reach = (self.pattern["square_mm"] if self.kind == "checkerboard" else
                     self.pattern["tag_mm"] * self.pattern["tag_spacing"]) / 1e3
            tangents = reach * np.eye(2)
            # Of edges that go on across the corner both sides, as far as the window sees them.
            share = lambda normals, lengths: 2 * np.minimum(WINDOW_PX / np.abs(normals).max(axis=-1), lengths)
        along = np.einsum("cij,tj->cti", J, tangents)
        lengths = np.linalg.norm(along, axis=-1)
        normals = np.stack([-along[..., 1], along[..., 0]], axis=-1) / lengths[..., None]
        T = np.einsum("cti,ctj,ct->cij", normals, normals, share(normals, lengths)) / (2 * WINDOW_PX)
        return np.transpose(np.linalg.cholesky(T), (0, 2, 1))

    def ellipse_centres(self, view):
        """Centres of the ellipses that the circles are in the picture of a camera without distortion."""
        R, t = self.poses[view]
        H = self.camera.K @ np.column_stack([R[:, 0], R[:, 1], t])
        H_inverse, radius = np.linalg.inv(H), self.pattern["diameter_mm"] / 2e3
        centres = []
        for x, y, _ in self.corners:
            circle = np.array([[1, 0, -x], [0, 1, -y], [-x, -y, x * x + y * y - radius**2]])
            conic = H_inverse.T @ circle @ H_inverse
            centres.append(-np.linalg.solve(conic[:2, :2], conic[:2, 2]))
        return np.array(centres)

    def is_grid(self, picture):
        """Whether OpenCV finds the grid of circles."""
        flags = cv2.CALIB_CB_ASYMMETRIC_GRID if self.kind == "asymmetric-circles" else cv2.CALIB_CB_SYMMETRIC_GRID
        return cv2.findCirclesGrid(picture, (self.pattern["columns"], self.pattern["rows"]), flags=flags, blobDetector=self.blobs)[0]

    def found(self, picture, truth):
        """The corners by OpenCV, by their numbers; NaN where they are not found."""
        if self.kind == "checkerboard":
            ok, corners = cv2.findChessboardCorners(picture, (self.pattern["columns"], self.pattern["rows"]))
            assert ok, "no checkerboard found"
            found = refined(picture, corners)
        elif self.kind == "aprilgrid":
            numbers, corners = tags(picture, self.pattern["columns"])
            found = np.full_like(truth, np.nan)
            found[numbers] = refined(picture, corners)
            return found
        else:
            # findCirclesGrid hands these on as they are, but does not find the steepest grids.
            found = np.array([blob.pt for blob in self.blobs.detect(picture)])
        # Grids that look the same from several sides may begin at any.
        nearest = np.linalg.norm(found[:, None] - truth[None], axis=2).argmin(axis=0)
        assert sorted(nearest) == list(range(len(truth)))
        return found[nearest]


def rms(errors):
    """Root mean square length."""
    return np.sqrt((errors**2).sum(axis=-1).mean())


def hold(kind, distance, seeds):
    """What is wrong with the corners of that board from so far away."""
    with tempfile.TemporaryDirectory() as folder:
        views = Views(Path(folder), kind, distance)
    is_round = "diameter_mm" in views.pattern
    off, ellipse, from_ellipse, grids, sigmas = [], [], [], [], []
    for view, picture in enumerate(views.pictures):
        every, here = views.project(view, views.corners), views.counted[view]
        truth, clean = every[here], views.found(picture, every)[here]
        assert np.isfinite(clean).all(), f"{kind} from {distance} mm at {TILTS_DEG[view]} degrees: corners that the plan counts on are not found"
        off.append(rms(clean - truth))
        if is_round:
            centres = views.ellipse_centres(view)[here]
            ellipse.append(rms(centres - truth))
            from_ellipse.append(rms(clean - centres))
            grids.append(views.is_grid(picture))
        rng = np.random.default_rng(view)
        noisy = lambda: np.clip(np.rint(picture + GREY_NOISE * rng.standard_normal(picture.shape)), 0, 255).astype(np.uint8)
        # In noise OpenCV misses tags; what is of interest is how their corners scatter.
        again = lambda picture: views.found(picture, every)[here] if is_round else refined(picture, clean)
        seen = np.array([again(noisy()) for _ in range(seeds)])
        whitened = np.einsum("cij,scj->sci", views.whiteners(view)[here], seen - seen.mean(axis=0))
        sigmas.append(np.sqrt((whitened**2).sum() / (2 * (seeds - 1) * len(truth))))
    sigma = np.exp(np.log(sigmas).mean())
    apart = np.abs(np.log(sigmas / sigma)).max()
    print(f"{kind} from {distance} mm, at {', '.join(map(str, TILTS_DEG))} degrees:")
    print(f"  off by {listed(off)} px; scatter, square-on, {sigma:.4f} px, the views within {100 * (np.exp(apart) - 1):.0f} % of it")
    wrong = []
    if is_round:
        print(f"  centres of the ellipses are off by {listed(ellipse)}, and OpenCV's from those by {listed(from_ellipse)}; "
              f"findCirclesGrid finds {sum(grids)} of {len(grids)} grids")
    if max(from_ellipse if is_round else off) > MOST_OFF:
        wrong.append(f"{kind} from {distance} mm: off by more than {MOST_OFF} px")
    if not is_round and apart > np.log(1 + AGREE):
        wrong.append(f"{kind} from {distance} mm: scatter is off the model by {100 * (np.exp(apart) - 1):.0f} %")
    return sigma, wrong


def listed(values):
    return ", ".join(f"{value:.3f}" for value in values)


def main():
    seeds = int(sys.argv[sys.argv.index("--seeds") + 1]) if "--seeds" in sys.argv else 30
    wrong = []
    for distance in DISTANCES_MM:
        sigmas = {}
        for kind in BOARDS:
            sigmas[kind], faults = hold(kind, distance, seeds)
            wrong += faults
        ratio = sigmas["aprilgrid"] / sigmas["checkerboard"]
        print(f"tags' corners scatter {ratio:.2f} times as much as a checkerboard's from {distance} mm")
        if abs(np.log(ratio)) > np.log(1 + AGREE):
            wrong.append(f"tags' corners from {distance} mm scatter {ratio:.2f} times as much as a checkerboard's")
    for fault in wrong:
        print(fault)
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    run_with("numpy==2.4.6", "opencv-python-headless==5.0.0.93")
    import cv2
    import numpy as np

    for module in (map_error, board_detectors):
        module.cv2, module.np = cv2, np
    cv2.setNumThreads(1)
    PROGRAM = os.environ.get("CALIPOSE", ROOT / "target/release/calipose")
    main()

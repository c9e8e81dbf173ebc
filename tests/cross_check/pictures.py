"""What plans are worth on pictures: rendered, detected and calibrated by OpenCV.

    python tests/cross_check/pictures.py [--seeds N] [--cut-boards] [--either-detector] PROBLEM PLAN [PROBLEM PLAN ...]
    python tests/cross_check/pictures.py [--seeds N] --scatter

`calipose render` makes the picture of every pose of a plan, on the grid or polished, without noise. From the plan's camera poses and its
problem file a checkerboard is rendered here in NumPy too: the lens, antialiasing, blur, a gradient of the light; around the corners both
must have the same grey values, and cornerSubPix must find the same corners. OpenCV's two chessboard detectors must find every board. Of
ChArUco boards and AprilGrids NumPy draws nothing; OpenCV's detectors of markers must find the corners that the plan counts on. For every
seed the sensor's noise is added, at two levels; cornerSubPix finds the corners, of boards with markers those whose markers are read, and
`cv2.calibrateCamera` and `calipose calibrate` the camera, from the corners alone. Coefficients of the lens that the problem does not
estimate are held. Printed are the corners' scatter and the true map error over the image's area after the best rotation, as a whole, and
as scatter over the seeds and the systematic rest, beside what is predicted for so much noise and for the corners that were found;
`calipose noise` must find the same scatter in the corners. With --scatter, views of one board between 0 and 70 degrees of tilt and
squares of 8 to 60 px hold the scatter of cornerSubPix against the model of the noise, sharp ones and ones out of focus and moved. Exits
with 1 where a prediction is off by more than 15 %, a board is not found (with --cut-boards, for plans whose best views cut squares at the
board's rim, one that is wholly in the picture; with --either-detector, one that neither detector finds), or the two renderers differ.
"""

import json
import os
import re
import subprocess
import sys
import tempfile
from multiprocessing import Pool
from pathlib import Path

import board_detectors
import drawing
import map_error
from board_detectors import WINDOW_PX, refined, told
from drawing import BLUR_PX, GRADIENT, SUBPIXELS, Views, blurred, exposed
from environment import run_with
from map_error import COEFFICIENTS, SHARP_PX, Camera, accuracies, board_in_camera, map_weight, read_problem, whiteners

ROOT = Path(__file__).resolve().parents[2]
AGREE = 0.15
# How far the two renderers may be apart: grey values in the mean, px between the corners found.
SAME_GREY, SAME_PX = 0.5, 0.02
# How far the noise measured by `calipose noise` may be from NumPy's, as a share.
SAME_SIGMA = 0.005
# Share of the corners that a plan counts on which the detectors of markers must find in clean pictures.
FOUND = 0.98
# Fewest corners of a board with markers from which its pose is found.
FEWEST = 6
# How far from the corners that a plan counts on their markers may reach, px.
MARKERS_PX = 120
# Of the sensor's noise, grey values.
LEVELS = {"clean": 2.0, "noisy": 16.0}
GAUSS_ORDER = 24
SHARP_VIEWS, BLURRED_VIEWS = 40, 40


def around(picture, truth, margin=3 * WINDOW_PX):
    """The part of a picture in which the corners' windows are and may move, and its first pixel."""
    low = np.maximum(np.floor(truth.min(0)).astype(int) - margin, 0)
    high = np.ceil(truth.max(0)).astype(int) + margin + 1
    return picture[low[1]:high[1], low[0]:high[0]], low


def detected(picture, truth):
    """The corners by cornerSubPix, from half a pixel beside the true ones."""
    start = truth + 0.5 * np.sign(np.sin(1.7 * np.arange(truth.size).reshape(truth.shape)))
    return refined(picture, start)


def share(work, items):
    """The work on all items, on two cores; what it needs beside an item is in the parent's memory."""
    with Pool(2) as pool:
        return pool.map(work, items, chunksize=1)


# --- The scatter of corners


def scatter_of_view(index):
    views, seeds = STATE["views"], STATE["seeds"]
    pose = views.poses[index]
    picture, truth = views.picture(pose), views.project(pose)
    disc, path, direction = STATE["blurs"][index]
    (part, low), rng = around(blurred(picture, disc, path, direction), truth), np.random.default_rng(index)
    seen = np.array([detected(exposed(part, 8.0, rng), truth - low) + low for _ in range(seeds)])
    deviations = seen - seen.mean(0)
    rvec, tvec = cv2.Rodrigues(pose[0])[0], pose[1].reshape(3, 1)
    # The model does not know the direction.
    width = np.sqrt(SHARP_PX**2 + disc**2 / 16 + path**2 / 24)
    W = whiteners(views.target, views.camera, views.board, rvec, tvec, {"sigma_px": 1.0, "window_px": WINDOW_PX}, width)
    freedoms = 2 * (seeds - 1) * len(truth)
    whitened = np.einsum("jik,sjk->sji", W, deviations)
    return np.sqrt((deviations**2).sum() / freedoms), np.sqrt((whitened**2).sum() / freedoms)


def random_views(count):
    target = {"columns": 8, "rows": 6, "square_mm": 30}
    camera = Camera({"width_px": 1280, "height_px": 720, "fx_px": 1000, "fy_px": 1000, "distortion": {"model": "brown-conrady"}})
    rng, poses, kinds = np.random.default_rng(0), [], []
    views = Views(camera, target, poses)
    while len(poses) < count:
        tilt, spacing = rng.uniform(0, 70), np.exp(rng.uniform(np.log(8), np.log(60)))
        azimuth, roll, distance = *rng.uniform(0, 2 * np.pi, 2), 30 / spacing
        axis = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
        R = cv2.Rodrigues(np.array([0, 0, roll]))[0] @ cv2.Rodrigues(axis * np.radians(tilt))[0] @ np.diag([1.0, -1, -1])
        t = np.array([rng.uniform(-0.05, 0.05) * distance, rng.uniform(-0.03, 0.03) * distance, distance])
        if (views.board @ R.T + t)[:, 2].min() < 0.05:
            continue
        pixels = views.project((R, t))
        inside = (pixels > 20).all() and (pixels < np.array(camera.size) - 21).all()
        if inside and least_height(pixels, target) >= 1.5 * WINDOW_PX + 0.5:
            poses.append((R, t))
            kinds.append((tilt, spacing))
    return views, kinds


def least_height(pixels, target):
    """The least height of a square in the picture."""
    grid = pixels.reshape(target["rows"], target["columns"], 2)
    a, b = np.diff(grid, axis=1)[:-1], np.diff(grid, axis=0)[:, :-1]
    area = np.abs(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])
    return (area / np.maximum(np.linalg.norm(a, axis=-1), np.linalg.norm(b, axis=-1))).min()


def hold_scatter(seeds):
    views, kinds = random_views(SHARP_VIEWS + BLURRED_VIEWS)
    rng = np.random.default_rng(1)
    # Diameter of the blur circle, length of the path, px, and its direction.
    blurs = [(rng.uniform(0, 6), rng.uniform(0, 4), rng.uniform(0, np.pi)) for _ in kinds]
    blurs[:SHARP_VIEWS] = [(0, 0, 0)] * SHARP_VIEWS
    STATE.update(views=views, seeds=seeds, blurs=blurs)
    sigmas = np.array(share(scatter_of_view, range(len(kinds))))
    good = True
    for name, sigma in zip(("constant", "edges"), sigmas.T):
        # One number is fitted, to the sharp views.
        sharp = np.exp(np.log(sigma[:SHARP_VIEWS]).mean())
        for what, ratio in [("views of 0 to 70 degrees and 8 to 60 px a square", sigma[:SHARP_VIEWS] / sharp),
                            ("the same out of focus by up to 6 px and moved by up to 4 px", sigma[SHARP_VIEWS:] / sharp)]:
            print(f"{name}: scatter of {len(ratio)} {what} over the model's: RMS {np.sqrt((np.log(ratio) ** 2).mean()):.3f}, "
                  f"{ratio.min():.2f} to {ratio.max():.2f}; sigma {sharp:.4f} px")
            good &= name == "constant" or np.abs(np.log(ratio)).max() < np.log(1 + AGREE)
    return good


# --- Plans


def by_numpy(index):
    views = STATE["views"]
    return np.clip(np.rint(views.picture(views.poses[index])), 0, 255).astype(np.uint8)


def compared(index):
    """How far the rendered picture of a view is from NumPy's in the corners' windows: grey values in the mean, px between corners found."""
    views, truth = STATE["views"], STATE["truths"][index]
    pair = [STATE["pictures"][index], by_numpy(index)]
    here = np.zeros(pair[0].shape, bool)
    for u, v in np.rint(truth).astype(int):
        here[max(v - WINDOW_PX, 0):v + WINDOW_PX + 1, max(u - WINDOW_PX, 0):u + WINDOW_PX + 1] = True
    grey = np.abs(pair[0][here].astype(float) - pair[1][here]).mean()
    return grey, np.linalg.norm(detected(pair[0], truth) - detected(pair[1], truth), axis=1).max()


def rendered(problem_path, plan_path):
    """The pictures of all poses by `calipose render`, without noise."""
    folder = STATE["folder"] / "pictures"
    options = {"blur-px": BLUR_PX, "gradient": GRADIENT, "supersampling": SUBPIXELS, "noise": 0, "output": folder, "problem": problem_path}
    run = [program(), "render", plan_path, "--json", "--quiet", *[f"--{name}={value}" for name, value in options.items()]]
    pictures = json.loads(subprocess.run(run, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, check=True).stdout)["pictures"]
    # They are numbered in the order of the tour, and the plan lists its poses by their ids.
    files = {entry["pose"]: entry["file"] for entry in pictures}
    ids = [pose["id"] for pose in json.loads(Path(plan_path).read_text())["poses"]]
    return [cv2.imread(str(folder / files[pose]), cv2.IMREAD_GRAYSCALE) for pose in ids]


def corners_in(picture, view):
    """The corners that the plan counts on, as far as they are found; others are NaN."""
    truth, low = STATE["truths"][view], STATE["parts"][view][1]
    counted = STATE["counted"][view]
    if has_markers(STATE["views"].target):
        counted = np.intersect1d(counted, told(picture, STATE["views"].target))
        counted = counted if len(counted) >= FEWEST else []
    found = np.full(truth.shape, np.nan)
    if len(counted):
        found[counted] = detected(picture, truth[counted] - low) + low
    return found


def trial(seed):
    """The corners of all views, and the errors of both calibrations over the image."""
    views, noise = STATE["views"], STATE["noise"]
    rng = np.random.default_rng(seed)
    seen = np.array([corners_in(exposed(part, noise, rng), view) for view, (part, _) in enumerate(STATE["parts"])])
    return seen, error_over_image(views.camera, *by_opencv(seen)), error_over_image(views.camera, *by_calipose(seen, seed))


def by_opencv(seen):
    """K and D by OpenCV, which estimates what the plan does."""
    views, names = STATE["views"], STATE["plan"]["intrinsics"]["names"]
    is_found = [np.isfinite(corners[:, 0]) for corners in seen if np.isfinite(corners).any()]
    seen = [corners for corners in seen if np.isfinite(corners).any()]
    board = [views.board[here].astype(np.float32) for here in is_found]
    pixels = [corners[here].astype(np.float32).reshape(-1, 1, 2) for corners, here in zip(seen, is_found)]
    held = [name for name in COEFFICIENTS["rational"] if name not in names]
    flags = cv2.CALIB_RATIONAL_MODEL if views.camera.model == "rational" else 0
    for name in held:
        flags |= cv2.CALIB_FIX_TANGENT_DIST if name in ("p1", "p2") else getattr(cv2, f"CALIB_FIX_{name.upper()}")
    K, D = None, None
    if any(value for name, value in zip(COEFFICIENTS[views.camera.model], views.camera.coefficients) if name in held):
        # They are held at what a first camera has.
        K, D, flags = views.camera.K.copy(), views.camera.D.copy(), flags | cv2.CALIB_USE_INTRINSIC_GUESS
    _, K, D, *_ = cv2.calibrateCamera(board, pixels, views.camera.size, K, D, flags=flags)
    return K, D.ravel()


def listed(corners):
    return [None if np.isnan(u) else [u, v] for u, v in corners.tolist()]


def by_calipose(seen, seed):
    folder, (width, height) = STATE["folder"], STATE["views"].camera.size
    observations = {
        "format": "calipose.observations",
        "version": 1,
        "image": {"width_px": width, "height_px": height},
        "views": [{"name": f"{i}.png", "corners": listed(corners)} for i, corners in enumerate(seen)],
    }
    path = folder / f"{seed}.json"
    path.write_text(json.dumps(observations))
    run = [program(), "calibrate", path, "--problem", STATE["file"], "--output", folder / f"camera-{seed}", "--json", "--quiet"]
    # A map error that misses what the problem asks for is no failure here: exit code 4.
    found = json.loads(subprocess.run(run, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, check=False).stdout)
    values = dict(zip(found["intrinsics"]["names"], found["intrinsics"]["values"]))
    K = np.array([[values["fx"], 0, values["cx"]], [0, values["fy"], values["cy"]], [0, 0, 1]])
    return K, np.array([values.get(name, 0.0) for name in COEFFICIENTS["rational"]])


def program():
    return os.environ.get("CALIPOSE", ROOT / "target/release/calipose")


def error_over_image(camera, K, D):
    """How far the calibrated camera images true rays from where the true one does, at nodes over the image's area, weighted, px."""
    width, height = camera.size
    nodes, weights = np.polynomial.legendre.leggauss(GAUSS_ORDER)
    pixels = np.array([[a, b] for b in (nodes + 1) / 2 * height - 0.5 for a in (nodes + 1) / 2 * width - 0.5])
    root = np.repeat(np.sqrt([p * q / 4 for q in weights for p in weights]), 2)
    rays, zero = np.ascontiguousarray(camera.rays(pixels)).reshape(-1, 1, 3), np.zeros((3, 1))
    error = (cv2.projectPoints(rays, zero, zero, K, D)[0].reshape(-1, 2) - pixels).ravel() * root
    turn = camera.jacobians(rays, zero, zero)[1][:, :3] * root[:, None]
    return error - turn @ np.linalg.lstsq(turn, error, rcond=None)[0]


def parts(errors):
    """Map error in all, its scatter over the seeds, its systematic part, and the scatter's standard error as a share."""
    errors = np.array(errors)
    mean = errors.mean(0)
    scatter = np.sqrt(((errors - mean) ** 2).sum() / (len(errors) - 1))
    systematic = np.sqrt(max(0.0, (mean**2).sum() - scatter**2 / len(errors)))
    chance = 0.5 * ((errors - mean) ** 2).sum(1).std() / scatter**2 / np.sqrt(len(errors))
    return np.sqrt((errors**2).sum(1).mean()), scatter, systematic, chance


def same_noise(seen, constant, edges):
    """Whether `calipose noise` finds the same in the corners of every view, each a scene of repeated pictures."""
    files = []
    for view in range(seen.shape[1]):
        files.append(STATE["folder"] / f"scene-{view}.vnl")
        lines = [f"{picture}.png - -" if np.isnan(u) else f"{picture}.png {u} {v} 0"
                 for picture, corners in enumerate(seen[:, view]) for u, v in corners]
        files[-1].write_text("\n".join(["# filename x y level", *lines, ""]))
    run = [program(), "noise", *files, "--problem", STATE["file"], "--json", "--quiet"]
    found = json.loads(subprocess.run(run, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, check=True).stdout)
    sigma = {model["model"]: model["sigma_px"] for model in found["models"]}
    off = max(abs(sigma["constant"] / constant - 1), abs(sigma["edges"] / edges - 1))
    print(f"  calipose noise: {found['models'][0]['model']}, sigma off by {off:.1e}")
    # It takes the edges' directions from a homography of the corners, not from the camera.
    return off < SAME_SIGMA and found["models"][0]["model"] == "edges"


def has_markers(target):
    return target.get("kind", "checkerboard") in ("charuco", "aprilgrid")


def is_whole(pose):
    """Whether all squares are in the picture: detectors look for squares, a plan asks for inner corners alone."""
    views = STATE["views"]
    reach = [(views.target[side] + 1) / 2 * views.target["square_mm"] / 1e3 for side in ("columns", "rows")]
    rim = [[x * reach[0], y * reach[1], 0] for x in np.linspace(-1, 1, 21) for y in np.linspace(-1, 1, 21)]
    pixels = views.project(pose, np.array(rim))
    return bool((pixels >= 0).all() and (pixels <= np.array(views.camera.size) - 1).all())


def found_by_detectors(index):
    picture, target = STATE["pictures"][index], STATE["views"].target
    size = target["columns"], target["rows"]
    return [bool(find(picture, size)[0]) for find in (cv2.findChessboardCorners, cv2.findChessboardCornersSB)]


def checkerboard_is_found(plan_path):
    """Whether both renderers draw the same, and both of OpenCV's detectors, or one of them, find every board that they must."""
    poses = STATE["views"].poses
    # Found once, for all who draw. NumPy takes its time.
    _ = STATE["views"].rays
    grey, apart = np.max(share(compared, range(len(poses))), axis=0)
    found = np.array(share(found_by_detectors, range(len(poses))))
    whole = np.array([is_whole(pose) for pose in poses])
    print(f"{plan_path}: {len(poses)} poses; boards found by the classic detector {found[:, 0].sum()}, by sectors {found[:, 1].sum()}; "
          f"of the {whole.sum()} that are wholly in the picture {found[whole, 0].sum()} and {found[whole, 1].sum()}; "
          f"calipose's pictures and NumPy's differ by {grey:.2f} grey values, {apart:.4f} px at the corners", flush=True)
    must = whole if STATE["cut_boards"] else np.full(len(poses), True)
    enough = found.any(axis=1, keepdims=True) if STATE["either_detector"] else found
    return enough[must].all() and grey < SAME_GREY and apart < SAME_PX


def markers_are_found(plan_path):
    """Whether OpenCV finds what the plan counts on, where it is."""
    target, counts, apart = STATE["views"].target, np.zeros(3, int), []
    for picture, truth, counted in zip(STATE["pictures"], STATE["truths"], STATE["counted"]):
        ids = told(picture, target)
        both = np.intersect1d(counted, ids)
        counts += len(counted), len(both), len(ids) - len(both)
        apart.append(np.linalg.norm(detected(picture, truth[both]) - truth[both], axis=1).max())
    of, found, more = counts
    print(f"{plan_path}: {len(apart)} poses; {found} of the {of} corners that it counts on are found, and {more} others; "
          f"cornerSubPix finds them within {max(apart):.3f} px")
    return found >= FOUND * of


def file_of(problem_path, plan):
    """The problem file, with the tables that the plan was made with: `calibrate` and `noise`, to whom it is all one how poses were selected,
    have no --set."""
    settings = [setting for setting in plan["problem"].get("set", []) if not setting.startswith("selection.")]
    if not settings:
        return problem_path
    text = Path(problem_path).read_text()
    for setting in settings:
        table = setting.partition("=")[0].strip()
        if "." in table:
            sys.exit(f"{problem_path}: `{setting}` was set; here only whole tables may be")
        text = f"{setting}\n" + re.sub(rf"(?ms)^\[+{table}[].].*?(?=^\[+(?!{table}[].])|\Z)", "", text)
    path = STATE["folder"] / Path(problem_path).name
    path.write_text(text)
    return path


def planned():
    """Map errors that the plan states, for corners that scatter by 1 px square-on, with weights and without."""
    plan, stated = STATE["plan"], STATE["problem"]["noise"]["sigma_px"]
    return plan["map_error_px"] / stated, plan.get("unweighted", plan)["map_error_px"] / stated


def predicted(seen):
    """The same for the corners that were found."""
    plan, camera, problem = STATE["plan"], STATE["views"].camera, STATE["problem"]
    stated = problem["noise"]["sigma_px"]
    if not has_markers(problem["target"]):
        return planned()
    estimated = [camera.names.index(name) for name in plan["intrinsics"]["names"]]
    weight, is_found = map_weight(camera, estimated), np.isfinite(seen[..., 0])
    squares = []
    for views in is_found:
        poses = [pose | {"corners_seen": np.flatnonzero(view)} for pose, view in zip(plan["poses"], views) if view.any()]
        squares.append([map_error**2 / stated**2 for map_error, _ in accuracies(camera, problem, poses, estimated, weight)])
    return np.sqrt(np.mean(squares, axis=0))


def plan_on_pictures(problem_path, plan_path, seeds):
    plan = json.loads(Path(plan_path).read_text())
    problem = read_problem(problem_path, plan)
    camera, target = Camera(problem["camera"]), problem["target"]
    if camera.model not in ("none", "brown-conrady", "rational"):
        sys.exit(f"{problem_path}: OpenCV's calibrateCamera does not know the lens {camera.model}")
    poses = [board_in_camera(problem, pose) for pose in plan["poses"]]
    views = Views(camera, target, poses)
    STATE.update(views=views, plan=plan, problem=problem, file=file_of(problem_path, plan))
    STATE["truths"] = [views.project(pose) for pose in poses]
    STATE["pictures"] = rendered(problem_path, plan_path)
    every = np.arange(len(views.board))
    STATE["counted"] = [np.array(pose.get("corners_seen") or every) for pose in plan["poses"]]
    margin = MARKERS_PX if has_markers(target) else 3 * WINDOW_PX
    STATE["parts"] = [around(picture, truth[counted], margin) for picture, truth, counted in
                      zip(STATE["pictures"], STATE["truths"], STATE["counted"])]
    good = markers_are_found(plan_path) if has_markers(target) else checkerboard_is_found(plan_path)
    W = [whiteners(target, camera, views.board, cv2.Rodrigues(R)[0], t.reshape(3, 1), problem["noise"] | {"sigma_px": 1.0})
         for R, t in poses]
    for level, noise in LEVELS.items():
        STATE["noise"] = noise
        seen, by_opencv, by_us = zip(*share(trial, range(seeds)))
        seen = np.array(seen)
        weighted, unweighted = predicted(seen)
        found = np.isfinite(seen[..., 0]).sum() / (seeds * sum(map(len, STATE["counted"])))
        times = np.isfinite(seen[..., 0]).sum(0)
        seen[:, times < 2] = np.nan
        mean = np.nansum(seen, axis=0) / np.maximum(times, 1)[..., None]
        deviations = seen - mean
        freedoms = 2 * (times[times > 1] - 1).sum()
        sigma = np.sqrt(np.nansum(np.einsum("vjik,svjk->svji", np.array(W), deviations) ** 2) / freedoms)
        constant = np.sqrt(np.nansum(deviations**2) / freedoms)
        good &= same_noise(seen, constant, sigma)
        offset = np.sqrt(((mean - np.array(STATE["truths"]))[times > 1] ** 2).mean())
        print(f"  {level}: corners scatter by {constant:.3f} px (square-on {sigma:.3f}) and are off by {offset:.3f}; {found:.1%} of them are found")
        for name, errors, expected, as_planned in [("OpenCV", by_opencv, unweighted * sigma, planned()[1] * sigma),
                                                   ("calipose, weighted", by_us, weighted * sigma, planned()[0] * sigma)]:
            total, scatter, systematic, chance = parts(errors)
            good &= abs(scatter / expected - 1) < AGREE
            # A plan's own statement is for all the corners that it counts on.
            good &= found < FOUND or abs(scatter / as_planned - 1) < AGREE
            print(f"    map error by {name}: {total:.3f} px; scatter {scatter:.3f}, predicted {expected:.3f} ({scatter / expected - 1:+.0%} ± {chance:.0%}); "
                  f"systematic {systematic:.3f}", flush=True)
    return good


if __name__ == "__main__":
    run_with("numpy==2.4.6", "opencv-python-headless==5.0.0.93")
    import cv2
    import numpy as np

    for module in (board_detectors, drawing, map_error):
        module.cv2, module.np = cv2, np
    cv2.setNumThreads(1)
    STATE = {}
    arguments = sys.argv[1:]
    seeds = 100
    if "--seeds" in arguments:
        at = arguments.index("--seeds")
        seeds = int(arguments[at + 1])
        del arguments[at:at + 2]
    for option in ["--cut-boards", "--either-detector"]:
        STATE[option.strip("-").replace("-", "_")] = option in arguments
        arguments = [argument for argument in arguments if argument != option]
    if arguments == ["--scatter"]:
        sys.exit(0 if hold_scatter(seeds) else 1)
    if not arguments or len(arguments) % 2:
        sys.exit(__doc__)
    with tempfile.TemporaryDirectory() as folder:
        STATE["folder"] = Path(folder)
        good = [plan_on_pictures(*pair, seeds) for pair in zip(arguments[::2], arguments[1::2])]
    sys.exit(0 if all(good) else 1)

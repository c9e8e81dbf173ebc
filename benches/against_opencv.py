"""Times calipose's calibration against OpenCV's on the same corners, side by side.

    pip install opencv-python-headless numpy
    python benches/against_opencv.py

Builds and runs the example calibration_timing in release mode. Both take one thread and the median of their runs.
OpenCV runs twice: with its default criteria (30 iterations, machine epsilon) and, in the columns "loose", with an
epsilon of 1e-6, which stops short of the optimum that calipose goes to. Sets on which OpenCV's fisheye gives up are
named and left out.
"""

import json
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

import cv2
import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests" / "golden"))
import opencv_calibration as golden

VIEWS = 20
REPEATS = 11


def data_set(lens, rng):
    """20 views of 48 corners: the set as calipose reads it, and the corner lists for OpenCV."""
    width, height, K, D = golden.camera(lens, rng)
    points = golden.board(8, 6, 2 / 64)
    images = []
    for _ in range(VIEWS):
        pixels = golden.view(lens, points, (width, height), K, D, rng) + rng.normal(0, 0.3, (len(points), 2))
        images.append(np.round(pixels * golden.UNIT) / golden.UNIT)
    data = {
        "lens": lens,
        "image": [width, height],
        "board": {"columns": 8, "rows": 6, "square": 2 / 64},
        "views": [[[round(u * golden.UNIT), round(v * golden.UNIT)] for u, v in image] for image in images],
    }
    return data, (width, height), [points] * VIEWS, images


def opencv(lens, size, objects, images, epsilon):
    """Median seconds and the cost in px^2."""
    criteria = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 30, epsilon)
    if lens == "kannala-brandt":
        flags = cv2.CALIB_FIX_SKEW | cv2.CALIB_RECOMPUTE_EXTRINSIC
        objects, images = [o.reshape(1, -1, 3) for o in objects], [i.reshape(1, -1, 2) for i in images]
        run = lambda: cv2.fisheye.calibrate(objects, images, size, None, None, flags=flags, criteria=criteria)[0]
    else:
        flags = {"none": golden.NO_DISTORTION, "brown-conrady": 0}[lens]
        objects, images = [o.astype(np.float32) for o in objects], [i.astype(np.float32) for i in images]
        run = lambda: cv2.calibrateCamera(objects, images, size, None, None, flags=flags, criteria=criteria)[0]
    seconds = []
    for _ in range(REPEATS):
        begin = time.perf_counter()
        rms = run()
        seconds.append(time.perf_counter() - begin)
    return statistics.median(seconds), rms * rms * sum(i.size // 2 for i in images)


def main():
    cv2.setNumThreads(1)
    rng = np.random.default_rng(7)
    rows = []
    for lens in ["none", "none", "none", "brown-conrady", "brown-conrady", "brown-conrady"] + ["kannala-brandt"] * 3:
        data, *arguments = data_set(lens, rng)
        try:
            rows.append((data, opencv(lens, *arguments, 2.2e-16), opencv(lens, *arguments, 1e-6)))
        except cv2.error:
            print(f"{lens}: OpenCV fails on this set")
    with tempfile.NamedTemporaryFile("w", suffix=".json") as file:
        json.dump({"pixels_per_unit": 1 / golden.UNIT, "sets": [data for data, _, _ in rows]}, file)
        file.flush()
        command = ["cargo", "run", "--release", "--quiet", "--example", "calibration_timing", file.name]
        ours = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout.splitlines()
    print(f"OpenCV {cv2.__version__}, {VIEWS} views of 48 corners, one thread each")
    print(f"{'lens':15} {'calipose':>10} {'OpenCV':>10} {'loose':>10} {'faster':>8} {'loose':>8}  cost differs by")
    for (data, (default, cost), (loose, _)), line in zip(rows, ours):
        seconds, our_cost, _ = (float(x) for x in line.split())
        print(
            f"{data['lens']:15} {seconds * 1e3:7.3f} ms {default * 1e3:7.2f} ms {loose * 1e3:7.2f} ms"
            f" {default / seconds:7.1f}x {loose / seconds:7.1f}x  {our_cost / cost - 1:.1e}"
        )


if __name__ == "__main__":
    main()

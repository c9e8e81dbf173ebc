"""Writes opencv_real_views.json: what OpenCV finds from the real corners in ../data/corners, with some intrinsics held.

    pip install opencv-python-headless numpy
    python opencv_real_views.py

The corners are those that OpenCV's detector found in pictures of a board of 9 x 6 corners, 25 mm. It is restarted from its
own result; the rational lens creeps along a valley all the same, and stops before the optimum.
"""

import json
import pathlib

import cv2
import numpy as np

HERE = pathlib.Path(__file__).parent
CRITERIA = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 10_000, 1e-16)
HELD = {
    "": 0,
    "fx=fy": cv2.CALIB_FIX_ASPECT_RATIO,
    "p1,p2": cv2.CALIB_ZERO_TANGENT_DIST,
    "k3": cv2.CALIB_FIX_K3,
    "cx,cy": cv2.CALIB_FIX_PRINCIPAL_POINT,
    "fx=fy,cx,cy,k2,p1,p2,k3": cv2.CALIB_FIX_ASPECT_RATIO
    | cv2.CALIB_FIX_PRINCIPAL_POINT
    | cv2.CALIB_FIX_K2
    | cv2.CALIB_ZERO_TANGENT_DIST
    | cv2.CALIB_FIX_K3,
}
CASES = [("weights.vnl", [640, 480], "brown-conrady", held) for held in HELD]
CASES += [(f"rational-real-{n}.vnl", [640, 512], lens, "") for n in ("8-4", "10-4", "2-5") for lens in ("brown-conrady", "rational")]


def read(name):
    """Image points (views, corners, 2)."""
    views = {}
    for line in (HERE / "../data/corners" / name).read_text().splitlines():
        if not line.startswith("#"):
            image, x, y, *_ = line.split()
            views.setdefault(image, []).append([float(x), float(y)])
    return np.array(list(views.values()), np.float32)


def main():
    board = np.array([[0.025 * (i % 9), 0.025 * (i // 9), 0] for i in range(54)], np.float32)
    results = []
    for name, size, lens, held in CASES:
        images = list(read(name))
        flags = HELD[held] | (cv2.CALIB_RATIONAL_MODEL if lens == "rational" else 0)
        K = None
        if "fx=fy" in held:
            # The ratio is that of a guess.
            K = cv2.initCameraMatrix2D([board] * len(images), images, size, 1.0)
            K[1, 1] = K[0, 0]
            flags |= cv2.CALIB_USE_INTRINSIC_GUESS
        D = None
        for _ in range(10):
            rms, K, D, _, _ = cv2.calibrateCamera([board] * len(images), images, size, K, D, flags=flags, criteria=CRITERIA)
            flags |= cv2.CALIB_USE_INTRINSIC_GUESS
        count = 8 if lens == "rational" else 5
        θ = [K[0, 0], K[1, 1], K[0, 2], K[1, 2], *D.ravel()[:count]]
        print(name, lens, held, rms, θ)
        results.append({"file": name, "image": size, "lens": lens, "held": held, "rms": rms, "intrinsics": [float(x) for x in θ]})
    text = json.dumps({"opencv": cv2.__version__, "results": results}, separators=(",", ":"))
    (HERE / "opencv_real_views.json").write_text(text.replace('{"file"', '\n{"file"') + "\n")


if __name__ == "__main__":
    main()

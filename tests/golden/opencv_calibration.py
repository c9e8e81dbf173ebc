"""Writes opencv_calibration.json: simulated corner sets with the optimum that OpenCV finds for each.

    pip install opencv-python-headless numpy
    python opencv_calibration.py

Pixels are multiples of 1/1024 and the board's squares of 1/64 m, both exact in the single precision that OpenCV reads,
so that the two sides see the same numbers. OpenCV runs with the tightest criteria and is restarted from its own result
until it stands still; the poses are X_CT with z out of the board's printed side, towards the camera.
"""

import json
import pathlib

import cv2
import numpy as np

UNIT = 1024
VIEWS = [5, 6, 8, 10, 12, 15, 20, 25, 30, 40]
CRITERIA = (cv2.TERM_CRITERIA_COUNT + cv2.TERM_CRITERIA_EPS, 10_000, 1e-16)
NO_DISTORTION = cv2.CALIB_FIX_K1 | cv2.CALIB_FIX_K2 | cv2.CALIB_FIX_K3 | cv2.CALIB_ZERO_TANGENT_DIST


def board(columns, rows, square):
    """Corners in T (n x 3, m), row by row, centred."""
    j, i = np.meshgrid(np.arange(columns), np.arange(rows))
    x = (j.ravel() - (columns - 1) / 2) * square
    y = (i.ravel() - (rows - 1) / 2) * square
    return np.stack([x, y, np.zeros_like(x)], axis=1)


def project(lens, points, R, t, K, D):
    rvec, _ = cv2.Rodrigues(R)
    if lens == "kannala-brandt":
        pixels, _ = cv2.fisheye.projectPoints(points.reshape(-1, 1, 3), rvec, t, K, D)
    else:
        pixels, _ = cv2.projectPoints(points, rvec, t, K, D if len(D) else None)
    return pixels.reshape(-1, 2)


def camera(lens, rng):
    """Image size, K and D of a random camera."""
    width, height = [(1280, 720), (1280, 960), (640, 480), (1920, 1200)][rng.integers(4)]
    focal = {"none": 0.9, "brown-conrady": 0.8, "rational": 0.5, "kannala-brandt": 0.36}[lens]
    fx = focal * width * rng.uniform(0.85, 1.2)
    fy = fx * rng.uniform(0.98, 1.02)
    cx = width / 2 + rng.uniform(-0.02, 0.02) * width
    cy = height / 2 + rng.uniform(-0.02, 0.02) * height
    K = np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1.0]])
    u = lambda a: rng.uniform(-a, a)
    D = {
        "none": lambda: [],
        "brown-conrady": lambda: [rng.uniform(-0.3, -0.05), rng.uniform(0, 0.12), u(2e-3), u(2e-3), u(0.03)],
        "rational": lambda: [0.9 + u(0.3), 0.4 + u(0.15), u(1e-3), u(1e-3), 0.03 + u(0.01), 1.2 + u(0.3), 0.7 + u(0.15), 0.12 + u(0.04)],
        "kannala-brandt": lambda: [u(0.05), u(0.02), u(0.01), u(0.003)],
    }[lens]()
    return width, height, K, np.array(D)


def view(lens, points, size, K, D, rng):
    """Pixels (n x 2, px) of a random view that lies in the image."""
    width, height = size
    extent = np.ptp(points[:, 0])
    while True:
        # Upright from the printed side is a half turn about x away from C; then roll and tilt.
        axis = rng.uniform(0, 2 * np.pi)
        tilt = np.radians(rng.uniform(10, 45)) * np.array([np.cos(axis), np.sin(axis), 0])
        R = cv2.Rodrigues(tilt)[0] @ cv2.Rodrigues(np.array([0, 0, rng.uniform(-0.6, 0.6)]))[0] @ np.diag([1.0, -1, -1])
        depth = extent * K[0, 0] / width * rng.uniform(1.2, 3.0)
        spread = 1.0 if lens == "kannala-brandt" else 0.5
        t = np.array([rng.uniform(-spread, spread) * width / K[0, 0], rng.uniform(-spread, spread) * height / K[1, 1], 1]) * depth
        if ((points @ R.T + t)[:, 2] < 0.1 * depth).any() or (R[:, 2] @ t) > -0.2 * np.linalg.norm(t):
            continue
        pixels = project(lens, points, R, t, K, D)
        if (pixels > 4).all() and (pixels[:, 0] < width - 5).all() and (pixels[:, 1] < height - 5).all():
            return pixels


def calibrate(lens, objects, images, size, K, D):
    """OpenCV's optimum from K and D or its own start: (cost in px^2, [fx fy cx cy ...], whether it stood still)."""
    count = sum(len(i) for i in images)
    last = None
    for _ in range(20):
        guess = 0 if K is None else cv2.CALIB_USE_INTRINSIC_GUESS
        if lens == "kannala-brandt":
            flags = guess | cv2.CALIB_FIX_SKEW | cv2.CALIB_RECOMPUTE_EXTRINSIC
            shaped = [o.reshape(1, -1, 3) for o in objects], [i.reshape(1, -1, 2) for i in images]
            rms, K, D, _, _ = cv2.fisheye.calibrate(*shaped, size, K, D, flags=flags, criteria=CRITERIA)
        else:
            model = {"none": NO_DISTORTION, "brown-conrady": 0, "rational": cv2.CALIB_RATIONAL_MODEL}[lens]
            single = [o.astype(np.float32) for o in objects], [i.astype(np.float32) for i in images]
            rms, K, D, _, _ = cv2.calibrateCamera(*single, size, K, D, flags=guess | model, criteria=CRITERIA)
        size_of_D = {"none": 0, "brown-conrady": 5, "rational": 8, "kannala-brandt": 4}[lens]
        θ = np.array([K[0, 0], K[1, 1], K[0, 2], K[1, 2], *D.ravel()[:size_of_D]])
        if last is not None and np.max(np.abs(θ - last) / np.abs(θ)) < 1e-7:
            return rms * rms * count, θ, True
        last = θ
    return rms * rms * count, θ, False


def main():
    rng = np.random.default_rng(20260511)
    sets = []
    for lens, number in [("none", 10), ("brown-conrady", 20), ("rational", 12), ("kannala-brandt", 15)]:
        made = 0
        while made < number:
            views = VIEWS[made % len(VIEWS)]
            if lens == "rational":
                views = max(views, 15)
            columns, rows = (8, 6) if views <= 10 else (6, 5) if views <= 15 else (5, 4)
            if lens == "rational":
                columns, rows = 7, 6
            square = 2 / 64
            width, height, K, D = camera(lens, rng)
            σ = [0.1, 0.3, 0.5][made % 3] if lens != "rational" else 0.05
            points = board(columns, rows, square)
            objects, images, kept = [], [], []
            for _ in range(views):
                pixels = view(lens, points, (width, height), K, D, rng)
                pixels = np.round((pixels + rng.normal(0, σ, pixels.shape)) * UNIT) / UNIT
                # Every third set misses a tenth of its corners.
                keep = rng.uniform(size=len(points)) > (0.1 if made % 3 == 2 else 0)
                objects.append(points[keep])
                images.append(pixels[keep])
                kept.append([[round(u * UNIT), round(v * UNIT)] if k else None for (u, v), k in zip(pixels, keep)])
            # The fisheye's own start often fails; the true camera then takes its place. What neither brings to rest
            # at the level of the noise is left out.
            truth = np.array([K[0, 0], K[1, 1], K[0, 2], K[1, 2], *D])
            best, start = None, "its own"
            for start, guess in [("its own", (None, None)), ("the true", (K.copy(), D.reshape(-1, 1).copy()))]:
                try:
                    cost, θ, still = calibrate(lens, objects, images, (width, height), *guess)
                except cv2.error:
                    continue
                if lens == "rational" and (np.abs(θ - truth) > 0.5 * np.abs(truth))[[4, 5, 9, 10]].any():
                    # Numerator and denominator nearly cancel: the coefficients are lost in the noise.
                    continue
                if still and cost < 3 * 2 * σ**2 * sum(len(i) for i in images):
                    best = cost, θ
                    break
            print(f"{lens:15} {views:3} views, {start} start:", "left out" if best is None else best[0], flush=True)
            if best is None:
                continue
            cost, θ = best
            sets.append(
                {
                    "lens": lens,
                    "image": [width, height],
                    "board": {"columns": columns, "rows": rows, "square": square},
                    "truth": [float(x) for x in truth],
                    "sigma": σ,
                    "cost": float(cost),
                    "intrinsics": [float(x) for x in θ],
                    "views": kept,
                }
            )
            made += 1
    text = json.dumps({"opencv": cv2.__version__, "pixels_per_unit": 1 / UNIT, "sets": sets}, separators=(",", ":"))
    pathlib.Path(__file__).with_suffix(".json").write_text(text.replace('{"lens"', '\n{"lens"') + "\n")


if __name__ == "__main__":
    main()

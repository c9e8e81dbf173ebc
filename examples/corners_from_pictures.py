"""Finds a checkerboard's inner corners in pictures and prints them as mrcal's table, which `calipose calibrate` reads.

    pip install opencv-python-headless
    python corners_from_pictures.py 8x6 pictures/*.png > corners.vnl
    calipose calibrate corners.vnl --board 8x6 --square-mm 35 --image 1280x720

8x6 are the board's inner corners along its longer and its shorter side: one less than squares. All pictures are of one
camera, with one zoom and focus, and of one size, which is said at the end. A picture without the whole board gets a line
that says so. An even number of corners along one side and an odd one along the other tells the board's ends apart.
"""

import argparse
import sys

import cv2
import numpy as np


def board_size(text):
    columns, rows = (int(side) for side in text.lower().split("x"))
    if columns < 3 or rows < 3:
        raise ValueError
    return columns, rows


def corners_in(picture, size):
    """The corners, row by row (n x 2, px), or None. Pixel (0, 0) is the centre of the top-left pixel."""
    found, corners = cv2.findChessboardCornersSB(picture, size, flags=cv2.CALIB_CB_EXHAUSTIVE | cv2.CALIB_CB_ACCURACY)
    if not found:
        found, corners = cv2.findChessboardCorners(picture, size, flags=cv2.CALIB_CB_ADAPTIVE_THRESH)
        if not found:
            return None
        # A window of a third of the least distance of two corners stays on its own.
        grid = corners.reshape(size[1], size[0], 2)
        steps = [np.linalg.norm(np.diff(grid, axis=axis), axis=2).min() for axis in (0, 1)]
        half = int(np.clip(min(steps) / 3, 2, 15))
        end = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 100, 1e-4)
        corners = cv2.cornerSubPix(picture, corners, (half, half), (-1, -1), end)
    return corners.reshape(-1, 2)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("board", type=board_size, help="inner corners, as in 8x6")
    parser.add_argument("pictures", nargs="+")
    arguments = parser.parse_args()

    shape, seen = None, 0
    print("# filename x y level")
    for name in arguments.pictures:
        picture = cv2.imread(name, cv2.IMREAD_GRAYSCALE)
        if picture is None:
            sys.exit(f"{name} is not a picture that OpenCV reads")
        if any(c.isspace() for c in name):
            sys.exit(f"{name}: the table has no room for spaces; rename the picture")
        if shape is not None and picture.shape != shape:
            sys.exit(f"{name} has {picture.shape[1]}x{picture.shape[0]} px, the others {shape[1]}x{shape[0]}")
        shape = picture.shape
        corners = corners_in(picture, arguments.board)
        if corners is None:
            print(f"{name} - - -")
            print(f"{name}: no board of {arguments.board[0]}x{arguments.board[1]} corners", file=sys.stderr)
            continue
        seen += 1
        for x, y in corners:
            print(f"{name} {x:.4f} {y:.4f} 0")
    print(
        f"board found in {seen} of {len(arguments.pictures)} pictures; give calipose --image {shape[1]}x{shape[0]}",
        file=sys.stderr,
    )


if __name__ == "__main__":
    main()

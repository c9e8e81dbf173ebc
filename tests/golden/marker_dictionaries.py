"""Writes src/target/dictionaries.bin: the bits of the markers of OpenCV's predefined dictionaries.

    python3 -m venv venv && venv/bin/pip install opencv-python-headless==5.0.0.93 numpy==2.4.6
    venv/bin/python tests/golden/marker_dictionaries.py

The dictionaries follow each other in the order of FAMILIES; of each, every marker with its bits row by row from the upper left, light ones 1,
padded with zeros to whole bytes. OpenCV's dictionaries are under the Apache License 2.0, the tags of AprilTag under the BSD 2-Clause
License (https://github.com/AprilRobotics/apriltag), ArUco's ORIGINAL and MIP_36h12 under OpenCV's. Smaller ones of a size are the beginnings of
larger ones, which is asserted.
"""

from pathlib import Path

import cv2
import numpy as np

FAMILIES = {
    "4X4_1000": ["4X4_50", "4X4_100", "4X4_250"],
    "5X5_1000": ["5X5_50", "5X5_100", "5X5_250"],
    "6X6_1000": ["6X6_50", "6X6_100", "6X6_250"],
    "7X7_1000": ["7X7_50", "7X7_100", "7X7_250"],
    "ARUCO_ORIGINAL": [],
    "ARUCO_MIP_36h12": [],
    "APRILTAG_16h5": [],
    "APRILTAG_25h9": [],
    "APRILTAG_36h10": [],
    "APRILTAG_36h11": [],
}


def bits(name):
    """Markers × bits."""
    dictionary = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, f"DICT_{name}"))
    side = dictionary.markerSize
    rows = [cv2.aruco.Dictionary.getBitsFromByteList(row[None], side).ravel() for row in dictionary.bytesList]
    return side, np.array(rows, np.uint8)


def main():
    table = b""
    for name, smaller in FAMILIES.items():
        side, markers = bits(name)
        for other in smaller:
            begin = bits(other)[1]
            assert (markers[: len(begin)] == begin).all(), f"{other} is not the beginning of {name}"
        print(f"{name}: {len(markers)} markers of {side} × {side} bits, from byte {len(table)}")
        table += np.packbits(markers, axis=1).tobytes()
    (Path(__file__).resolve().parents[2] / "src/target/dictionaries.bin").write_bytes(table)


if __name__ == "__main__":
    main()

"""Shows that OpenCV reads the camera files that calipose writes: the snapshots of tests/camera_formats.rs.

    pip install opencv-python-headless numpy pyyaml
    python opencv_reads_cameras.py

Each FileStorage file must give, to the last digit, the numbers that PyYAML reads from the ROS file of the same camera,
and they must be a camera that cv2.projectPoints or cv2.fisheye.projectPoints takes. OpenCV 5.0.0 reads them all.
"""

import pathlib

import cv2
import numpy as np
import yaml

SNAPSHOTS = pathlib.Path(__file__).parent.parent / "snapshots"


def snapshot(name):
    """The text of a snapshot, less insta's header."""
    return (SNAPSHOTS / f"camera_formats__{name}.snap").read_text().split("---\n", 2)[2]


def main():
    point = np.array([[[0.1, -0.2, 1.0]]])
    zero = np.zeros(3)
    for lens in ["none", "brown-conrady", "rational", "kannala-brandt"]:
        ros = yaml.safe_load(snapshot(f"ros_{lens}"))
        K = np.array(ros["camera_matrix"]["data"], dtype=float).reshape(3, 3)
        D = np.array(ros["distortion_coefficients"]["data"], dtype=float)
        for format in ["opencv", "opencv-json"]:
            flags = cv2.FILE_STORAGE_READ | cv2.FILE_STORAGE_MEMORY
            storage = cv2.FileStorage(snapshot(f"{format}_{lens}"), flags)
            read = storage.getNode("distortion_coefficients").mat()
            coefficients = np.zeros(0) if read is None else read
            assert (storage.getNode("camera_matrix").mat() == K).all()
            assert coefficients.size == D.size and (coefficients.ravel() == D).all()
            assert storage.getNode("image_width").real() == ros["image_width"]
            assert storage.getNode("image_height").real() == ros["image_height"]
            fisheye = storage.getNode("fisheye_model")
            assert (not fisheye.empty() and fisheye.real() == 1) == (lens == "kannala-brandt")
            project = cv2.fisheye.projectPoints if lens == "kannala-brandt" else cv2.projectPoints
            pixel, _ = project(point, zero, zero, K, coefficients if coefficients.size else np.zeros(5))
            print(f"{format:12} {lens:15} {pixel.ravel()}")
    print(f"OpenCV {cv2.__version__} reads them all")


if __name__ == "__main__":
    main()

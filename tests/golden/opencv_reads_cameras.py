"""Shows that other code reads the camera files that calipose writes: the snapshots of tests/files/camera_formats.rs.

    pip install opencv-python-headless numpy pyyaml
    python opencv_reads_cameras.py

Each FileStorage file must give, to the last digit, the numbers that PyYAML reads from the ROS file of the same camera,
and they must be a camera that cv2.projectPoints or cv2.fisheye.projectPoints takes. OpenCV 5.0.0 reads them all.
Kalibr's files must give them to PyYAML, with the types and signs that Kalibr's CameraParameters insists on, and mrcal's to the
Python parser that mrcal uses.
"""

import ast

import pathlib

import cv2
import numpy as np
import yaml

SNAPSHOTS = pathlib.Path(__file__).parent.parent / "snapshots"


def snapshot(name):
    """The text of a snapshot, less insta's header."""
    return (SNAPSHOTS / f"camera_formats__{name}.snap").read_text().split("---\n", 2)[2]


def check_kalibr(name, K, D, size):
    """What Kalibr's CameraParameters checks, and that the numbers are those of the ROS file."""
    (camera,) = yaml.safe_load(snapshot(name)).values()
    focal, principal = camera["intrinsics"][:2], camera["intrinsics"][2:]
    assert camera["camera_model"] == "pinhole" and len(principal) == 2
    assert all(isinstance(x, float) and x >= 0 for x in focal + principal)
    counts = {"radtan": 4, "equidistant": 4, "none": 0}
    assert len(camera["distortion_coeffs"]) == counts[camera["distortion_model"]]
    assert all(isinstance(x, float) for x in camera["distortion_coeffs"])
    assert camera["resolution"] == size and isinstance(camera["rostopic"], str)
    assert focal + principal == [K[0, 0], K[1, 1], K[0, 2], K[1, 2]]
    assert camera["distortion_coeffs"] == list(D[:4])


def check_mrcal(name, K, D, size):
    model = ast.literal_eval(snapshot(name))
    counts = {"LENSMODEL_PINHOLE": 4, "LENSMODEL_OPENCV5": 9, "LENSMODEL_OPENCV8": 12}
    assert len(model["intrinsics"]) == counts[model["lensmodel"]]
    assert model["intrinsics"] == [K[0, 0], K[1, 1], K[0, 2], K[1, 2], *D]
    assert model["imagersize"] == size and len(model["rt_cam_ref"]) == 6


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
        size = [ros["image_width"], ros["image_height"]]
        if lens != "rational":
            check_kalibr(f"kalibr_{lens}", K, D, size)
        if lens != "kannala-brandt":
            check_mrcal(f"mrcal_{lens}", K, D, size)
    print(f"OpenCV {cv2.__version__}, PyYAML {yaml.__version__} and Python read them all")


if __name__ == "__main__":
    main()

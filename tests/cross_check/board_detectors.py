"""OpenCV's detectors of boards: which corners they tell, and cornerSubPix, which says where they are."""

WINDOW_PX = 5
# Of the markers of an AprilGrid, drawn as Kalibr's. OpenCV's defaults read few of them in noisy pictures; in slightly smoothed ones, with
# a threshold that noise does not pass, they are read nearly all. The corners are refined in the picture as it is.
SMOOTH_PX = 0.8
TAGS = {"markerBorderBits": 2, "adaptiveThreshConstant": 20, "adaptiveThreshWinSizeMin": 9, "adaptiveThreshWinSizeMax": 29}


def refined(picture, corners):
    """By cornerSubPix."""
    until = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 100, 1e-4)
    found = cv2.cornerSubPix(picture, corners.reshape(-1, 1, 2).astype(np.float32), (WINDOW_PX, WINDOW_PX), (-1, -1), until)
    return found.reshape(-1, 2).astype(float)


def tags(picture, columns):
    """Numbers of the corners of an AprilGrid's tags that are read, and about where they are."""
    parameters = cv2.aruco.DetectorParameters()
    for name, value in TAGS.items():
        setattr(parameters, name, value)
    dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36h11)
    smooth = cv2.GaussianBlur(picture, (0, 0), SMOOTH_PX)
    corners, ids, _ = cv2.aruco.ArucoDetector(dictionary, parameters).detectMarkers(smooth)
    if ids is None:
        return np.array([], int), np.empty((0, 2))
    # OpenCV begins at the lower right corner and goes round clockwise.
    wide = 2 * columns
    first = [2 * (tag // columns) * wide + 2 * (tag % columns) for tag in ids.ravel()]
    return np.array([[at + 1, at, at + wide, at + wide + 1] for at in first]).ravel(), np.concatenate(corners).reshape(-1, 2)


def charuco(picture, target):
    """The same of a ChArUco board's corners."""
    dictionary = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, target["dictionary"]))
    board = cv2.aruco.CharucoBoard((target["columns"], target["rows"]), target["square_mm"], target["marker_mm"], dictionary)
    board.setLegacyPattern(target.get("legacy_pattern", False))
    corners, ids, *_ = cv2.aruco.CharucoDetector(board).detectBoard(picture)
    return (np.array([], int), np.empty((0, 2))) if ids is None else (ids.ravel(), corners.reshape(-1, 2))


def told(picture, target):
    """Numbers of the corners that are seen of a board with markers."""
    return (charuco(picture, target) if target["kind"] == "charuco" else tags(picture, target["columns"]))[0]

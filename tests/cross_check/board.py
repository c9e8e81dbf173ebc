"""Boards that `calipose board` draws, measured by foreign eyes.

    python tests/cross_check/board.py [CALIPOSE]

Renders the PDF with PDFium and the SVG with resvg, lays the page on something dark, and lets OpenCV find the corners
(findChessboardCornersSB, CharucoDetector, ArucoDetector, findCirclesGrid). Asserts that each is within 0.05 mm of its place, without fitting a
scale or a turn, and has the number that the document gives it; that a ChArUco board is OpenCV's own picture of it; that page and scale bar
have the length they state; that a checkerboard's square at the lower left is black; and that the pages of a tiling, cut at their marks and
put together, make the same grid. CALIPOSE is the program, built in release when left out. The packages are
PyPI's (in $CROSS_CHECK_VENV, or a temporary folder). Exits with 1 where anything is off.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

from environment import run_with

ROOT = Path(__file__).resolve().parents[2]
# Pages whose sides are whole tenths of a millimetre have whole pixels.
PX_PER_MM = 10
COARSER = 4
WITHIN = 0.05  # mm
# Problem file, or the keys of a target, options, and whether the pattern is spread over several pages.
CHARUCO = "--set target.kind=charuco --set target.columns=9 --set target.rows=7 --set target.marker_mm=26 --set target.dictionary="
CIRCLES = "diameter_mm = 18\nspacing_mm = 40\n"
APRILGRID = 'kind = "aprilgrid"\ncolumns = 4\nrows = 3\ntag_mm = 50\ntag_spacing = 0.3'
CASES = [
    ("servosila-engineer", CHARUCO + "DICT_5X5_50", False),
    ("servosila-engineer", CHARUCO + "DICT_APRILTAG_36h11 --set target.rows=6", False),
    ("servosila-engineer", CHARUCO + "DICT_4X4_100 --set target.rows=6 --set target.legacy_pattern=true", False),
    ("servosila-engineer", CHARUCO + "DICT_ARUCO_ORIGINAL --page A4 --tile", True),
    (APRILGRID, "", False),
    (APRILGRID, "--page A4 --tile", True),
    (CIRCLES + 'kind = "circles"\ncolumns = 5\nrows = 8', "", False),
    # OpenCV mixes up asymmetric grids with an even number of rows.
    (CIRCLES + 'kind = "asymmetric-circles"\ncolumns = 4\nrows = 11', "", False),
    ("servosila-engineer", "", False),
    ("servosila-engineer", "--page 376x280 --margin-mm 0", False),
    ("servosila-engineer", "--set target.square_mm=17.3 --page letter", False),
    ("seven-axis-carrier", "", False),
    ("servosila-engineer", "--page A4 --tile", True),
    ("seven-axis-carrier", "--page A5 --tile --margin-mm 5", True),
]


def from_pdf(path):
    """The pages in grey, and their sizes in mm."""
    for page in pypdfium2.PdfDocument(path):
        picture = page.render(scale=PX_PER_MM * 25.4 / 72, grayscale=True).to_numpy()
        yield np.squeeze(picture), np.array(page.get_size()) * 25.4 / 72


def from_svg(path):
    """The page in grey, and its size in mm."""
    png = resvg_py.svg_to_bytes(svg_path=str(path), dpi=PX_PER_MM * 25.4)
    picture = cv2.imdecode(np.frombuffer(bytes(png), np.uint8), cv2.IMREAD_GRAYSCALE)
    root = ElementTree.parse(path).getroot()
    return picture, np.array([float(root.get(side).removesuffix("mm")) for side in ("width", "height")])


def grid_error(picture, px_per_mm, pattern):
    """How far, in mm, the farthest corner is from its place; with it the mean spacing along x and y, and the shades beside corner 0."""
    columns, rows, square = pattern["columns"], pattern["rows"], pattern["square_mm"]
    # The detector takes half a minute for a picture of ten pixels a millimetre.
    height, width = (side // COARSER * COARSER for side in picture.shape)
    coarse = cv2.resize(picture[:height, :width], None, fx=1 / COARSER, fy=1 / COARSER, interpolation=cv2.INTER_AREA)
    px_per_mm = px_per_mm / COARSER
    dark = cv2.copyMakeBorder(coarse, 80, 80, 80, 80, cv2.BORDER_CONSTANT, value=20)
    found, corners = cv2.findChessboardCornersSB(dark, (columns, rows), flags=cv2.CALIB_CB_ACCURACY)
    assert found, "no board found"
    mm = corners.reshape(-1, 2).astype(float) / px_per_mm
    # Row by row from the lower left, whichever way the detector began.
    mm = mm[np.lexsort((mm[:, 0], -np.round(mm[:, 1] / square)))].reshape(rows, columns, 2)
    place = np.stack(np.meshgrid(np.arange(columns), -np.arange(rows)), axis=-1) * square
    off = mm - place
    off -= off.mean(axis=(0, 1))
    spacing = np.diff(mm[..., 0], axis=1).mean(), -np.diff(mm[..., 1], axis=0).mean()
    shade = lambda x, y: dark[tuple(np.round((mm[0, 0] + np.array([x, -y]) * square)[::-1] * px_per_mm).astype(int))]
    shades = [shade(-0.5, -0.5), shade(0.5, -0.5), shade(-0.5, 0.5), shade(columns - 0.5, -0.5)]
    return np.abs(off).max(), spacing, [int(level) for level in shades]


def numbered(picture, px_per_mm, pattern):
    """Numbers of the corners that OpenCV finds, and where, in px."""
    kind = pattern["kind"]
    if kind == "charuco":
        detector = cv2.aruco.CharucoDetector(charuco(pattern))
        corners, ids = detector.detectBoard(picture)[:2]
        return ids.ravel(), corners.reshape(-1, 2)
    if kind == "aprilgrid":
        parameters = cv2.aruco.DetectorParameters()
        parameters.markerBorderBits = 2
        dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36h11)
        corners, ids, _ = cv2.aruco.ArucoDetector(dictionary, parameters).detectMarkers(picture)
        # AprilTag's tags are upside down in OpenCV, which begins at their upper left: at the lower right, clockwise.
        columns = 2 * pattern["columns"]
        first = [2 * (tag // pattern["columns"]) * columns + 2 * (tag % pattern["columns"]) for tag in ids.ravel()]
        numbers = np.array([[base + 1, base, base + columns, base + columns + 1] for base in first]).ravel()
        found = np.concatenate(corners).reshape(-1, 1, 2)
        criteria = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 100, 1e-4)
        return numbers, cv2.cornerSubPix(picture, found, (20, 20), (-1, -1), criteria).reshape(-1, 2)
    flags = cv2.CALIB_CB_ASYMMETRIC_GRID if kind == "asymmetric-circles" else cv2.CALIB_CB_SYMMETRIC_GRID
    parameters = cv2.SimpleBlobDetector_Params()
    # Dark, and larger than the letters on the page.
    parameters.minArea, parameters.maxArea, parameters.minDistBetweenBlobs = 500, 1e5, 20
    parameters.filterByCircularity, parameters.minCircularity = True, 0.8
    blobs = cv2.SimpleBlobDetector_create(parameters)
    coarse = cv2.resize(picture, None, fx=1 / COARSER, fy=1 / COARSER, interpolation=cv2.INTER_AREA)
    found, centres = cv2.findCirclesGrid(coarse, (pattern["columns"], pattern["rows"]), flags=flags, blobDetector=blobs)
    assert found, "no grid of circles found"
    centres = (centres.reshape(-1, 2) + 0.5) * COARSER - 0.5
    # The grid looks the same from its other end, and the plain one mirrored too; OpenCV may begin there.
    grid = centres.reshape(pattern["rows"], pattern["columns"], 2)
    sign = 1 if kind == "asymmetric-circles" else -1
    if grid[0, 0, 0] > grid[0, -1, 0]:
        grid = grid[:, ::-1] if kind == "circles" else grid[::-1, ::-1]
    if sign * (grid[-1, 0, 1] - grid[0, 0, 1]) < 0:
        grid = grid[::-1]
    return np.arange(len(centres)), grid.reshape(-1, 2)


def charuco(pattern):
    dictionary = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, pattern["dictionary"]))
    board = cv2.aruco.CharucoBoard((pattern["columns"], pattern["rows"]), pattern["square_mm"], pattern["marker_mm"], dictionary)
    board.setLegacyPattern(pattern["legacy_pattern"])
    return board


def check_numbered(what, whole, scale, pattern, wrong):
    """Holds corners, found with their numbers, against the document's places; and a ChArUco board against OpenCV's picture."""
    ids, found = numbered(whole, scale, pattern)
    places = np.array(pattern["corners_mm"]) * [1, -1]
    mm = (found.astype(float) + 0.5) / scale
    off = mm - places[ids]
    middle = off.mean(axis=0)
    error = np.abs(off - middle).max()
    print(f"{what}: {len(ids)} of {len(places)} corners found with their numbers, within {error:.4f} mm")
    if sorted(ids) != list(range(len(places))) or error > WITHIN:
        wrong.append(f"{what}: corners {sorted(ids)}, {error} mm off")
    if pattern["kind"] == "charuco":
        size = np.array(pattern["size_mm"])
        begin = np.round((middle - size / 2) * scale).astype(int)
        width, height = np.round(size * scale).astype(int)
        drawn = whole[begin[1] : begin[1] + height, begin[0] : begin[0] + width]
        opencv = charuco(pattern).generateImage((int(width), int(height)), marginSize=0)
        # A pixel's rounding along every edge of a module.
        differing = np.mean(np.abs(drawn.astype(float) - opencv) > 128)
        print(f"{what}: {100 * differing:.2f} % of the pixels differ from OpenCV's picture")
        if differing > 0.02:
            wrong.append(f"{what}: {100 * differing:.1f} % of the pixels differ from OpenCV's picture")


def parts(picture):
    """Bounding boxes (x, y, width, height in px) of what is dark and connected."""
    return cv2.connectedComponentsWithStats((picture < 170).astype(np.uint8), connectivity=8)[2][1:, :4]


def ticks(picture, px_per_mm, length):
    """Places of the scale bar's ticks in mm."""
    sides = lambda box: sorted(box[2:] / px_per_mm)
    bars = [box for box in parts(picture) if abs(sides(box)[1] - length) < 2 and sides(box)[0] < 6]
    assert len(bars) == 1, f"{len(bars)} scale bars"
    x, y, width, height = bars[0]
    along, across = px_per_mm if width > height else px_per_mm[::-1]
    bar = picture[y - 2 : y + height + 2, x - 2 : x + width + 2]
    if height > width:
        bar = np.rot90(bar, -1)
    # Between the line and the top of the short ticks.
    low, high = (len(bar) - 2 - round(mm * across) for mm in (0.6, 2.0))
    darkness = 255.0 - bar[high:low].mean(axis=0)
    is_tick = np.concatenate([[0], darkness > 20, [0]])
    edges = np.flatnonzero(np.diff(is_tick)).reshape(-1, 2)
    at = np.arange(len(darkness))
    return np.array([np.average(at[a:b], weights=darkness[a:b]) for a, b in edges]) / along


def cut(picture, px_per_mm):
    """The page between its marks: moved so that it begins on a pixel's edge, and its width and height in px."""
    lines = {0: [], 1: []}
    for x, y, width, height in parts(picture):
        short, long = sorted(np.array([width, height]) / px_per_mm)
        if 3 < long < 4 and short < 0.3:
            axis = int(width > height)
            box = 255.0 - picture[y - 2 : y + height + 2, x - 2 : x + width + 2]
            lines[axis].append((x, y)[axis] - 2 + np.average(np.arange(box.shape[1 - axis]), weights=box.sum(axis=axis)) + 0.5)
    begin, end = [], []
    for axis in (0, 1):
        ordered = sorted(lines[axis])
        assert len(ordered) == 4 and ordered[1] - ordered[0] < 0.5 and ordered[3] - ordered[2] < 0.5, f"marks at {ordered}"
        begin.append(np.mean(ordered[:2]))
        end.append(np.mean(ordered[2:]))
    return np.array(begin), np.array(end)


def assembled(pages, tiles, px_per_mm):
    """The pages, cut at their marks and put together edge to edge."""
    cuts = [cut(picture, px_per_mm) for picture in pages]
    sizes = np.array([end - begin for begin, end in cuts]).reshape(tiles["rows"], tiles["columns"], 2)
    assert np.ptp(sizes[..., 0], axis=0).max() < 0.5 and np.ptp(sizes[..., 1], axis=1).max() < 0.5, "parts do not fit together"
    left = np.concatenate([[0], np.cumsum(sizes[0, :, 0])])
    top = np.concatenate([[0], np.cumsum(sizes[:, 0, 1])])
    whole = np.full((int(top[-1]), int(left[-1])), 255, np.uint8)
    for n, (picture, (begin, _)) in enumerate(zip(pages, cuts)):
        row, column = divmod(n, tiles["columns"])
        shift = np.array([left[column], top[row]]) - begin
        move = np.array([[1.0, 0, shift[0]], [0, 1, shift[1]]])
        moved = cv2.warpAffine(picture, move, whole.shape[::-1], flags=cv2.INTER_LINEAR, borderValue=255)
        y0, y1, x0, x1 = (round(edge) for edge in (top[row], top[row + 1], left[column], left[column + 1]))
        whole[y0:y1, x0:x1] = moved[y0:y1, x0:x1]
    return whole


def check(what, pages, document, wrong):
    """Holds rendered pages, each with its size, against what the document says."""
    pattern, length = document["pattern"], document["scale_bar_mm"]
    bars = []
    for picture, size in pages:
        if np.abs(size - document["page"]["size_mm"]).max() > 1e-3:
            wrong.append(f"{what}: the page has {size} mm")
        scale = np.array(picture.shape[::-1]) / size
        found = ticks(picture, scale, length)
        bars.append(np.abs(found - found[0] - np.arange(0, length + 1, 10)).max() if len(found) == length / 10 + 1 else np.inf)
    whole = pages[0][0] if document["tiles"] is None else assembled([page for page, _ in pages], document["tiles"], scale)
    if pattern["kind"] != "checkerboard":
        print(f"{what}: {len(pages)} page(s); ticks of the scale bar within {max(bars):.4f} mm")
        if max(bars) > WITHIN:
            wrong.append(f"{what}: the scale bar is {max(bars)} mm off")
        return check_numbered(what, whole, scale, pattern, wrong)
    error, spacing, (black, white, other, last) = grid_error(whole, scale, pattern)
    print(
        f"{what}: {len(pages)} page(s); corners within {error:.4f} mm, spacing {spacing[0]:.4f} x {spacing[1]:.4f} mm, "
        f"ticks of the scale bar within {max(bars):.4f} mm"
    )
    if error > WITHIN or max(abs(side - pattern["square_mm"]) for side in spacing) > WITHIN:
        wrong.append(f"{what}: corners {error} mm off, spacing {spacing}")
    if max(bars) > WITHIN:
        wrong.append(f"{what}: the scale bar is {max(bars)} mm off")
    is_last_black = pattern["columns"] % 2 == 0
    if not (black < 60 and white > 200 and other > 200 and (last < 60) == is_last_black):
        wrong.append(f"{what}: shades around corner 0 are {black}, {white}, {other}, {last}")


def with_target(keys):
    """The Servosila with another target."""
    text = (ROOT / "problems/servosila-engineer.toml").read_text()
    for line in ("columns = 8", "rows = 6", "square_mm = 35"):
        assert f"\n{line}\n" in text
        text = text.replace(f"\n{line}\n", "\n", 1)
    return text.replace("[target]\n", f"[target]\n{keys}\n", 1)


def main():
    if len(sys.argv) > 1:
        program = Path(sys.argv[1]).resolve()
    else:
        subprocess.run(["cargo", "build", "--release", "--locked", "--quiet"], cwd=ROOT, check=True)
        program = ROOT / "target/release/calipose"
    wrong = []
    for problem, options, is_tiled in CASES:
        with tempfile.TemporaryDirectory() as folder:
            path = ROOT / f"problems/{problem}.toml"
            if "=" in problem:
                path = Path(folder) / "problem.toml"
                path.write_text(with_target(problem))
            command = [program, "board", path, *options.split(), "--json"]
            document = json.loads(subprocess.run(command, cwd=folder, check=True, capture_output=True, text=True).stdout)
            assert (document["tiles"] is not None) == is_tiled, f"{problem} {options}: {document['tiles']}"
            files = [Path(folder) / file["file"] for file in document["files"]]
            pdf, svg = [[file for file in files if file.suffix == suffix] for suffix in (".pdf", ".svg")]
            what = f"{' '.join(problem.split())} {options}".strip()
            check(f"{what}, pdf", list(from_pdf(pdf[0])), document, wrong)
            check(f"{what}, svg", [from_svg(file) for file in svg], document, wrong)
    for fault in wrong:
        print(fault)
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    run_with("numpy==2.4.6", "opencv-python-headless==5.0.0.93", "pypdfium2==5.15.2", "resvg_py==0.5.0")
    from xml.etree import ElementTree

    import cv2
    import numpy as np
    import pypdfium2
    import resvg_py

    main()

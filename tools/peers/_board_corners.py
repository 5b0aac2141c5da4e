"""Finds the corners of rendered boards with OpenCV and compares them with the truth beside each picture.

    BOARDS=DIR cargo test -p virtual-rig --test calibration -- --ignored
    python tools/peers/_board_corners.py DIR
"""

import json
import pathlib
import sys

import cv2
import numpy as np

STOP = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 100, 1e-4)
MAX_RMS_PX = 0.05
MIN_FOUND = 0.99


def chessboard(picture, board):
    """Corners by their number, as `findChessboardCorners` and `cornerSubPix` find them."""
    found, corners = cv2.findChessboardCorners(picture, (board["columns"], board["rows"]))
    if not found:
        return {}
    corners = cv2.cornerSubPix(picture, corners, (6, 6), (-1, -1), STOP)
    return dict(enumerate(corners.reshape(-1, 2)))


def charuco(picture, board):
    """Corners by their number, as `CharucoDetector` and `cornerSubPix` find them."""
    markers = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50)
    size = (board["columns"], board["rows"])
    pattern = cv2.aruco.CharucoBoard(size, board["square_mm"], board["marker_mm"], markers)
    parameters = cv2.aruco.DetectorParameters()
    # Cells of 6 px, blurred, are misread when they are resampled to the 4 px of the default.
    parameters.perspectiveRemovePixelPerCell = 8
    parameters.perspectiveRemoveIgnoredMarginPerCell = 0.3
    detector = cv2.aruco.CharucoDetector(pattern, cv2.aruco.CharucoParameters(), parameters)
    corners, ids, _, _ = detector.detectBoard(picture)
    if ids is None:
        return {}
    corners = cv2.cornerSubPix(picture, corners.astype(np.float32), (4, 4), (-1, -1), STOP)
    return dict(zip(ids.ravel().tolist(), corners.reshape(-1, 2)))


FINDERS = {"chessboard": chessboard, "charuco": charuco}


def compare(truth_path):
    """Kind of board, how many corners there are, and the distances in px of those that were found."""
    board, corners = json.loads(truth_path.read_text())
    ((kind, board),) = board.items()
    picture = cv2.imread(str(truth_path.with_suffix(".png")), cv2.IMREAD_GRAYSCALE)
    found = FINDERS[kind](picture, board)
    distances = [np.linalg.norm(found[corner] - (x, y)) for corner, x, y in corners if corner in found]
    return kind, len(corners), distances


def main(folder):
    """Prints one line per kind of board; 1 if too few corners were found or their RMS is too large."""
    counts, distances = dict.fromkeys(FINDERS, 0), {kind: [] for kind in FINDERS}
    for truth_path in sorted(folder.glob("*.json")):
        kind, count, found = compare(truth_path)
        counts[kind] += count
        distances[kind] += found
    good = True
    for kind, found in distances.items():
        rms = float(np.sqrt(np.mean(np.square(found)))) if found else float("inf")
        print(f"{kind}: {len(found)} of {counts[kind]} corners, RMS {rms:.4f} px, worst {max(found, default=0):.3f} px")
        good &= rms <= MAX_RMS_PX and len(found) >= MIN_FOUND * counts[kind]
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main(pathlib.Path(sys.argv[1])))

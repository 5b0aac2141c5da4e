"""Scores of `calibrate`: real stereo pairs beside OpenCV, a real four-camera session beside the calibration shipped with it,
and virtual takes beside their truth. Corners are found by OpenCV here, and both sides get the same."""

import csv
import json
import time
import tomllib

import cv2
import numpy as np
from scipy.optimize import least_squares

import _calibrate_formats
import _calibrate_wand
from _takes import make

SEEDS = [1, 2]
STOP = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 100, 1e-4)


def metric(name, value, target, better, unit, **context):
    return {"metric": f"calibrate/{name}", "value": value, "target": target, "better": better, "unit": unit, "context": context}


def write_corners(path, board, cameras, frames):
    """`frames`: number -> camera -> corner -> (x, y)."""
    rows = [{"schema": "board-corners/1", "data": {"board": board, "cameras": cameras, "take": None}}]
    for number, seen in sorted(frames.items()):
        corners = {c: [[int(i), float(x), float(y)] for i, (x, y) in sorted(points.items())] for c, points in seen.items()}
        rows.append({"frame": number, "corners": corners})
    path.write_text("".join(json.dumps(row) + "\n" for row in rows))
    return path


def chessboard(picture, size, reach):
    found, corners = cv2.findChessboardCorners(picture, size)
    if not found:
        return {}
    corners = cv2.cornerSubPix(picture, corners, (reach, reach), (-1, -1), STOP)
    return dict(enumerate(corners.reshape(-1, 2)))


def read_rig(path):
    """Per camera (K, distortion, R, t)."""
    rig = {}
    for name, c in json.loads(path.read_text())["data"]["cameras"].items():
        (fx, fy), (cx, cy), d, pose = c["focal_px"], c["center_px"], c["distortion"], c["cam_from_world"]
        matrix = np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1.0]])
        rig[name] = (matrix, np.array([d[k] for k in ("k1", "k2", "p1", "p2", "k3")]), np.array(pose["rotation"]), np.array(pose["translation_mm"]))
    return rig


def project(camera, points):
    matrix, distortion, rotation, shift = camera
    return cv2.projectPoints(points, cv2.Rodrigues(rotation)[0], shift, matrix, distortion)[0].reshape(-1, 2)


def rms(errors):
    return float(np.sqrt((np.asarray(errors) ** 2).sum(axis=1).mean()))


# ---------------------------------------------------------------- real stereo pairs

PAIRS = [1, 2, 3, 4, 5, 6, 7, 8, 9, 11, 12, 13, 14]
GRID = (9, 6)


def heldout(rig, views, board):
    """Reprojection errors, px, with nothing but the board's pose fitted, one pose per instant for all cameras."""
    errors = []
    for seen in views.values():
        first = next(iter(seen))
        matrix, distortion, rotation, shift = rig[first]
        _, turn, move = cv2.solvePnP(board, np.array(list(seen[first].values())), matrix, distortion)
        world = np.concatenate([cv2.Rodrigues(rotation.T @ cv2.Rodrigues(turn)[0])[0].ravel(), rotation.T @ (move.ravel() - shift)])

        def residual(pose):
            points = board @ cv2.Rodrigues(pose[:3])[0].T + pose[3:]
            return np.concatenate([project(rig[c], points) - np.array(list(corners.values())) for c, corners in seen.items()]).ravel()

        errors.append(least_squares(residual, world, x_scale="jac", xtol=1e-14, ftol=1e-14).fun.reshape(-1, 2))
    return np.concatenate(errors)


def opencv_stereo(views, board, size):
    """OpenCV's calibration of both cameras: each by itself, then together, intrinsics included; five coefficients."""
    points = [board.astype(np.float32)] * len(views)
    image = {c: [np.array(list(seen[c].values()), np.float32) for seen in views.values()] for c in ("left", "right")}
    alone = {c: cv2.calibrateCamera(points, image[c], size, None, None, criteria=STOP) for c in image}
    (_, k1, d1, *_), (_, k2, d2, *_) = alone["left"], alone["right"]
    stop = (STOP[0], 500, 1e-12)
    _, k1, d1, k2, d2, rotation, shift, *_ = cv2.stereoCalibrate(
        points, image["left"], image["right"], k1, d1, k2, d2, size, flags=cv2.CALIB_USE_INTRINSIC_GUESS, criteria=stop
    )
    return {"left": (k1, d1.ravel(), np.eye(3), np.zeros(3)), "right": (k2, d2.ravel(), rotation, shift.ravel())}


def stereo(ctx):
    data, views = ctx.data("stereo_opencv_chessboard"), {}
    for number in PAIRS:
        pictures = {c: cv2.imread(str(data / f"{c}{number:02}.jpg"), cv2.IMREAD_GRAYSCALE) for c in ("left", "right")}
        views[number] = {c: chessboard(picture, GRID, 8) for c, picture in pictures.items()}
    size = pictures["left"].shape[::-1]
    square = 25.0
    board = np.array([[square * (i % GRID[0]), square * (i // GRID[0]), 0.0] for i in range(GRID[0] * GRID[1])])
    description = {"chessboard": {"columns": GRID[0], "rows": GRID[1], "square_mm": square}}
    halves = [{n: views[n] for n in PAIRS[start::2]} for start in (0, 1)]
    ours, theirs = [], []
    for train, test in (halves, halves[::-1]):
        corners = write_corners(ctx.tmp / "stereo.jsonl", description, {c: list(size) for c in ("left", "right")}, train)
        ctx.run([ctx.binary("calibrate"), "board", "--corners", corners, "--lens", "full", "--out", ctx.tmp / "stereo.json"])
        ours.append(heldout(read_rig(ctx.tmp / "stereo.json"), test, board))
        theirs.append(heldout(opencv_stereo(train, board, size), test, board))
    a, b = rms(np.concatenate(ours)), rms(np.concatenate(theirs))
    return metric("chessboard_heldout_vs_opencv", a / b, 1.001, "lower", "ratio", ours_px=a, opencv_px=b,
                  by_half=[rms(x) / rms(y) for x, y in zip(ours, theirs)])


# ---------------------------------------------------------------- a real session of four cameras

SQUARE_MM = 54.0


def session(data):
    """Instant -> camera -> corner -> pixel; the shipped cameras (mm)."""
    frames = {}
    for row in csv.DictReader(open(data / "xy.csv")):
        corners = frames.setdefault(int(row["sync_index"]), {}).setdefault(f"c{row['cam_id']}", {})
        corners[int(row["keypoint_id"])] = (float(row["img_loc_x"]), float(row["img_loc_y"]))
    shipped = tomllib.loads((data / "camera_array.toml").read_text())["cameras"]
    rig = {f"c{i}": (np.array(c["matrix"]), np.array(c["distortions"]), np.array(c["rotation"]), 1000 * np.array(c["translation"])) for i, c in shipped.items()}
    return frames, rig


def triangulated(rig, seen):
    """Corner -> (point, reprojection errors) of the corners that two cameras see: least squares of the reprojection."""
    found = {}
    for corner in sorted({i for points in seen.values() for i in points}):
        cameras = [c for c in seen if corner in seen[c]]
        if len(cameras) < 2:
            continue
        rows = []
        for c in cameras:
            matrix, distortion, rotation, shift = rig[c]
            x, y = cv2.undistortPoints(np.array([[seen[c][corner]]]), matrix, distortion).ravel()
            pose = np.hstack([rotation, shift[:, None]])
            rows += [x * pose[2] - pose[0], y * pose[2] - pose[1]]
        point = np.linalg.svd(np.array(rows))[2][-1]

        def residual(p):
            return np.concatenate([project(rig[c], p[None])[0] - seen[c][corner] for c in cameras])

        fit = least_squares(residual, point[:3] / point[3], x_scale="jac")
        found[corner] = fit.x, fit.fun.reshape(-1, 2)
    return found


def judge(rig, frames):
    """Reprojection RMS, px, of triangulated corners, and RMS error of the distances of neighbouring ones, mm."""
    errors, off = [], []
    for seen in frames.values():
        points = triangulated(rig, seen)
        errors += [e for _, e in points.values()]
        for i in points:
            for j in ([i + 1] if i % 3 < 2 else []) + [i + 3]:
                if j in points:
                    off.append(np.linalg.norm(points[i][0] - points[j][0]) - SQUARE_MM)
    return rms(np.concatenate(errors)), float(np.sqrt(np.mean(np.square(off))))


def caliscope(ctx):
    frames, shipped = session(ctx.data("multicam_caliscope_4cam"))
    board = {"charuco": {"columns": 4, "rows": 5, "square_mm": SQUARE_MM, "marker_mm": 40.5, "dictionary": "4x4_1000"}}
    numbers = sorted(frames)
    cameras = {name: [1280, 720] for name in sorted(shipped)}
    rows = {"ours": [], "from_shipped": [], "shipped": []}
    start = write_rig(ctx.tmp / "shipped.json", shipped)
    for parity in (0, 1):
        train = {n: frames[n] for n in numbers[parity::2]}
        test = {n: frames[n] for n in numbers[1 - parity :: 2]}
        corners = write_corners(ctx.tmp / "session.jsonl", board, cameras, train)
        ctx.run([ctx.binary("calibrate"), "board", "--corners", corners, "--out", ctx.tmp / "ours.json"])
        ctx.run([ctx.binary("calibrate"), "refine", "--cameras", start, "--corners", corners, "--out", ctx.tmp / "refined.json"])
        rows["ours"].append(judge(read_rig(ctx.tmp / "ours.json"), test))
        rows["from_shipped"].append(judge(read_rig(ctx.tmp / "refined.json"), test))
        rows["shipped"].append(judge(shipped, test))
    mean = {name: np.sqrt(np.mean(np.square(values), axis=0)) for name, values in rows.items()}
    for at, (name, unit) in enumerate((("caliscope_heldout_px", "px"), ("caliscope_square_mm", "mm"))):
        yield metric(name, float(mean["ours"][at]), float(mean["shipped"][at]), "lower", unit, shipped=float(mean["shipped"][at]),
                     refined_poses_only=float(mean["from_shipped"][at]))


def write_rig(path, rig):
    cameras = {}
    for name, (matrix, d, rotation, shift) in rig.items():
        u, _, v = np.linalg.svd(rotation)
        cameras[name] = {
            "image_size": [1280, 720], "focal_px": [matrix[0, 0], matrix[1, 1]], "center_px": [matrix[0, 2], matrix[1, 2]],
            "distortion": dict(zip(("k1", "k2", "p1", "p2", "k3"), d.tolist())),
            "cam_from_world": {"rotation": (u @ v).tolist(), "translation_mm": shift.tolist()}, "rms_px": None,
        }
    path.write_text(json.dumps({"schema": "cameras/1", "data": {"cameras": cameras, "take": None}}))
    return path


# ---------------------------------------------------------------- virtual takes


def found_in(folder):
    """Corners of a take's board pictures, found by OpenCV."""
    board = json.loads((folder / "calibration" / "board.json").read_text())["board"]
    size = (board["chessboard"]["columns"], board["chessboard"]["rows"])
    frames, cameras = {}, {}
    for path in sorted((folder / "calibration" / "board").glob("*/*.png")):
        picture = cv2.imread(str(path), cv2.IMREAD_GRAYSCALE)
        cameras[path.parent.name] = list(picture.shape[::-1])
        # A quick look first: a search without a board takes seconds.
        if cv2.checkChessboard(picture, size):
            corners = chessboard(picture, size, 5)
            if corners:
                frames.setdefault(int(path.stem), {})[path.parent.name] = corners
    return board, cameras, frames


def score(ctx):
    yield stereo(ctx)
    yield from caliscope(ctx)
    errors = {}
    for seed in ctx.seeds or SEEDS:
        folder = make(ctx, f"calibrate-{seed}", "--scenario", "standard", "--seed", seed, "--length", "short", "--no-normals")
        corners = write_corners(ctx.tmp / f"board-{seed}.jsonl", *found_in(folder / "take"))
        out = ctx.tmp / f"board-{seed}.json"
        ctx.run([ctx.binary("calibrate"), "board", "--corners", corners, "--out", out])
        summary = ctx.run([ctx.binary("virtual-rig"), "score", "cameras", out, "--truth", folder / "truth"])
        rows = {row["metric"].split("/")[1]: row["value"] for row in summary["results"]["metrics"]}
        errors[seed] = rows
    worst = max(rows["marker_mm"] for rows in errors.values())
    yield metric("board_marker_mm", worst, 0.05, "lower", "mm", by_seed=errors)
    yield from _calibrate_wand.score(ctx)
    yield from _calibrate_formats.score(ctx)


def bench(ctx):
    """Time of OpenCV's calibration over ours, the same corners."""
    data, views = ctx.data("stereo_opencv_chessboard"), {}
    for number in PAIRS:
        views[number] = {c: chessboard(cv2.imread(str(data / f"{c}{number:02}.jpg"), cv2.IMREAD_GRAYSCALE), GRID, 8) for c in ("left", "right")}
    board = np.array([[25.0 * (i % GRID[0]), 25.0 * (i // GRID[0]), 0.0] for i in range(GRID[0] * GRID[1])])
    description = {"chessboard": {"columns": GRID[0], "rows": GRID[1], "square_mm": 25.0}}
    corners = write_corners(ctx.tmp / "bench.jsonl", description, {c: [640, 480] for c in ("left", "right")}, views)
    ratios = []
    for _ in range(5):
        started = time.perf_counter()
        opencv_stereo(views, board, (640, 480))
        theirs = time.perf_counter() - started
        run = ctx.run([ctx.binary("calibrate"), "board", "--corners", corners, "--lens", "full", "--out", ctx.tmp / "bench.json"])
        ratios.append(run["seconds"]["calibrate"] / theirs)
    yield metric("board_vs_opencv_time", float(np.median(ratios)), 1.0, "lower", "ratio", low=min(ratios), high=max(ratios),
                 inside="13 stereo pairs: each camera by itself, then both; corners found before")

"""Reads markers in 3D (trajectories-3d/1 in world space, head-trajectories/1 in head space), mm."""
import json
import sys

import numpy as np


def read(path):
    """(header, frames: #F, points: #F x #M x 3 in mm, NaN where missing, status: #F x #M strings)."""
    with open(path, encoding="utf-8") as file:
        first = json.loads(file.readline())
        if first["schema"] not in ("trajectories-3d/1", "head-trajectories/1"):
            raise ValueError(f"{path}: holds {first['schema']}")
        lines = [json.loads(line) for line in file if line.strip()]
    header = first["data"]
    markers = header["markers"]
    missing = [np.nan] * 3
    frames = np.array([line["frame"] for line in lines], dtype=np.int64)
    points = np.array([[line["points"].get(m) or missing for m in markers] for line in lines], dtype=float)
    status = np.array([[line.get("status", {}).get(m, "measured") for m in markers] for line in lines])
    return header, frames, points.reshape(len(lines), len(markers), 3), status


def read_accuracy(path):
    """(covariances: #F x #M x 3 x 3 in mm², NaN where nothing is said, views: #F lists of {marker: [camera, …]})."""
    with open(path, encoding="utf-8") as file:
        markers = json.loads(file.readline())["data"]["markers"]
        lines = [json.loads(line) for line in file if line.strip()]
    upper = [[line.get("covariance_mm2", {}).get(m, [np.nan] * 6) for m in markers] for line in lines]
    upper = np.array(upper, dtype=float).reshape(len(lines), len(markers), 6)
    return upper[..., [[0, 1, 2], [1, 3, 4], [2, 4, 5]]], [line.get("views", {}) for line in lines]


if __name__ == "__main__":
    header, frames, points, status = read(sys.argv[1])
    seen = np.isfinite(points[..., 0]).mean() if points.size else 0.0
    print(f"{len(frames)} frames ({frames.min()}-{frames.max()}) of {len(header['markers'])} markers, "
          f"{seen:.1%} there, {np.mean(status != 'measured'):.1%} not simply measured")

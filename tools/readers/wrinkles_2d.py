"""Reads valley curves in the images (wrinkles-2d/1), px; pixel (0, 0) is the centre of the top-left pixel."""
import json
import sys

import numpy as np

# Weights of four control points, times 6: rows 1, v, v^2, v^3 of the uniform cubic B-spline.
BASIS = np.array([[1, 4, 1, 0], [-3, 0, 3, 0], [3, -6, 3, 0], [-1, 3, -3, 1]]) / 6


def read(path):
    """(header, frames: frame number -> camera id -> wrinkle id -> curve)."""
    with open(path, encoding="utf-8") as file:
        first = json.loads(file.readline())
        if first["schema"] != "wrinkles-2d/1":
            raise ValueError(f"{path}: holds {first['schema']}, not wrinkles-2d/1")
        lines = [json.loads(line) for line in file if line.strip()]
    for curve in (curve for line in lines for curves in line["curves"].values() for curve in curves.values()):
        curve["controls"] = np.array(curve["controls"], dtype=float)
        curve.setdefault("state", "seen")
        curve.setdefault("confidence", 1.0)
        curve.setdefault("paint", [])
    return first["data"], {line["frame"]: line["curves"] for line in lines}


def evaluate(curve, u):
    """(points, unit tangents, unit normals to the right side: #U x 2 each) at parameters u from 0 to #controls - 3."""
    controls, u = curve["controls"], np.asarray(u, dtype=float)
    span = np.clip(u.astype(int), 0, len(controls) - 4)
    v, one = u - span, np.ones_like(u)
    corners = controls[span[:, None] + np.arange(4)]
    powers = np.stack([one, v, v**2, v**3], axis=1)
    slopes = np.stack([0 * v, one, 2 * v, 3 * v**2], axis=1)
    points, tangents = (np.einsum("ui,ij,ujk->uk", p, BASIS, corners) for p in (powers, slopes))
    tangents /= np.linalg.norm(tangents, axis=1, keepdims=True)
    return points, tangents, np.stack([-tangents[:, 1], tangents[:, 0]], axis=1)


if __name__ == "__main__":
    header, frames = read(sys.argv[1])
    print(f"{len(frames)} frames ({min(frames)}-{max(frames)}), {len(header['wrinkles'])} wrinkles")
    for camera in header["cameras"]:
        print(f"{camera}: {sum(len(cameras.get(camera, {})) for cameras in frames.values())} curves")

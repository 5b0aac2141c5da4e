"""Reads valley curves of wrinkles on the mesh (valleys/1), mm in face space."""
import json
import sys

import numpy as np


def read(path):
    """(header, frames: frame number -> wrinkle id -> arrays by field, one row per point of the valley)."""
    with open(path, encoding="utf-8") as file:
        first = json.loads(file.readline())
        if first["schema"] != "valleys/1":
            raise ValueError(f"{path}: holds {first['schema']}, not valleys/1")
        lines = [json.loads(line) for line in file if line.strip()]

    def columns(points):
        return {field: np.array([point[field] for point in points]) for field in (points[0] if points else ())}

    return first["data"], {line["frame"]: {wrinkle: columns(points) for wrinkle, points in line["valleys"].items()}
                           for line in lines}


if __name__ == "__main__":
    header, frames = read(sys.argv[1])
    for name in (wrinkle["id"] for wrinkle in header["wrinkles"]):
        depths = [valleys[name]["d_mm"].max() for valleys in frames.values() if valleys.get(name)]
        print(f"{name}: in {len(depths)} of {len(frames)} frames, deepest {max(depths, default=0.0):.3g} mm")

"""Reads displacements of handle vertices over frames (handles/1), mm in face space."""
import json
import sys

import numpy as np


def read(path):
    """(header, frames: #F, displacements: #F x #H x 3 in mm, NaN where missing, weights: #F x #H, inf = met exactly)."""
    with open(path, encoding="utf-8") as file:
        first = json.loads(file.readline())
        if first["schema"] != "handles/1":
            raise ValueError(f"{path}: holds {first['schema']}, not handles/1")
        lines = [json.loads(line) for line in file if line.strip()]
    header = first["data"]
    markers = [handle["marker"] for handle in header["handles"]]
    missing = [np.nan] * 3
    frames = np.array([line["frame"] for line in lines], dtype=np.int64)
    moves = np.array([[line["displacements_mm"].get(m) or missing for m in markers] for line in lines], dtype=float)
    weights = np.array([[line.get("weights", {}).get(m, np.inf) for m in markers] for line in lines], dtype=float)
    return header, frames, moves.reshape(len(lines), len(markers), 3), weights


if __name__ == "__main__":
    header, frames, moves, weights = read(sys.argv[1])
    print(f"{len(frames)} frames of {len(header['handles'])} handles on {header['mesh']['file']['name']}, "
          f"largest displacement {np.nanmax(np.linalg.norm(moves, axis=2)):.4g} mm")

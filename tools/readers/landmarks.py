"""Reads the landmarks of a picture (landmarks/1)."""
import json
import sys

import numpy as np


def read(path):
    """(data, ids, points: n x 2 in px, depths: n in px, nan where not known)."""
    with open(path, encoding="utf-8") as file:
        artifact = json.load(file)
    if artifact["schema"] != "landmarks/1":
        raise ValueError(f"{path}: holds {artifact['schema']}, not landmarks/1")
    data = artifact["data"]
    ids = sorted(data["points"])
    points = np.array([data["points"][id_]["at"] for id_ in ids], dtype=float).reshape(-1, 2)
    depths = [data["points"][id_]["depth_px"] for id_ in ids]
    return data, ids, points, np.array([np.nan if depth is None else depth for depth in depths])


if __name__ == "__main__":
    data, ids, points, depths = read(sys.argv[1])
    print(f"{len(ids)} landmarks, {np.isfinite(depths).sum()} with a depth")

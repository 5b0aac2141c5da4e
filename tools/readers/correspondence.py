"""Reads which vertex of the scan each marker sits on (correspondence/1)."""
import json
import sys

import numpy as np


def read(path):
    """(mesh reference, marker ids, vertices: #M, positions: #M x 3 in mm)."""
    with open(path, encoding="utf-8") as file:
        artifact = json.load(file)
    if artifact["schema"] != "correspondence/1":
        raise ValueError(f"{path}: holds {artifact['schema']}, not correspondence/1")
    pairs = artifact["data"]["pairs"]
    vertices = np.array([pair["vertex"] for pair in pairs], dtype=np.uint32)
    positions = np.array([pair["position_mm"] for pair in pairs], dtype=float).reshape(-1, 3)
    return artifact["data"]["mesh"], [pair["marker"] for pair in pairs], vertices, positions


if __name__ == "__main__":
    mesh, markers, vertices, positions = read(sys.argv[1])
    print(f"{len(markers)} markers on {mesh['file']['name']} ({mesh['vertex_count']} vertices)")

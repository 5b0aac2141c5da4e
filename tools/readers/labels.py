"""Reads hand-labelled markers of one frame (labels/1), px; pixel (0, 0) is the centre of the top-left pixel."""
import json
import sys

import numpy as np


def read(path):
    """(frame, camera id -> (marker ids, points: #M x 2, px))."""
    with open(path, encoding="utf-8") as file:
        artifact = json.load(file)
    if artifact["schema"] != "labels/1":
        raise ValueError(f"{path}: holds {artifact['schema']}, not labels/1")
    labels = artifact["data"]
    points = {camera: (list(markers), np.array(list(markers.values()), dtype=float).reshape(-1, 2))
              for camera, markers in labels["cameras"].items()}
    return labels["frame"], points


if __name__ == "__main__":
    frame, cameras = read(sys.argv[1])
    counts = ", ".join(f"{camera}: {len(markers)}" for camera, (markers, _) in cameras.items())
    print(f"frame {frame}; labelled markers: {counts}")

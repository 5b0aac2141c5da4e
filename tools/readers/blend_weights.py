"""Reads how much of each reference pose's wrinkles shows (blend-weights/1), frame by frame."""
import json
import sys

import numpy as np


def read(path):
    """(header, frame numbers, shares of bones: #F x #K x #B, NaN where a bone is not of a pose, weights of vertices:
    #F x #K x #V, NaN where they were not written)."""
    with open(path, encoding="utf-8") as file:
        first = json.loads(file.readline())
        if first["schema"] != "blend-weights/1":
            raise ValueError(f"{path}: holds {first['schema']}, not blend-weights/1")
        lines = [json.loads(line) for line in file if line.strip()]
    header = first["data"]
    shares = np.full((len(lines), len(header["poses"]), len(header["bones"])), np.nan)
    weights = np.full((len(lines), len(header["poses"]), header["vertex_count"]), np.nan)
    for number, line in enumerate(lines):
        for k, pose in enumerate(header["poses"]):
            for bone, share in line["bones"].get(pose, {}).items():
                shares[number, k, header["bones"].index(bone)] = share
            if "vertices" in line:
                weights[number, k] = line["vertices"].get(pose, 0.0)
    return header, np.array([line["frame"] for line in lines]), shares, weights


if __name__ == "__main__":
    header, frames, shares, weights = read(sys.argv[1])
    print(f"{len(frames)} frames, {len(header['poses'])} poses, {len(header['bones'])} bones, {header['vertex_count']} vertices")

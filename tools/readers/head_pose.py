"""Reads where the head is in the world, frame by frame (head-pose/1)."""
import json
import sys

import numpy as np


def matrix(pose):
    """4 x 4 world_from_head of a line of the file; NaN where the pose is missing."""
    if pose is None:
        return np.full((4, 4), np.nan)
    w, x, y, z = pose["rotation_wxyz"]
    rotation = [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]
    out = np.eye(4)
    out[:3, :3], out[:3, 3] = rotation, pose["translation_mm"]
    return out


def read(path):
    """(header, frames: #F, world_from_head: #F x 4 x 4, mm, residual_mm: #F, NaN where missing)."""
    with open(path, encoding="utf-8") as file:
        first = json.loads(file.readline())
        if first["schema"] != "head-pose/1":
            raise ValueError(f"{path}: holds {first['schema']}, not head-pose/1")
        lines = [json.loads(line) for line in file if line.strip()]
    frames = np.array([line["frame"] for line in lines], dtype=np.int64)
    poses = np.array([matrix(line["world_from_head"]) for line in lines]).reshape(-1, 4, 4)
    residuals = np.array([line["residual_mm"] for line in lines], dtype=float)
    return first["data"], frames, poses, residuals


if __name__ == "__main__":
    header, frames, poses, residuals = read(sys.argv[1])
    print(f"{len(frames)} frames, {np.isfinite(poses[:, 0, 0]).sum()} with a pose, reference frame "
          f"{header['reference_frame']}, largest residual {np.nanmax(residuals):.4g} mm")

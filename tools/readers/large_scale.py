"""Reads an animated mesh (large-scale/1, wrinkled/1): the index and the PC2 vertex cache beside it."""
import json
import pathlib
import sys

import numpy as np

MM = {"mm": 1.0, "cm": 10.0, "m": 1000.0}


def read(path):
    """(index, frames: #F, positions: #F x #V x 3 in mm, mapped from the file as they are used where it is in mm)."""
    path = pathlib.Path(path)
    artifact = json.loads(path.read_text(encoding="utf-8"))
    if artifact["schema"] not in ("large-scale/1", "wrinkled/1"):
        raise ValueError(f"{path}: holds {artifact['schema']}, not large-scale/1 or wrinkled/1")
    index = artifact["data"]
    shape = (len(index["frames"]), index["mesh"]["vertex_count"], 3)
    cache = path.with_name(index["cache"])
    counts = np.fromfile(cache, dtype="<u4", count=8)
    if counts[4] != shape[1] or counts[7] != shape[0] or cache.stat().st_size != 32 + 4 * np.prod(shape):
        raise ValueError(f"{cache}: does not hold {shape[0]} samples of {shape[1]} vertices")
    positions = np.memmap(cache, dtype="<f4", mode="r", offset=32, shape=shape)
    scale = MM[index["mesh"]["unit"]]
    return index, np.array(index["frames"], dtype=np.int64), positions if scale == 1.0 else positions * scale


if __name__ == "__main__":
    index, frames, positions = read(sys.argv[1])
    print(f"{len(frames)} frames ({frames.min()}-{frames.max()}) of {positions.shape[1]} vertices, "
          f"rest mesh {index['mesh']['file']['name']} in {index['mesh']['unit']}")

"""Reads an index of baked maps (baked-maps/1); its pictures are read with any library for PNG and OpenEXR."""
import json
import pathlib
import sys

import numpy as np


def read(path):
    """(index, pictures: per tile number a dict with the paths `normal`, `displacement_exr`, `displacement`)."""
    path = pathlib.Path(path)
    artifact = json.loads(path.read_text(encoding="utf-8"))
    if artifact["schema"] != "baked-maps/1":
        raise ValueError(f"{path}: holds {artifact['schema']}, not baked-maps/1")
    index = artifact["data"]
    names = ("normal", "displacement_exr", "displacement")
    return index, {tile["tile"]: {name: path.with_name(tile[name]) for name in names} for tile in index["tiles"]}


def normals(index, codes):
    """Unit normals, … x 3, y along growing v, from a normal map's code values, … x 3 (red, green, blue) of 8 or 16 bits."""
    codes = np.asarray(codes)
    found = 2.0 * codes / np.iinfo(codes.dtype).max - 1.0
    if index["green"] == "directx":
        found[..., 1] *= -1.0
    return found / np.linalg.norm(found, axis=-1, keepdims=True)


def displacement_mm(index, codes):
    """Displacement along the mesh's normal, mm, from code values of 16 bits."""
    return index["black_mm"] + np.asarray(codes) / 65535.0 * (index["white_mm"] - index["black_mm"])


if __name__ == "__main__":
    index, pictures = read(sys.argv[1])
    print(f"{len(pictures)} tiles of {index['size']}², frame {index['frame']}, of {index['mesh']['file']['name']}")

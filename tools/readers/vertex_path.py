"""Reads a line of vertices on a mesh (vertex-path/1)."""
import json
import sys

import numpy as np


def read(path):
    """(mesh reference, name, vertices: 0-based, in the order of the line)."""
    with open(path, encoding="utf-8") as file:
        artifact = json.load(file)
    if artifact["schema"] != "vertex-path/1":
        raise ValueError(f"{path}: holds {artifact['schema']}, not vertex-path/1")
    data = artifact["data"]
    return data["mesh"], data["name"], np.array(data["vertices"], dtype=np.uint32)


if __name__ == "__main__":
    mesh, name, vertices = read(sys.argv[1])
    print(f"{name}: {len(vertices)} vertices in a line on {mesh['file']['name']}")

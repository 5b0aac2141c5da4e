"""Reads a Wavefront OBJ mesh, in the file's own unit; vertex order and polygons are kept."""
import sys

import numpy as np


def read(path):
    """(positions: #V x 3, uvs: #T x 2, faces: list of vertex index lists, face_uvs: the same into uvs, -1 = none)."""
    positions, uvs, faces, face_uvs = [], [], [], []

    def index(text, count):
        return (int(text) - 1 if int(text) > 0 else count + int(text)) if text else -1

    with open(path, encoding="utf-8-sig") as file:
        for line in file:
            keyword, *words = line.split() or [""]
            if keyword == "v":
                positions.append([float(word) for word in words[:3]])
            elif keyword == "vt":
                uvs.append([float(word) for word in (words + ["0"])[:2]])
            elif keyword == "f":
                corners = [(word + "//").split("/") for word in words]
                faces.append([index(corner[0], len(positions)) for corner in corners])
                face_uvs.append([index(corner[1], len(uvs)) for corner in corners])
    return np.array(positions, float).reshape(-1, 3), np.array(uvs, float).reshape(-1, 2), faces, face_uvs


if __name__ == "__main__":
    positions, uvs, faces, _ = read(sys.argv[1])
    print(f"{len(positions)} vertices, {len(faces)} faces, {len(uvs)} texture coordinates, "
          f"from {positions.min(0)} to {positions.max(0)}")

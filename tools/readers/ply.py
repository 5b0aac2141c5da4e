"""Reads a binary little-endian PLY mesh as Furrow writes it, in the file's own unit."""
import sys

import numpy as np

TYPES = {"char": "i1", "uchar": "u1", "short": "<i2", "ushort": "<u2", "int": "<i4", "uint": "<u4",
         "float": "<f4", "double": "<f8"}


def read(path):
    """(vertices: #V record array with x, y, z and more, faces: list of {property: array}, one per face)."""
    with open(path, "rb") as file:
        data = file.read()
    head, mark, body = data.partition(b"end_header\n")
    lines = [line.split() for line in head.decode("ascii").splitlines()]
    if not mark or ["format", "binary_little_endian", "1.0"] not in lines:
        raise ValueError(f"{path}: is not a binary little-endian PLY")
    elements = []
    for line in lines:
        if line[0] == "element":
            elements.append((line[1], int(line[2]), []))
        elif line[0] == "property":
            elements[-1][2].append((line[-1], *(TYPES[kind] for kind in line[1:-1] if kind != "list")))
    (_, vertex_count, properties), (_, face_count, lists) = elements
    vertices = np.frombuffer(body, np.dtype(properties), vertex_count)
    at, faces = vertices.nbytes, []
    for _ in range(face_count):
        face = {}
        for name, count_type, kind in lists:
            count = int(np.frombuffer(body, count_type, 1, at)[0])
            at += np.dtype(count_type).itemsize
            face[name] = np.frombuffer(body, kind, count, at)
            at += face[name].nbytes
        faces.append(face)
    return vertices, faces


if __name__ == "__main__":
    vertices, faces = read(sys.argv[1])
    print(f"{len(vertices)} vertices with {', '.join(vertices.dtype.names)}; {len(faces)} faces")

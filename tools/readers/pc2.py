"""Reads a PC2 vertex cache, in the unit of the rest mesh beside it."""
import sys

import numpy as np


def read(path):
    """(start frame, positions: #samples x #V x 3, mapped from the file)."""
    with open(path, "rb") as file:
        header = file.read(32)
    if header[:12] != b"POINTCACHE2\0":
        raise ValueError(f"{path}: is not a PC2 vertex cache")
    _, vertices = np.frombuffer(header, "<i4", 2, 12)
    start, _ = np.frombuffer(header, "<f4", 2, 20)
    samples = np.frombuffer(header, "<u4", 1, 28)[0]
    return int(start), np.memmap(path, "<f4", "r", 32, (int(samples), int(vertices), 3))


if __name__ == "__main__":
    start, positions = read(sys.argv[1])
    print(f"{positions.shape[0]} samples of {positions.shape[1]} vertices, the first for frame {start}")

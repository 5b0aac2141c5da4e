"""Reads the markers of a C3D file (Intel byte order, real or integer), in the file's own unit."""
import sys

import numpy as np


def parameters(data, block):
    """{(group, name): bytes or array} of the parameter section that starts at a 512-byte block."""
    at, end, names, out = 512 * (block - 1) + 4, 512 * (block - 1 + data[512 * (block - 1) + 2]), {}, {}
    signed = memoryview(data).cast("b")
    while at < end and data[at]:
        length, group = abs(signed[at]), signed[at + 1]
        name, at = data[at + 2: at + 2 + length].decode("latin-1").upper(), at + 2 + length
        step = int(np.frombuffer(data, "<u2", 1, at)[0])
        if group < 0:
            names[-group] = name
        else:
            kind, count = signed[at + 2], data[at + 3]
            shape = tuple(data[at + 4: at + 4 + count])
            dtype = {-1: "S1", 1: "u1", 2: "<i2", 4: "<f4"}[kind]
            size = int(np.prod(shape, dtype=int))
            out[group, name] = np.frombuffer(data, dtype, size, at + 4 + count).reshape(shape[::-1])
        if step == 0:
            break
        at += step
    return {(names.get(group, ""), name): value for (group, name), value in out.items()}


def read(path):
    """(labels, unit, rate in Hz, frames: #F, points: #F x #M x 3, NaN where missing)."""
    with open(path, "rb") as file:
        data = file.read()
    if data[1] != 0x50 or data[512 * (data[0] - 1) + 3] != 84:
        raise ValueError(f"{path}: is not a C3D file in Intel byte order")
    values, words = parameters(data, data[0]), np.frombuffer(data, "<u2", 10)
    scale, rate = np.frombuffer(data, "<f4", 1, 12)[0], np.frombuffer(data, "<f4", 1, 20)[0]
    markers, analog, first, last, start = (int(word) for word in words[[1, 2, 3, 4, 8]])
    width, dtype = 4 * markers + analog, "<f4" if scale < 0 else "<i2"
    count = min(last - first + 1, (len(data) - 512 * (start - 1)) // (width * np.dtype(dtype).itemsize))
    samples = np.frombuffer(data, dtype, count * width, 512 * (start - 1)).reshape(count, width)
    points = samples[:, : 4 * markers].reshape(count, markers, 4).astype(float)
    points[points[..., 3] < 0] = np.nan
    text = [b"".join(row).decode("latin-1").strip(" \0") for row in np.atleast_2d(values["POINT", "LABELS"])]
    unit = b"".join(values.get(("POINT", "UNITS"), np.empty(0, "S1"))).decode("latin-1").strip(" \0")
    return text[:markers], unit, float(rate), first + np.arange(count), points[..., :3] * (scale if scale > 0 else 1)


if __name__ == "__main__":
    labels, unit, rate, frames, points = read(sys.argv[1])
    print(f"{len(frames)} frames ({frames[0]}-{frames[-1]}) of {len(labels)} markers in {unit} at {rate:g} Hz")

"""Reads the markers of a TRC file (tab-separated text), in the file's own unit."""
import sys

import numpy as np


def read(path):
    """(labels, unit, rate in Hz, frames: #F, points: #F x #M x 3, NaN where missing)."""
    with open(path, encoding="utf-8-sig") as file:
        lines = [line.rstrip("\r\n") for line in file]
    about = dict(zip(lines[1].split("\t"), lines[2].split("\t")))
    labels = [name.strip() for name in lines[3].split("\t")[2:] if name.strip()]
    rows = [[float(cell) if cell.strip() else np.nan for cell in line.split("\t")] for line in lines[5:] if line.strip()]
    width = 2 + 3 * len(labels)
    table = np.array([(row + [np.nan] * width)[:width] for row in rows]).reshape(-1, width)
    points = table[:, 2:].reshape(-1, len(labels), 3)
    return labels, about["Units"], float(about["DataRate"]), table[:, 0].astype(np.int64), points


if __name__ == "__main__":
    labels, unit, rate, frames, points = read(sys.argv[1])
    print(f"{len(frames)} frames ({frames[0]}-{frames[-1]}) of {len(labels)} markers in {unit} at {rate:g} Hz")

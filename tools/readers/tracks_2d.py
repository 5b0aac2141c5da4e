"""Reads markers in the images of every camera (tracks-2d/1), px; pixel (0, 0) is the centre of the top-left pixel."""
import json
import sys

import numpy as np


def read(path):
    """(header, frames: #F, images: #F x #C booleans, points: #F x #C x #M x 2 in px, NaN where lost,
    confidence: #F x #C x #M, 0 where lost, states: #F x #C x #M strings)."""
    with open(path, encoding="utf-8") as file:
        first = json.loads(file.readline())
        if first["schema"] != "tracks-2d/1":
            raise ValueError(f"{path}: holds {first['schema']}, not tracks-2d/1")
        lines = [json.loads(line) for line in file if line.strip()]
    header = first["data"]
    cameras, markers = header["cameras"], header["markers"]

    def table(field, nothing, line):
        said = line.get(field, {})
        return [[said.get(camera, {}).get(marker, nothing) for marker in markers] for camera in cameras]

    shape = (len(lines), len(cameras), len(markers))
    frames = np.array([line["frame"] for line in lines], dtype=np.int64)
    images = np.array([[camera in line["points"] for camera in cameras] for line in lines], dtype=bool)
    points = np.array([table("points", [np.nan] * 2, line) for line in lines], dtype=float).reshape(*shape, 2)
    lost = np.isnan(points[..., 0])
    confidence = np.array([table("confidence", 1.0, line) for line in lines], dtype=float).reshape(shape)
    states = np.array([table("state", "seen", line) for line in lines], dtype=object).reshape(shape)
    return header, frames, images, points, np.where(lost, 0.0, confidence), np.where(lost, "lost", states)


if __name__ == "__main__":
    header, frames, images, points, confidence, states = read(sys.argv[1])
    print(f"{len(frames)} frames ({frames.min()}-{frames.max()}), {len(header['markers'])} markers")
    for i, camera in enumerate(header["cameras"]):
        there = states[images[:, i], i]
        print(f"{camera}: {images[:, i].sum()} images, {np.mean(there == 'seen'):.1%} seen, "
              f"{np.mean(there == 'lost'):.1%} lost")

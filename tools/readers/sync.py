"""Reads one time base for all cameras (sync/1): which image of which camera shows each mocap frame."""
import json
import sys

import numpy as np

NOT_DUE, MISSING = -2**63, -2**63 + 1


def read(path):
    """(header, frames: #F, index: camera id -> #F image numbers, NOT_DUE or MISSING where there is none,
    doubled: camera id -> #F booleans)."""
    with open(path, encoding="utf-8") as file:
        first = json.loads(file.readline())
        if first["schema"] != "sync/1":
            raise ValueError(f"{path}: holds {first['schema']}, not sync/1")
        lines = [json.loads(line) for line in file if line.strip()]
    frames = np.array([line["frame"] for line in lines], dtype=np.int64)
    index, doubled = {}, {}
    for camera in first["data"]["cameras"]:
        shown = [line["shows"].get(camera, False) for line in lines]
        numbers = [NOT_DUE if image is False else MISSING if image is None else image["index"] for image in shown]
        index[camera] = np.array(numbers, dtype=np.int64)
        doubled[camera] = np.array([bool(image) and image.get("doubled", False) for image in shown])
    return first["data"], frames, index, doubled


def mocap_time(camera, frames):
    """When the images that show these mocap frames were taken, in mocap frames; `camera` is one of the header's."""
    frames = np.asarray(frames, dtype=float)
    return frames + camera["offset_frames"] + camera["drift_ppm"] * 1e-6 * (frames - camera["phase"])


if __name__ == "__main__":
    header, frames, index, doubled = read(sys.argv[1])
    print(f"{len(frames)} mocap frames ({frames.min()}-{frames.max()})")
    for name, numbers in index.items():
        print(f"{name}: {np.sum(numbers > MISSING)} images, {np.sum(numbers == MISSING)} missing, "
              f"{doubled[name].sum()} doubled, {header['cameras'][name]['offset_frames']:+.4g} frames")

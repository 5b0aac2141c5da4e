"""Reads cross-sections of wrinkles measured in the images (sections/1). Lengths are px in the image."""
import json
import sys

import numpy as np

FIELDS = ("u", "at", "normal", "w_px", "d_px", "epsilon", "kappa", "tilt_rad", "residual")


def read(path):
    """(header, frames: frame number -> camera id -> wrinkle id -> arrays by field, NaN where nothing is said)."""
    with open(path, encoding="utf-8") as file:
        first = json.loads(file.readline())
        if first["schema"] != "sections/1":
            raise ValueError(f"{path}: holds {first['schema']}, not sections/1")
        lines = [json.loads(line) for line in file if line.strip()]

    def columns(sections):
        table = {field: np.array([section.get(field, np.nan) for section in sections]) for field in FIELDS}
        deviations = [section.get("deviation", {"w_px": np.nan, "d_px": np.nan}) for section in sections]
        return {**table, "deviation": np.array([[d["w_px"], d["d_px"]] for d in deviations]).reshape(-1, 2),
                "state": np.array([section["state"] for section in sections], dtype=str)}

    frames = {line["frame"]: {camera: {wrinkle: columns(sections) for wrinkle, sections in wrinkles.items()}
                              for camera, wrinkles in line["sections"].items()} for line in lines}
    return first["data"], frames


def height(p, w, d, epsilon=0.0, kappa=0.0):
    """The profile at distances p from the crease (positive on the right side): -d at 0, 0 at about w."""
    p, ws = np.asarray(p, dtype=float), w / np.sqrt(1 - epsilon**2)
    bent = np.hypot(p / (ws * np.where(p < 0, 1 - kappa, 1 + kappa)), epsilon)
    return d * np.exp(epsilon) / (1 - epsilon) * (bent - 1) * np.exp(-bent)


if __name__ == "__main__":
    header, frames = read(sys.argv[1])
    columns = [table for cameras in frames.values() for wrinkles in cameras.values() for table in wrinkles.values()]
    states, depths = (np.concatenate([table[field] for table in columns]) for field in ("state", "d_px"))
    print(f"{len(frames)} frames, {len(states)} sections of profile {header['profile']}, "
          f"{np.sum(states == 'flat')} flat, {np.sum(states == 'failed')} failed, deepest {depths.max():.3g} px")

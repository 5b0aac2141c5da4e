"""Reads reference poses (poses/1): where bones stand in their parents, in units of the character's file."""
import json
import sys

import numpy as np


def read(path):
    """(pose id -> bone name -> dictionary of translation, rotation_wxyz and scale, NaN where the bone rests, pose id -> name of its
    map or None, modulation curve: #P x 2, or None for the cosine)."""
    with open(path, encoding="utf-8") as file:
        artifact = json.load(file)
    if artifact["schema"] != "poses/1":
        raise ValueError(f"{path}: holds {artifact['schema']}, not poses/1")
    sizes = {"translation": 3, "rotation_wxyz": 4, "scale": 3}
    poses = {pose["id"]: {name: {key: np.array(bone.get(key, [np.nan] * size), dtype=float) for key, size in sizes.items()}
                          for name, bone in pose["bones"].items()} for pose in artifact["data"]["poses"]}
    maps = {pose["id"]: pose.get("map", {}).get("name") for pose in artifact["data"]["poses"]}
    curve = artifact["data"].get("modulation")
    return poses, maps, None if curve is None else np.array(curve, dtype=float)


if __name__ == "__main__":
    poses, maps, _ = read(sys.argv[1])
    print("\n".join(f"{pose}: {len(bones)} bones, map {maps[pose]}" for pose, bones in poses.items()))

"""Reads a take manifest (take/1, take/2): who, when, rate, cameras, footage, units, consent."""
import json
import sys


def read(path):
    """The manifest as a dict, with the rate also as a float in `hz`; a camera's `footage` is None where it is not said."""
    with open(path, encoding="utf-8") as file:
        artifact = json.load(file)
    if artifact["schema"] not in ("take/1", "take/2"):
        raise ValueError(f"{path}: holds {artifact['schema']}, not take/1 or take/2")
    take = artifact["data"]
    for camera in take.setdefault("cameras", []):
        camera.setdefault("footage", None)
    take["hz"] = take["rate"]["frames"] / take["rate"]["seconds"]
    return take


if __name__ == "__main__":
    take = read(sys.argv[1])
    print(f"take {take['take']} of {take['subject']}: {take['hz']:.6g} Hz from frame {take['first_frame']}, "
          f"{len(take['cameras'])} cameras, scan in {take['mesh_unit']}, {take['mesh_up']} up")

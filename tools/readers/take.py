"""Reads a take manifest (take/1): who, when, rate, cameras, units, consent."""
import json
import sys


def read(path):
    """The manifest as a dict, with the rate also as a float in `hz`."""
    with open(path, encoding="utf-8") as file:
        artifact = json.load(file)
    if artifact["schema"] != "take/1":
        raise ValueError(f"{path}: holds {artifact['schema']}, not take/1")
    take = artifact["data"]
    take["hz"] = take["rate"]["frames"] / take["rate"]["seconds"]
    return take


if __name__ == "__main__":
    take = read(sys.argv[1])
    print(f"take {take['take']} of {take['subject']}: {take['hz']:.6g} Hz from frame {take['first_frame']}, "
          f"{len(take['cameras'])} cameras, scan in {take['mesh_unit']}, {take['mesh_up']} up")

"""Reads what a virtual take was made from (scenario/1): length, clocks, face, light, and what goes wrong on purpose."""
import json
import sys

import numpy as np


def read(path):
    """The scenario as a dictionary; `hz` is the rate of the mocap clock, `frames` are its numbers, `wrinkle_frames` those
    that wrinkle cameras film too."""
    with open(path, encoding="utf-8") as file:
        document = json.load(file)
    if document["schema"] != "scenario/1":
        raise ValueError(f"{path}: holds {document['schema']}, not scenario/1")
    scenario = document["data"]
    extent = scenario["extent"]
    frames = extent["first_frame"] + np.arange(extent["frames"])
    return {**scenario, "hz": extent["rate"]["frames"] / extent["rate"]["seconds"], "frames": frames,
            "wrinkle_frames": frames[extent.get("wrinkle_phase", 0)::extent["wrinkle_every"]]}


def amount(scenario, kind, camera):
    """How much of a fault happens to a camera, in the fault's unit; None if it does not."""
    amounts = [fault["amount"] for fault in scenario.get("faults", [])
               if fault["kind"] == kind and fault.get("camera") in (None, camera)]
    return sum(amounts) if amounts else None


if __name__ == "__main__":
    found = read(sys.argv[1])
    print(f"{found['name']}, seed {found['seed']}: {found['vertices']} vertices, {len(found['frames'])} frames at "
          f"{found['hz']:g} Hz ({found['frames'][0]}-{found['frames'][-1]}), "
          f"{len(found['wrinkle_frames'])} of them for wrinkles")
    for fault in found.get("faults", []):
        print(f"  {fault['kind']} {fault['amount']:g}: {fault.get('camera') or 'every camera'}")

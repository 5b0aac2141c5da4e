"""Reads which vertex became which when faces were cut out of a mesh (vertex-map/1)."""
import json
import sys

import numpy as np


def read(path):
    """(old and new mesh references, new_from_old: -1 where gone, old_from_new)."""
    with open(path, encoding="utf-8") as file:
        artifact = json.load(file)
    if artifact["schema"] != "vertex-map/1":
        raise ValueError(f"{path}: holds {artifact['schema']}, not vertex-map/1")
    data = artifact["data"]
    new_from_old = np.array([-1 if new is None else new for new in data["new_from_old"]], dtype=np.int64)
    return data["old"], data["new"], new_from_old, np.array(data["old_from_new"], dtype=np.int64)


if __name__ == "__main__":
    old, new, new_from_old, old_from_new = read(sys.argv[1])
    print(f"{old['file']['name']} -> {new['file']['name']}: {len(old_from_new)} of {len(new_from_old)} vertices stay")

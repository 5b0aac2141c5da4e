"""Reads how every vertex answers to a unit displacement of each handle (response-basis/1 and its .npy)."""
import hashlib
import json
import pathlib
import sys

import numpy as np


def read(path):
    """(header, basis: #V x #H, schur: #H x #H). Displacements of all vertices are basis @ those of the handles."""
    path = pathlib.Path(path)
    artifact = json.loads(path.read_text(encoding="utf-8"))
    if artifact["schema"] != "response-basis/1":
        raise ValueError(f"{path}: holds {artifact['schema']}, not response-basis/1")
    header = artifact["data"]
    array = path.with_name(header["array"]["name"])
    if hashlib.sha256(array.read_bytes()).hexdigest() != header["array"]["sha256"]:
        raise ValueError(f"{array}: is not the array that {path.name} was written with")
    basis = np.load(array, allow_pickle=False)
    if basis.shape != (header["mesh"]["vertex_count"], len(header["handles"])):
        raise ValueError(f"{array}: has shape {basis.shape}")
    return header, basis, np.array(header["schur"], dtype=float)


if __name__ == "__main__":
    header, basis, schur = read(sys.argv[1])
    print(f"{basis.shape[0]} vertices x {basis.shape[1]} handles on {header['mesh']['file']['name']}")

"""Reads a side-car (provenance/1): what made an artifact, from what, and how well; and checks inputs against it."""
import hashlib
import json
import pathlib
import sys


def read(path):
    """The record as a dict: stage, version, parameters, inputs, results."""
    with open(path, encoding="utf-8") as file:
        artifact = json.load(file)
    if artifact["schema"] != "provenance/1":
        raise ValueError(f"{path}: holds {artifact['schema']}, not provenance/1")
    return artifact["data"]


def made_from(record, file):
    """The role under which a file was used, or None: the hash decides, not the name."""
    sha256 = hashlib.sha256(pathlib.Path(file).read_bytes()).hexdigest()
    return next((role for role, used in record["inputs"].items() if used["sha256"] == sha256), None)


if __name__ == "__main__":
    record = read(sys.argv[1])
    print(f"made by {record['stage']} {record['version']} from "
          + ", ".join(f"{role} {used['name']}" for role, used in record["inputs"].items()))

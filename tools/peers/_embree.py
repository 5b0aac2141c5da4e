"""Occlusion queries of Embree, as `embreex` from PyPI offers them: one ray a call (`rtcOccluded1`), on one thread.

`occlusion(folder)` takes what the example `rays` of `virtual-rig` writes: `vertices.npy`, `triangles.npy` (or another mesh:
`mesh`, an OBJ or NPZ), `origins.npy`, `directions.npy` (float32), and compares with `occluded.npy` where it is there.
"""

import json
import statistics
import sys
import time
from importlib.metadata import version
from pathlib import Path

import numpy as np
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene

REPEATS = 5


def read_mesh(path):
    """Vertices and triangles of an OBJ (triangles only), or of an NPZ that names them so."""
    if path.suffix == ".npz":
        with np.load(path) as arrays:
            return arrays["vertices"], arrays["triangles"]
    with open(path) as file:
        rows = [line.split() for line in file if line.startswith(("v ", "f "))]
    vertices = np.array([row[1:4] for row in rows if row[0] == "v"], float)
    triangles = np.array([[corner.split("/")[0] for corner in row[1:4]] for row in rows if row[0] == "f"], int)
    return vertices, triangles - 1


def occlusion(folder, mesh=None):
    """Rays per second (median, least and most over repeats), the time to build, and how many answers differ from ours."""
    folder = Path(folder)
    if mesh:
        vertices, triangles = read_mesh(Path(mesh))
    else:
        vertices, triangles = np.load(folder / "vertices.npy"), np.load(folder / "triangles.npy")
    origins, directions = np.load(folder / "origins.npy"), np.load(folder / "directions.npy")
    scene = EmbreeScene()
    TriangleMesh(scene, vertices.astype(np.float32), triangles.astype(np.int32))
    started = time.perf_counter()
    scene.run(origins[:1], directions[:1], query="OCCLUDED")  # builds the tree
    build = time.perf_counter() - started
    times = []
    for _ in range(REPEATS):
        started = time.perf_counter()
        answer = scene.run(origins, directions, query="OCCLUDED")
        times.append(time.perf_counter() - started)
    rates = [len(origins) / seconds for seconds in times]
    result = {
        "rays": len(origins),
        "rays_per_s": statistics.median(rates),
        "min": min(rates),
        "max": max(rates),
        "build_s": build,
        "peer": f"embreex {version('embreex')}, rtcOccluded1, 1 thread",
    }
    ours = folder / "occluded.npy"
    if ours.exists():
        blocked = np.asarray(answer) != -1
        result["blocked_rel"] = float(blocked.mean())
        result["differ_rel"] = float((blocked != np.load(ours).astype(bool)).mean())
    return result


if __name__ == "__main__":
    print(json.dumps(occlusion(*sys.argv[1:3])))

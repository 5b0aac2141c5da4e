"""Reads a warp (warp/1) and applies it: c(x) = sum w |u - center|^3 + polynomial(u), u = (x - origin) / scale."""
import json
import sys

import numpy as np


def read(path):
    """The artifact as a dict; `face_from_mocap` and `mocap_from_face` are what `apply` takes."""
    with open(path, encoding="utf-8") as file:
        artifact = json.load(file)
    if artifact["schema"] != "warp/1":
        raise ValueError(f"{path}: holds {artifact['schema']}, not warp/1")
    return artifact["data"]


def apply(interpolant, points):
    """Maps points, n x 3 in mm."""
    u = (np.asarray(points, dtype=float) - interpolant["origin_mm"]) / interpolant["scale_mm"]
    x, y, z = u.T
    terms = np.stack([np.ones_like(x), x, y, z, x * x, y * y, z * z, x * y, x * z, y * z], axis=1)
    polynomial = np.array(interpolant["polynomial"])
    centers, weights = (np.array(interpolant[key]).reshape(-1, 3) for key in ("centers", "weights"))
    kernel = np.linalg.norm(u[:, None] - centers[None], axis=2) ** 3
    return kernel @ weights + terms[:, : len(polynomial)] @ polynomial


if __name__ == "__main__":
    warp = read(sys.argv[1])
    fit = warp["fit"]
    print(f"{len(warp['markers'])} markers, rest frame {warp['rest_frame']}, polynomial of rank "
          f"{fit['polynomial_rank']}, worst left-out marker {max(fit['leave_one_out_mm'].values()):.4g} mm")

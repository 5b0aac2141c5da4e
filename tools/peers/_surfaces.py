"""Files of meshes and vertex sets for the stages that edit meshes."""

import hashlib
import json

import numpy as np


def write_obj(path, points, triangles):
    with open(path, "w") as out:
        out.writelines(f"v {x!r} {y!r} {z!r}\n" for x, y, z in points.tolist())
        out.writelines(f"f {a} {b} {c}\n" for a, b, c in (triangles + 1).tolist())


def read_points(path):
    with open(path) as lines:
        return np.array([line.split()[1:4] for line in lines if line.startswith("v ")], float)


def write_set(path, mesh, vertex_count, vertices):
    """A vertex-set/1 of a mesh in mm."""
    file = {"name": mesh.name, "sha256": hashlib.sha256(mesh.read_bytes()).hexdigest()}
    reference = {"file": file, "unit": "mm", "vertex_count": vertex_count}
    data = {"mesh": reference, "name": "region", "vertices": [int(v) for v in np.sort(vertices)]}
    path.write_text(json.dumps({"schema": "vertex-set/1", "data": data}))


def normals(points, triangles):
    """Unit normals of the vertices, triangles weighted by area."""
    a, b, c = (points[triangles[:, i]] for i in range(3))
    faces = np.cross(b - a, c - a)
    sums = np.zeros_like(points)
    for i in range(3):
        np.add.at(sums, triangles[:, i], faces)
    return sums / np.maximum(np.linalg.norm(sums, axis=1), 1e-300)[:, None]


def angle_weighted_normals(points, triangles):
    corners = [points[triangles[:, i]] for i in range(3)]
    faces = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    faces /= np.maximum(np.linalg.norm(faces, axis=1), 1e-300)[:, None]
    sums = np.zeros_like(points)
    for i in range(3):
        one, other = corners[(i + 1) % 3] - corners[i], corners[(i + 2) % 3] - corners[i]
        angle = np.arctan2(np.linalg.norm(np.cross(one, other), axis=1), (one * other).sum(1))
        np.add.at(sums, triangles[:, i], faces * angle[:, None])
    return sums / np.maximum(np.linalg.norm(sums, axis=1), 1e-300)[:, None]


def lee_perry_smith(ctx, levels, low=(-90, -115, -40), high=(90, 80, 90), smooth_mm=0):
    """A part of the real head scan (Lee Perry-Smith, CC BY 3.0), subdivided by Loop's rule: points in mm, triangles.

    With `smooth_mm`, relief of shorter wavelength is taken out of it first: what is left is the shape of a face without anything
    of the scale of wrinkles.
    """
    import igl

    points, triangles = [], []
    for line in open(ctx.data("head_lee_perry_smith") / "LeePerrySmith.obj"):
        words = line.split()
        if words[:1] == ["v"]:
            points.append([1000 * float(x) for x in words[1:4]])
        elif words[:1] == ["f"]:
            face = [int(word.split("/")[0]) - 1 for word in words[1:]]
            triangles += [[face[0], face[i], face[i + 1]] for i in range(1, len(face) - 1)]
    points, triangles = np.array(points), np.array(triangles)
    middle = points[triangles].mean(1)
    triangles = triangles[((middle > low) & (middle < high)).all(1)]
    used = np.unique(triangles)
    new = -np.ones(len(points), int)
    new[used] = np.arange(len(used))
    points, triangles = points[used], new[triangles]
    for level in range(levels):
        points, triangles = igl.loop(points, triangles, 1)
        if smooth_mm and level == 1:
            points = smoothed(points, triangles, smooth_mm)
    return points, triangles


def smoothed(points, triangles, wavelength):
    """One implicit step of bi-Laplacian smoothing, half of a wave of that length left."""
    import igl
    import scipy.sparse as sp
    import scipy.sparse.linalg as linear

    stiffness = -igl.cotmatrix(points, triangles)
    mass = igl.massmatrix(points, triangles, igl.MASSMATRIX_TYPE_VORONOI).diagonal()
    bending = stiffness @ sp.diags(1 / mass) @ stiffness
    system = sp.diags(mass) + (wavelength / (2 * np.pi)) ** 4 * bending
    return linear.splu(system.tocsc()).solve(mass[:, None] * points)

"""Scores of `rbf-warp`: against SciPy's RBFInterpolator and planted maps; and its speed beside SciPy.

`score(ctx)` and `bench(ctx)` yield one dict per metric. NumPy and SciPy only. Markers are decoded here, by code of its
own, and handed to the stage as head-trajectories; targets stand in an OBJ in millimetres.
"""

import csv
import hashlib
import json
import os
import struct
import subprocess
import sys

import numpy as np
from scipy.interpolate import RBFInterpolator
from scipy.spatial import ConvexHull

OFF_HULL_MM = 20.0  # points for comparison lie in the markers' hull, its faces moved out by this
SCAN_POINTS = 700_000  # vertices of the paper's scans
REPEATS = 7


# ---------------------------------------------------------------- recorded markers: name → (rest, targets), n × 3, mm


def ict(ctx):
    """90 markers of a performance frame, onto the neutral scan."""
    folder = ctx.data("ict_facekit_dev")
    about = json.loads((folder / "sequence.json").read_text())
    raw = np.fromfile(folder / "sequence.u16", "<u2").reshape(about["frames"], about["vertices"], 3)
    lo, hi = np.array(about["lo"]), np.array(about["hi"])
    markers = about["marker_vertices"]
    moving = lo + raw[:, markers] / 65535.0 * (hi - lo)
    with open(folder / "neutral.obj") as file:
        scan = np.array([line.split()[1:4] for line in file if line.startswith("v ")], float)
    return moving[40] * 10.0, scan[markers] * 10.0


def animface(ctx):
    """41 markers, mouth open, onto the same at rest."""
    with open(ctx.data("face_markers_animface") / "jaw.csv", newline="") as file:
        rows = list(csv.reader(file))
    points = np.array(rows[1:], float)[:, 1:].reshape(len(rows) - 1, -1, 3) * 10.0
    return points[400], points[0]


def sing(ctx):
    """The 31 face markers of a C3D, one frame onto another."""
    data = (ctx.data("c3d") / "Facial-Sing_frames0001-1500.c3d").read_bytes()
    count, analog, first, last = struct.unpack("<4H", data[2:10])
    start = (struct.unpack("<H", data[16:18])[0] - 1) * 512
    rows = np.frombuffer(data, "<f4", offset=start, count=(last - first + 1) * (4 * count + analog))
    rows = rows.reshape(last - first + 1, -1)[:, : 4 * count].reshape(-1, count, 4).astype(float)
    at = data.find(b"LABELS", 512) + 6  # next offset (2), type (1), dimensions (1), then their sizes
    width, labels = data[at + 4], data[at + 5]
    text = data[at + 6 : at + 6 + width * labels]
    names = [text[i * width : (i + 1) * width].decode("latin1").strip() for i in range(labels)]
    face = [i for i, name in enumerate(names) if name.startswith("section")]
    seen = np.flatnonzero((rows[:, face, 3] >= 0).all(axis=1))
    return rows[seen[0], face, :3], rows[seen[len(seen) // 2], face, :3]


SETS = {"ict 90": ict, "animface 41": animface, "sing 31": sing}


# ---------------------------------------------------------------- running the stage


def write_obj(path, points):
    """Points as an OBJ; a mesh has to have a face."""
    with open(path, "w") as file:
        file.writelines(f"v {x!r} {y!r} {z!r}\n" for x, y, z in points.tolist())
        file.write("f 1 2 3\n")


def read_points(path):
    with open(path) as file:
        return np.array([line.split()[1:4] for line in file if line.startswith("v ")], float)


def write_artifact(path, schema, data, frames=()):
    lines = [{"schema": schema, "data": data}, *frames]
    path.write_text("".join(json.dumps(line) + "\n" for line in lines))


class Fitted:
    """A warp fitted by the stage, and where its files are."""

    def __init__(self, ctx, rest, targets):
        self.ctx, self.binary, self.folder = ctx, ctx.binary("rbf-warp"), ctx.tmp
        scan = self.folder / "scan.obj"
        write_obj(scan, targets)
        ids = [f"m{i}" for i in range(len(rest))]
        header = {"unit": "mm", "rate": None, "markers": ids, "take": None}
        frame = {"frame": 1, "points": dict(zip(ids, rest.tolist()))}
        write_artifact(self.folder / "head.jsonl", "head-trajectories/1", header, [frame])
        file = {"name": "scan.obj", "sha256": hashlib.sha256(scan.read_bytes()).hexdigest()}
        pairs = [{"marker": m, "vertex": i, "position_mm": p} for i, (m, p) in enumerate(zip(ids, targets.tolist()))]
        mesh = {"file": file, "unit": "mm", "vertex_count": len(targets)}
        write_artifact(self.folder / "correspondence.json", "correspondence/1", {"mesh": mesh, "pairs": pairs})
        words = "fit --markers head.jsonl --correspondence correspondence.json --mesh scan.obj --unit mm --out warp.json"
        self.results = self.run(words)["results"]

    def run(self, words):
        return self.ctx.run([self.binary, *words.split()], cwd=self.folder)

    @property
    def whole(self):
        """Whether the markers determine all ten terms: else it is another interpolant than SciPy's, on purpose."""
        return self.results["polynomial_rank"] == 10

    def apply(self, points, options=""):
        write_obj(self.folder / "points.obj", points)
        summary = self.run(f"apply --warp warp.json --points points.obj --unit mm --out mapped.obj {options}")
        return read_points(self.folder / "mapped.obj"), summary


def around(markers, count, rng):
    """Points spread evenly over the convex hull of markers, its faces moved out by OFF_HULL_MM."""
    faces = ConvexHull(markers).equations
    low, high = markers.min(axis=0) - OFF_HULL_MM, markers.max(axis=0) + OFF_HULL_MM
    kept, found = [], 0
    while found < count:
        points = rng.uniform(low, high, (count, 3))
        inside = (points @ faces[:, :3].T + faces[:, 3]).max(axis=1) <= OFF_HULL_MM
        kept.append(points[inside])
        found += int(inside.sum())
    return np.concatenate(kept)[:count]


def extent(points):
    return np.linalg.norm(points - points.mean(axis=0), axis=1).max()


def largest(differences):
    return float(np.linalg.norm(differences, axis=1).max())


def quadratic_map(rng, points):
    """A random quadratic map whose three parts have the size of the points."""
    centre, size = points.mean(axis=0), extent(points)
    shift, linear, forms = rng.normal(size=3) * size, rng.normal(size=(3, 3)), rng.normal(size=(3, 3, 3)) / size

    def apply(x):
        x = x - centre
        return shift + x @ linear.T + np.einsum("kij,ni,nj->nk", forms, x, x)

    return apply


# ---------------------------------------------------------------- accuracy


def metric(name, value, target, unit, context):
    return {"metric": f"rbf-warp/{name}", "value": value, "target": target, "better": "lower", "unit": unit,
            "context": context}


def score(ctx):
    differences, errors, left_out = {}, {}, []
    for name, read in SETS.items():
        rest, targets = read(ctx)
        for seed in ctx.seeds:
            rng = np.random.default_rng(seed)
            points = around(rest, 20_000, rng)
            fitted = Fitted(ctx, rest, targets)
            if fitted.whole:
                reference = RBFInterpolator(rest, targets, kernel="cubic", degree=2)(points)
                difference = largest(fitted.apply(points)[0] - reference) / extent(targets)
                differences[name] = max(difference, differences.get(name, 0.0))
            else:
                left_out.append(f"{name}: {fitted.results['polynomial_rank']} terms")
            planted = quadratic_map(rng, rest)
            fitted = Fitted(ctx, rest, planted(rest))
            error = largest(fitted.apply(points)[0] - planted(points)) / extent(planted(rest))
            errors[name] = max(error, errors.get(name, 0.0))
    compared = {"relative to": "extent of the targets", "points": f"20 000 in the hull + {OFF_HULL_MM:g} mm"}
    worst = max(differences.values(), default=None)
    yield metric("scipy_rel_diff", worst, 1e-8, "", compared | {"per set": differences, "terms dropped": left_out})
    yield metric("quadratic_rel_error", max(errors.values()), 1e-8, "", compared | {"per set": errors})
    yield from score_inverse(ctx)


def score_inverse(ctx):
    residuals, lost, seconds = [], 0, []
    for seed in ctx.seeds:
        rest, targets = ict(ctx)
        points = around(targets, SCAN_POINTS, np.random.default_rng(seed))
        found, summary = Fitted(ctx, rest, targets).apply(points, "--inverse --keep-unconverged")
        lost += summary["results"]["unconverged"]
        seconds.append(summary["seconds"]["invert"])
        # SciPy's interpolant, not the stage's own, says where the preimages land.
        residuals.append(largest(RBFInterpolator(rest, targets, kernel="cubic", degree=2)(found) - points))
    context = {"points": f"{SCAN_POINTS} in the hull of 90 markers + {OFF_HULL_MM:g} mm (ict)", "seconds": seconds}
    yield metric("invert_mm", max(residuals), 1e-6, "mm", context | {"forward by": "SciPy"})
    yield metric("invert_unconverged", lost, 0, "points", context)


# ---------------------------------------------------------------- speed


PEER = """
import sys, time, numpy as np
from scipy.interpolate import RBFInterpolator
case = np.load(sys.argv[1])
warp = RBFInterpolator(case["rest"], case["targets"], kernel="cubic", degree=2)
warp(case["points"][:1000])
start = time.perf_counter()
warp(case["points"])
print(time.perf_counter() - start)
"""


def bench(ctx):
    rest, targets = ict(ctx)
    points = around(rest, SCAN_POINTS, np.random.default_rng(ctx.seeds[0]))
    fitted = Fitted(ctx, rest, targets)
    case = ctx.tmp / "case.npz"
    np.savez(case, rest=rest, targets=targets, points=points)
    write_obj(ctx.tmp / "points.obj", points)
    one = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
    apply = "apply --warp warp.json --points points.obj --unit mm --out mapped.obj"
    times = {"scipy": [], "all threads": [], "one thread": []}
    for _ in range(REPEATS):
        peer = [sys.executable, "-c", PEER, str(case)]
        done = subprocess.run(peer, env=os.environ | one, capture_output=True, text=True, check=True)
        times["scipy"].append(float(done.stdout))
        for name, threads in (("all threads", ""), ("one thread", "--threads 1")):
            times[name].append(fitted.run(f"{apply} {threads}")["seconds"]["evaluate"])
    medians = {name: float(np.median(seconds)) for name, seconds in times.items()}
    context = {
        "timed": "evaluation of 700 000 points × 90 centers alone, on both sides; nothing read, written or fitted",
        "peer": "SciPy RBFInterpolator, one thread (it has no more), its compiled evaluation warmed up",
        "seconds": {name: {"median": medians[name], "min": min(s), "max": max(s)} for name, s in times.items()},
        "repeats": f"{REPEATS}, interleaved",
        "ratio on one thread": medians["one thread"] / medians["scipy"],
        "cores": os.cpu_count(),
    }
    yield metric("apply_vs_scipy", medians["all threads"] / medians["scipy"], 0.05, "×", context)

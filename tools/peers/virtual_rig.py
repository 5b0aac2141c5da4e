"""Scores of `virtual-rig`: is the truth true? And its speed, beside Embree for the rays.

What a take shows is measured here, by code of its own, and compared with what the rig says is true; what the rig scores
is perturbed here by known amounts. The rig never marks its own work.
"""

import hashlib
import json
import math
import subprocess
import time
from pathlib import Path

import cv2
import numpy as np

from _takes import lines, make, write_lines

SEEDS = [1, 2, 3, 4]
QUIET = ["--no-calibration", "--no-normals"]


def metric(name, value, target, better, unit, **context):
    return {"metric": f"virtual-rig/{name}", "value": value, "target": target, "better": better, "unit": unit, "context": context}


def point_cache(path):
    """#F x #V x 3 coordinates of a PC2 file."""
    head = Path(path).read_bytes()[:32]
    vertices, frames = int.from_bytes(head[16:20], "little"), int.from_bytes(head[28:32], "little")
    return np.memmap(path, "<f4", "r", 32, (frames, vertices, 3))


def mesh(path):
    """#V x 3 points, #T x 3 corners of an OBJ file of triangles."""
    points, corners = [], []
    for line in open(path):
        if line.startswith("v "):
            points.append([float(x) for x in line.split()[1:4]])
        elif line.startswith("f "):
            corners.append([int(x.split("/")[0]) - 1 for x in line.split()[1:4]])
    return np.array(points), np.array(corners)


# ---------------------------------------------------------------- where paint is seen

REACH = 7  # half of the window around a dot, px


def linear(image):
    """Linear grey of an 8-bit sRGB picture as OpenCV reads it."""
    x = image.mean(axis=2) / 255.0
    return np.where(x <= 0.04045, x / 12.92, ((x + 0.055) / 1.055) ** 2.4)


def in_paint(ctx, seed, name, reflectance):
    """The same take with dots of another grey."""
    rig = ctx.binary("virtual-rig")
    words = [rig, "scenario", "--scenario", "clean", "--seed", seed, "--count", 5, "--quiet"]
    scenario = json.loads(subprocess.run([str(w) for w in words], check=True, capture_output=True, text=True).stdout)
    scenario["data"]["paint"]["dot_color"] = [reflectance] * 3
    # The centroid is that of the paint's area; in a shadow that crosses a dot, its brightness has another.
    scenario["data"]["light"]["shadows"] = False
    path = ctx.tmp / f"{name}-{seed}.json"
    path.write_text(json.dumps(scenario))
    folder = ctx.tmp / f"{name}-{seed}"
    ctx.run([rig, "make", "--scenario", path, *QUIET, "--out", folder])
    return folder


def center_errors(ctx, seed):
    """(centroid of the paint in the pictures) - (centroid that the truth says), px, one row per dot that stands alone.

    The take is filmed with white dots and with black ones: what differs is paint, whatever the skin looks like.
    """
    white, black = in_paint(ctx, seed, "white", 0.9), in_paint(ctx, seed, "black", 0.0)
    header, frames = lines(white / "truth" / "tracks-2d.jsonl")
    errors = []
    for number, frame in enumerate(frames):
        for camera in header["cameras"]:
            name = Path("take") / "footage" / camera / f"{number:06}.png"
            share = linear(cv2.imread(str(white / name))) - linear(cv2.imread(str(black / name)))
            points = frame["points"].get(camera, {})
            places = np.array(list(points.values()))
            shares, states = (frame.get(key, {}).get(camera, {}) for key in ("confidence", "state"))
            for marker, at in points.items():
                column, row = np.round(at).astype(int)
                window = share[row - REACH : row + REACH + 1, column - REACH : column + REACH + 1]
                apart = np.sort(np.linalg.norm(places - at, axis=1))[1]
                # What is partly hidden is compared by the stages' scores; here a dot must show whole and alone.
                if shares.get(marker, 1.0) < 0.999 or marker in states or window.shape != (2 * REACH + 1,) * 2 or apart < 2 * REACH:
                    continue
                y, x = np.mgrid[-REACH : REACH + 1, -REACH : REACH + 1]
                errors.append(np.array([(window * x).sum(), (window * y).sum()]) / window.sum() + [column, row] - at)
    return np.array(errors)


# ---------------------------------------------------------------- how long the skin is


def section(points, corners, origin, along, across, reach):
    """Edges that the plane through `origin` with normal `along` crosses within `reach` along `across`, in their order:
    (#E x 2 vertices, shares along the edges)."""
    near = np.linalg.norm(points - origin, axis=1) < 1.5 * reach + 1.0
    faces = corners[near[corners].all(axis=1)]
    edges = np.unique(np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1), axis=0)
    side = (points - origin) @ along
    edges = edges[side[edges[:, 0]] * side[edges[:, 1]] < 0]
    share = side[edges[:, 0]] / (side[edges[:, 0]] - side[edges[:, 1]])
    at = between(points, edges, share)
    lateral = (at - origin) @ across
    order = np.argsort(lateral)
    order = order[np.abs(lateral[order]) <= reach]
    return edges[order], share[order]


def between(points, edges, share):
    return points[edges[:, 0]] * (1 - share)[:, None] + points[edges[:, 1]] * share[:, None]


def length(points):
    return np.linalg.norm(np.diff(points, axis=0), axis=1).sum()


def arc_lengths(ctx, seed):
    """Length of sections across wrinkles over that of the same skin at rest, where the folds are neither flat nor as deep
    as they can be; beside it what the surface without wrinkles has left."""
    folder = make(ctx, f"arcs-{seed}", "--scenario", "clean", "--seed", seed, "--count", 9, "--no-footage", *QUIET)
    rest, corners = mesh(folder / "take" / "scan.obj")
    _, frames = lines(folder / "truth" / "valleys.jsonl")
    wrinkled, flat = (point_cache(folder / "truth" / f"{name}.pc2") for name in ("wrinkled", "large-scale"))
    rows = []
    for number in range(4, len(frames)):
        deformed, smooth = wrinkled[number].astype(float), flat[number].astype(float)
        for wrinkle, valley in frames[number]["valleys"].items():
            at = np.array([rest[corners[p["face"]]].T @ p["barycentric"] for p in valley])
            inner = range(int(0.35 * len(valley)), int(0.65 * len(valley)), max(1, len(valley) // 25))
            for i in inner:
                point = valley[i]
                if not 0.15 <= point["d_mm"] / point["w_mm"] <= 0.7 or i < 3 or i + 3 >= len(valley):
                    continue
                along = at[i + 3] - at[i - 3]
                along /= np.linalg.norm(along)
                normal = np.array(point["normal"])
                across = np.cross(along, normal)
                edges, share = section(rest, corners, at[i], along, across / np.linalg.norm(across), 2.5 * point["w_mm"])
                if len(edges) < 12:
                    continue
                lengths = [length(between(p, edges, share)) for p in (rest, deformed, smooth)]
                rows.append((lengths[1] / lengths[0] - 1.0, lengths[2] / lengths[0] - 1.0))
    return np.array(rows)


# ---------------------------------------------------------------- scores of what is known


def score_of(ctx, kind, result, truth, *args):
    """Metrics of a result against a truth, by name without the stage."""
    summary = ctx.run([ctx.binary("virtual-rig"), "score", kind, result, "--truth", truth, *args])
    return {row["metric"].split("/")[1]: row for row in summary["results"]["metrics"]}


KINDS = {
    "tracks-2d": "tracks-2d.jsonl",
    "trajectories-3d": "markers.jsonl",
    "head-trajectories": "head.jsonl",
    "head-pose": "pose.jsonl",
    "cameras": "cameras-calibrated.json",
    "sync": "sync.jsonl",
    "large-scale": "large-scale.json",
    "wrinkled": "wrinkled.json",
    "wrinkles-2d": "wrinkles-2d.jsonl",
    "sections": "sections.jsonl",
    "valleys": "valleys.jsonl",
    "masks": "paint",
    "normals": "normals",
}
# The truth fills no sample; and no sequence without wrinkles is given beside it.
UNMEASURED = {"triangulate/filled_rms_mm", "stabilize/filled_rms_mm", "shell-synth/outside_moved"}
ROUNDING = 1e-9  # a curve is a spline, whose points come back to rounding only


def truth_errors(ctx, folder):
    """Per kind the largest departure of the truth's own score from perfection."""
    found = {}
    for kind, name in KINDS.items():
        rows = score_of(ctx, kind, folder / "truth" / name, folder / "truth")
        off = []
        for row in rows.values():
            if row["value"] is None:
                off.append(0.0 if row["metric"] in UNMEASURED else math.inf)
                continue
            off.append(abs(row["value"] - 1.0) if row["unit"] == "share" and row["better"] == "higher" else abs(row["value"]))
        worst = max(off)
        found[kind] = 0.0 if worst < ROUNDING else worst
    return found


def perturbed(ctx, folder, out):
    """Relative difference between planted and recovered errors, by kind."""
    truth, rng, found = folder / "truth", np.random.default_rng(5), {}

    def compare(name, kind, file, metric_name, planted):
        row = score_of(ctx, kind, file, truth)[metric_name]
        found[name] = math.inf if row["value"] is None else abs(row["value"] / planted - 1.0)

    header, frames = lines(truth / "tracks-2d.jsonl")
    squares = []
    for frame in frames:
        for camera, points in frame["points"].items():
            for marker, at in points.items():
                shift = rng.normal(0, 0.2, 2)
                if marker not in frame.get("state", {}).get(camera, {}):
                    squares.append(shift @ shift)
                points[marker] = (np.array(at) + shift).tolist()
    compare("tracks_rms", "tracks-2d", write_lines(out / "t.jsonl", "tracks-2d/1", header, frames), "rms_px", math.sqrt(np.mean(squares)))

    header, frames = lines(truth / "markers.jsonl")
    for frame in frames:
        frame["points"] = {m: (np.array(p) + [0.3, -0.4, 0.0]).tolist() for m, p in frame["points"].items()}
    compare("markers_rms", "trajectories-3d", write_lines(out / "m.jsonl", "trajectories-3d/1", header, frames), "rms_mm", 0.5)

    header, frames = lines(truth / "sections.jsonl")
    for frame in frames:
        for sections in (s for camera in frame["sections"].values() for s in camera.values()):
            for one in sections:
                one["d_px"] *= 1.1
    compare("sections_ratio", "sections", write_lines(out / "s.jsonl", "sections/1", header, frames), "ratio_rel", 0.1)

    header, frames = lines(truth / "valleys.jsonl")
    for frame in frames:
        for one in (p for valley in frame["valleys"].values() for p in valley):
            one["at_mm"] = (np.array(one["at_mm"]) + 0.2 * np.array(one["across"])).tolist()
    rows = score_of(ctx, "valleys", write_lines(out / "v.jsonl", "valleys/1", header, frames), truth)
    row = rows.get("position_mm") or next(row for name, row in rows.items() if name.startswith("position"))
    found["valleys_position"] = abs(row["value"] / 0.2 - 1.0)

    rig = json.loads((truth / "cameras-calibrated.json").read_text())
    for camera in rig["data"]["cameras"].values():
        camera["focal_px"] = [1.01 * f for f in camera["focal_px"]]
    (out / "c.json").write_text(json.dumps(rig))
    compare("cameras_focal", "cameras", out / "c.json", "focal_rel", 0.01)

    index = json.loads((truth / "large-scale.json").read_text())
    cache = point_cache(truth / "large-scale.pc2")
    (out / "large-scale.pc2").write_bytes((truth / "large-scale.pc2").read_bytes()[:32] + (cache + np.float32([0, 0, 0.25])).tobytes())
    (out / "large-scale.json").write_text(json.dumps(index))
    compare("surface_mean", "large-scale", out / "large-scale.json", "mean_mm", 0.25)
    return found


# ---------------------------------------------------------------- the table


def score(ctx):
    seeds = ctx.seeds or SEEDS
    errors = {seed: center_errors(ctx, seed) for seed in seeds}
    radial = {seed: float(np.sqrt((e**2).sum(axis=1).mean())) for seed, e in errors.items()}
    yield metric("marker_center_px", max(radial.values()), 0.02, "lower", "px", by_seed=radial,
                 dots={seed: len(e) for seed, e in errors.items()},
                 mean_px={seed: e.mean(axis=0).round(4).tolist() for seed, e in errors.items()})

    table = ctx.run([ctx.binary("virtual-rig"), "groove", "--rays", 8192])["results"]["table"]
    off = {ratio: abs(light * (1 + 4 * ratio**2) - 1) for ratio, light in table}
    table = ctx.run([ctx.binary("virtual-rig"), "groove", "--rays", 512])["results"]["table"]
    fewer = max(abs(light * (1 + 4 * ratio**2) - 1) for ratio, light in table)
    yield metric("groove_intensity_rel", max(off.values()), 0.01, "lower", "share", rays=8192, by_ratio=off, with_512_rays=fewer)

    arcs = {seed: arc_lengths(ctx, seed) for seed in seeds}
    worst = {seed: float(np.quantile(np.abs(rows[:, 0]), 0.9)) if len(rows) else math.inf for seed, rows in arcs.items()}
    yield metric("arc_length_rel", max(worst.values()), 0.01, "lower", "share", p90_by_seed=worst,
                 median={seed: float(np.median(np.abs(rows[:, 0]))) for seed, rows in arcs.items() if len(rows)},
                 without_wrinkles={seed: float(np.median(np.abs(rows[:, 1]))) for seed, rows in arcs.items() if len(rows)},
                 sections={seed: len(rows) for seed, rows in arcs.items()})

    fixture = ctx.root / "fixtures" / "tiny-face" / "00-virtual-rig"
    size = sum(file.stat().st_size for file in fixture.rglob("*") if file.is_file()) / 1e6
    yield metric("tiny_mb", size or None, 3, "lower", "MB", files=sum(1 for file in fixture.rglob("*") if file.is_file()))

    hashes = []
    for threads in (1, 2):
        folder = ctx.tmp / f"threads-{threads}"
        ctx.run([ctx.binary("virtual-rig"), "make", "--length", "tiny", "--threads", threads, "--out", folder])
        hashes.append({f.relative_to(folder): hashlib.sha256(f.read_bytes()).hexdigest() for f in folder.rglob("*") if f.is_file()})
    differ = sum(hashes[0].get(f) != hashes[1].get(f) for f in hashes[0] | hashes[1])
    yield metric("thread_invariance", differ, 0, "lower", "files that differ", files=len(hashes[0]))

    folder = make(ctx, "scored", "--scenario", "standard", "--length", "short", "--vertices", 40000, "--count", 9, "--no-calibration")
    exact = truth_errors(ctx, folder)
    yield metric("score_of_truth", max(exact.values()), 0, "lower", "largest error", by_kind=exact)
    planted = perturbed(ctx, folder, ctx.tmp)
    yield metric("score_perturbation_rel", max(planted.values()), 0.01, "lower", "share", by_kind=planted)


def timed(words):
    started = time.perf_counter()
    subprocess.run([str(word) for word in words], check=True, capture_output=True)
    return time.perf_counter() - started


def bench(ctx):
    rig = ctx.binary("virtual-rig")
    short = timed([rig, "make", "--length", "short", *QUIET, "--out", ctx.tmp / "short", "--threads", 2])
    yield metric("short_take_s", short, 240, "lower", "s", vertices=150000, images="6 x 25 + 2 x 7", threads=2,
                 inside="everything, PNG coding and truth included; without calibration sequences and pictures of normals")

    tiny = sorted(timed([rig, "make", "--length", "tiny", "--out", ctx.tmp / f"tiny-{i}"]) for i in range(3))
    yield metric("tiny_s", tiny[1], 5, "lower", "s", low=tiny[0], high=tiny[-1])

    scenario = json.loads(subprocess.run([rig, "scenario", "--scenario", "standard", "--quiet"], check=True, capture_output=True, text=True).stdout)
    cameras = 6
    scenario["data"]["extent"] |= {"frames": 60, "wrinkle_every": 60, "wrinkle_phase": 59}
    (ctx.tmp / "mocap.json").write_text(json.dumps(scenario))
    words = [rig, "make", "--scenario", ctx.tmp / "mocap.json", *QUIET, "--threads", 2]
    rates = []
    for i in range(3):
        setup = timed([*words, "--frames", "1001", "--out", ctx.tmp / f"first-{i}"])
        whole = timed([*words, "--frames", "1001-1059", "--out", ctx.tmp / f"mocap-{i}"])
        rates.append(cameras * 58 / (whole - setup))
    yield metric("long_mocap_fps", float(np.median(rates)), 15, "higher", "images per s", low=min(rates), high=max(rates), vertices=150000,
                 threads=2, inside="poses, folds, film, sensor, truth, PNG coding and disk; set-up taken off")

    yield from rays(ctx)


def rays(ctx):
    built = ["cargo", "build", "--release", "--locked", "--package", "virtual-rig", "--example", "rays"]
    subprocess.run(built, cwd=ctx.root, check=True, capture_output=True)
    example = ctx.root / "target" / "release" / "examples" / "rays"
    from _embree import occlusion

    scan = make(ctx, "rays", "--scenario", "clean", "--count", 9, "--no-footage", *QUIET) / "take" / "scan.obj"
    ours = json.loads(subprocess.run([example, ctx.tmp / "rays", scan], check=True, capture_output=True, text=True).stdout)
    theirs = occlusion(ctx.tmp / "rays")
    yield metric("rays_vs_embree", ours["beams_per_s"] / theirs["rays_per_s"], 0.3, "higher", "ratio", ours=ours, embree=theirs)

"""Scores of `calibrate wand` and `calibrate doctor`, on virtual takes. The truth stands beside the takes; what is planted for the
doctor is planted here, in copies of files, by code of its own."""

import json
import math
import subprocess

import numpy as np

from _takes import lines, make, write_lines

SEEDS = [1, 2]
NOISE_PX = [0.05, 0.1]


def metric(name, value, target, better, unit, **context):
    return {"metric": f"calibrate/{name}", "value": value, "target": target, "better": better, "unit": unit, "context": context}


def take(ctx, seed):
    return make(ctx, f"calibrate-{seed}", "--scenario", "standard", "--seed", seed, "--length", "short", "--no-normals")


def lengths(folder):
    """Three lengths between places of the waved point, as if measured."""
    path = {f["frame"]: f["point_mm"] for f in json.loads((folder / "truth/calibration/wand.json").read_text())["frames"]}
    frames = sorted(path)
    pairs = [(0.0, 0.33), (0.1, 0.6), (0.25, 0.9)]
    ends = [(frames[int(a * len(frames))], frames[int(b * len(frames))]) for a, b in pairs]
    return ",".join(f"{a}:{b}={math.dist(path[a], path[b])}" for a, b in ends)


def calibrated(ctx, seed):
    """The rig that the waved point of a take tells, and where the point was seen."""
    folder, rig, tracks = take(ctx, seed), ctx.tmp / f"wand-{seed}.json", ctx.tmp / f"wand-{seed}.jsonl"
    if not rig.exists():
        images = folder / "take" / "calibration" / "wand"
        ctx.run([ctx.binary("calibrate"), "wand", images, "--scale", lengths(folder), "--out", rig, "--out-tracks", tracks])
    return folder, rig, tracks


def wand_marker_mm(ctx):
    """3D marker error that the calibration from the waved point causes: the worst seed."""
    by_seed = {}
    for seed in ctx.seeds or SEEDS:
        folder, rig, _ = calibrated(ctx, seed)
        summary = ctx.run([ctx.binary("virtual-rig"), "score", "cameras", rig, "--truth", folder / "truth"])
        by_seed[seed] = {row["metric"].split("/")[1]: row["value"] for row in summary["results"]["metrics"]}
    worst = max(rows["marker_mm"] for rows in by_seed.values())
    yield metric("wand_marker_mm", worst, 0.08, "lower", "mm", by_seed=by_seed, scale="three known lengths")


# ---------------------------------------------------------------- the doctor


def rotation(axis, angle):
    x, y, z = np.asarray(axis) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross


def turn(camera, seen, rng, middle):
    """0.3 degrees about any axis."""
    carry(camera, rotation(rng.standard_normal(3), math.radians(0.3)), np.zeros(3))


def carry(camera, turned, about):
    """Turns what the camera sees about a point in its own space."""
    pose = camera["cam_from_world"]
    matrix, shift = np.array(pose["rotation"]), np.array(pose["translation_mm"])
    pose["rotation"] = (turned @ matrix).tolist()
    pose["translation_mm"] = (turned @ (shift - about) + about).tolist()


def zoom(camera, seen, rng, middle):
    factor = 1 + rng.choice([-0.02, 0.02])
    camera["focal_px"] = [factor * f for f in camera["focal_px"]]


def delay(camera, seen, rng, middle):
    step = int(rng.choice([-1, 1]))
    before = {frame: dict(points) for frame, points in seen.items()}
    for frame in seen:
        seen[frame] = before.get(frame - step, {})


def mirror(camera, seen, rng, middle):
    for points in seen.values():
        for marker, (x, y) in points.items():
            points[marker] = [camera["image_size"][0] - 1 - x, y]


def flip(camera, seen, rng, middle):
    """The other pose of a flat board that was tilted by 10 to 40 degrees."""
    pose = camera["cam_from_world"]
    at = np.array(pose["rotation"]) @ middle + np.array(pose["translation_mm"])
    aside = np.cross(at, rng.standard_normal(3))
    carry(camera, rotation(aside, 2 * math.radians(rng.uniform(10, 40))), at)


def missize(camera, seen, rng, middle):
    width, height = camera["image_size"]
    sizes = [[2 * width, 2 * height], [height, width], [640, 480]]
    camera["image_size"] = sizes[rng.integers(3)]


FAULTS = {"turned": turn, "zoomed": zoom, "late": delay, "mirrored": mirror, "flipped": flip, "image-size": missize}


def evidence(ctx, seed):
    """What the doctor is shown: name, rig, tracks (header, camera -> frame -> marker -> pixel)."""
    folder, rig, wand = calibrated(ctx, seed)
    for name, cameras, tracks in (("wand", rig, wand), ("markers", folder / "truth/cameras-calibrated.json", folder / "truth/tracks-2d.jsonl")):
        header, frames = lines(tracks)
        header["take"] = None
        seen = {c: {f["frame"]: dict(f["points"].get(c, {})) for f in frames if c in f["points"]} for c in header["cameras"]}
        document = json.loads(cameras.read_text())["data"]
        document["take"] = None
        document["cameras"] = {c: document["cameras"][c] for c in header["cameras"]}
        yield folder, name, document, header, seen


def examined(ctx, folder, document, header, seen, noise_px, rng):
    """The doctor's findings; noise is added to every pixel."""
    rig = ctx.tmp / "patient.json"
    rig.write_text(json.dumps({"schema": "cameras/1", "data": document}))
    numbers = sorted({frame for points in seen.values() for frame in points})
    noisy = lambda p: [p[0] + noise_px * rng.standard_normal(), p[1] + noise_px * rng.standard_normal()]
    rows = [
        {"frame": n, "points": {c: {m: noisy(p) for m, p in seen[c][n].items()} for c in seen if n in seen[c]}} for n in numbers
    ]
    tracks = write_lines(ctx.tmp / "evidence.jsonl", "tracks-2d/1", header, rows)
    words = [ctx.binary("calibrate"), "doctor", rig, "--tracks", tracks, "--take", folder / "take" / "take.json"]
    return findings(words)


def findings(words):
    done = subprocess.run([*map(str, words), "--json", "--quiet"], capture_output=True, text=True)
    # Exit code 1 says that something was found; the summary is there all the same.
    summaries = [line for line in done.stdout.splitlines() if line.startswith("{")]
    if done.returncode not in (0, 1) or not summaries:
        raise RuntimeError(done.stderr.strip())
    return json.loads(summaries[-1])["results"]["examination"]["findings"]


def middle_of(document):
    """The point nearest to the optical axes of all cameras, mm."""
    total, right = np.zeros((3, 3)), np.zeros(3)
    for camera in document["cameras"].values():
        matrix, shift = np.array(camera["cam_from_world"]["rotation"]), np.array(camera["cam_from_world"]["translation_mm"])
        across = np.eye(3) - np.outer(matrix[2], matrix[2])
        total, right = total + across, right + across @ (-matrix.T @ shift)
    return np.linalg.solve(total, right)


def doctor(ctx):
    """The share of planted faults that are found in the camera in which they are, and findings where there is nothing."""
    caught, named, blamed, planted, missed = 0, 0, 0, 0, []
    alarms, clean = [], 0
    for seed in ctx.seeds or SEEDS:
        for folder, name, document, header, seen in evidence(ctx, seed):
            middle = middle_of(document)
            for noise_px in NOISE_PX:
                rng = np.random.default_rng([seed, int(1000 * noise_px)])
                found = examined(ctx, folder, document, header, seen, noise_px, rng)
                clean += 1
                alarms += [[seed, name, noise_px, f["camera"], f["kind"]] for f in found]
            for number, camera in enumerate(header["cameras"]):
                for kind, plant in FAULTS.items():
                    rng = np.random.default_rng([seed, number, list(FAULTS).index(kind)])
                    ill, tracks = json.loads(json.dumps(document)), {**seen, camera: {f: dict(p) for f, p in seen[camera].items()}}
                    plant(ill["cameras"][camera], tracks[camera], rng, middle)
                    found = examined(ctx, folder, ill, header, tracks, NOISE_PX[number % 2], rng)
                    kinds = [f["kind"] for f in found if f["camera"] == camera]
                    planted, caught, named = planted + 1, caught + bool(kinds), named + (kind in kinds)
                    blamed += sum(f["camera"] != camera for f in found)
                    if kind not in kinds:
                        missed.append([seed, name, camera, kind, [[f["camera"], f["kind"]] for f in found]])
    yield metric("doctor_caught", caught / planted, 1.0, "higher", "share", planted=planted, named_rightly=named / planted,
                 other_cameras_blamed=blamed, not_named=missed, noise_px=NOISE_PX)
    yield metric("doctor_false_alarms", len(alarms), 0, "lower", "count", examinations=clean, alarms=alarms, noise_px=NOISE_PX)


def score(ctx):
    yield from wand_marker_mm(ctx)
    yield from doctor(ctx)

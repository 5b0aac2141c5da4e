"""Scores of `stabilize`: rigid invariance, jitter, jumps; and its speed beside NumPy.

`score(ctx)` and `bench(ctx)` yield one dict per metric. NumPy only. Markers are decoded here, by code of its own, and
handed to the stage as trajectories-3d, so that known motions can be planted on recorded ones.
"""

import csv
import json
import struct
import time

import numpy as np

REAL_JUMP = {  # seen by eye in Facial-Sing: samples that are at another marker's place, or slide there and back
    "section3-1": (821, 843),
    "section3-2": (821, 862),
    "section4-2": (844, 863),
}
HEAD = ["--head-markers", "root-*", "--drop", "Unlabeled*"]


class Clip:
    """A marker take: names, points (frames, markers, 3) in mm with NaN where missing, rate, stage arguments."""

    def __init__(self, name, markers, points, rate, args=()):
        self.name, self.markers, self.points, self.rate, self.args = name, markers, points, rate, list(args)

    def with_points(self, points):
        return Clip(self.name, self.markers, points, self.rate, self.args)


# ---------------------------------------------------------------- recorded takes


def sing(ctx):
    data = (ctx.data("c3d") / "Facial-Sing_frames0001-1500.c3d").read_bytes()
    count, analog, first, last = struct.unpack("<4H", data[2:10])
    start = (struct.unpack("<H", data[16:18])[0] - 1) * 512
    rows = np.frombuffer(data, "<f4", offset=start, count=(last - first + 1) * (4 * count + analog))
    rows = rows.reshape(last - first + 1, -1)[:, : 4 * count].reshape(-1, count, 4).astype(float)
    points = rows[..., :3].copy()
    points[rows[..., 3] < 0] = np.nan
    at = data.find(b"LABELS", 512) + 6  # next offset (2), type (1), dimensions (1), then their sizes
    width, labels = data[at + 4], data[at + 5]
    text = data[at + 6 : at + 6 + width * labels]
    names = [text[i * width : (i + 1) * width].decode("latin1").strip() for i in range(labels)]
    return Clip("sing", names, points, 100, HEAD)


def animface(ctx, name):
    with open(ctx.data("face_markers_animface") / f"{name}.csv", newline="") as file:
        rows = list(csv.reader(file))
    points = np.array(rows[1:], float)[:, 1:].reshape(len(rows) - 1, -1, 3) * 10.0
    return Clip(name, [column[:-2] for column in rows[0][1::3]], points, 60)


def ict(ctx):
    folder = ctx.data("ict_facekit_dev")
    about = json.loads((folder / "sequence.json").read_text())
    raw = np.fromfile(folder / "sequence.u16", "<u2").reshape(about["frames"], about["vertices"], 3)
    low, high = np.array(about["lo"]), np.array(about["hi"])
    chosen = about["marker_vertices"]
    points = 10.0 * (low + raw[:, chosen] / 65535.0 * (high - low))
    return Clip("ict", [f"v{vertex}" for vertex in chosen], points, 30)


def synthetic(seed, frames=600, rate=100):
    """Six head markers and 30 face markers that speak; 0.05 mm of noise. Returns the noise-free points too."""
    rng = np.random.default_rng(seed)
    head = np.array([[-70, 60, 20], [70, 60, 20], [-75, 0, -10], [75, 0, -10], [-25, 95, 40], [30, 95, 40.0]])
    grid = [[x, y, 85 - 0.008 * (x * x) - 0.003 * y * y] for y in (45, 20, -10, -35, -55, -75) for x in (-40, -20, 0, 20, 40)]
    rest = np.vstack([head, np.array(grid, float)])
    time_s = np.arange(frames) / rate
    points = np.repeat(rest[None], frames, 0)
    for _ in range(8):  # gestures: smooth bumps of lower-face markers, up to 6 Hz
        center, width = rng.uniform(0, frames / rate), rng.uniform(0.05, 0.3)
        place, reach = rest[rng.integers(16, len(rest))], rng.uniform(15, 40)
        local = np.exp(-((rest - place) ** 2).sum(1) / (2 * reach**2)) * (np.arange(len(rest)) >= 6)
        bump = np.exp(-((time_s - center) ** 2) / (2 * width**2))
        points += bump[:, None, None] * local[None, :, None] * rng.normal(0, 4, 3)
    names = [f"head-{i}" for i in range(6)] + [f"face-{i}" for i in range(len(grid))]
    noisy = points + rng.normal(0, 0.05, points.shape)
    return Clip(f"synthetic-{seed}", names, noisy, rate, ["--head-markers", "head-*"]), points


# ---------------------------------------------------------------- running the stage


def write_clip(path, clip, first=1001):
    header = {"unit": "mm", "rate": {"frames": clip.rate, "seconds": 1}, "markers": clip.markers, "take": None}
    with open(path, "w") as file:
        file.write(json.dumps({"schema": "trajectories-3d/1", "data": header}) + "\n")
        for number, row in enumerate(clip.points, first):
            points = {m: (None if np.isnan(p).any() else p.tolist()) for m, p in zip(clip.markers, row)}
            file.write(json.dumps({"frame": number, "points": points}) + "\n")


def read_head(path):
    lines = open(path).read().splitlines()
    markers = json.loads(lines[0])["data"]["markers"]
    points = np.full((len(lines) - 1, len(markers), 3), np.nan)
    for f, line in enumerate(lines[1:]):
        for marker, point in json.loads(line)["points"].items():
            if point is not None:
                points[f, markers.index(marker)] = point
    return markers, points


def read_pose(path):
    frames = [json.loads(line)["world_from_head"] for line in open(path).read().splitlines()[1:]]
    rotations, shifts = np.full((len(frames), 3, 3), np.nan), np.full((len(frames), 3), np.nan)
    for f, pose in enumerate(frames):
        if pose is not None:
            w, x, y, z = pose["rotation_wxyz"]
            rotations[f] = [
                [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
            ]
            shifts[f] = pose["translation_mm"]
    return rotations, shifts


def stabilized(ctx, clip, *extra, first=1):
    folder = ctx.tmp / "stabilize"
    folder.mkdir(parents=True, exist_ok=True)
    files = {key: folder / f"{key}.jsonl" for key in ("markers", "out", "pose")}
    write_clip(files["markers"], clip, first)
    named = [part for key, path in files.items() for part in (f"--{key}", str(path))]
    summary = ctx.run([str(ctx.binary("stabilize")), *named, *clip.args, *map(str, extra)])
    markers, head = read_head(files["out"])
    return summary["results"], markers, head, read_pose(files["pose"])


# ---------------------------------------------------------------- geometry


def kabsch(source, target):
    """Rotation and shift that carry source onto target, least squares."""
    a, b = source.mean(0), target.mean(0)
    u, _, vt = np.linalg.svd((target - b).T @ (source - a))
    rotation = u @ np.diag([1, 1, np.linalg.det(u @ vt)]) @ vt
    return rotation, b - rotation @ a


def rotations(angles):
    """Rz(c) Ry(b) Rx(a) per row of angles, rad."""
    (sa, sb, sc), (ca, cb, cc) = np.sin(angles).T, np.cos(angles).T
    zero, one = np.zeros_like(sa), np.ones_like(sa)
    stack = lambda rows: np.array(rows).transpose(2, 0, 1)
    x = stack([[one, zero, zero], [zero, ca, -sa], [zero, sa, ca]])
    y = stack([[cb, zero, sb], [zero, one, zero], [-sb, zero, cb]])
    z = stack([[cc, -sc, zero], [sc, cc, zero], [zero, zero, one]])
    return z @ y @ x


def head_motion(kind, frames, rate, rng):
    """Angles (rad) and shifts (mm) per frame: up to 15° and 30 mm, up to 3 Hz, or sudden starts and stops."""
    t = np.arange(frames) / rate
    span = np.radians(15.0) * np.ones(6)
    span[3:] = 30.0
    if kind == "sudden":  # still, then off at full speed within one frame, stop, back
        moves = np.zeros((frames, 6))
        for start in np.arange(0.4, max(t[-1], 0.5), 1.1):
            ramp = np.clip((t - start) / 0.12, 0, 1) - np.clip((t - start - 0.5) / 0.12, 0, 1)
            moves += ramp[:, None] * rng.uniform(-1, 1, 6)
    else:
        fastest = 3.0 if kind == "nods" else 0.7
        parts = [(rng.uniform(0.2, fastest, 6), rng.uniform(0, 2 * np.pi, 6)) for _ in range(3)]
        parts.append((np.full(6, fastest), rng.uniform(0, 2 * np.pi, 6)))
        moves = sum(np.sin(2 * np.pi * t[:, None] * hz + phase) for hz, phase in parts) / len(parts)
    moves = moves / np.maximum(np.abs(moves).max(0), 1e-9) * span
    return moves[:, :3], moves[:, 3:]


def planted(clip, kind, rng):
    """The clip with a head motion about the neck planted on it."""
    angles, shifts = head_motion(kind, len(clip.points), clip.rate, rng)
    pivot = np.nanmean(clip.points, (0, 1)) - [0, 100, 60]
    turned = np.einsum("fij,fmj->fmi", rotations(angles), clip.points - pivot)
    return clip.with_points(turned + pivot + shifts[:, None])


# ---------------------------------------------------------------- metrics


def rigid_difference(a, b):
    """Largest distance of two results after one rigid alignment of the whole; inf if other samples are missing."""
    if a.shape != b.shape or (np.isnan(a) != np.isnan(b)).any():
        return float("inf")
    seen = ~np.isnan(a[..., 0])
    rotation, shift = kabsch(b[seen], a[seen])
    return float(np.linalg.norm(b[seen] @ rotation.T + shift - a[seen], axis=1).max())


def invariance(ctx, clips):
    """Largest change of head space, over clips and planted motions."""
    found = {}
    for clip in clips:
        _, _, still, _ = stabilized(ctx, clip)
        for kind in ("turns", "nods", "sudden"):
            rng = np.random.default_rng([ctx.seeds[0], len(found)])
            _, _, moved, _ = stabilized(ctx, planted(clip, kind, rng))
            found[f"{clip.name}/{kind}"] = rigid_difference(still, moved)
    return found


def jitter(points):
    """Noise of the common motion of markers, mm per axis: third differences of their middle, median over frames."""
    third = np.diff(np.nanmean(points, 1), n=3, axis=0)
    return float(np.nanmedian(np.linalg.norm(third, axis=1)) / 1.538 / np.sqrt(20.0))


def held_out_jitter(ctx, clip, rng):
    """Jitter of markers that the stage was not shown, through its poses: world, as fitted, steadied; mm."""
    face = [i for i, m in enumerate(clip.markers) if m.startswith("section")]
    hidden = sorted(rng.permutation(face)[: len(face) // 2].tolist())
    shown = [i for i in range(len(clip.markers)) if i not in hidden]
    visible = Clip(clip.name, [clip.markers[i] for i in shown], clip.points[:, shown], clip.rate, clip.args)
    world = clip.points[:, hidden]
    found = [jitter(world)]
    for smooth in (0, 60):
        _, _, _, (rotation, shift) = stabilized(ctx, visible, "--smooth-ms", smooth)
        found.append(jitter(np.einsum("fji,fmj->fmi", rotation, world - shift[:, None])))
    return found


def pose_errors(ctx, seed):
    """Error of the face's places through the poses against truth, rms mm: as fitted, steadied (a nodding head)."""
    clip, truth = synthetic(seed)
    rng = np.random.default_rng([seed, 7])
    angles, shifts = head_motion("nods", len(truth), clip.rate, rng)
    turn = rotations(angles)
    world = clip.with_points(np.einsum("fij,fmj->fmi", turn, clip.points) + shifts[:, None])
    errors = []
    for smooth in (0, 60):
        _, _, _, (rotation, shift) = stabilized(ctx, world, "--smooth-ms", smooth)
        places = np.einsum("fij,fmj->fmi", turn, truth[:, 6:]) + shifts[:, None]
        head = np.einsum("fji,fmj->fmi", rotation, places - shift[:, None])
        align, offset = kabsch(head.reshape(-1, 3), truth[:, 6:].reshape(-1, 3))
        off = head @ align.T + offset - truth[:, 6:]
        errors.append(float(np.sqrt((off**2).sum(2).mean())))
    return errors


def alarms_on(ctx, clip):
    """Samples of false alarms: (all reported jumps) − the real ones, by marker and frame."""
    result, *_ = stabilized(ctx, clip, "--swaps", "report")
    real = REAL_JUMP if clip.name == "sing" else {}
    flagged = {(j["marker"], f) for j in result["jumps"] for f in range(j["frames"][0], j["frames"][1] + 1)}
    known = {(m, f) for m, (a, b) in real.items() for f in range(a, b + 1)}
    beside = {(m, f) for m, (a, b) in real.items() for f in range(a - 2, b + 4)}
    return len(flagged - beside), len(flagged & known), len(known)


def planted_jumps(ctx, clip, seed, count=12):
    """Plants jumps and swaps; returns samples planted, caught, and flagged elsewhere."""
    rng = np.random.default_rng([seed, 3])
    points = clip.points.copy()
    planted_samples = set()
    starts = np.linspace(20, len(points) - 60, count).astype(int)
    for start in starts:
        length = int(rng.integers(1, 25))
        marker = int(rng.integers(points.shape[1]))
        frames = slice(start, start + length)
        gap = np.linalg.norm(points[start] - points[start, marker], axis=1)
        if rng.random() < 0.5:
            shift = rng.normal(size=3)
            points[frames, marker] += shift / np.linalg.norm(shift) * rng.uniform(20, 60)
            names = [marker]
        else:
            other = int(rng.choice(np.flatnonzero(gap > 15)))
            points[frames, [marker, other]] = points[frames, [other, marker]]
            names = [marker, other]
        planted_samples |= {(clip.markers[m], f + 1) for m in names for f in range(start, start + length)}
    result, *_ = stabilized(ctx, clip.with_points(points), "--swaps", "report")
    flagged = {
        (j["marker"], f) for j in result["jumps"] if j["removed"] for f in range(j["frames"][0], j["frames"][1] + 1)
    }
    return len(planted_samples), len(flagged & planted_samples), len(flagged - planted_samples)


def metric(name, value, target, better, unit, **context):
    return {
        "metric": f"stabilize/{name}", "value": value, "target": target, "better": better, "unit": unit, "context": context
    }


def available(ctx, makers):
    """The clips whose data are there, and the names of those that are not."""
    clips, missing = [], []
    for name, make in makers:
        try:
            clips.append(make())
        except ctx.Missing:
            missing.append(name)
    return clips, missing


def score(ctx):
    makers = [("sing", lambda: sing(ctx)), ("jaw", lambda: animface(ctx, "jaw")),
              ("eyebrows", lambda: animface(ctx, "eyebrows")), ("ict", lambda: ict(ctx))]
    real, missing = available(ctx, makers)
    clips = real + [synthetic(seed)[0] for seed in ctx.seeds]
    found = invariance(ctx, clips)
    yield metric("rigid_invariance_mm", max(found.values()), 0.02, "lower", "mm", worst=max(found, key=found.get),
                 runs=len(found), missing=missing, motion="15 deg, 30 mm, up to 3 Hz and sudden starts")

    errors = np.array([pose_errors(ctx, seed) for seed in ctx.seeds])
    before, after = np.sqrt((errors**2).mean(0))
    yield metric("pose_error_rms_mm", float(after), None, "lower", "mm", as_fitted=float(before), noise_mm=0.05)

    alarms = [alarms_on(ctx, clip) for clip in real]
    yield metric("false_alarm_samples", sum(a[0] for a in alarms) if real else None, None, "lower", "samples",
                 clips=[clip.name for clip in real], missing=missing)
    by_name = {clip.name: (clip, alarm) for clip, alarm in zip(real, alarms)}
    if "sing" in by_name:
        clip, (_, caught, known) = by_name["sing"]
        yield metric("jump_frames_caught", caught / known, None, "higher", "share", samples=known, take="Facial-Sing")
        world, fitted, steady = held_out_jitter(ctx, clip, np.random.default_rng(ctx.seeds[0]))
        yield metric("jitter_ratio", steady / fitted, None, "lower", "ratio", world_mm=world, as_fitted_mm=fitted,
                     steadied_mm=steady, measured_on="markers that the stage was not shown")
    for name in ("jaw", "eyebrows"):
        if name in by_name:
            sums = np.sum([planted_jumps(ctx, by_name[name][0], seed) for seed in ctx.seeds], axis=0)
            yield metric(f"planted_jumps_caught_{name}", float(sums[1] / sums[0]), None, "higher", "share",
                         samples=int(sums[0]), flagged_elsewhere=int(sums[2]))


def bench(ctx):
    """Whole runs (process start, JSON in and out) against the rigid fits alone in NumPy, its data in memory."""
    clip, _ = synthetic(ctx.seeds[0], frames=3000)
    stage, peer = [], []
    for _ in range(5):
        start = time.perf_counter()
        peer_fit(clip.points)
        middle = time.perf_counter()
        result = stabilized_seconds(ctx, clip)
        peer.append(middle - start)
        stage.append(result)
    ratio = [a / b for a, b in zip(stage, peer)]
    yield metric("time_ratio_numpy", float(np.median(ratio)), None, "lower", "ratio", low=min(ratio), high=max(ratio),
                 frames=3000, stage_s=float(np.median(stage)), numpy_s=float(np.median(peer)),
                 timed="stage: all steps without reading and writing; NumPy: one Kabsch fit per frame to frame one")


def stabilized_seconds(ctx, clip):
    folder = ctx.tmp / "stabilize"
    folder.mkdir(parents=True, exist_ok=True)
    write_clip(folder / "markers.jsonl", clip)
    args = ["--markers", folder / "markers.jsonl", "--out", folder / "out.jsonl", "--pose", folder / "pose.jsonl"]
    return ctx.run([str(ctx.binary("stabilize")), *map(str, args), *clip.args])["seconds"]["stabilize"]


def peer_fit(points):
    out = np.empty_like(points)
    for f, row in enumerate(points):
        rotation, shift = kabsch(points[0, :6], row[:6])
        out[f] = (row - shift) @ rotation
    return out

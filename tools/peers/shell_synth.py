"""Numbers of shell-synth: on virtual takes whose surface with and without wrinkles is known, with true valleys and true large-scale
motion, so that nothing but the synthesis is measured; and one linear solve against CHOLMOD."""

import csv
import json

import numpy as np

import operators
from _takes import make

# The definitions of region_error_ratio, bulge_height_rel and outside_moved stand in `virtual_rig::score::wrinkled`.
SCORES = {"region_error_ratio": (0.40, "ratio"), "bulge_height_rel": (0.30, "ratio"), "outside_moved": (0.0, "mm")}
REPORTED = ("region_rms_mm", "region_raw_ratio", "valley_depth_rel")


def metric(name, value, target, better, unit, **context):
    return {"metric": f"shell-synth/{name}", "value": value, "target": target, "better": better, "unit": unit, "context": context}


# ---- takes and artifacts -------------------------------------------------------------------------------------------


def true_take(ctx, seed, *options, name="short"):
    """Truth without images: scan, surfaces with and without wrinkles, valleys; kept outside the repository."""
    return make(ctx, f"truth-{name}-{seed}", "--scenario", "standard", "--seed", seed, "--length", "short", "--no-footage",
                "--no-calibration", *options)


def read_lines(path):
    return [json.loads(line) for line in open(path)]


def write_lines(path, lines):
    with open(path, "w") as out:
        out.writelines(json.dumps(line) + "\n" for line in lines)
    return path


def read_sequence(path):
    index = json.load(open(path))["data"]
    samples = np.fromfile(path.with_name(index["cache"]), "<f4", offset=32)
    return index["frames"], samples.reshape(len(index["frames"]), -1, 3).astype(float)


def write_sequence(path, like, frames, samples):
    """A large-scale sequence like another one, of other frames."""
    index = json.load(open(like))
    index["data"] |= {"frames": [int(frame) for frame in frames], "cache": path.with_suffix(".pc2").name}
    path.write_text(json.dumps(index))
    head = b"POINTCACHE2\0" + np.array([1, samples.shape[1], 0, 0, len(frames)], "<i4").tobytes()
    values = np.frombuffer(head, np.uint8).copy()
    values[20:28] = np.array([frames[0], 1.0], "<f4").view(np.uint8)
    path.with_suffix(".pc2").write_bytes(values.tobytes() + samples.astype("<f4").tobytes())
    return path


def scan(folder):
    vertices, triangles = [], []
    for line in open(folder / "take" / "scan.obj"):
        words = line.split()
        if words[:1] == ["v"]:
            vertices.append([float(x) for x in words[1:4]])
        elif words[:1] == ["f"]:
            triangles.append([int(word.split("/")[0]) - 1 for word in words[1:4]])
    return np.array(vertices), np.array(triangles)


def synthesise(ctx, folder, name, *options, large=None, valleys=None):
    out = ctx.tmp / f"{folder.name}-{name}.json"
    summary = ctx.run([ctx.binary("shell-synth"), "--mesh", folder / "take" / "scan.obj",
                       "--large-scale", large or folder / "truth" / "large-scale.json",
                       "--valleys", valleys or folder / "truth" / "valleys.jsonl",
                       "--out", out, "--report", out.with_suffix(".csv"), *options])
    return out, summary


def compare(ctx, folder, out, *options):
    truth = folder / "truth"
    summary = ctx.run([ctx.binary("virtual-rig"), "score", "wrinkled", out, "--truth", truth, "--against", truth / "large-scale.json",
                       *options])
    return {row["metric"].split("/")[1]: row for row in summary["results"]["metrics"]}


def pooled(rows, name):
    """Root mean square of a ratio or length over takes; the largest for what must not happen at all."""
    values = [row[name]["value"] for row in rows]
    pool = max(values) if name == "outside_moved" else float(np.sqrt(np.mean(np.square(values))))
    return pool, [round(value, 4) for value in values]


# ---- accuracy ------------------------------------------------------------------------------------------------------


def score_surface(ctx, folders, made):
    rows = [compare(ctx, folder, out) for folder, (out, _) in zip(folders, made)]
    for name, (target, unit) in SCORES.items():
        value, each = pooled(rows, name)
        yield metric(name, value, target, "lower", unit, seeds=ctx.seeds, each=each, profiles="foreign")
    for name in REPORTED:
        value, each = pooled(rows, name)
        yield metric(name, value, None, None, rows[0][name].get("unit", ""), seeds=ctx.seeds, each=each)
    yield metric("inverted_triangles", sum(summary["results"]["inverted_triangles"] for _, summary in made), 0, "lower", "count",
                 seeds=ctx.seeds, unfinished_regions=sum(summary["results"]["unfinished_regions"] for _, summary in made))


def every_fourth(ctx, folder):
    header, *frames = read_lines(folder / "truth" / "valleys.jsonl")
    return write_lines(ctx.tmp / f"{folder.name}-fourth.jsonl", [header, *frames[::4]])


def score_between(ctx, folders):
    """Valleys known in every fourth frame only; compared in the frames between."""
    ratios = []
    for folder in folders:
        out, _ = synthesise(ctx, folder, "fourth", valleys=every_fourth(ctx, folder))
        rows = [compare(ctx, folder, out, "--frames", f"{first + 1}-{first + 3}")["region_error_ratio"]["value"]
                for first in known_frames(folder)[8:-1:4]]
        ratios.append(float(np.sqrt(np.mean(np.square(rows)))))
    yield metric("inbetween_error_ratio", float(np.sqrt(np.mean(np.square(ratios)))), 0.50, "lower", "ratio", seeds=ctx.seeds, each=ratios)


def known_frames(folder):
    return [line["frame"] for line in read_lines(folder / "truth" / "valleys.jsonl")[1:]]


def wandering(ctx, folder, amount_mm=0.6):
    """True valleys that wander to and fro across themselves over the skin, each in its own time."""
    header, *frames = read_lines(folder / "truth" / "valleys.jsonl")
    vertices, triangles = scan(folder)
    ids = [wrinkle["id"] for wrinkle in header["data"]["wrinkles"]]
    around = [[] for _ in vertices]
    for number, triangle in enumerate(triangles):
        [around[vertex].append(number) for vertex in triangle]
    for t, frame in enumerate(frames):
        for wrinkle, points in frame["valleys"].items():
            shift = amount_mm * np.sin(0.9 * t + ids.index(wrinkle))
            for point in points:
                move(point, shift, vertices, triangles, around)
    return write_lines(ctx.tmp / f"{folder.name}-wandering.jsonl", [header, *frames])


def move(point, shift, vertices, triangles, around):
    """Moves a valley point along its own direction across, to the triangle nearby that it falls into."""
    corners = triangles[point["face"]]
    at = np.array(point["barycentric"]) @ vertices[corners] + shift * np.array(point["across"])
    best = None
    for number in {n for corner in corners for m in around[corner] for v in triangles[m] for n in around[v]}:
        a, b, c = vertices[triangles[number]]
        shares, *_ = np.linalg.lstsq(np.stack([b - a, c - a], 1), at - a, rcond=None)
        shares = np.array([1 - shares.sum(), *shares])
        if best is None or shares.min() > best[0]:
            best = (shares.min(), number, shares)
    shares = np.clip(best[2], 0, None)
    point["face"], point["barycentric"] = int(best[1]), (shares / shares.sum()).tolist()


def score_drift(ctx, folder):
    """How far creases move over the skin when the valleys that were given wander by 0.6 mm: 95 % of the movement of the deepest
    vertex' place, found in the output alone."""
    header, *frames = read_lines(folder / "truth" / "valleys.jsonl")
    out, summary = synthesise(ctx, folder, "wandering", valleys=wandering(ctx, folder))
    numbers, made = read_sequence(out)
    _, flat = read_sequence(folder / "truth" / "large-scale.json")
    vertices, triangles = scan(folder)
    drifts = []
    for wrinkle in {id for frame in frames for id in frame["valleys"]}:
        drifts += crease_drifts(wrinkle, frames, made, flat, vertices, triangles)
    yield metric("valley_drift_mm", float(np.percentile(drifts, 95)), 0.3, "lower", "mm", planted_mm=0.6, samples=len(drifts),
                 found_mm=summary["results"]["drift_found_mm"], seed=ctx.seeds[0])


def crease_drifts(wrinkle, frames, made, flat, vertices, triangles):
    """Per sample and frame how far the crease is from where it is in the mean, across itself, mm at rest."""
    places = []
    for t, frame in enumerate(frames):
        row = []
        for point in frame["valleys"].get(wrinkle, [])[::8]:
            if point["d_mm"] < 0.3:
                row.append(np.nan)
                continue
            at = np.array(point["barycentric"]) @ vertices[triangles[point["face"]]]
            away = vertices - at
            near = np.nonzero((away**2).sum(1) < point["w_mm"] ** 2)[0]
            across = away[near] @ np.array(point["across"])
            depth = np.clip(-(made[t][near] - flat[t][near]) @ np.array(point["normal"]) - 0.5 * point["d_mm"], 0, None)
            row.append((across * depth).sum() / depth.sum() if depth.sum() > 0 else np.nan)
        places.append(row)
    longest = max(map(len, places), default=0)
    table = np.array([row for row in places if len(row) == longest])
    table = table[:, (~np.isnan(table)).sum(0) > 4] if table.size else table
    return np.abs(table - np.nanmedian(table, axis=0))[~np.isnan(table)].tolist() if table.size else []


def score_jitter(ctx, folder, repeats=8):
    """A face that stands still: one frame again and again, its valleys shaken by 0.02 mm as a steady measurement is."""
    header, *frames = read_lines(folder / "truth" / "valleys.jsonl")
    _, flat = read_sequence(folder / "truth" / "large-scale.json")
    numbers = [line["frame"] for line in frames]
    still = 2 * len(frames) // 3
    shaken, random = [], np.random.default_rng(ctx.seeds[0])
    for t in range(repeats):
        copy = json.loads(json.dumps(frames[still])) | {"frame": numbers[0] + t}
        for points in copy["valleys"].values():
            w, d = random.normal(0, 0.005, 2)
            for point in points:
                point["w_mm"], point["d_mm"] = point["w_mm"] + w, max(0.0, point["d_mm"] + d * min(1.0, point["d_mm"]))
        shaken.append(copy)
    valleys = write_lines(ctx.tmp / "still.jsonl", [header, *shaken])
    large = write_sequence(ctx.tmp / "still.json", folder / "truth" / "large-scale.json", [f["frame"] for f in shaken],
                           np.repeat(flat[still][None], repeats, 0))
    out, _ = synthesise(ctx, folder, "still", large=large, valleys=valleys)
    _, made = read_sequence(out)
    moved = np.linalg.norm(np.diff(made, axis=0), axis=2)
    active = np.linalg.norm(made[0] - flat[still], axis=1) > 1e-4
    yield metric("frame_jitter_mm", float(np.percentile(moved[:, active], 99)), 0.02, "lower", "mm", seed=ctx.seeds[0],
                 largest=float(moved.max()), shaken="w and d of each wrinkle by 0.005 mm (sd)", note="99 % of the vertices that wrinkles move")


def score_order(ctx, folder, count=20):
    """Frames from the one before, forwards and backwards, against each anew; and 'compression first, then valleys'."""
    header, *frames = read_lines(folder / "truth" / "valleys.jsonl")
    frames = frames[-count:]
    numbers, flat = read_sequence(folder / "truth" / "large-scale.json")
    flat = flat[-count:]
    start = frames[0]["frame"]
    ways = {"forward": list(range(count)), "backward": list(range(count))[::-1]}
    cases = {"motion": list(range(count)), "compression first": [count - 1] * count}
    apart = {}
    for case, poses in cases.items():
        cold = None
        for way, order in ways.items():
            number = {t: start + k for k, t in enumerate(order)}
            lines = [header, *(frames[t] | {"frame": number[t]} for t in order)]
            valleys = write_lines(ctx.tmp / "order.jsonl", lines)
            large = write_sequence(ctx.tmp / "order.json", folder / "truth" / "large-scale.json", [number[t] for t in order],
                                   np.array([flat[poses[t]] for t in order]))
            made = read_sequence(synthesise(ctx, folder, "order", large=large, valleys=valleys)[0])[1]
            if cold is None:
                cold = read_sequence(synthesise(ctx, folder, "order-cold", "--cold", large=large, valleys=valleys)[0])[1]
            apart[f"{case}, {way}"] = float(np.linalg.norm(made - cold[order], axis=2).max())
    yield metric("order_mm", max(apart.values()), 0.01, "lower", "mm", each=apart, frames=count, seed=ctx.seeds[0])


def score_converged(ctx, folder):
    """The default stop against one at a hundredth of its step."""
    last = known_frames(folder)[-1]
    frames = ("--frames", f"{last - 2}-{last}", "--cold")
    usual = read_sequence(synthesise(ctx, folder, "usual", *frames)[0])[1]
    fine = read_sequence(synthesise(ctx, folder, "fine", *frames, "--step", "2e-5")[0])[1]
    yield metric("converged_mm", float(np.linalg.norm(usual - fine, axis=2).max()), 0.01, "lower", "mm", seed=ctx.seeds[0], frames=3)


def score(ctx):
    folders = [true_take(ctx, seed) for seed in ctx.seeds]
    made = [synthesise(ctx, folder, "made") for folder in folders]
    yield from score_surface(ctx, folders, made)
    yield from score_between(ctx, folders)
    yield from score_converged(ctx, folders[0])
    yield from score_order(ctx, folders[0])
    yield from score_jitter(ctx, folders[0])
    yield from score_drift(ctx, folders[0])


# ---- speed ---------------------------------------------------------------------------------------------------------


def frame_seconds(summary, warm=False):
    """Seconds a frame, of those that start from the one before or of those that start anew."""
    seconds = summary["seconds"]
    count = WARM_FRAMES if warm else 1
    return seconds["synthesis-warm" if warm else "synthesis"] / count


def shell_hessian(rest, triangles):
    """JᵀJ of the shell's edges, areas and dihedral angles at rest, three unknowns a vertex: what one step solves with."""
    import scipy.sparse as sp

    rows, columns, values, count = [], [], [], 0

    def terms(vertices, slopes, weights):
        """vertices: T × N; slopes: T × N × 3."""
        nonlocal count
        total, n = vertices.shape
        rows.append(np.repeat(count + np.arange(total), 3 * n))
        columns.append((3 * vertices[:, :, None] + np.arange(3)).ravel())
        values.append((slopes * np.sqrt(weights)[:, None, None]).ravel())
        count += total

    corners = rest[triangles]
    opposite = np.roll(corners, 1, 1) - np.roll(corners, -1, 1)
    double = np.cross(opposite[:, 0], opposite[:, 1])
    areas = 0.5 * np.linalg.norm(double, axis=1)
    terms(triangles, 0.5 * np.cross(double[:, None] / (2 * areas)[:, None, None], opposite), 30_000 / areas)
    sides = np.concatenate([np.stack([triangles[:, i], triangles[:, (i + 1) % 3], triangles[:, (i + 2) % 3]], 1) for i in range(3)])
    key = np.sort(sides[:, :2], 1) @ np.array([len(rest), 1])
    order = np.argsort(key, kind="stable")
    unique, first, copies = np.unique(key[order], return_index=True, return_counts=True)
    ends = sides[order[first]][:, :2]
    along = rest[ends[:, 1]] - rest[ends[:, 0]]
    length = np.linalg.norm(along, axis=1)
    unit = along / length[:, None]
    terms(ends, np.stack([-unit, unit], 1), 300 / length)
    two = first[copies == 2]
    around = np.column_stack([sides[order[two]], sides[order[two + 1]][:, 2]])
    e, length = along[copies == 2], length[copies == 2]
    arms = [rest[around[:, 2 + i]] - rest[around[:, 0]] for i in (0, 1)]
    normals = [np.cross(e, arms[0]), np.cross(arms[1], e)]
    apex = [-n * (length / (n**2).sum(1))[:, None] for n in normals]
    foot = [((arm * e).sum(1) / length**2)[:, None] for arm in arms]
    ends = [-(apex[0] * (1 - foot[0]) + apex[1] * (1 - foot[1])), -(apex[0] * foot[0] + apex[1] * foot[1])]
    height = sum(np.linalg.norm(n, axis=1) for n in normals) / 2 / length / 3
    terms(around, np.stack([*ends, *apex], 1), 20 * length / height)
    jacobian = sp.csr_matrix((np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))), shape=(count, 3 * len(rest)))
    matrix = (2.0 * jacobian.T @ jacobian + 1e-3 * sp.identity(3 * len(rest))).tocsr()
    matrix.sort_indices()
    return matrix


def bench_step(ctx, vertices=20_000, repeats=5):
    """One linear solve of a region, ours against CHOLMOD's, the same matrix; one thread each, CPU seconds."""
    rest, triangles = operators.face_like(vertices, ctx.seeds[0])
    edges = np.linalg.norm(rest[triangles] - rest[np.roll(triangles, 1, 1)], axis=2)
    rest = rest * (0.3 / np.median(edges))
    handles = (3 * operators.spread_handles(rest, 30, 1)[:, None] + np.arange(3)).ravel()
    problem = operators.write_problem(ctx.tmp / "step.bin", np.repeat(rest, 3, 0), shell_hessian(rest, triangles), np.sort(handles))
    step = lambda run: operators.median(run["seconds"], "factor", 0) + operators.median(run["seconds"], "solve3", 0)
    runs = {"ours": [], **{kernel: [] for kernel in operators.KERNELS}}
    for _ in range(repeats):
        runs["ours"].append(operators.ours(ctx, problem))
        [runs[kernel].append(operators.peer(ctx, problem, kernel=kernel)) for kernel in operators.KERNELS]
    times = {name: float(np.median([step(run) for run in rows])) for name, rows in runs.items()}
    peer = min(times[kernel] for kernel in operators.KERNELS)
    yield metric("step_vs_cholmod", times["ours"] / peer, 0.40, "lower", "1", seconds=times, vertices=len(rest), unknowns=3 * len(rest),
                 timed="ours: analysis, factor, three columns; CHOLMOD: factor, three columns, its analysis left out",
                 peer="CHOLMOD + METIS, the better of two sets of OpenBLAS kernels", clock="CPU seconds, one thread each")


# The reach of valleys, in their widths, at which about 80 000 of 700 000 vertices are free.
REACH = ("--influence-widths", 1.55)
# Frames after one whose number is a multiple of eight: each starts from the one before.
WARM_FRAMES = 4


def bench_frames(ctx, folder, name, *options, repeats=3):
    """Seconds of a frame anew, of frames that start from the one before, and how many vertices were free."""
    first = next(frame for frame in reversed(known_frames(folder)[: -WARM_FRAMES]) if frame % 8 == 0)
    frames = ("--frames", f"{first}-{first + WARM_FRAMES}")
    made = [synthesise(ctx, folder, name, *frames, *options) for _ in range(repeats)]
    rows = [row for row in csv.DictReader(open(made[0][0].with_suffix(".csv")))]
    free = sum(int(row["free_vertices"]) for row in rows) / (WARM_FRAMES + 1)
    steps = {way: sum(int(row["steps"]) * int(row["free_vertices"]) for row in rows if row["warm"] == warm)
             / max(1, sum(int(row["free_vertices"]) for row in rows if row["warm"] == warm))
             for way, warm in (("cold", "false"), ("warm", "true"))}
    about = dict(free_vertices=round(free), steps_a_vertex=steps, clock="wall seconds a frame, two threads",
                 timed="valleys, constraints, regions, solve; no files")
    times = {way: [frame_seconds(summary, way == "warm") for _, summary in made] for way in ("cold", "warm")}
    return times, about, float(np.median([summary["seconds"]["prepare"] for _, summary in made]))


def bench(ctx):
    yield from bench_step(ctx)
    folder = true_take(ctx, ctx.seeds[0], "--vertices", 700_000, "--count", 12, name="fine")
    for suffix, options, targets in (("s", REACH, (2.5, 1.0)), ("default_reach_s", (), (None, None))):
        times, about, prepare = bench_frames(ctx, folder, "bench", *options)
        for (way, some), target in zip(times.items(), targets):
            yield metric(f"frame_{way}_{suffix}", float(np.median(some)), target, "lower" if target else None, "s", least=min(some),
                         largest=max(some), **about)
        yield metric(f"prepare_{suffix}", prepare, None, None, "s", once="a run")
    last = known_frames(folder)[-1]
    paper = synthesise(ctx, folder, "paper", "--frames", f"{last}-{last}", "--preset", "paper", *REACH)[1]
    yield metric("paper_solver_s", frame_seconds(paper), None, None, "s", **about)

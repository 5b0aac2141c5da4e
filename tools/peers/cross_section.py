"""Scores of `cross-section`: valleys measured in virtual takes, beside their true sections. And its speed.

The curves handed over are the true ones, moved across by up to two pixels along their length and without the truth's detail, as far off
as curves fitted to paint are. Where the skin lies is known, as after a first pass: the scan, carried by the true motion without wrinkles; beside it
stands what is reached without. The paper's model is measured on the same data.
"""

import json
import math
import random
import statistics

from _takes import WRINKLE_TEXTURE, lines, wrinkles, write_lines

SEEDS = [1, 2, 3, 4, 5, 6]
FAMILIES = {"s": "exact", "rounded": "rounded", "foreign": "foreign"}
REPEATS = 5
OFF_PX = 2.0


def metric(name, value, target, better, unit, **context):
    return {"metric": name, "value": value, "target": target, "better": better, "unit": unit, "context": context}


def moved(controls, rng):
    """Control points of a curve shifted across it: two slow waves, together never more than OFF_PX."""
    count = len(controls)
    waves = [(rng.uniform(0, 2 * math.pi), rng.uniform(0.5, 2.0)) for _ in range(2)]
    first, last = controls[0], controls[-1]
    length = math.hypot(last[0] - first[0], last[1] - first[1]) or 1.0
    across = (-(last[1] - first[1]) / length, (last[0] - first[0]) / length)

    def place(index, control):
        share = index / max(count - 1, 1)
        off = sum(0.5 * OFF_PX * math.sin(phase + 2 * math.pi * cycles * share) for phase, cycles in waves)
        return [control[0] + off * across[0], control[1] + off * across[1]]

    return [place(index, control) for index, control in enumerate(controls)]


def disturbed(ctx, folder, seed, still=False):
    """The true curves of a take, off by up to OFF_PX; `still`: off alike in all frames."""
    header, frames = lines(folder / "truth" / "wrinkles-2d.jsonl")
    for frame in frames:
        for camera, curves in frame["curves"].items():
            for wrinkle, curve in curves.items():
                key = f"{seed}-{camera}-{wrinkle}" + ("" if still else f"-{frame['frame']}")
                curve["controls"] = moved(curve["controls"], random.Random(key))
    return write_lines(ctx.tmp / f"{folder.name}-curves.jsonl", "wrinkles-2d/1", header, frames)


def geometry(ctx, folder):
    """What a first pass knows of the face: the scan in the space of the head, cameras, the head's pose, the motion without wrinkles."""
    mesh, truth = ctx.tmp / f"{folder.name}-head.obj", folder / "truth"
    if not mesh.exists():
        rbf = ctx.binary("rbf-warp")
        scan = ["--mesh", folder / "take" / "scan.obj", "--unit", "mm"]
        pairs, warp = ctx.tmp / f"{folder.name}-pairs.json", ctx.tmp / f"{folder.name}-warp.json"
        ctx.run([rbf, "correspond", *scan, "--picks", folder / "take" / "picks.csv", "--out", pairs])
        ctx.run([rbf, "fit", "--markers", truth / "head.jsonl", "--correspondence", pairs, *scan, "--out", warp])
        ctx.run([rbf, "apply", "--warp", warp, "--points", folder / "take" / "scan.obj", "--unit", "mm", "--inverse",
                 "--keep-unconverged", "--out", mesh])
    return ["--mesh", mesh, "--unit", "mm", "--cameras", truth / "cameras.json", "--head-pose", truth / "pose.jsonl",
            "--large-scale", truth / "large-scale.json"]


def measure(ctx, folder, curves, *args):
    """Sections of a take, and the summary."""
    out = ctx.tmp / f"{folder.name}.jsonl"
    words = [ctx.binary("cross-section"), "measure", "--take", folder / "take" / "take.json"]
    words += ["--sync", folder / "truth" / "sync.jsonl", "--wrinkles", curves, "--out", out]
    return out, ctx.run([*words, *args])


def scored(ctx, folder, sections):
    """Metrics by name."""
    rows = ctx.run([ctx.binary("virtual-rig"), "score", "sections", sections, "--truth", folder / "truth"])
    return {row["metric"].split("/")[1]: row for row in rows["results"]["metrics"]}


def value(row):
    return row["value"] if row else None


def median(rows, name):
    """The median over takes of a metric, and its values by seed."""
    by_seed = {seed: value(row.get(name)) for seed, row in rows.items()}
    known = [number for number in by_seed.values() if number is not None]
    return (statistics.median(known) if known else None), by_seed


def share(rows, name, count):
    """A share over all takes: each weighs as many wrinkle images as it has."""
    known = [row[name] for row in rows if value(row.get(name)) is not None]
    total = sum(row["context"][count] for row in known)
    return (sum(row["value"] * row["context"][count] for row in known) / total if total else None), total


def score(ctx):
    seeds = ctx.seeds or SEEDS
    ours, blind, papers = {}, {}, {}
    for family in FAMILIES:
        folders = {seed: wrinkles(ctx, "standard", seed, family=family) for seed in seeds}
        curves = {seed: disturbed(ctx, folder, seed) for seed, folder in folders.items()}
        known = lambda seed: measure(ctx, folders[seed], curves[seed], *geometry(ctx, folders[seed]))[0]
        ours[family] = {seed: scored(ctx, folders[seed], known(seed)) for seed in seeds}
        guess = lambda seed: measure(ctx, folders[seed], curves[seed])[0]
        blind[family] = {seed: scored(ctx, folders[seed], guess(seed)) for seed in seeds}
        paper = lambda seed: measure(ctx, folders[seed], curves[seed], "--model", "paper")[0]
        papers[family] = {seed: scored(ctx, folders[seed], paper(seed)) for seed in seeds}
    merged = {f"{family} {seed}": row for family, rows in ours.items() for seed, row in rows.items()}
    for name, target in [("crease_px", 0.2), ("crease_p90_px", 0.6)]:
        found, by_seed = median(merged, name)
        yield metric(name, found, target, "lower", "px", by_take=by_seed)
    wanted = [("s", "ratio_rel", 0.06), ("s", "width_rel", 0.10), ("rounded", "ratio_rel", 0.08), ("foreign", "ratio_rel", 0.12)]
    for family, name, target in wanted:
        found, by_seed = median(ours[family], name)
        p90 = median(ours[family], name.replace("_rel", "_p90"))[0]
        yield metric(f"{FAMILIES[family]}_{name}", found, target, "lower", "ratio", p90=p90, by_seed=by_seed)
    for name, target in [("rim_depth_rel", 0.12), ("rim_depth_p90", 0.30)]:
        found, by_seed = median(ours["foreign"], name)
        yield metric(f"foreign_{name.removeprefix('rim_')}", found, target, "lower", "ratio", by_seed=by_seed)
    for name, count, target in [("flat_rejected", "flat_wrinkles", 0.97), ("shallow_kept", "shallow_wrinkles", 0.95)]:
        found, total = share(merged.values(), name, count)
        context = {"wrinkle_images": total, "paint_texture": WRINKLE_TEXTURE}
        yield metric(name, found, target, "higher", "share", **context)
    alone = {f"{family} {seed}": row for family, rows in blind.items() for seed, row in rows.items()}
    for name in ["crease_px", "crease_p90_px", "ratio_rel", "width_rel"]:
        found, by_seed = median(alone, name)
        yield metric(f"without_geometry_{name}", found, None, None, "px" if name.endswith("px") else "ratio", by_take=by_seed)
    for family, name in FAMILIES.items():
        found, by_seed = median(papers[family], "ratio_rel")
        yield metric(f"paper_ratio_rel_{name}", found, None, None, "ratio", by_seed=by_seed)
    yield from jitter(ctx, seeds[0])


def jitter(ctx, seed):
    """How much the refined curve moves from frame to frame against the true one, with first curves that are off differently each time."""
    folder = wrinkles(ctx, "standard", seed, family="s")
    out, _ = measure(ctx, folder, disturbed(ctx, folder, seed))
    truth = {frame["frame"]: frame["sections"] for frame in lines(folder / "truth" / "sections.jsonl")[1]}
    last, changes = {}, []
    for frame in lines(out)[1]:
        for camera, found in frame["sections"].items():
            for wrinkle, sections in found.items():
                true = truth.get(frame["frame"], {}).get(camera, {}).get(wrinkle, [])
                off = offsets(sections, true)
                before = last.get((camera, wrinkle))
                changes += [abs(now - then) for now, then in zip(off, before or []) if now is not None and then is not None]
                last[camera, wrinkle] = off
    value = statistics.median(changes) / math.sqrt(2) if changes else None
    yield metric("curve_jitter_px", value, 0.15, "lower", "px", changes=len(changes), seed=seed,
                 measured="median change from frame to frame of the distance from the true crease, at ten places of each wrinkle, over √2")


def offsets(sections, true):
    """Signed distances of the measured crease from the true one at ten places, where d/w is 0.3 or more."""
    measured = [section for section in sections if section["state"] == "measured"]
    if not measured or len(true) < 10:
        return [None] * 10
    off = []
    for k in range(10):
        section = true[k * (len(true) - 1) // 9]
        if section["w_px"] <= 0 or section["d_px"] < 0.3 * section["w_px"]:
            off.append(None)
            continue
        gap = lambda other: math.dist(other["at"], section["at"])
        nearest = min(measured, key=gap)
        normal = nearest["normal"]
        off.append(sum((a - b) * n for a, b, n in zip(nearest["at"], section["at"], normal)) if gap(nearest) < 6 else None)
    return off


def bench(ctx):
    folder = wrinkles(ctx, "standard", 1, family="foreign")
    curves = folder / "truth" / "wrinkles-2d.jsonl"
    sections = sum(len(one) for frame in lines(folder / "truth" / "sections.jsonl")[1]
                   for camera in frame["sections"].values() for one in camera.values())
    for model, target in [("paper", 20), ("extended", 250)]:
        times = []
        for _ in range(REPEATS):
            _, summary = measure(ctx, folder, curves, "--model", model, "--threads", 1)
            # 12 wrinkles of 60 sections.
            times.append(1000 * summary["seconds"]["fit"] * 720 / summary["results"]["sections"])
        context = {"min_ms": min(times), "max_ms": max(times), "sections": sections, "threads": 1, "timed": "paint and fit of 720 sections; decoding apart"}
        yield metric(f"frame_ms_{model}", statistics.median(times), target, "lower", "ms", **context)

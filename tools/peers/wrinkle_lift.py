"""Scores of `wrinkle-lift`: valleys on the face beside the true ones of virtual takes.

First with everything true but the warp, which is fitted to the take's markers as a user would: what lifting itself gets wrong. Then with
curves and sections as `wrinkle-track` and `cross-section` measure them in the images: reported, it is theirs.
"""

import statistics

import cross_section
import wrinkle_track
from _takes import lines
from wrinkle_track import metric, scored, take_of

SEEDS = [1, 2, 3, 4]


def warp(ctx, folder):
    """The warp of a take, from its picks and the true markers in head space."""
    mesh = ["--mesh", folder / "take" / "scan.obj", "--unit", "mm"]
    pairs, out = ctx.tmp / f"{folder.name}-pairs.json", ctx.tmp / f"{folder.name}-warp.json"
    program = ctx.binary("rbf-warp")
    ctx.run([program, "correspond", *mesh, "--picks", folder / "take" / "picks.csv", "--out", pairs])
    ctx.run([program, "fit", "--markers", folder / "truth" / "head.jsonl", "--correspondence", pairs, *mesh, "--out", out])
    return out


def lift(ctx, folder, warp, sections, *words):
    """Valleys, and the summary."""
    truth, out = folder / "truth", ctx.tmp / f"{folder.name}-valleys.jsonl"
    call = [ctx.binary("wrinkle-lift"), "run", "--mesh", folder / "take" / "scan.obj", "--unit", "mm", "--large-scale", truth / "large-scale.json"]
    call += ["--warp", warp, "--head-pose", truth / "pose.jsonl", "--cameras", truth / "cameras.json", "--sync", truth / "sync.jsonl"]
    return out, ctx.run([*call, "--sections", sections, "--out", out, *words])


def measured(ctx, folder):
    """Sections as the stages before find them in the images."""
    model, _ = wrinkle_track.train(ctx, folder)
    curves, _ = wrinkle_track.track(ctx, folder, model)
    return cross_section.measure(ctx, folder, curves)[0]


def pooled(rows, name):
    """The median over takes, and the values by seed."""
    by_seed = {seed: row[name]["value"] for seed, row in rows.items()}
    known = [value for value in by_seed.values() if value is not None]
    return (statistics.median(known) if known else None), by_seed


TARGETS = [
    ("position_mm", 0.03, "lower", "mm"),
    ("position_p90_mm", 0.1, "lower", "mm"),
    ("depth_rel", 0.01, "lower", "ratio"),
    ("depth_p90", 0.05, "lower", "ratio"),
    ("width_rel", 0.01, "lower", "ratio"),
    ("width_p90", 0.05, "lower", "ratio"),
    ("coverage", 0.99, "higher", "share"),
    ("missing", 0, "equal", "count"),
    ("false_valleys", 0, "equal", "count"),
]


def score(ctx):
    seeds = ctx.seeds or SEEDS
    folders = {seed: take_of(ctx, seed) for seed in seeds}
    warps = {seed: warp(ctx, folder) for seed, folder in folders.items()}
    true = lambda folder: folder / "truth" / "sections.jsonl"
    exact, paper, found, apart, drift = {}, {}, {}, {}, {}
    for seed, folder in folders.items():
        valleys, summary = lift(ctx, folder, warps[seed], true(folder))
        exact[seed] = scored(ctx, folder, "valleys", valleys)
        apart[seed] = summary["results"]["apart_p90_mm"]
        valleys, _ = lift(ctx, folder, warps[seed], true(folder), "--no-parallax")
        paper[seed] = scored(ctx, folder, "valleys", valleys)
    for name, target, better, unit in TARGETS:
        value, by_seed = pooled(exact, name)
        yield metric(name, value, target, better, unit, by_seed=by_seed)
    yield metric("cameras_apart_p90_mm", statistics.median(apart.values()), 0.15, "lower", "mm", by_seed=apart)
    for name in ["position_mm", "position_p90_mm"]:
        value, by_seed = pooled(paper, name)
        yield metric(f"no_parallax_{name}", value, None, None, "mm", by_seed=by_seed)
    theirs, apart = {}, {}
    for seed, folder in folders.items():
        sections = measured(ctx, folder)
        theirs[seed] = scored(ctx, folder, "sections", sections)
        valleys, summary = lift(ctx, folder, warps[seed], sections)
        found[seed] = scored(ctx, folder, "valleys", valleys)
        apart[seed], drift[seed] = summary["results"]["apart_mm"], summary["results"]["drift_mm"]
    for name, _, _, unit in TARGETS:
        value, by_seed = pooled(found, name)
        beside = {key: pooled(theirs, key)[0] for key in ["ratio_rel", "width_rel", "crease_px"]} if name.endswith("_mm") else {}
        yield metric(f"measured_{name}", value, None, None, unit, by_seed=by_seed, **{f"sections_{key}": one for key, one in beside.items()})
    yield metric("measured_cameras_apart_mm", statistics.median(apart.values()), None, None, "mm", by_seed=apart)
    yield metric("measured_drift_mm", statistics.median(drift.values()), None, None, "mm", by_seed=drift)


def bench(ctx):
    folder = take_of(ctx, 1)
    frames = len(lines(folder / "truth" / "sections.jsonl")[1])
    _, summary = lift(ctx, folder, warp(ctx, folder), folder / "truth" / "sections.jsonl", "--threads", 1)
    seconds, results = summary["seconds"], summary["results"]
    context = {"frames": frames, "sections": results["sections"], "threads": 1}
    yield metric("carry_back_s", seconds["carry back"] / frames, None, None, "s", timed="inverse of the warp at 143 000 vertices, tree of boxes; per frame", **context)
    yield metric("section_ms", 1000 * seconds["lift"] / results["sections"], None, None, "ms", timed="casts, lengths, merge; per section", **context)

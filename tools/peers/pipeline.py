"""Numbers of the whole: from the footage of eight cameras to wrinkled meshes, by `tools/take`, with nothing handed over that a user would
not bring. On virtual takes; each intermediate beside its truth.

Not known to the run: cameras (boards are filmed), time (stamps), names of the wrinkles (none are given). Known, as from a user: the
markers' names in one frame, where they sit on the scan, the paint marked in one image of each wrinkle camera.
"""

import json
import os
import shutil
import statistics
import subprocess
import sys
from pathlib import Path

import numpy as np

from _takes import make

SEEDS = [1, 2, 3]
FEATURES = "virtual-rig/video,capture-sync/video,calibrate/detect,calibrate/video"
STAGES = ("virtual-rig capture-sync calibrate marker-track triangulate stabilize rbf-warp linear-shell wrinkle-track cross-section "
          "wrinkle-edit wrinkle-lift shell-synth preview").split()
SCENARIO = "fixtures/demo-face/scenario.json"
FINE = 700_000
# Surfaces are scored in every so-manyth frame, which takes seconds each, from the first with wrinkles on; not only in those with images.
LEAD, EVERY = 8, 6


def metric(name, value, target, better, unit, **context):
    return {"metric": name, "value": value, "target": target, "better": better, "unit": unit, "context": context}


def binaries(ctx):
    """The folder of all stages, with what finds boards in pictures."""
    if os.environ.get("FURROW_BIN"):
        return Path(os.environ["FURROW_BIN"])
    words = ["cargo", "build", "--release", "--locked", "--quiet", "--bins", "--features", FEATURES]
    words += [word for stage in STAGES for word in ("--package", stage)]
    if subprocess.run(words, cwd=ctx.root).returncode != 0:
        raise ctx.Failed("the stages do not build")
    return ctx.root / "target" / "release"


def take_of(ctx, seed):
    return make(ctx, f"demo-{seed}", "--scenario", ctx.root / SCENARIO, "--seed", seed, "--no-normals")


def processed(ctx, take, name, *words):
    """A run of tools/take."""
    out = ctx.tmp / name
    environment = os.environ | {"FURROW_BIN": str(binaries(ctx))}
    call = [ctx.root / "tools" / "take", take, out, "--head-markers", "head_*", *words]
    done = subprocess.run([str(word) for word in call], env=environment, capture_output=True, text=True)
    if done.returncode != 0:
        raise ctx.Failed("\n".join(done.stderr.strip().splitlines()[-5:]))
    return out


def scored(ctx, kind, result, truth, *words):
    """Metrics of a result by name."""
    call = [binaries(ctx) / "virtual-rig", "score", kind, result, "--truth", truth, *words]
    return {row["metric"].split("/")[1]: row["value"] for row in ctx.run(call)["results"]["metrics"]}


def surface_scores(ctx, out, truth, against):
    """Scores of the wrinkled surface in every so-manyth frame, pooled: errors over errors, the rest in the median."""
    made, frames = out / "medium-scale" / "wrinkled.json", json.loads((truth / "wrinkled.json").read_text())["data"]["frames"]
    rows = [scored(ctx, "wrinkled", made, truth, "--against", against, "--frames", f"{frame}-{frame}") for frame in frames[LEAD::EVERY]]
    rows = [row for row in rows if row["region_error_ratio"]]
    pooled = {}
    for ratio, rms in (("region_error_ratio", "region_rms_mm"), ("region_raw_ratio", "region_raw_rms_mm")):
        errors = sum(row[rms] ** 2 for row in rows)
        pooled[ratio] = (errors / sum((row[rms] / row[ratio]) ** 2 for row in rows)) ** 0.5
        pooled[rms] = (errors / len(rows)) ** 0.5
    for name in ("valley_depth_rel", "bulge_height_rel"):
        known = [row[name] for row in rows if row[name] is not None]
        pooled[name] = statistics.median(known) if known else None
    return pooled | {"frames": len(rows)}


def valley_scores(ctx, out, truth):
    """Scores of the valleys, in the frames that have images, under the truth's names by where they lie."""
    words = [ctx.root / "tools" / "same-wrinkles", out / "medium-scale" / "valleys.jsonl", "--truth", truth, out / "as-truth"]
    subprocess.run([str(word) for word in words], capture_output=True, check=True)
    return scored(ctx, "valleys", out / "as-truth" / "valleys.jsonl", out / "as-truth" / "truth")


def measured(trajectories):
    """Places by frame and marker."""
    header, frames, points, status = trajectories
    return {(int(frame), marker): points[f, m] for f, frame in enumerate(frames) for m, marker in enumerate(header["markers"])
            if status[f, m] == "measured" and np.isfinite(points[f, m]).all()}


def marker_rms(ctx, out, truth):
    """RMS distance of the measured markers from the true ones, mm, after one rigid motion of the whole take, without scale: boards do not
    know where the world's origin is."""
    sys.path.insert(0, str(ctx.root / "tools" / "readers"))
    import trajectories_3d

    made, true = (measured(trajectories_3d.read(path)) for path in (out / "capture" / "markers.jsonl", truth / "markers.jsonl"))
    keys = sorted(made.keys() & true.keys())
    a, b = (np.array([points[key] for key in keys]) for points in (made, true))
    u, _, vt = np.linalg.svd((a - a.mean(0)).T @ (b - b.mean(0)))
    rotation = u @ np.diag([1, 1, np.sign(np.linalg.det(u @ vt))]) @ vt
    off = (a - a.mean(0)) @ rotation - (b - b.mean(0))
    return float(np.sqrt((off**2).sum(1).mean())), len(keys)


# Steps that draw, though a run without pictures does them.
DRAWING = ("capture/show", "wrinkles/curves", "wrinkles/picture-", "wrinkles/light-")


def seconds(ctx, out):
    """Wall and processor seconds by step, pictures and scores left out."""
    rows = subprocess.run([ctx.root / "tools" / "take-report", "--seconds", out], capture_output=True, text=True, check=True).stdout
    found = [(name, float(wall), float(cpu)) for name, wall, cpu in map(str.split, rows.splitlines())]
    working = [row for row in found if row[0].split("/")[0] in ("capture", "large-scale", "wrinkles", "medium-scale")]
    return [row for row in working if not row[0].startswith(DRAWING)]


def folder_bytes(folder):
    return sum(path.lstat().st_size for path in Path(folder).rglob("*") if path.is_file() and not path.is_symlink())


def median(rows, name):
    by_seed = {seed: row[name] for seed, row in rows.items()}
    known = [value for value in by_seed.values() if value is not None]
    return (statistics.median(known) if known else None), by_seed


def score(ctx):
    markers, samples, valleys, surfaces, own, larges = {}, {}, {}, {}, {}, {}
    for seed in ctx.seeds or SEEDS:
        folder = take_of(ctx, seed)
        truth, out = folder / "truth", processed(ctx, folder, f"run-{seed}", "--no-pictures")
        markers[seed], samples[seed] = marker_rms(ctx, out, truth)
        larges[seed] = scored(ctx, "large-scale", out / "large-scale" / "large-scale.json", truth)
        valleys[seed] = valley_scores(ctx, out, truth)
        # Over the error of the TRUE surface without wrinkles, so that a bad large-scale result does not help.
        surfaces[seed] = surface_scores(ctx, out, truth, truth / "large-scale.json")
        own[seed] = surface_scores(ctx, out, truth, out / "large-scale" / "large-scale.json")
        shutil.rmtree(out)
    yield metric("marker_rms_mm", max(markers.values()), 0.1, "lower", "mm", by_seed=markers, samples=samples, pooled="the worst seed")
    value, by_seed = median(valleys, "depth_rel")
    yield metric("depth_median_rel", value, 0.25, "lower", "ratio", by_seed=by_seed, p90=median(valleys, "depth_p90")[0])
    value, by_seed = median(surfaces, "region_error_ratio")
    yield metric("region_error_ratio", value, 0.60, "lower", "ratio", by_seed=by_seed, over="the true surface without wrinkles",
                 region_rms_mm=median(surfaces, "region_rms_mm")[1])
    for name, rows, key, unit in [("region_over_own_large_scale", own, "region_error_ratio", "ratio"), ("region_raw_ratio", own, "region_raw_ratio", "ratio"),
                                  ("bulge_height_rel", own, "bulge_height_rel", "ratio"), ("surface_depth_rel", own, "valley_depth_rel", "ratio"),
                                  ("valley_position_mm", valleys, "position_mm", "mm"), ("valley_width_rel", valleys, "width_rel", "ratio"),
                                  ("valley_coverage", valleys, "coverage", "share"), ("valleys_missing", valleys, "missing", "count"),
                                  ("valleys_false", valleys, "false_valleys", "count"), ("large_scale_mean_mm", larges, "mean_mm", "mm")]:
        value, by_seed = median(rows, key)
        yield metric(name, value, None, None, unit, by_seed=by_seed)


def fine_take(ctx, seed):
    """The footage of a take beside a scan of the same face with 700 000 vertices."""
    filmed, folder = take_of(ctx, seed), ctx.tmp / "fine"
    fine = make(ctx, f"demo-scan-{seed}", "--scenario", ctx.root / SCENARIO, "--seed", seed, "--no-normals", "--no-footage", "--no-calibration",
                "--vertices", FINE, "--count", 3)
    folder.mkdir()
    for path in (filmed / "take").iterdir():
        if path.name not in ("take.json", "scan.obj", "picks.csv"):
            (folder / path.name).symlink_to(path)
    for name in ("scan.obj", "picks.csv"):
        (folder / name).symlink_to(fine / "take" / name)
    take = json.loads((filmed / "take" / "take.json").read_text())
    take["data"]["references"].pop("scan", None)
    (folder / "take.json").write_text(json.dumps(take))
    return folder, take["data"]


def bench(ctx):
    seed = (ctx.seeds or SEEDS)[0]
    folder = take_of(ctx, seed)
    rows = seconds(ctx, processed(ctx, folder, "demo", "--no-pictures"))
    wall, cpu = sum(row[1] for row in rows), sum(row[2] for row in rows)
    longest = {name: wall for name, wall, _ in sorted(rows, key=lambda row: -row[1])[:6]}
    yield metric("demo_min", wall / 60, 4.0, "lower", "min", cores=os.cpu_count(), longest_s=longest,
                 timed="all stages from images to wrinkled meshes; not the filming, pictures and scores")
    yield metric("demo_processor_min", cpu / 60, None, None, "min", timed="the same, by the clock of the processors")
    fine, take = fine_take(ctx, seed)
    out = processed(ctx, fine, "fine-run", "--no-pictures")
    rows = seconds(ctx, out)
    frames = len(json.loads((out / "large-scale" / "large-scale.json").read_text())["data"]["frames"])
    footage_s = frames * take["rate"]["seconds"] / take["rate"]["frames"]
    # Boards, training and the factor are once a session or scan; what grows with the footage is the rest.
    once = ("capture/corners", "capture/board", "wrinkles/train", "large-scale/correspondence", "large-scale/warp", "wrinkles/ground")
    growing = [row for row in rows if row[0] not in once]
    longest = {name: wall for name, wall, _ in sorted(growing, key=lambda row: -row[1])[:6]}
    yield metric("footage_ratio", sum(row[1] for row in growing) / footage_s, 45, "lower", "s/s", vertices=FINE, footage_s=footage_s,
                 with_what_is_done_once=sum(row[1] for row in rows) / footage_s, longest_s=longest)
    yield metric("footage_processor_ratio", sum(row[2] for row in growing) / footage_s, None, None, "s/s", vertices=FINE)
    yield metric("disk_gb_per_min", folder_bytes(out) / 1e9 / (footage_s / 60), None, None, "GB/min", vertices=FINE, footage="not counted")

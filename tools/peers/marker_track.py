"""Scores of `marker-track`: dots found, named and placed, beside the truth of virtual takes. And its speed, beside OpenCV.

The peer does what the stage does per image: find the pixels of the paint's colour, connected components, a centroid per
component.
"""

import statistics
import time

import cv2
import numpy as np

from _takes import mocap

SEEDS = [1, 2, 3, 4, 5, 6]
REPEATS = 5


def metric(name, value, target, better, unit, **context):
    return {"metric": name, "value": value, "target": target, "better": better, "unit": unit, "context": context}


def track(ctx, folder, *args, to="tracks"):
    """Tracks of a take, and the summary."""
    out = ctx.tmp / f"{folder.name}-{to}.jsonl"
    words = [ctx.binary("marker-track"), "track", "--take", folder / "take" / "take.json"]
    words += ["--sync", folder / "truth" / "sync.jsonl", "--labels", folder / "take" / "labels.json", "--out", out]
    return out, ctx.run([*words, *args])


def scored(ctx, folder, tracks):
    """Metrics by name."""
    rows = ctx.run([ctx.binary("virtual-rig"), "score", "tracks-2d", tracks, "--truth", folder / "truth"])
    return {row["metric"].split("/")[1]: row["value"] for row in rows["results"]["metrics"]}


def plain(ctx, scenario, seed):
    """A first pass."""
    folder = mocap(ctx, scenario, seed)
    return scored(ctx, folder, track(ctx, folder)[0])


def hard(ctx, seed):
    """Metrics of a first pass, of a second one that its own 3D markers guide, and of one that the true ones guide."""
    folder = mocap(ctx, "hard", seed)
    cameras = folder / "truth" / "cameras.json"
    first, _ = track(ctx, folder)
    markers = ctx.tmp / f"{folder.name}-markers.jsonl"
    ctx.run([ctx.binary("triangulate"), "--cameras", cameras, "--tracks", first, "--out", markers])
    guided = lambda guide, to: track(ctx, folder, "--guide", guide, "--cameras", cameras, to=to)[0]
    second, best = guided(markers, "second"), guided(folder / "truth" / "markers.jsonl", "true")
    return [scored(ctx, folder, tracks) for tracks in (first, second, best)]


def score(ctx):
    seeds = ctx.seeds or SEEDS
    standard = {seed: plain(ctx, "standard", seed) for seed in seeds}
    by = lambda rows, name: {seed: row[name] for seed, row in rows.items()}
    yield metric("swaps", sum(by(standard, "swaps").values()), 0, "lower", "count", by_seed=by(standard, "swaps"))
    yield metric("recall", min(by(standard, "recall").values()), 0.995, "higher", "share", by_seed=by(standard, "recall"))
    yield metric("rms_px", max(by(standard, "rms_px").values()), 0.10, "lower", "px", by_seed=by(standard, "rms_px"))
    passes = {seed: hard(ctx, seed) for seed in seeds}
    first, second, best = [{seed: rows[k] for seed, rows in passes.items()} for k in range(3)]
    for name, total, target, better, unit in (("swaps", sum, 0, "lower", "count"), ("recall", min, 0.98, "higher", "share")):
        context = {"guide": "the first pass's own 3D markers, true cameras", "by_seed": by(second, name)}
        context |= {"first_pass": by(first, name), "guided_by_the_truth": by(best, name)}
        yield metric(f"hard_{name}", total(by(second, name).values()), target, better, unit, **context)


def peer(images):
    """Seconds for the same detection with OpenCV."""
    start = time.perf_counter()
    for image in images:
        hsv = cv2.cvtColor(image, cv2.COLOR_BGR2HSV)
        mask = cv2.inRange(hsv, (105, 80, 20), (125, 255, 255))
        count, labels, stats, _ = cv2.connectedComponentsWithStats(mask, connectivity=4)
        for left, top, width, height, area in stats[1:count]:
            if area >= 4:
                part = slice(top, top + height), slice(left, left + width)
                cv2.moments((labels[part] > 0).astype(np.uint8) * hsv[part][..., 1])
    return time.perf_counter() - start


def bench(ctx):
    folder = mocap(ctx, "standard", 1)
    cameras = sorted((folder / "take" / "footage").glob("m?"))
    images = [cv2.imread(str(path)) for camera in cameras for path in sorted(camera.glob("*.png"))[:50]]
    cv2.setNumThreads(1)
    ours, theirs = [], []
    for _ in range(REPEATS):
        _, summary = track(ctx, folder, "--threads", 1)
        # The labelled image of each camera is no step.
        seconds = summary["seconds"]["track"] + summary["seconds"]["name"]
        ours.append(seconds / (summary["results"]["images"] - len(cameras)))
        theirs.append(peer(images) / len(images))
    each = statistics.median(ours)
    context = {"min_s": min(ours), "max_s": max(ours), "timed": "predict, find, measure, assign, name; decoding apart", "threads": 1}
    yield metric("frames_per_s_core", 1 / each, 400, "higher", "1/s", **context)
    ratio = each / statistics.median(theirs)
    peer_context = {"peer": f"OpenCV {cv2.__version__}", "peer_s": theirs, "peer_does": "HSV, inRange, connectedComponentsWithStats, moments"}
    yield metric("vs_opencv", ratio, 1.0, "lower", "ratio", **context, **peer_context)

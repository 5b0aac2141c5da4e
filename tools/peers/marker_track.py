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


def track(ctx, folder, *args):
    """Tracks of a take, and the summary."""
    out = ctx.tmp / f"{folder.name}.jsonl"
    words = [ctx.binary("marker-track"), "track", "--take", folder / "take" / "take.json"]
    words += ["--sync", folder / "truth" / "sync.jsonl", "--labels", folder / "take" / "labels.json", "--out", out]
    return out, ctx.run([*words, *args])


def scored(ctx, scenario, seed, guided):
    """Metrics by name."""
    folder = mocap(ctx, scenario, seed)
    guide = ["--guide", folder / "truth" / "markers.jsonl", "--cameras", folder / "truth" / "cameras.json"]
    tracks, _ = track(ctx, folder, *(guide if guided else []))
    rows = ctx.run([ctx.binary("virtual-rig"), "score", "tracks-2d", tracks, "--truth", folder / "truth"])
    return {row["metric"].split("/")[1]: row["value"] for row in rows["results"]["metrics"]}


def score(ctx):
    seeds = ctx.seeds or SEEDS
    plain = {seed: scored(ctx, "standard", seed, False) for seed in seeds}
    by = lambda rows, name: {seed: row[name] for seed, row in rows.items()}
    yield metric("swaps", sum(by(plain, "swaps").values()), 0, "lower", "count", by_seed=by(plain, "swaps"))
    yield metric("recall", min(by(plain, "recall").values()), 0.995, "higher", "share", by_seed=by(plain, "recall"))
    yield metric("rms_px", max(by(plain, "rms_px").values()), 0.10, "lower", "px", by_seed=by(plain, "rms_px"))
    hard = {seed: scored(ctx, "hard", seed, True) for seed in seeds}
    context = {"guide": "the true 3D markers"}
    yield metric("hard_swaps", sum(by(hard, "swaps").values()), 0, "lower", "count", by_seed=by(hard, "swaps"), **context)
    yield metric("hard_recall", min(by(hard, "recall").values()), 0.98, "higher", "share", by_seed=by(hard, "recall"), **context)


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

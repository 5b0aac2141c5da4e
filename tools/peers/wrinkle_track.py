"""Scores of `wrinkle-track`: painted pixels, ids and curves, beside the truth of virtual takes. And its classifier, beside independent
solvers of the same problem.

Wrinkles are named as a user would: places on their paint in the first image, from the true curves there.
"""

import csv
import json
import statistics
import sys
import time

import numpy as np

from _takes import lines, wrinkles

SEEDS = [1, 2, 3, 4, 5, 6]
# The form of the folds changes with the seed; wrinkles-track should not care.
FAMILIES = ["foreign", "s", "rounded"]
REPEATS = 5


def metric(name, value, target, better, unit, **context):
    return {"metric": name, "value": value, "target": target, "better": better, "unit": unit, "context": context}


def take_of(ctx, seed):
    return wrinkles(ctx, "standard", seed, family=FAMILIES[(seed - 1) % len(FAMILIES)])


def readers(ctx):
    """The folder of readers, to import from."""
    folder = str(ctx.root / "tools" / "readers")
    if folder not in sys.path:
        sys.path.insert(0, folder)


def source(folder):
    return ["--take", folder / "take" / "take.json", "--sync", folder / "truth" / "sync.jsonl"]


def names(ctx, folder):
    """A table of names: places along the true curves of the first image of each camera that lie well on marked paint."""
    import cv2

    readers(ctx)
    import wrinkles_2d

    _, frames = wrinkles_2d.read(folder / "truth" / "wrinkles-2d.jsonl")
    path = ctx.tmp / f"{folder.name}-names.csv"
    with open(path, "w", newline="") as file:
        table = csv.writer(file)
        table.writerow(["camera", "x", "y", "wrinkle"])
        for camera, curves in frames[min(frames)].items():
            mask = cv2.imread(str(folder / "take" / "paint-mask" / f"{camera}.png")).any(axis=2)
            for wrinkle, curve in curves.items():
                places, _, _ = wrinkles_2d.evaluate(curve, np.linspace(0, len(curve["controls"]) - 3, 40))
                for x, y in places:
                    column, row = round(x), round(y)
                    inside = 0 <= row < mask.shape[0] and 0 <= column < mask.shape[1]
                    if inside and mask[row, column]:
                        table.writerow([camera, round(x, 1), round(y, 1), wrinkle])
    return path


def train(ctx, folder, *words):
    out = ctx.tmp / f"{folder.name}-model.json"
    words = [ctx.binary("wrinkle-track"), "train", *source(folder), "--masks", folder / "take" / "paint-mask", "--out", out, *words]
    return out, ctx.run(words)


def track(ctx, folder, model, *words):
    out = ctx.tmp / f"{folder.name}-wrinkles.jsonl"
    words = [ctx.binary("wrinkle-track"), "track", *source(folder), "--masks", folder / "take" / "paint-mask", "--model", model,
             "--names", names(ctx, folder), "--out", out, *words]
    return out, ctx.run(words)


def scored(ctx, folder, kind, result, *words):
    summary = ctx.run([ctx.binary("virtual-rig"), "score", kind, result, "--truth", folder / "truth", *words])
    return {row["metric"].split("/")[1]: row for row in summary["results"]["metrics"]}


def score(ctx):
    seeds = ctx.seeds or SEEDS
    pixels, bias, curves, checks = {}, {}, {}, {}
    for seed in seeds:
        folder = take_of(ctx, seed)
        model, summary = train(ctx, folder)
        checks[seed] = {paint: round(row["score"], 5) for paint, row in summary["results"]["paints"].items()}
        masks = ctx.tmp / f"masks-{seed}"
        ctx.run([ctx.binary("wrinkle-track"), "apply", *source(folder), "--model", model, "--camera", "w1,w2", "--white", "--out", masks])
        # The marked image is the first; later ones count.
        later = f"{lines(folder / 'truth' / 'wrinkles-2d.jsonl')[1][0]['frame'] + 1}-999999"
        rows = scored(ctx, folder, "masks", masks, "--frames", later)
        pixels[seed], bias[seed] = rows["pixel_f1"], rows["edge_bias_px"]
        found, _ = track(ctx, folder, model)
        curves[seed] = scored(ctx, folder, "wrinkles-2d", found)
    value = lambda rows: {seed: row["value"] for seed, row in rows.items()}
    masks = {seed: row["context"]["masks"] for seed, row in pixels.items()}
    yield metric("pixel_f1", min(value(pixels).values()), 0.97, "higher", "share", by_seed=value(pixels), masks=masks, cross_validated=checks)
    signed = {seed: row["context"]["bias_px"] for seed, row in bias.items()}
    yield metric("edge_bias_px", max(value(bias).values()), 0.2, "lower", "px", by_seed=signed)
    by = lambda name: {seed: rows[name]["value"] for seed, rows in curves.items()}
    yield metric("id_errors", sum(by("id_errors").values()), 0, "equal", "count", by_seed=by("id_errors"))
    for name, unit in [("curve_px", "px"), ("curve_p90_px", "px"), ("coverage", "share"), ("missing", "count"), ("false_curves", "count")]:
        yield metric(name, statistics.median(by(name).values()), None, None, unit, by_seed=by(name), counts="of the first valley curves, before cross-section")

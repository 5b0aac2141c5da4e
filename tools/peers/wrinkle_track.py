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
    diffs = {seed: decision_diffs(ctx, seed) for seed in seeds}
    worst = max(diff for found in diffs.values() for diff in found.values())
    peer = "active sets, dense linear systems, conditions of optimality checked to 1e-10"
    yield metric("svm_decision_diff", worst, 1e-6, "lower", "decision", by_seed=diffs, solver=peer)
    by = lambda name: {seed: rows[name]["value"] for seed, rows in curves.items()}
    yield metric("id_errors", sum(by("id_errors").values()), 0, "equal", "count", by_seed=by("id_errors"))
    for name, unit in [("curve_px", "px"), ("curve_p90_px", "px"), ("coverage", "share"), ("missing", "count"), ("false_curves", "count")]:
        yield metric(name, statistics.median(by(name).values()), None, None, unit, by_seed=by(name), counts="of the first valley curves, before cross-section")


# ---------------------------------------------------------------- the classifier beside other solvers


def gaussian(gamma, a, b):
    squared = (a**2).sum(axis=1)[:, None] + (b**2).sum(axis=1) - 2 * a @ b.T
    return np.exp(-gamma * np.maximum(squared, 0.0))


def exact(places, signs, c, gamma):
    """Support, coefficients and bias of the squared-hinge machine, by active sets: each set is one linear system, solved densely.
    The conditions of optimality are checked; where they hold, the solution is the only one, however it was found."""
    kernel = gaussian(gamma, places, places) + np.eye(len(signs)) / c
    active = np.ones(len(signs), bool)
    for _ in range(1000):
        index = np.flatnonzero(active)
        system = np.zeros((len(index) + 1, len(index) + 1))
        system[:-1, :-1] = kernel[np.ix_(index, index)]
        system[:-1, -1] = system[-1, :-1] = 1.0
        solved = np.linalg.solve(system, np.append(signs[index], 0.0))
        coefficients, bias = solved[:-1], solved[-1]
        wrong = coefficients * signs[index] <= 0.0
        if wrong.any():
            # The worst first: those that were dropped for others' sake come back below.
            limit = np.median((coefficients * signs[index])[wrong])
            active[index[wrong & (coefficients * signs[index] <= limit)]] = False
            continue
        margins = signs * (kernel[:, index] @ coefficients + bias)
        margins[index] = 1.0
        if margins.min() >= 1.0 - 1e-10:
            return places[index], coefficients, bias
        active[np.argmin(margins)] = True
    raise RuntimeError("the active sets do not settle")


def problem(folder, paint):
    """Places and signs of a paint's training pixels."""
    table = np.loadtxt(folder / f"{paint}.csv", delimiter=",", skiprows=1)
    return table[:, :2], np.where(table[:, 2] > 0, 1.0, -1.0)


def image_ratios(ctx, folder, number, floor):
    """Log ratios of all pixels of an image of the first wrinkle camera."""
    import cv2

    import paint_model

    code = cv2.imread(str(folder / "take" / "footage" / "w1" / f"{number:06}.png"))[:, :, ::-1].reshape(-1, 3) / 255
    light = np.where(code <= 0.04045, code / 12.92, ((code + 0.055) / 1.055) ** 2.4)
    return paint_model.ratios(light, floor)


def decision_diffs(ctx, seed):
    """Largest difference of decisions, over all training pixels and a sample of a later image."""
    readers(ctx)
    import paint_model

    folder = take_of(ctx, seed)
    samples = ctx.tmp / f"samples-{seed}"
    model, _ = train(ctx, folder, "--samples", samples)
    floor, paints = paint_model.read(model)
    others = image_ratios(ctx, folder, 17, floor)[::331]
    found = {}
    for name, paint in paints.items():
        places, signs = problem(samples, name)
        support, coefficients, bias = exact(places, signs, paint["c"], paint["gamma"])
        at = np.concatenate([places, others])
        ours = paint_model.decisions(paint, at)
        theirs = gaussian(paint["gamma"], at, support) @ coefficients + bias
        found[name] = float(np.abs(ours - theirs).max())
    return found


def bench(ctx):
    import sklearn
    from sklearn.svm import SVC

    readers(ctx)
    import paint_model

    folder = take_of(ctx, 1)
    samples = ctx.tmp / "samples-bench"
    model, _ = train(ctx, folder, "--samples", samples)
    floor, paints = paint_model.read(model)
    machines = []
    for name, paint in paints.items():
        places, signs = problem(samples, name)
        machines.append(SVC(C=paint["c"], gamma=paint["gamma"]).fit(places, signs))
    frames = lines(folder / "truth" / "wrinkles-2d.jsonl")[1]
    number, index = frames[17]["frame"], 17
    pixels = image_ratios(ctx, folder, index, floor)
    ones, each, theirs = [], [], []
    for repeat in range(REPEATS):
        words = [ctx.binary("wrinkle-track"), "apply", *source(folder), "--model", model, "--camera", "w1", "--threads", 1]
        ones.append(ctx.run([*words, "--range", f"{number}-{number}", "--out", ctx.tmp / f"one-{repeat}"])["seconds"])
        whole = ctx.run([*words, "--out", ctx.tmp / f"all-{repeat}"])
        each.append(whole["seconds"]["classify"] / whole["results"]["images"])
        if repeat < 3:
            start = time.perf_counter()
            for machine in machines:
                machine.predict(pixels)
            theirs.append(time.perf_counter() - start)
    context = {"threads": 1, "paints": len(paints)}
    cold = [one["classify"] + one["tidy"] for one in ones]
    timed = "one image of 1384 x 1038 px from a cold start: bounds, tables, look-ups, opening and closing; decoding apart"
    yield metric("apply_s", statistics.median(cold), 0.1, "lower", "s", min_s=min(cold), max_s=max(cold), timed=timed, **context)
    ratio = statistics.median(each) / statistics.median(theirs)
    peer = {"peer": f"scikit-learn {sklearn.__version__}", "peer_s": theirs, "support": [int(m.n_support_.sum()) for m in machines],
            "peer_does": "SVC.predict per paint, on all pixels of one image; ratios and decoding apart"}
    context["one_image_from_a_cold_start"] = statistics.median(one["classify"] for one in ones) / statistics.median(theirs)
    timed = f"decisions on all pixels of {len(frames)} images, the cold start included, per image"
    yield metric("apply_vs_sklearn", ratio, 0.005, "lower", "ratio", apply_s=each, timed=timed, **context, **peer)

"""Numbers of marker-plan: what planned markers are worth on a real expression set with true surfaces."""

import csv

import numpy as np
from linear_shell import EXPRESSIONS, PAPER, SOFT, Ict, fields_of, mean_errors


def metric(name, value, target, better, **context):
    return {"metric": name, "value": value, "target": target, "better": better, "unit": "1", "context": context}


def plan(ctx, mesh_path, count):
    """Vertices of the planned markers, and the run's summary."""
    out = ctx.tmp / f"plan-{count}.csv"
    words = ["--mesh", mesh_path, "--unit", "mm", "--out", out, "--count", count]
    summary = ctx.run([ctx.binary("marker-plan"), *words])
    return np.array([int(row["vertex"]) for row in csv.DictReader(open(out))]), summary


def score(ctx):
    ict = Ict(ctx.data("ict_facekit_dev"))
    mesh_path, _ = ict.write(ctx)
    moved = [ict.truth[name] - ict.rest for name in EXPRESSIONS]
    found = {}
    for count in (90, 60):
        planned, summary = plan(ctx, mesh_path, count)
        for placement, markers in (("planned", planned), ("given", ict.markers[:count])):
            for model, options in (("soft", SOFT), ("paper", PAPER)):
                fields, _ = fields_of(ctx, mesh_path, markers, ict.rest, moved, f"{placement}-{model}-{count}", *options)
                errors = mean_errors(fields, moved, ict.regions)
                found[placement, model, count] = {r: float(np.mean([e[r][0] for e in errors])) for r in ict.regions}
        if count == 90:
            about = summary["results"]
    over = lambda a, b, region="face": found[a][region] / found[b][region]
    new, old = ("planned", "soft", 90), ("given", "paper", 90)
    by_region = {r: [round(found[x][r], 3) for x in (new, ("planned", "paper", 90), ("given", "soft", 90), old)] for r in ict.regions}
    plan_context = {k: about[k] for k in ("pairs", "least_distance_mm", "largest_gap_mm", "asymmetry_mm")}
    yield metric("linear-shell/planned_vs_given", over(new, old), 0.75, "lower", plan=plan_context,
                 means_mm_planned_soft_planned_paper_given_soft_given_paper=by_region)
    sixty = over(("planned", "soft", 60), old)
    yield metric("marker-plan/planned_60_vs_given_90", sixty, None, None, note="60 planned markers over the 90 given")
    alone = over(("planned", "paper", 90), old)
    yield metric("marker-plan/placement_alone", alone, None, None, note="the paper's operator on both sides")


def bench(ctx):
    return iter(())

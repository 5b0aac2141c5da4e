"""Scores of `wrinkle-removal`: what goes, what stays, and how long it takes.

On skin of known parts (a curved patch, wrinkles with the paper's profile, pores: `_skin.py`), and on a real head scan with
wrinkles and pores planted. All is measured from positions, with bands of this module's own (Fourier, on a regular grid).
"""

import time

import numpy as np

from _skin import Skin, relief
from _surfaces import angle_weighted_normals, lee_perry_smith, read_points, write_obj, write_set

REACH = 6  # the stage's default: widths from the valley
WRINKLE_BAND = (1.2, 25.0)  # mm
PORE_BAND = (None, 1.1)


def metric(name, value, target, better, unit, **context):
    return {"metric": name, "value": value, "target": target, "better": better, "unit": unit, "context": context}


def rms(field):
    return float(np.sqrt(np.mean(field**2)))


def remove(ctx, name, points, triangles, region, *options):
    mesh, chosen, out = (ctx.tmp / f"{name}{end}" for end in (".obj", ".json", "-out.obj"))
    write_obj(mesh, points, triangles)
    write_set(chosen, mesh, len(points), region)
    words = [ctx.binary("wrinkle-removal"), "--mesh", mesh, "--unit", "mm", "--vertices", chosen, "--out", out, *options]
    summary = ctx.run(words)
    return read_points(out), summary


def synthetic(ctx, seed, *options, **skin):
    """Decibels that the wrinkle band falls, the same without bands, and the pores' energy that is left."""
    skin = Skin(seed, **skin)
    region = skin.reach < REACH
    before = skin.scan()
    after, _ = remove(ctx, f"skin-{seed}", before, skin.triangles, np.flatnonzero(region), *options)
    outside = float(np.abs(after - before)[~region].max())
    grid = skin.grid()
    inner = grid.take(region.astype(float)) > 0.5
    heights, pores, wrinkles = (grid.take(field) for field in (skin.heights(after), skin.pores, skin.wrinkles))
    left = heights - pores
    drop = 20 * np.log10(rms(grid.band(wrinkles, *WRINKLE_BAND)[inner]) / rms(grid.band(left, *WRINKLE_BAND)[inner]))
    raw = 20 * np.log10(rms(wrinkles[inner]) / rms(left[inner]))
    true, found = grid.band(pores, *PORE_BAND)[inner], grid.band(heights, *PORE_BAND)[inner]
    # The part of what is found that is the true pores, by projection: other fine relief cannot make up for lost pores.
    return float(drop), float(raw), float((found @ true / (true @ true)) ** 2), outside


def real(ctx, seed):
    """A real face with planted wrinkles: how far the band falls against the scan before planting, and the pores kept."""
    smooth, triangles = lee_perry_smith(ctx, 3)
    normals = angle_weighted_normals(smooth, triangles)
    rng = np.random.default_rng(seed)
    wrinkles, pores, reach = relief(smooth, rng, [((-38, 30), (-8, 36)), ((8, 36), (38, 30)), ((-48, -38), (-40, -66))])
    before = smooth + (wrinkles + pores)[:, None] * normals
    region = reach < REACH
    after, _ = remove(ctx, f"real-{seed}", before, triangles, np.flatnonzero(region))
    left = ((after - smooth) * normals).sum(1) - pores
    near = reach < 3
    drop = 20 * np.log10(rms(wrinkles[near]) / rms(left[near]))
    outside = float(np.abs(after - before)[~region].max())
    heights = ((after - smooth) * normals).sum(1)[region]
    fine, true = heights - smoothed(smooth, triangles, heights, region), pores[region]
    true = true - smoothed(smooth, triangles, true, region)
    kept = float((fine @ true / (true @ true)) ** 2)
    return float(drop), kept, outside


def smoothed(points, triangles, values, region):
    """Values of a region, averaged over 0.5 mm (a Gaussian of neighbours in space)."""
    from scipy.spatial import cKDTree

    places = points[region]
    tree = cKDTree(places)
    pairs = tree.sparse_distance_matrix(tree, 1.2, output_type="coo_matrix")
    weights = np.exp(-0.5 * (pairs.data / 0.5) ** 2)
    sums = np.bincount(pairs.row, weights * values[pairs.col], len(places))
    return sums / np.bincount(pairs.row, weights, len(places))


def score(ctx):
    rows = [synthetic(ctx, seed) for seed in ctx.seeds]
    seeds = {"seeds": list(ctx.seeds)}
    yield metric("band_drop_db", min(row[0] for row in rows), 20, "higher", "dB", band_mm=WRINKLE_BAND, each=[round(r[0], 1) for r in rows], **seeds)
    yield metric("all_drop_db", min(row[1] for row in rows), None, None, "dB", what="no band: shape at large and fine remains count", **seeds)
    yield metric("pores_kept", min(row[2] for row in rows), 0.90, "higher", "energy", band_mm=PORE_BAND, each=[round(r[2], 3) for r in rows], **seeds)
    yield metric("outside_moved", max(row[3] for row in rows), 0, "equal", "mm", **seeds)
    sharp = [synthetic(ctx, seed, rounding=0.02) for seed in ctx.seeds]
    yield metric("sharp_band_drop_db", min(row[0] for row in sharp), None, None, "dB", what="creases rounded over 0.02 w", **seeds)
    paper = [synthetic(ctx, seed, "--paper") for seed in ctx.seeds]
    yield metric("paper_band_drop_db", min(row[0] for row in paper), None, None, "dB", pores_kept=min(r[2] for r in paper), **seeds)
    rows = [real(ctx, seed) for seed in ctx.seeds]
    about = {"scan": "Lee Perry-Smith, face subdivided three times", **seeds}
    yield metric("real_drop_db", min(row[0] for row in rows), 20, "higher", "dB", what="no band, |p| < 3 w", **about)
    yield metric("real_pores_kept", min(row[1] for row in rows), 0.90, "higher", "energy", **about)
    yield metric("real_outside_moved", max(row[2] for row in rows), 0, "equal", "mm", **about)


def bench(ctx):
    """A patch of 700 000 vertices; the time is that of the whole program, reading and writing OBJ included."""
    skin = Skin(1, size=167.0, edge=0.2, wrinkle_count=3)
    region = np.flatnonzero(skin.reach < REACH)
    seconds, inner = [], []
    for _ in range(3):
        mesh, chosen, out = ctx.tmp / "large.obj", ctx.tmp / "large.json", ctx.tmp / "large-out.obj"
        if not mesh.exists():
            write_obj(mesh, skin.scan(), skin.triangles)
            write_set(chosen, mesh, len(skin.points), region)
        start = time.perf_counter()
        summary = ctx.run([ctx.binary("wrinkle-removal"), "--mesh", mesh, "--unit", "mm", "--vertices", chosen, "--out", out])
        seconds.append(time.perf_counter() - start)
        inner.append(summary["seconds"]["removal"])
    about = {"vertices": len(skin.points), "region": len(region), "least": min(seconds), "most": max(seconds)}
    yield metric("time_700k_s", float(np.median(seconds)), 5, "lower", "s", removal_alone=float(np.median(inner)), **about)

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


PARTS = {  # of the real scan: subdivisions, box low, box high, wrinkles as lines in x and y, mm
    "forehead": (5, (-60, 5, -40), (60, 66, 90), [((-38, 32), (-6, 37)), ((6, 37), (38, 32))]),
    "cheek": (5, (-66, -88, -40), (-18, -8, 90), [((-42, -30), (-38, -64))]),
}


def real(ctx, seed, part):
    """A part of a real face without its own medium-scale relief, wrinkles and pores planted: how far they fall, the pores kept,
    and how far anything outside moved."""
    levels, low, high, lines = PARTS[part]
    smooth, triangles = lee_perry_smith(ctx, levels, low, high, smooth_mm=50)
    normals = angle_weighted_normals(smooth, triangles)
    wrinkles, pores, reach = relief(smooth, np.random.default_rng(seed), lines)
    before = smooth + (wrinkles + pores)[:, None] * normals
    region = reach < REACH
    after, _ = remove(ctx, f"{part}-{seed}", before, triangles, np.flatnonzero(region))
    heights = ((after - smooth) * normals).sum(1)
    fine = (heights - smoothed(smooth, heights, region))[region]
    true = (pores - smoothed(smooth, pores, region))[region]
    kept = float((fine @ true / (true @ true)) ** 2)
    planted, left = (medium(smooth, field, reach < 20) for field in (wrinkles, heights - pores))
    raw = 20 * np.log10(rms(wrinkles[region]) / rms((heights - pores)[region]))
    return float(20 * np.log10(rms(planted) / rms(left))), kept, float(np.abs(after - before)[~region].max()), float(raw)


def medium(points, values, around):
    """The band of wrinkles: values averaged in cells of 1 mm, minus their average over 5 mm (Gaussian: half of a wave of 26 mm)."""
    from scipy.spatial import cKDTree

    _, cell = np.unique(np.floor(points[around]).astype(int), axis=0, return_inverse=True)
    cell = cell.reshape(-1)
    count = np.bincount(cell)
    mean = np.bincount(cell, values[around]) / count
    places = np.column_stack([np.bincount(cell, points[around][:, axis]) / count for axis in range(3)])
    tree = cKDTree(places)
    pairs = tree.sparse_distance_matrix(tree, 12.0, output_type="coo_matrix")
    weights = np.exp(-0.5 * (pairs.data / 5.0) ** 2)
    sums = np.bincount(pairs.row, weights * mean[pairs.col], len(places))
    return mean - sums / np.bincount(pairs.row, weights, len(places))


def smoothed(points, values, region):
    """Values averaged over 0.5 mm around the vertices of a region (Gaussian); others stay."""
    from scipy.spatial import cKDTree

    chosen = np.flatnonzero(region)
    places, near = cKDTree(points[chosen]), cKDTree(points)
    pairs = places.sparse_distance_matrix(near, 1.2, output_type="coo_matrix")
    weights = np.exp(-0.5 * (pairs.data / 0.5) ** 2)
    sums = np.bincount(pairs.row, weights * values[pairs.col], len(chosen))
    result = values.copy()
    result[chosen] = sums / np.bincount(pairs.row, weights, len(chosen))
    return result


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
    rows = {f"{part} {seed}": real(ctx, seed, part) for part in PARTS for seed in ctx.seeds}
    about = {"scan": "Lee Perry-Smith, forehead and cheek", **seeds}
    each = [{name: round(row[i], 3) for name, row in rows.items()} for i in (0, 1)]
    yield metric("real_drop_db", min(row[0] for row in rows.values()), 20, "higher", "dB", band_mm=(1, 26), unbanded=min(row[3] for row in rows.values()), each=each[0], **about)
    yield metric("real_pores_kept", min(row[1] for row in rows.values()), 0.90, "higher", "energy", each=each[1], **about)
    yield metric("real_outside_moved", max(row[2] for row in rows.values()), 0, "equal", "mm", **about)


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

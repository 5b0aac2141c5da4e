"""Scores of `wrinkle-edit`: how well a drawn wrinkle keeps its place on the moving skin. And its speed beside Python's json.

A wrinkle of the rig's truth is drawn by its place in one image, to follow its neighbours of the truth; the reference is where it truly is
in the other images. Beside it stands what comes of a wrinkle that stays where it was drawn.
"""

import json
import math
import random
import statistics
import time

from _takes import lines, wrinkles

SEEDS = [1, 2, 3, 4]
# Seeds 1 to 4: foreign, s, rounded, foreign.
FAMILIES = ["rounded", "foreign", "s"]
# A drawn wrinkle follows so many, the nearest ones.
NEIGHBOURS = 2
PLACES = 8
REPEATS = 5


def metric(name, value, target, better, unit, **context):
    return {"metric": name, "value": value, "target": target, "better": better, "unit": unit, "context": context}


def spread(sections, count):
    """Places at equal shares of a crease's length."""
    at = [section["at"] for section in sections]
    lengths = [0.0]
    for one, other in zip(at, at[1:]):
        lengths.append(lengths[-1] + math.dist(one, other))
    places = []
    for i in range(count):
        wanted = lengths[-1] * i / (count - 1)
        after = next((k for k in range(1, len(at)) if lengths[k] >= wanted), len(at) - 1)
        share = (wanted - lengths[after - 1]) / max(lengths[after] - lengths[after - 1], 1e-9)
        places.append([a + share * (b - a) for a, b in zip(at[after - 1], at[after])])
    return places


def nearest(wrinkle, frame, camera):
    """The wrinkles whose middles are nearest in an image."""
    middle = lambda id: spread(frame["sections"][camera][id], 3)[1]
    others = [id for id in frame["sections"][camera] if id != wrinkle and len(frame["sections"][camera][id]) > 1]
    return sorted(others, key=lambda id: math.dist(middle(id), middle(wrinkle)))[:NEIGHBOURS]


def off(drawn, true):
    """Mean distance of places of a crease from the true one, px."""
    at = [section["at"] for section in true]
    return statistics.fmean(min(math.dist(place, other) for other in at) for place in spread(drawn, PLACES))


def edit(ctx, sections, text, *args):
    path, out = ctx.tmp / "edits.txt", ctx.tmp / "edited.jsonl"
    path.write_text("wrinkle-edits/1\n" + text)
    ctx.run([ctx.binary("wrinkle-edit"), "apply", "--sections", sections, "--edits", path, "--out", out, *args])
    return out


def followed(ctx, sections):
    """Errors of drawn wrinkles that follow their neighbours, and of those that stay, by image."""
    _, frames = lines(sections)
    first = frames[0]
    text, drawn = [], []
    for camera, here in sorted(first["sections"].items()):
        for wrinkle in sorted(id for id in here if len(here[id]) > 20):
            places = " ".join(f"{x},{y}" for x, y in spread(here[wrinkle], PLACES))
            look = f"in {camera} at {first['frame']} through {places} width 5 depth 2"
            text.append(f"draw follows_{wrinkle} {look} follow {','.join(nearest(wrinkle, first, camera))}")
            text.append(f"draw stays_{wrinkle} {look}")
            drawn.append((camera, wrinkle))
    _, edited = lines(edit(ctx, sections, "\n".join(text)))
    errors = {"follows": [], "stays": []}
    for frame in edited[1:]:
        for camera, wrinkle in drawn:
            here = frame["sections"].get(camera, {})
            for kind in errors:
                if wrinkle in here and f"{kind}_{wrinkle}" in here:
                    errors[kind].append(off(here[f"{kind}_{wrinkle}"], here[wrinkle]))
    return errors


def share(values, part):
    return sorted(values)[int(part * (len(values) - 1))]


def score(ctx):
    seeds = ctx.seeds or SEEDS
    errors = {"follows": [], "stays": []}
    for seed in seeds:
        sections = truth(ctx, seed)
        for kind, values in followed(ctx, sections).items():
            errors[kind] += values
    follows, stays = errors["follows"], errors["stays"]
    context = {"seeds": seeds, "images": len(follows)}
    yield metric("follow_median_px", statistics.median(follows), 1.5, "lower", "px", stay=statistics.median(stays), **context)
    # In the worst tenth the neighbours are on another part of the face: a brow does not know what the mouth does.
    yield metric("follow_90_over_stay", share(follows, 0.9) / share(stays, 0.9), 0.6, "lower", "ratio", follow_px=share(follows, 0.9), **context)
    yield metric("scaled_depth_rel", scaled(ctx, sections), 1e-12, "lower", "rel", reference="Python")


def truth(ctx, seed):
    """The true sections of a take; families of profiles take turns."""
    return wrinkles(ctx, "standard", seed, family=FAMILIES[seed % len(FAMILIES)]) / "truth" / "sections.jsonl"


def scaled(ctx, sections):
    """The largest difference of scaled depths from what Python makes of them."""
    rng = random.Random(1)
    factor = rng.uniform(0.2, 4.0)
    _, before = lines(sections)
    _, after = lines(edit(ctx, sections, f"scale depth {factor!r}"))
    worst = 0.0
    for one, other in zip(before, after, strict=True):
        for camera, here in one["sections"].items():
            for id, rows in here.items():
                for a, b in zip(rows, other["sections"][camera][id], strict=True):
                    wanted = factor * a["d_px"]
                    worst = max(worst, abs(b["d_px"] - wanted) / max(wanted, 1e-9))
    return worst


def by_python(sections, out, factor):
    """The same scaling as a script would do it."""
    with open(sections) as source, open(out, "w") as target:
        target.write(next(source))
        for line in source:
            frame = json.loads(line)
            for here in frame["sections"].values():
                for rows in here.values():
                    for row in rows:
                        row["d_px"] *= factor
            target.write(json.dumps(frame, separators=(",", ":")) + "\n")


def bench(ctx):
    seed = (ctx.seeds or SEEDS)[0]
    sections = truth(ctx, seed)
    ratios = []
    for _ in range(REPEATS):
        start = time.perf_counter()
        edit(ctx, sections, "scale depth 2")
        middle = time.perf_counter()
        by_python(sections, ctx.tmp / "python.jsonl", 2.0)
        ratios.append((middle - start) / (time.perf_counter() - middle))
    yield metric("scale_over_python", statistics.median(ratios), 1.0, "lower", "ratio", least=min(ratios), most=max(ratios),
                 timed="reading, scaling, writing, side-cars and hashes; process start", peer="json of Python")

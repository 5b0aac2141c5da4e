"""Takes of the virtual rig, kept outside the repository, and their files."""

import hashlib
import json
import os
import shutil
from pathlib import Path

# What a take shows hangs on these; a change elsewhere, in a reader or the shell, films nothing anew.
SOURCES = ("crates/stages/virtual-rig/src", "crates/stages/virtual-rig/scenarios", "crates/shared/mesh/src")


# The part of the rig that no film shows: files and lines that name it are passed over.
NOT_FILMED = "character"


def sources(ctx):
    """A digest of the rig's sources."""
    digest = hashlib.sha256()
    for path in sorted(path for folder in SOURCES for path in (ctx.root / folder).rglob("*") if path.is_file()):
        name = path.relative_to(ctx.root).as_posix()
        if NOT_FILMED in name:
            continue
        lines = path.read_bytes().splitlines(keepends=True)
        filmed = lambda line: "virtual-rig" not in name or NOT_FILMED.encode() not in line
        digest.update(name.encode() + b"".join(filter(filmed, lines)))
    return digest


def make(ctx, name, *args):
    """A take of these arguments of `virtual-rig make`, under a name that says what it was made with; made if it is not there."""
    digest = sources(ctx)
    for word in map(str, args):
        digest.update(b"\0" + (Path(word).read_bytes() if Path(word).is_file() else word.encode()))
    folder = ctx.cache / "takes" / f"{name}-{digest.hexdigest()[:16]}"
    if not (folder / "take" / "take.json").exists():
        # Filmed under another name: two scores may want the same take at the same time.
        unfinished = folder.with_name(f".{folder.name}.{os.getpid()}")
        shutil.rmtree(unfinished, ignore_errors=True)
        ctx.run([ctx.binary("virtual-rig"), "make", *args, "--out", unfinished])
        if not (folder / "take" / "take.json").exists():
            shutil.rmtree(folder, ignore_errors=True)
            unfinished.rename(folder)
        shutil.rmtree(unfinished, ignore_errors=True)
    return folder


def mocap(ctx, scenario, seed):
    """A long take of a scenario and seed, by the motion capture's cameras alone; they tell no more vertices apart."""
    words = ["--scenario", scenario, "--seed", seed, "--length", "long", "--vertices", 60000, "--cameras", "m1,m2,m3,m4,m5,m6"]
    return make(ctx, f"{scenario}-{seed}-mocap", *words, "--no-normals", "--no-calibration")


# Frames of a wrinkle take: the one that is painted by hand, and more than forty others.
WRINKLE_FRAMES = 42
# So many seconds of the performance per second, that all of its actions fit (it needs five seconds): the face moves three times
# as fast from image to image as in the studio.
WRINKLE_PACE = 1.5
# Edges along creases, mm, half a pixel: coarser ones cut sharp creases off, and light is known at vertices only.
WRINKLE_CREASE_MM = 0.1
# How uneven the paint is, as a share of its light.
WRINKLE_TEXTURE = 0.007


def wrinkles(ctx, scenario, seed, **folds):
    """A take of a scenario and seed by the wrinkle cameras alone, w1 and w2, at their 12.5 images a second; no mocap frames
    between. `folds` are parameters of the folds that differ from the scenario's, e.g. family="s", "rounded" or "foreign"."""
    path = ctx.tmp / "scenario.json"
    ctx.run([ctx.binary("virtual-rig"), "scenario", "--scenario", scenario, "--out", path])
    data = json.loads(path.read_text())
    data["data"]["folds"] = data["data"].get("folds", {}) | folds
    rate = {"frames": 25, "seconds": 2}
    data["data"]["extent"] |= {"frames": WRINKLE_FRAMES, "rate": rate, "wrinkle_every": 1, "pace": WRINKLE_PACE}
    data["data"]["crease_mm"] = WRINKLE_CREASE_MM
    data["data"]["paint"] |= {"texture": WRINKLE_TEXTURE}
    changed = "".join(f"-{value}" for value in folds.values() if isinstance(value, str))
    path = ctx.tmp / f"{scenario}{changed}-wrinkles.json"
    path.write_text(json.dumps(data, sort_keys=True))
    words = ["--scenario", path, "--seed", seed, "--vertices", 150000, "--cameras", "w1,w2"]
    return make(ctx, f"{scenario}{changed}-{seed}-wrinkles", *words, "--no-normals", "--no-calibration")


def lines(path):
    """Header and frames of an artifact with frames."""
    rows = [json.loads(line) for line in open(path)]
    return rows[0]["data"], rows[1:]


def write_lines(path, kind, header, frames):
    """The same way back."""
    rows = [{"schema": kind, "data": header}, *frames]
    path.write_text("".join(json.dumps(row) + "\n" for row in rows))
    return path

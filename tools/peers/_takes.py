"""Takes of the virtual rig, kept outside the repository, and their files."""

import hashlib
import json
import shutil
from pathlib import Path

# What a take shows hangs on these; a change elsewhere, in a reader or the shell, films nothing anew.
SOURCES = ("crates/stages/virtual-rig/src", "crates/stages/virtual-rig/scenarios", "crates/shared/mesh/src")


def sources(ctx):
    """A digest of the rig's sources."""
    digest = hashlib.sha256()
    for path in sorted(path for folder in SOURCES for path in (ctx.root / folder).rglob("*") if path.is_file()):
        digest.update(path.relative_to(ctx.root).as_posix().encode() + path.read_bytes())
    return digest


def make(ctx, name, *args):
    """A take of these arguments of `virtual-rig make`, under a name that says what it was made with; made if it is not there."""
    digest = sources(ctx)
    for word in map(str, args):
        digest.update(b"\0" + (Path(word).read_bytes() if Path(word).is_file() else word.encode()))
    folder = ctx.cache / "takes" / f"{name}-{digest.hexdigest()[:16]}"
    if not (folder / "take" / "take.json").exists():
        shutil.rmtree(folder, ignore_errors=True)
        ctx.run([ctx.binary("virtual-rig"), "make", *args, "--out", folder])
    return folder


def mocap(ctx, scenario, seed):
    """A long take of a scenario and seed, by the motion capture's cameras alone; they tell no more vertices apart."""
    words = ["--scenario", scenario, "--seed", seed, "--length", "long", "--vertices", 60000, "--cameras", "m1,m2,m3,m4,m5,m6"]
    return make(ctx, f"{scenario}-{seed}-mocap", *words, "--no-normals", "--no-calibration")


def lines(path):
    """Header and frames of an artifact with frames."""
    rows = [json.loads(line) for line in open(path)]
    return rows[0]["data"], rows[1:]


def write_lines(path, kind, header, frames):
    """The same way back."""
    rows = [{"schema": kind, "data": header}, *frames]
    path.write_text("".join(json.dumps(row) + "\n" for row in rows))
    return path

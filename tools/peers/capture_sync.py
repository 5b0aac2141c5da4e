"""Scores of `capture-sync` against the virtual rig's truth, and on a recorded session of four free-running cameras.

`score(ctx)` and `bench(ctx)` yield one dict per metric. Takes are small (164 x 122 px) and long (600 frames), with dropped
and doubled images, a late start, and a clock that drifts.
"""

import csv
import json
import shutil
import statistics
import struct
import subprocess
import zlib

from _takes import make

FAULTS = ["dropped=0.04@m2", "doubled=0.04@m3", "offset=2.3@m4", "drift=120@m5"]
FRAMES = 600


def metric(name, value, target, better, unit, **context):
    return {"metric": f"capture-sync/{name}", "value": value, "target": target, "better": better, "unit": unit, "context": context}


def take(ctx, seed, kind):
    """A take with faults: `free` (clocks of their own), `flash` (and a flash), `trigger` (no late start, no drift)."""
    rig = ctx.binary("virtual-rig")
    words = [rig, "scenario", "--scenario", "standard", "--quiet"]
    scenario = json.loads(subprocess.run([str(w) for w in words], check=True, capture_output=True, text=True).stdout)
    data = scenario["data"]
    data["extent"]["frames"], data["vertices"], data["image_scale"] = FRAMES, 8000, 0.25
    if kind == "flash":
        data["flash"] = {"mocap_frame": 40, "length_s": 0.1, "factor": 1.6}
    faults = FAULTS[:2] if kind == "trigger" else FAULTS
    path = ctx.tmp / f"{kind}-{seed}.json"
    path.write_text(json.dumps(scenario))
    planted = [word for fault in faults for word in ("--fault", fault)]
    return make(ctx, f"sync-{kind}-{seed}", "--scenario", path, "--seed", seed, "--no-normals", "--no-calibration", *planted)


def scored(ctx, folder, mode, *extra):
    """The rig's verdict on a time base, by metric."""
    out = ctx.tmp / f"sync-{len(list(ctx.tmp.iterdir()))}"
    ctx.run([ctx.binary("capture-sync"), "run", folder / "take" / "take.json", "--out", out, "--mode", mode, "--no-extract", *extra])
    words = [ctx.binary("virtual-rig"), "score", "sync", out / "sync.jsonl", "--truth", folder / "truth"]
    rows = ctx.run(words)["results"]["metrics"]
    return {row["metric"].split("/")[1]: row for row in rows}


RUNS = [("timestamps", "trigger", []), ("correlation", "free", []), ("flash", "flash", [])]


def score(ctx):
    found = {}
    for seed in ctx.seeds:
        for mode, kind, extra in RUNS:
            found[f"{mode}/{seed}"] = scored(ctx, take(ctx, seed, kind), mode, *extra)
    for name, target, unit in [("offset_frames", 0.1, "frames"), ("drops_missed", 0, "count"), ("drops_invented", 0, "count")]:
        values = {run: rows[name]["value"] for run, rows in found.items()}
        yield metric(name, max(values.values()), target, "lower", unit, by_run=values, frames=FRAMES, faults=FAULTS)
    wrong = {run: rows["wrong_images"]["value"] for run, rows in found.items()}
    yield metric("wrong_images", max(wrong.values()), 0, "lower", "count", by_run=wrong)
    short = {run: rows["drift_ppm"]["value"] for run, rows in found.items()}
    yield metric("drift_short_ppm", max(short.values()), None, "lower", "ppm", by_run=short, seconds=FRAMES / 50,
                 note="twelve seconds tell little of drift")
    yield from ten_minutes(ctx)
    yield from caliscope(ctx)


# ---------------------------------------------------------------- ten minutes of stamps


def png_of_a_pixel():
    chunk = lambda name, body: struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))
    header = struct.pack(">IIBBBBB", 1, 1, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(bytes(4))) + chunk(b"IEND", b"")


def manifest(folder, cameras, rate, clock):
    """A take whose footage is tiny pictures, all the same: only stamps count."""
    footage = lambda id: {"file": None, "images": f"footage/{id}/{{frame:06}}.png", "first": 0, "timestamps": f"footage/{id}.csv"}
    camera = lambda id: {"id": id, "image_size": [1, 1], "transfer": "srgb", "bit_depth": 8, "rate": rate, "footage": footage(id)}
    data = {"subject": "s", "session": "s", "take": "stamps", "rate": rate, "start_timecode": None, "first_frame": 1001,
            "clock": clock, "cameras": [camera(id) for id in cameras], "mesh_unit": "mm", "mesh_up": "y",
            "consent": {"licence": "none: made up or timestamps only", "credit": None, "notes": None}}
    pixel = png_of_a_pixel()
    for id, times in cameras.items():
        (folder / "footage" / id).mkdir(parents=True)
        for index in range(len(times)):
            (folder / "footage" / id / f"{index:06}.png").write_bytes(pixel)
        lines = [f"{index},{time:.9f}" for index, time in enumerate(times)]
        (folder / "footage" / f"{id}.csv").write_text("index,time_s\n" + "\n".join(lines) + "\n")
    (folder / "take.json").write_text(json.dumps({"schema": "take/2", "data": data}))
    return folder / "take.json"


def header_of(path):
    return json.loads(open(path).readline())["data"]


def ten_minutes(ctx):
    """Drift of clocks over ten minutes, by jittered stamps with drops."""
    import random

    worst = {}
    for seed in ctx.seeds:
        random.seed(seed)
        drifts = {"m1": 0.0, "m2": random.uniform(-150, 150), "m3": random.uniform(-150, 150)}
        times = {
            id: [n / 50 * (1 + 1e-6 * ppm) + random.gauss(0, 0.001) * (n > 0) for n in range(30000) if n == 0 or random.random() > 0.01]
            for id, ppm in drifts.items()
        }
        times = {id: sorted(row) for id, row in times.items()}
        folder = ctx.tmp / f"ten-minutes-{seed}"
        path = manifest(folder, times, {"frames": 50, "seconds": 1}, "timestamps")
        ctx.run([ctx.binary("capture-sync"), "run", path, "--out", folder / "out", "--no-extract"])
        cameras = header_of(folder / "out" / "sync.jsonl")["cameras"]
        worst[seed] = max(abs(cameras[id]["drift_ppm"] - ppm) for id, ppm in drifts.items())
        shutil.rmtree(folder)
    yield metric("drift_ppm", max(worst.values()), 5, "lower", "ppm", by_seed=worst, frames=30000, jitter_ms=1.0, dropped="1 %")


# ---------------------------------------------------------------- a recorded session


def caliscope(ctx):
    """Four webcams without a trigger: how well lines through their stamps agree with the session's own grouping."""
    rows = list(csv.DictReader(open(ctx.data("multicam_caliscope_4cam") / "timestamps.csv")))
    times, groups = {}, {}
    for row in sorted(rows, key=lambda row: float(row["frame_time"])):
        camera = f"c{row['cam_id']}"
        groups.setdefault(camera, []).append(int(row["sync_index"]))
        times.setdefault(camera, []).append(float(row["frame_time"]))
    folder = ctx.tmp / "caliscope"
    path = manifest(folder, times, {"frames": 6, "seconds": 1}, "timestamps")
    ctx.run([ctx.binary("capture-sync"), "run", path, "--out", folder / "out", "--no-extract"])
    frames = [json.loads(line) for line in open(folder / "out" / "sync.jsonl")][1:]
    same = total = 0
    for frame in frames:
        own = [groups[camera][shown["index"]] for camera, shown in frame["shows"].items() if shown]
        if own:
            same, total = same + own.count(statistics.mode(own)), total + len(own)
    cameras = header_of(folder / "out" / "sync.jsonl")["cameras"]
    yield metric("caliscope_same_group", same / total if total else None, None, "higher", "share of images",
                 skew_ms={id: round(1e3 / 6 * camera["offset_frames"], 2) for id, camera in cameras.items()},
                 drift_ppm={id: round(camera["drift_ppm"], 1) for id, camera in cameras.items()}, images=total)


def bench(ctx):
    """Reading and correlating, images a second; no named peer does the same."""
    folder = take(ctx, ctx.seeds[0], "free")
    rates, parts = [], {}
    for i in range(3):
        done = ctx.run([ctx.binary("capture-sync"), "run", folder / "take" / "take.json", "--out", ctx.tmp / f"bench-{i}", "--no-extract"])
        images = sum(camera["images"] for camera in done["results"]["cameras"].values())
        parts = done["seconds"]
        rates.append(images / sum(parts.values()))
    yield metric("images_per_s", statistics.median(rates), None, "higher", "images/s", low=min(rates), high=max(rates), parts=parts,
                 timed="PNG decoding of 164 x 122 px, readings and correlation")

"""Scores of `triangulate`: error on virtual takes, the filter on noise and on a blink, speed, memory, and C3D by ezc3d."""

import json
import os
import statistics
import subprocess
import sys

import numpy as np

from _takes import lines, mocap, write_lines
from virtual_rig import score_of

SEEDS = [1, 2, 3, 4, 5, 6]
NOISE_PX = 0.1  # radial, root mean square
HZ = 50


def metric(name, value, target, better, unit, **context):
    return {"metric": f"triangulate/{name}", "value": value, "target": target, "better": better, "unit": unit, "context": context}


def run(ctx, cameras, tracks, out, *args):
    return ctx.run([ctx.binary("triangulate"), "--cameras", cameras, "--tracks", tracks, "--out", out, *args])


def disturbed(source, out, seed):
    """The tracks with Gaussian errors."""
    rng = np.random.default_rng(seed)
    header, frames = lines(source)
    for frame in frames:
        for points in frame["points"].values():
            for marker, at in points.items():
                points[marker] = (np.array(at) + rng.normal(0, NOISE_PX / np.sqrt(2), 2)).tolist()
    return write_lines(out, "tracks-2d/1", header, frames)


# ---------------------------------------------------------------- takes of our own: a camera model independent of the stage


def project(camera, points):
    """Pixels of points, #M x 3, OpenCV's model."""
    pose, lens = camera["cam_from_world"], camera["distortion"]
    cam = points @ np.array(pose["rotation"]).T + np.array(pose["translation_mm"])
    x, y = cam[:, 0] / cam[:, 2], cam[:, 1] / cam[:, 2]
    r2 = x * x + y * y
    radial = 1 + r2 * (lens["k1"] + r2 * (lens["k2"] + r2 * lens["k3"]))
    xd = x * radial + 2 * lens["p1"] * x * y + lens["p2"] * (r2 + 2 * x * x)
    yd = y * radial + lens["p1"] * (r2 + 2 * y * y) + 2 * lens["p2"] * x * y
    return np.stack([xd, yd], axis=1) * camera["focal_px"] + camera["center_px"]


class Scene:
    """The rig and the markers of a virtual take at rest, moved as we say; each camera sees what it saw in the first frame."""

    def __init__(self, folder):
        truth = folder / "truth"
        self.cameras_file = truth / "cameras.json"
        self.rig = json.loads(self.cameras_file.read_text())["data"]["cameras"]
        first = lines(truth / "tracks-2d.jsonl")[1][0]
        rest = lines(truth / "markers.jsonl")[1][0]["points"]
        states = first.get("state", {})
        self.seen = {c: {m for m in points if m not in states.get(c, {})} for c, points in first["points"].items()}
        twice = [m for m in rest if rest[m] and sum(m in seen for seen in self.seen.values()) >= 2]
        self.markers, self.rest = twice, np.array([rest[m] for m in twice])

    def write(self, out, paths, seed):
        """Tracks of `paths`, #F x #M x 3, with noise."""
        rng = np.random.default_rng(seed)
        header = {"cameras": list(self.seen), "markers": self.markers, "rate": {"frames": HZ, "seconds": 1}, "take": None}
        with open(out, "w") as file:
            file.write(json.dumps({"schema": "tracks-2d/1", "data": header}) + "\n")
            for number, points in enumerate(paths):
                line = {}
                for camera, seen in self.seen.items():
                    at = project(self.rig[camera], points) + rng.normal(0, NOISE_PX / np.sqrt(2), (len(points), 2))
                    line[camera] = {m: at[i].round(4).tolist() for i, m in enumerate(self.markers) if m in seen}
                file.write(json.dumps({"frame": 1001 + number, "points": line}) + "\n")
        return out

    def read(self, path):
        """#F x #M x 3, NaN where missing."""
        _, frames = lines(path)
        return np.array([[f["points"].get(m) or [np.nan] * 3 for m in self.markers] for f in frames])


def rms(errors):
    return float(np.sqrt(np.nanmean((errors**2).sum(axis=-1))))


def filter_scores(ctx, scene):
    """Per filter: noise left on still markers, and how much of the peak of a 60 ms blink of the upper lids stays."""
    still = np.repeat(scene.rest[None], 100, axis=0)
    lids = [i for i, m in enumerate(scene.markers) if m.startswith("lid_upper")]
    tracks = scene.write(ctx.tmp / "still.jsonl", still, 3)
    raw = out = ctx.tmp / "f.jsonl"
    run(ctx, scene.cameras_file, tracks, raw, "--no-filter")
    before = rms(scene.read(raw) - still)
    found = {"affine": {"kept": {}}, "paper": {"kept": {}}}
    for name, scores in found.items():
        run(ctx, scene.cameras_file, tracks, out, "--filter", name)
        scores["noise"] = rms(scene.read(out) - still) / before
    for depth in (1.0, 3.0, 8.0):
        blink = still.copy()
        for frame, share in ((49, 0.25), (50, 1.0), (51, 0.25)):  # a raised cosine of 60 ms
            blink[frame, lids, 1] -= depth * share
        tracks = scene.write(ctx.tmp / "blink.jsonl", blink, 5)

        def peak(*args):
            run(ctx, scene.cameras_file, tracks, out, *args)
            path = scene.read(out)[:, lids, 1]
            return float(np.nanmean(path[30:45]) - np.nanmean(path[50]))

        unfiltered = peak("--no-filter")
        for name, scores in found.items():
            scores["kept"][depth] = peak("--filter", name) / unfiltered
    return found


def c3d_difference(ctx, scene):
    """Largest difference of our C3D as ezc3d reads it, mm; infinite if unit, rate, labels, first frame or gaps differ."""
    try:
        import ezc3d
    except ImportError as error:
        raise ctx.Missing("ezc3d is not installed") from error
    paths = np.repeat(scene.rest[None], 60, axis=0) + np.linspace(0, 20, 60)[:, None, None]
    tracks = scene.write(ctx.tmp / "gaps.jsonl", paths, 7)
    header, frames = lines(tracks)
    for frame in frames[20:50]:
        for points in frame["points"].values():
            points.pop(scene.markers[0], None)
    write_lines(tracks, "tracks-2d/1", header, frames)
    out, c3d = ctx.tmp / "c.jsonl", ctx.tmp / "c.c3d"
    run(ctx, scene.cameras_file, tracks, out, "--c3d", c3d)
    ours, read = scene.read(out), ezc3d.c3d(str(c3d))
    point = read["parameters"]["POINT"]
    theirs = read["data"]["points"][:3].transpose(2, 1, 0)
    same = (
        point["UNITS"]["value"] == ["mm"]
        and point["RATE"]["value"][0] == HZ
        and point["LABELS"]["value"] == scene.markers
        and read["header"]["points"]["first_frame"] + 1 in (1001, 1002)  # ezc3d counts from 0
        and theirs.shape == ours.shape
        and np.isnan(ours).any()
        and (np.isnan(ours) == np.isnan(theirs)).all()
    )
    return float(np.nanmax(np.abs(ours - theirs))) if same else float("inf")


def score(ctx):
    seeds = ctx.seeds or SEEDS
    raw, filtered = {}, {}
    for seed in seeds:
        folder = mocap(ctx, "standard", seed)
        truth, out = folder / "truth", ctx.tmp / "out.jsonl"
        tracks = disturbed(truth / "tracks-2d.jsonl", ctx.tmp / "tracks.jsonl", seed)
        for found, args in ((raw, ["--no-filter"]), (filtered, [])):
            run(ctx, truth / "cameras.json", tracks, out, *args)
            found[seed] = score_of(ctx, "trajectories-3d", out, truth)["rms_mm"]["value"]
    mean = lambda values: float(np.sqrt(np.mean(np.square(list(values.values())))))
    yield metric("rms_mm", mean(raw), 0.07, "lower", "mm", by_seed=raw, noise_px=NOISE_PX, after_the_filter=mean(filtered),
                 filtered_by_seed=filtered)
    scene = Scene(folder)
    found = filter_scores(ctx, scene)
    yield metric("filter_noise_ratio", found["affine"]["noise"], 0.5, "lower", "ratio", paper=found["paper"]["noise"])
    yield metric("filter_blink_kept", min(found["affine"]["kept"].values()), 0.95, "higher", "share",
                 by_depth_mm=found["affine"]["kept"], paper=found["paper"]["kept"])
    yield metric("c3d_read_back", c3d_difference(ctx, scene), 1e-4, "lower", "mm", oracle="ezc3d")


# ---------------------------------------------------------------- speed and memory


# A program's peak counts that of the one that starts it, so a small one does: not this one with its NumPy.
STARTER = """
import os, sys
pid = os.posix_spawn(sys.argv[1], sys.argv[1:], os.environ)
_, status, usage = os.wait4(pid, 0)
print(os.waitstatus_to_exitcode(status), usage.ru_maxrss * 1024, usage.ru_utime + usage.ru_stime)
"""


def usage(words):
    """Peak resident memory of a program, bytes, and its processor time, s."""
    start = [sys.executable, "-I", "-S", "-c", STARTER, *map(str, words)]
    done = subprocess.run(start, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, check=True)
    code, peak, seconds = done.stdout.split()[-3:]
    if int(code):
        raise RuntimeError(f"{words[0]} exits with {code}")
    return int(peak), float(seconds)


def bench(ctx):
    scene = Scene(mocap(ctx, "standard", 1))
    sway = lambda count: scene.rest[None] + 10 * np.sin(np.arange(count) / 20)[:, None, None]
    takes = {count: scene.write(ctx.tmp / f"{count}.jsonl", sway(count), 1) for count in (6 * HZ, 60 * HZ)}
    out, rates, whole = ctx.tmp / "bench.jsonl", [], []
    for _ in range(5):
        summary = run(ctx, scene.cameras_file, takes[60 * HZ], out, "--no-filter", "--fill-ms", 0)
        rates.append(summary["results"]["measured"] / summary["seconds"]["triangulate"])
        summary = run(ctx, scene.cameras_file, takes[60 * HZ], out)
        whole.append(summary["results"]["measured"] / summary["seconds"]["triangulate"])
    words = [ctx.binary("triangulate"), "--cameras", scene.cameras_file, "--out", out, "--quiet"]
    _, seconds = usage([*words, "--tracks", takes[60 * HZ], "--no-filter", "--fill-ms", 0])
    yield metric("points_per_s", statistics.median(rates), 200_000, "higher", "points per s", low=min(rates), high=max(rates),
                 with_filter_and_filling=statistics.median(whole), views_per_point=float(np.mean([len(s) for s in scene.seen.values()])) * len(scene.seen) / len(scene.markers),
                 per_processor_s_whole_program=summary["results"]["measured"] / seconds,
                 threads=os.cpu_count(), inside="interpolation, linear start, Gauss-Newton, outliers, covariance; reading and writing apart")
    words += ["--c3d", ctx.tmp / "b.c3d", "--trc", ctx.tmp / "b.trc"]
    peaks = {count: statistics.median(usage([*words, "--tracks", tracks])[0] for _ in range(3)) for count, tracks in takes.items()}
    yield metric("memory_growth", peaks[60 * HZ] / peaks[6 * HZ], 1.1, "lower", "ratio", mb={k: v / 1e6 for k, v in peaks.items()},
                 inside="the whole program, C3D and TRC included")

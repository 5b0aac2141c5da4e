"""Scores of `wrinkle-blend`: weights and maps beside a NumPy transcription of the equations, on the rig's character and on a real one."""

import json
import statistics
import struct
import time

import cv2
import numpy as np

from _player import agreement, browser_lacks

SEEDS = [1, 2, 3]
# The real character's own unit is the decimetre; times of its pose units, s.
REAL = ["--mm-per-unit", 100, "--pose", "brows=3+4+5+6", "--pose", "frown=1+2", "--pose", "smile=44+45", "--pose", "snarl=7"]


def metric(name, value, target, better, unit, **context):
    return {"metric": name, "value": value, "target": target, "better": better, "unit": unit, "context": context}


def character(ctx, seed, **words):
    """A character of the rig, made if it is not there."""
    folder = ctx.tmp / f"character-{seed}-{'-'.join(map(str, words.values()))}"
    if not folder.exists():
        options = [word for key, value in words.items() for word in (f"--{key.replace('_', '-')}", value)]
        ctx.run([ctx.binary("virtual-rig"), "character", "--seed", seed, *options, "--out", folder])
    return folder


def weights(ctx, folder, name, *words):
    """Weights of an animation: header, frames, summary."""
    out = ctx.tmp / f"{folder.name}-{name}{'-bones' if '--bones-only' in words else ''}.jsonl"
    call = [ctx.binary("wrinkle-blend"), "weights", "--model", folder / "head.glb", "--poses", folder / "poses.json"]
    summary = ctx.run([*call, "--animation", name, *words, "--out", out])
    lines = [json.loads(line) for line in out.read_text().splitlines()]
    return out, lines[0]["data"], lines[1:], summary


def blended(ctx, folder, weights, *words):
    out = ctx.tmp / f"{folder.name}-maps{'-bare' if '--padding' in words else ''}"
    call = [ctx.binary("wrinkle-blend"), "maps", "--model", folder / "head.glb", "--poses", folder / "poses.json"]
    summary = ctx.run([*call, "--neutral", folder / "neutral.png", "--weights", weights, *words, "--out", out])
    return out, summary


class Glb:
    """As much of a binary glTF as the transcription needs: one buffer, plain accessors."""

    def __init__(self, path):
        data = path.read_bytes()
        length = struct.unpack_from("<I", data, 12)[0]
        self.json, self.bytes = json.loads(data[20:20 + length]), data[28 + length:]

    def array(self, index):
        accessor = self.json["accessors"][index]
        view = self.json["bufferViews"][accessor["bufferView"]]
        kind = {5121: "u1", 5123: "<u2", 5125: "<u4", 5126: "<f4"}[accessor["componentType"]]
        width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}[accessor["type"]]
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        return np.frombuffer(self.bytes, kind, accessor["count"] * width, start).reshape(-1, width)


def turned(q, x):
    """Points x turned by the quaternion q = x, y, z, w."""
    return x + 2 * np.cross(q[:3], np.cross(q[:3], x) + q[3] * x)


class Transcription:
    """Equations 4 to 8 in NumPy, 64 bits: bones hang on the head directly, as the rig's do."""

    def __init__(self, folder):
        self.glb = Glb(folder / "head.glb")
        part = self.glb.json["meshes"][0]["primitives"][0]
        get = lambda name: self.glb.array(part["attributes"][name]).astype(float)
        joints, skin = get("JOINTS_0").astype(int), get("WEIGHTS_0")
        self.points, self.uvs = get("POSITION"), get("TEXCOORD_0")
        self.triangles = self.glb.array(part["indices"]).reshape(-1, 3).astype(int)
        self.names = [node["name"] for node in self.glb.json["nodes"]][:21]
        self.skin = np.zeros((len(self.points), 21))
        np.add.at(self.skin, (np.arange(len(joints))[:, None], joints), skin)
        self.skin /= self.skin.sum(axis=1, keepdims=True)
        binds = self.glb.array(self.glb.json["skins"][0]["inverseBindMatrices"]).reshape(-1, 4, 4)
        centroids = (self.skin.T @ self.points) / np.maximum(self.skin.sum(axis=0), 1e-300)[:, None]
        self.probes = centroids + binds[:, 3, :3]
        self.poses = [pose["bones"] for pose in json.loads((folder / "poses.json").read_text())["data"]["poses"]]

    def places(self, bones):
        """Probes in the head, mm, of a pose as poses.json says it."""
        rest = {node["name"]: node for node in self.glb.json["nodes"]}
        rows = []
        for name, probe in zip(self.names, self.probes):
            bone = bones.get(name, {})
            w, *xyz = bone.get("rotation_wxyz", [1, 0, 0, 0])
            rows.append(turned(np.array([*xyz, w]), probe) + bone.get("translation", rest[name]["translation"]))
        return 1000 * np.array(rows)

    def at(self, second):
        """The pose at a time of the expressions, between two keys a second apart."""
        animation = next(a for a in self.glb.json["animations"] if a["name"] == "expressions")
        bones, k, t = {}, int(second), second - int(second)
        for channel in animation["channels"]:
            sampler = animation["samplers"][channel["sampler"]]
            keys = self.glb.array(sampler["output"]).astype(float)
            a, b = keys[k], keys[min(k + 1, len(keys) - 1)]
            bone = bones.setdefault(self.names[channel["target"]["node"]], {})
            if channel["target"]["path"] == "translation":
                bone["translation"] = a + t * (b - a)
            else:
                angle = np.arccos(min(abs(a @ b), 1))
                q = a if angle < 1e-6 else (np.sin((1 - t) * angle) * a + np.sign(a @ b) * np.sin(t * angle) * b) / np.sin(angle)
                bone["rotation_wxyz"] = np.roll(q, 1)
        return bones

    def shares(self, bones):
        """Eq. 4, and which bones are of which pose."""
        rest = self.places({})
        ab = self.places(bones) - rest
        ac = np.array([self.places(pose) - rest for pose in self.poses])
        length = np.linalg.norm(ac, axis=2)
        # The head itself defines the space.
        of = (length >= np.maximum(0.5, 0.01 * length.max(axis=1, keepdims=True))) & (np.arange(21) > 0)
        return np.where(of, np.clip((ac * ab).sum(axis=2) / np.maximum(length, 1e-9) ** 2, 0, 1), 0), of

    def weights(self, bones):
        """Eq. 5–6 with the smooth mask: #K x #V."""
        alpha, of = self.shares(bones)
        theta = (np.cos(np.pi * (1 + alpha)) + 1) / 2
        x = np.minimum(4 * self.skin, 1)
        counts = x * x * (3 - 2 * x)
        return np.minimum(theta @ counts.T / np.maximum(of.astype(float) @ counts.T, 1), 1)


def picture(path):
    return cv2.cvtColor(cv2.imread(str(path), cv2.IMREAD_COLOR), cv2.COLOR_BGR2RGB).astype(float)


def encoded(normals):
    return np.rint((0.5 * normals / np.linalg.norm(normals, axis=2, keepdims=True) + 0.5) * 255)


def laid_over(neutral, maps, weights):
    """Eq. 7–8; weights: #K x H x W."""
    total = 2 * neutral / 255 - 1
    for image, weight in zip(maps, weights):
        n = 2 * image / 255 - 1
        n[..., :2] = np.where(np.abs(n[..., :2]) <= 1 / 255 + 1e-6, 0, n[..., :2])
        total[..., :2] += weight[..., None] * n[..., :2]
        total[..., 2] *= np.maximum(1 + weight * (n[..., 2] - 1), 0.05)
    return encoded(total)


def spread(mesh, weights, size):
    """Weights of vertices at the texels under the triangles, NaN elsewhere."""
    all_weights = np.full((len(weights), size, size), np.nan)
    at = mesh.uvs * size - 0.5
    for triangle in mesh.triangles:
        a, b, c = at[triangle]
        low, high = np.floor(np.min([a, b, c], axis=0)).astype(int), np.ceil(np.max([a, b, c], axis=0)).astype(int)
        x, y = np.meshgrid(np.arange(max(low[0], 0), min(high[0] + 1, size)), np.arange(max(low[1], 0), min(high[1] + 1, size)))
        area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])
        if area == 0 or x.size == 0:
            continue
        second = ((x - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (y - a[1])) / area
        third = ((b[0] - a[0]) * (y - a[1]) - (x - a[0]) * (b[1] - a[1])) / area
        inside = (second >= 0) & (third >= 0) & (second + third <= 1)
        i, j, l, m = y[inside], x[inside], second[inside], third[inside]
        for k, own in enumerate(weights):
            p, q, r = own[triangle]
            all_weights[k, i, j] = p + l * (q - p) + m * (r - p)
    return all_weights


def recovery(frames, poses):
    """At the reference poses (frames in the order of poses): the least own share and the largest of others over the bones of the
    pose; and the largest share that is shown, over vertices, of what another pose shows at its own."""
    own, others, sums = [], [], []
    for frame, pose in zip(frames, poses):
        bones = frame["bones"]
        own += bones[pose].values()
        others += [share for other in poses if other != pose for bone, share in bones[other].items() if bone in bones[pose]]
        sums.append([sum(frame["vertices"].get(other, [0])) for other in poses])
    shown = np.array(sums) / np.diag(sums)
    return min(own), max(others, default=0.0), float((shown - np.eye(len(poses))).max())


def real_recovery(ctx):
    """The least own share, and the largest crosstalk with and without --dual, of pose units of the real character."""
    model = ctx.data("skinned_face_makehuman") / "head_base.glb"
    program = ctx.binary("wrinkle-blend")
    poses = ctx.tmp / "real.json"
    ctx.run([program, "poses", "--model", model, *REAL, "--out", poses])
    summary = ctx.run([program, "check", "--model", model, *REAL, "--dual"])["results"]
    plain = ctx.run([program, "check", "--model", model, *REAL])["results"]
    largest = lambda matrix: max(share for m, row in enumerate(matrix) for k, share in enumerate(row) if k != m)
    return summary["own_share_min"], largest(summary["crosstalk"]), largest(plain["crosstalk"])


def score_browser(ctx, seeds):
    lacks = browser_lacks()
    if lacks:
        yield metric("shader_agreement", None, 0.999, "higher", "share") | {"reason": lacks}
        return
    found = {}
    for seed in seeds:
        folder = character(ctx, seed, vertices=6000, map_size=512)
        weighed, header, frames, _ = weights(ctx, folder, "expressions", "--rate", 2)
        out, _ = blended(ctx, folder, weighed, "--padding", 0)
        numbers = [frame["frame"] for frame in frames]
        found[seed] = agreement(ctx, folder, numbers, len(header["poses"]), lambda frame: picture(out / f"{frame:06}.png"))
    of = lambda key: {seed: one[key] for seed, one in found.items()}
    scale = {"browser": "headless Chromium, SwiftShader", "states": "13 of the expressions' animation", "map": "512 px"}
    yield metric("shader_agreement", min(of("share").values()), 0.999, "higher", "share", by_seed=of("share"), largest_codes=of("largest"), **scale)
    yield metric("shader_neutral_exact", min(of("exact").values()), True, "equal", "yes/no", by_seed=of("exact"))
    yield metric("uploads_while_moving", max(of("uploads").values()), 0, "equal", "calls", by_seed=of("uploads"))
    yield metric("page_faults", max(of("faults").values()), 0, "equal", "messages", by_seed=of("faults"))


def score(ctx):
    seeds = ctx.seeds or SEEDS
    own, others, crosstalk, plain, shares, at_vertices, exact, codes = ({} for _ in range(8))
    for seed in seeds:
        folder = character(ctx, seed, vertices=6000, map_size=512)
        mesh = Transcription(folder)
        _, header, frames, _ = weights(ctx, folder, "reference-poses", "--rate", 1, "--dual", "--frames", "1-4")
        own[seed], others[seed], crosstalk[seed] = recovery(frames, header["poses"])
        _, _, frames, _ = weights(ctx, folder, "reference-poses", "--rate", 1, "--frames", "1-4")
        plain[seed] = recovery(frames, header["poses"])[1:]
        path, header, frames, _ = weights(ctx, folder, "expressions", "--rate", 2)
        apart, off = 0.0, 0.0
        for frame in frames:
            alpha, of = mesh.shares(mesh.at(frame["frame"] / 2))
            for k, pose in enumerate(header["poses"]):
                apart = max([apart] + [abs(share - alpha[k, mesh.names.index(bone)]) for bone, share in frame["bones"][pose].items()])
            wanted = mesh.weights(mesh.at(frame["frame"] / 2))
            found = np.array([frame["vertices"].get(pose, np.zeros(len(mesh.points))) for pose in header["poses"]])
            off = max(off, np.abs(found - wanted).max())
        shares[seed], at_vertices[seed] = apart, off
        out, _ = blended(ctx, folder, path)
        maps = [picture(folder / f"{pose}.png") for pose in header["poses"]]
        neutral = picture(folder / "neutral.png")
        exact[seed] = bool((picture(out / "000000.png") == encoded(2 * neutral / 255 - 1)).all())
        worst = 0.0
        for frame in [f for f in frames if f["frame"] in (2, 10, 13)]:
            every = spread(mesh, mesh.weights(mesh.at(frame["frame"] / 2)), 512)
            wanted = laid_over(neutral, maps, np.nan_to_num(every))
            under = ~np.isnan(every[0])
            worst = max(worst, np.abs(picture(out / f"{frame['frame']:06}.png") - wanted)[under].max())
        codes[seed] = worst
    yield metric("pose_recovery", min(own.values()), 0.99, "higher", "share", by_seed=own, mode="--dual")
    yield metric("others_at_poses", max(others.values()), 0.01, "lower", "share", by_seed=others, mode="--dual", without_dual={seed: pair[0] for seed, pair in plain.items()})
    yield metric("crosstalk", max(crosstalk.values()), None, None, "share", by_seed=crosstalk, mode="--dual", without_dual={seed: pair[1] for seed, pair in plain.items()})
    yield metric("neutral_exact", min(exact.values()), True, "equal", "yes/no", by_seed=exact)
    yield metric("share_error", max(shares.values()), 1e-5, "lower", "share", by_seed=shares, peer="NumPy, 64 bits")
    yield metric("weight_error", max(at_vertices.values()), 1e-5, "lower", "share", by_seed=at_vertices, peer="NumPy, 64 bits")
    yield metric("map_error_codes", max(codes.values()), 1, "lower", "codes of 8 bits", by_seed=codes, peer="NumPy, 64 bits")
    least, largest, without = real_recovery(ctx)
    yield metric("real_pose_recovery", least, 0.99, "higher", "share", mode="--dual", character="MakeHuman head")
    yield metric("real_crosstalk", largest, 0.05, "lower", "share", mode="--dual", without_dual=without, character="MakeHuman head")
    yield from score_browser(ctx, seeds)


REPEATS = 3


def bench(ctx):
    folder = character(ctx, 1, vertices=10000, map_size=2048)
    mesh = Transcription(folder)
    ours, peers, rates, peer_rates = [], [], [], []
    path, header, frames, _ = weights(ctx, folder, "expressions", "--rate", 1)
    maps = [picture(folder / f"{pose}.png") for pose in header["poses"]]
    neutral = picture(folder / "neutral.png")
    texels = neutral.shape[0] * neutral.shape[1]
    for _ in range(REPEATS):
        _, _, many, summary = weights(ctx, folder, "expressions", "--rate", 30, "--threads", 1, "--bones-only")
        ours.append(1000 * summary["seconds"]["weights"] / len(many))
        start = time.perf_counter()
        mesh.weights(mesh.at(3.0))
        peers.append(1000 * (time.perf_counter() - start))
        _, summary = blended(ctx, folder, path, "--frames", "1-11", "--threads", 1)
        rates.append(11 * texels / summary["seconds"]["blend"] / 1e6)
        start = time.perf_counter()
        laid_over(neutral, maps, [np.full(neutral.shape[:2], 0.5)] * len(maps))
        peer_rates.append(texels / (time.perf_counter() - start) / 1e6)
    scale = {"vertices": header["vertex_count"], "bones": 21, "poses": len(header["poses"]), "threads": 1}
    spans = lambda values: {"min": min(values), "max": max(values)}
    yield metric("weights_ms", statistics.median(ours), 0.2, "lower", "ms", timed="shares of bones and weights of vertices; mean over a run's frames", **spans(ours), numpy_ms=statistics.median(peers), **scale)
    yield metric("blend_mpix_s", statistics.median(rates), 100, "higher", "Mpix/s", timed="weights over triangles, four maps of 2048², encoding; no files", frames="1-11 of the expressions, half of them the extremes", **spans(rates), numpy_mpix_s=statistics.median(peer_rates), threads=1)

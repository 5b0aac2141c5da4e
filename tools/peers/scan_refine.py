"""Scores of `scan-refine`: positions with noise and true normals (or biased ones) against the surface that they came from.

The truth is the analytic surface of `_skin.py`: its normals are found there, and errors are distances from it along its normals.
"""

import time

import numpy as np

from _skin import Skin
from _surfaces import angle_weighted_normals, lee_perry_smith, read_points, write_obj


def metric(name, value, target, better, unit, **context):
    return {"metric": name, "value": value, "target": target, "better": better, "unit": unit, "context": context}


def rms(values):
    return float(np.sqrt(np.mean(values**2)))


def degrees(one, other):
    return float(np.degrees(np.arccos(np.clip((one * other).sum(1), -1, 1))).mean())


def refine(ctx, name, points, triangles, normals, *options):
    mesh, given, out = (ctx.tmp / f"{name}{end}" for end in (".obj", ".npy", "-out.obj"))
    write_obj(mesh, points, triangles)
    np.save(given, normals.astype(np.float32))
    summary = ctx.run([ctx.binary("scan-refine"), "--mesh", mesh, "--unit", "mm", "--vertex-normals", given, "--out", out, *options])
    return read_points(out), summary


DEPTH, ALL = (0, 0, 1), (1, 1, 1)


class Case:
    """A surface with its true normals: smooth, with wrinkles. A scanner's noise is along its line of sight, z; surfaces lean by up
    to 50° from it."""

    def __init__(self, seed):
        self.skin = Skin(seed, size=40.0, edge=0.3, pore_rms=1e-9)
        self.rng = np.random.default_rng(1000 + seed)
        self.truth = self.skin.scan()
        self.normals = self._normals()

    def _normals(self):
        """By differences of the surface over a thousandth of a millimetre: exact but for the wrinkles' creases."""
        return angle_weighted_normals(self.truth, self.skin.triangles)

    def noise(self, sigma, axes):
        return sigma * self.rng.normal(size=self.truth.shape) * axes

    def off(self, points):
        return rms(((points - self.truth) * self.normals).sum(1))

    def run(self, ctx, name, sigma, normals, *options, axes=DEPTH):
        scan = self.truth + self.noise(sigma, axes)
        after, summary = refine(ctx, name, scan, self.skin.triangles, normals, *options)
        angle = degrees(angle_weighted_normals(after, self.skin.triangles), self.normals)
        return self.off(after) / self.off(scan), angle, self.off(after), summary

    def biased(self, lean):
        """Normals that lean by up to `lean` degrees, more and more over the patch, as under a near light, with 1° of noise."""
        p = (self.skin.points - self.skin.size / 2) / (self.skin.size / 2)
        turn = np.radians(lean) * np.column_stack([p[:, 0], 0.5 * p[:, 1] ** 2, np.zeros(len(p))])
        bent = self.normals + turn + np.radians(1.0) * self.rng.normal(size=turn.shape)
        return bent / np.linalg.norm(bent, axis=1)[:, None]


def score(ctx):
    cases = {seed: Case(seed) for seed in ctx.seeds}
    ratios, angles = {}, {}
    for sigma in (0.03, 0.1, 0.2):
        for seed, case in cases.items():
            ratio, angle, _, _ = case.run(ctx, f"noise-{seed}", sigma, case.normals)
            ratios[f"{seed}@{sigma}"], angles[f"{seed}@{sigma}"] = round(ratio, 3), round(angle, 2)
    about = {"noise_mm": [0.03, 0.1, 0.2], "edge_mm": 0.3, "seeds": list(ctx.seeds)}
    yield metric("noise_ratio", max(ratios.values()), 0.2, "lower", "ratio", each=ratios, **about)
    yield metric("angle_deg", max(angles.values()), 2, "lower", "°", each=angles, **about)
    for lean in (3, 8):
        rows = [case.run(ctx, f"bias-{seed}", 0.1, case.biased(lean)) for seed, case in cases.items()]
        plain = [case.run(ctx, f"bias-{seed}", 0.1, case.biased(lean), "--bias-mm", "0") for seed, case in cases.items()]
        yield metric(
            f"bias_{lean}deg_ratio", max(row[0] for row in rows), None, None, "ratio",
            off_mm=max(row[2] for row in rows), believed_off_mm=max(row[2] for row in plain), believed_ratio=max(row[0] for row in plain),
            angle_deg=max(row[1] for row in rows), normals=f"lean up to {lean}°, 1° of noise", noise_mm=0.1,
        )  # fmt: skip
    rows = [case.run(ctx, f"all-{seed}", 0.05, case.normals, axes=ALL) for seed, case in cases.items()]
    what = "noise of 0.05 mm along all axes: what moves vertices along the surface, normals cannot take back"
    yield metric("isotropic_noise_ratio", max(row[0] for row in rows), None, None, "ratio", what=what, angle_deg=max(r[1] for r in rows))
    truth, triangles = lee_perry_smith(ctx, 2)
    normals = angle_weighted_normals(truth, triangles)
    rng = np.random.default_rng(ctx.seeds[0])
    scan = truth + 0.05 * rng.normal(size=truth.shape) * DEPTH
    after, summary = refine(ctx, "real", scan, triangles, normals)
    seen = normals[:, 2] > 0.3  # what a scanner in front of the face sees
    off = [rms(((points - truth) * normals).sum(1)[seen]) for points in (scan, after)]
    about = {"scan": "Lee Perry-Smith, face subdivided twice", "noise_mm": 0.05, "vertices": len(truth)}
    yield metric("real_noise_ratio", off[1] / off[0], 0.2, "lower", "ratio", **about)
    angle = degrees(angle_weighted_normals(after, triangles)[seen], normals[seen])
    yield metric("real_angle_deg", angle, 2, "lower", "°", folded=summary["results"]["folded_triangles"], **about)


def bench(ctx):
    """700 000 vertices, reading and writing OBJ included."""
    skin = Skin(1, size=209.0, edge=0.25, wrinkle_count=3)
    normals = angle_weighted_normals(skin.scan(), skin.triangles)
    scan = skin.scan() + 0.1 * np.random.default_rng(1).normal(size=(len(normals), 3))
    mesh, given, out = ctx.tmp / "large.obj", ctx.tmp / "large.npy", ctx.tmp / "large-out.obj"
    write_obj(mesh, scan, skin.triangles)
    np.save(given, normals.astype(np.float32))
    seconds, inner = [], []
    for _ in range(3):
        start = time.perf_counter()
        words = ["--mesh", mesh, "--unit", "mm", "--vertex-normals", given, "--out", out]
        summary = ctx.run([ctx.binary("scan-refine"), *words])
        seconds.append(time.perf_counter() - start)
        inner.append(summary["seconds"]["refinement"])
    about = {"vertices": len(normals), "least": min(seconds), "most": max(seconds), "refinement_alone": float(np.median(inner))}
    yield metric("time_700k_s", float(np.median(seconds)), None, None, "s", **about)

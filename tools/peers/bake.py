"""Scores of `bake`: maps of a wrinkled sheet over a coarse one, against the sheet's formula.

What a renderer would show is computed here from the maps: normals and tangents of the coarse sheet by a transcription of MikkTSpace
[Mikkelsen2008] in NumPy. The truth is the normal of the formula at the place that the displacement leads to.
"""

import json
import time

import cv2
import numpy as np

from _surfaces import angle_weighted_normals

SIDE = 60.0
SIZE = 1024


def metric(name, value, target, better, unit, **context):
    return {"metric": name, "value": value, "target": target, "better": better, "unit": unit, "context": context}


class Sheet:
    """A bent sheet with six grooves that end within it: rounded bottoms, 0.8 to 2 mm wide, up to 0.6 of that deep."""

    def __init__(self, seed):
        rng = np.random.default_rng(seed)
        self.bends = rng.uniform(-6e-3, 6e-3, 3)
        self.grooves = [
            (rng.uniform(15, 45, 2), rng.uniform(0, np.pi), rng.uniform(0.8, 2), rng.uniform(0.2, 0.6), rng.uniform(6, 14)) for _ in range(6)
        ]

    def base(self, x, y):
        u, v = x - SIDE / 2, y - SIDE / 2
        return self.bends[0] * u * u + self.bends[1] * v * v + self.bends[2] * u * v

    def height(self, x, y):
        z = self.base(x, y)
        for (cx, cy), turn, width, ratio, length in self.grooves:
            along = (x - cx) * np.cos(turn) + (y - cy) * np.sin(turn)
            across = (y - cy) * np.cos(turn) - (x - cx) * np.sin(turn) - 0.02 * along**2
            round_ = np.hypot(across / width, 0.35)
            z = z + ratio * width * 2.2 * (round_ - 1) * np.exp(-round_) * np.exp(-((along / length) ** 4))
        return z

    def normal(self, x, y):
        e = 1e-4
        dx = (self.height(x + e, y) - self.height(x - e, y)) / (2 * e)
        dy = (self.height(x, y + e) - self.height(x, y - e)) / (2 * e)
        return unit(np.stack([-dx, -dy, np.ones_like(dx)], -1))


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def grid(cells, height):
    """Points, triangles, texture coordinates of a square sheet."""
    t = np.linspace(0, 1, cells + 1)
    u, v = np.meshgrid(t, t)
    x, y = u.ravel() * SIDE, v.ravel() * SIDE
    row, column = np.divmod(np.arange(cells * cells), cells)
    a = row * (cells + 1) + column
    b, c, d = a + 1, a + cells + 2, a + cells + 1
    triangles = np.stack([np.stack([a, b, c], 1), np.stack([a, c, d], 1)], 1).reshape(-1, 3)
    return np.stack([x, y, height(x, y)], 1), triangles, np.stack([u.ravel(), v.ravel()], 1)


def write(path, points, triangles, uvs):
    with path.open("w") as out:
        out.writelines(f"v {x:.9g} {y:.9g} {z:.9g}\n" for x, y, z in points)
        out.writelines(f"vt {u:.9g} {v:.9g}\n" for u, v in uvs)
        out.writelines(f"f {a}/{a} {b}/{b} {c}/{c}\n" for a, b, c in triangles + 1)


def tangents(points, triangles, uvs, normals):
    """Per vertex, for a texture that is nowhere mirrored and has no seams: angle-weighted sum of the triangles' tangents, each laid
    into the vertex's plane and made unit."""
    p, t = points[triangles], uvs[triangles]
    d1, d2, s1, s2 = p[:, 1] - p[:, 0], p[:, 2] - p[:, 0], t[:, 1] - t[:, 0], t[:, 2] - t[:, 0]
    along = unit(s2[:, 1:] * d1 - s1[:, 1:] * d2)
    sums = np.zeros_like(points)
    for k in range(3):
        vertex = triangles[:, k]
        n = normals[vertex]

        def flat(x, n=n):
            return unit(x - (x * n).sum(1, keepdims=True) * n)

        one, other = flat(p[:, (k + 1) % 3] - p[:, k]), flat(p[:, (k + 2) % 3] - p[:, k])
        angle = np.arccos(np.clip((one * other).sum(1), -1, 1))
        np.add.at(sums, vertex, angle[:, None] * flat(along))
    return unit(sums)


class Render:
    """The coarse sheet at the texels' centers."""

    def __init__(self, points, triangles, uvs, cells, size):
        self.normals = angle_weighted_normals(points, triangles)
        self.tangents = tangents(points, triangles, uvs, self.normals)
        t = (np.arange(size) + 0.5) / size
        u, v = np.meshgrid(t, 1 - t)
        column, row = np.minimum((u * cells).astype(int), cells - 1), np.minimum((v * cells).astype(int), cells - 1)
        fu, fv = u * cells - column, v * cells - row
        low = fv <= fu
        self.corners = triangles[2 * (row * cells + column) + ~low]
        shares = np.where(low[..., None], np.stack([1 - fu, fu - fv, fv], -1), np.stack([1 - fv, fu, fv - fu], -1))
        mixed = lambda of: (of[self.corners] * shares[..., None]).sum(-2)  # noqa: E731
        self.place, self.normal, self.tangent = mixed(points), mixed(self.normals), mixed(self.tangents)

    def shown(self, codes):
        n = 2 * codes / 65535 - 1
        bitangent = np.cross(self.normal, self.tangent)
        return unit(n[..., :1] * self.tangent + n[..., 1:2] * bitangent + n[..., 2:] * self.normal)


def baked(ctx, sheet, name, cells, size, *options):
    low, high, out = ctx.tmp / f"{name}-low.obj", ctx.tmp / f"{name}-high.obj", ctx.tmp / f"{name}-maps"
    coarse = grid(cells, sheet.base)
    write(low, *coarse)
    write(high, *grid(600, sheet.height))
    words = ["--low", low, "--high", high, "--unit", "mm", "--size", str(size), "--out", out, "--tangents", out / "tangents.npy"]
    start = time.perf_counter()
    summary = ctx.run([ctx.binary("bake"), *words, *options])
    return coarse, out, summary, time.perf_counter() - start


def picture(path):
    image = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
    return image[..., ::-1].astype(float) if image.ndim == 3 else image.astype(float)


def score(ctx):
    cells = 24
    medians, p90s, flats, offs, agree = {}, {}, {}, {}, {}
    for seed in ctx.seeds:
        sheet = Sheet(seed)
        (points, triangles, uvs), out, _, _ = baked(ctx, sheet, f"sheet-{seed}", cells, SIZE)
        render = Render(points, triangles, uvs, cells, SIZE)
        index = json.loads((out / "maps.json").read_text())["data"]
        height = picture(out / "displacement.png") / 65535 * (index["white_mm"] - index["black_mm"]) + index["black_mm"]
        at = render.place + height[..., None] * unit(render.normal)
        truth = sheet.normal(at[..., 0], at[..., 1])
        angle = np.degrees(np.arccos(np.clip((render.shown(picture(out / "normal.png")) * truth).sum(-1), -1, 1)))
        bare = np.degrees(np.arccos(np.clip((unit(render.normal) * truth).sum(-1), -1, 1)))
        steep = bare > 10
        medians[seed], p90s[seed] = float(np.median(angle[steep])), float(np.quantile(angle[steep], 0.9))
        flats[seed] = float(np.median(angle))
        offs[seed] = float(np.quantile(np.abs(at[..., 2] - sheet.height(at[..., 0], at[..., 1])), 0.95))
        given = np.load(out / "tangents.npy").reshape(-1, 3, 4)
        agree[seed] = float(np.abs(given[..., :3] - render.tangents[triangles]).max() + np.abs(given[..., 3] - 1).max())
    about = {"texels": SIZE, "coarse_vertices": (cells + 1) ** 2, "fine_vertices": 601**2, "seeds": list(ctx.seeds)}
    worst = max(medians.values())
    yield metric("normal_median_deg", worst, 0.5, "lower", "°", where="true tilt over 10° from the coarse mesh", each=medians, **about)
    yield metric("normal_p90_deg", max(p90s.values()), None, None, "°", **about)
    yield metric("normal_all_median_deg", max(flats.values()), None, None, "°", **about)
    yield metric("displacement_p95_mm", max(offs.values()), None, None, "mm", **about)
    what = "largest difference of a tangent's coordinate from a transcription in NumPy; bit-equality with another port is a test"
    yield metric("mikktspace_off", max(agree.values()), 1e-5, "lower", "length", what=what)


def bench(ctx):
    """2048² texels of four samples, 361 000 fine vertices; reading OBJ and writing apart."""
    inner, whole = [], []
    for _ in range(3):
        _, _, summary, seconds = baked(ctx, Sheet(1), "bench", 24, 2048)
        inner.append(summary["seconds"]["bake"])
        whole.append(seconds)
    about = {"least": min(inner), "most": max(inner), "with_files": float(np.median(whole)), "samples": 4}
    yield metric("bake_2048_s", float(np.median(inner)), None, None, "s", **about)

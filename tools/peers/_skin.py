"""Skin of known parts for `wrinkle_removal` and `scan_refine`: a curved patch, wrinkles on it, pores on all of it."""

import numpy as np
from scipy.spatial import Delaunay


class Skin:
    """A patch of `size` mm with edges of about `edge` mm; all parts are heights along the normals of the smooth part.

    points: (V, 2) places in the plane; smooth: (V, 3); normals of it; wrinkles, pores: (V,) mm; reach: (V,) distance from the
    nearest valley in its widths.
    """

    def __init__(self, seed, size=50.0, edge=0.2, wrinkle_count=3, pore_rms=0.015, pore_waves=(0.5, 0.9), rounding=0.12):
        rng = np.random.default_rng(seed)
        self.size, self.edge, self.rounding = size, edge, rounding
        count = int(round(size / edge))
        x, y = np.meshgrid(np.linspace(0, size, count + 1), np.linspace(0, size, count + 1))
        places = np.stack([x.ravel(), y.ravel()], 1)
        inside = ((places > 0) & (places < size)).all(1)
        places[inside] += rng.uniform(-0.25, 0.25, (inside.sum(), 2)) * size / count
        self.points = places
        self.triangles = np.ascontiguousarray(Delaunay(places).simplices.astype(np.int64))
        a, b, c = (places[self.triangles[:, i]] for i in range(3))
        turned = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0] < 0
        self.triangles[turned] = self.triangles[turned][:, ::-1]
        self._shape(rng)
        self._wrinkles(rng, wrinkle_count)
        self.pores = self._pores(rng, pore_rms, pore_waves)

    # -- the smooth part: a saddle or dome of face-like radii, with soft hills

    def _shape(self, rng):
        self.bend = 1 / rng.uniform(50, 110, 2) * np.array([1, rng.choice([-0.4, 1.0])])
        self.hills = [(rng.uniform(0, self.size, 2), rng.uniform(12, 20), rng.uniform(-1.5, 1.5)) for _ in range(4)]
        height, slope = self.surface(self.points)
        self.smooth = np.column_stack([self.points, height])
        self.normals = np.column_stack([-slope, np.ones(len(height))])
        self.normals /= np.linalg.norm(self.normals, axis=1)[:, None]

    def surface(self, places):
        """Height of the smooth part, and its slope."""
        p = places - self.size / 2
        height, slope = -0.5 * (self.bend * p**2).sum(1), -self.bend * p
        for middle, width, lift in self.hills:
            d = places - middle
            bump = lift * np.exp(-0.5 * (d**2).sum(1) / width**2)
            height, slope = height + bump, slope - bump[:, None] * d / width**2
        return height, slope

    # -- wrinkles: bent lines with the paper's profile, fading at their ends

    def _wrinkles(self, rng, count):
        self.wrinkles, self.reach = np.zeros(len(self.points)), np.full(len(self.points), np.inf)
        self.valleys = []
        heading = rng.uniform(0, np.pi)
        for number in range(count):
            width = rng.uniform(0.9, 1.6)
            depth = width * rng.uniform(0.2, 0.5)
            across = np.array([-np.sin(heading), np.cos(heading)])
            middle = self.size / 2 + (number - (count - 1) / 2) * 9 * across + rng.uniform(-1, 1, 2)
            half = rng.uniform(8, 11)
            t = np.linspace(-1, 1, 60)[:, None]
            line = middle + half * t * [np.cos(heading), np.sin(heading)] + rng.uniform(-2, 2) * (t**2 - 0.3) * across
            away, along = _distance(self.points, line)
            fade = np.clip((1 - np.abs(2 * along - 1)) / 0.25, 0, 1)
            fade = fade**2 * (3 - 2 * fade)
            p = np.sqrt(away**2 + (self.rounding * width) ** 2) / width
            self.wrinkles += fade * depth * (p - 1) * np.exp(-p)
            self.reach = np.minimum(self.reach, away / width)
            self.valleys.append((line, width, depth))

    def _pores(self, rng, rms, waves):
        """Noise between two wavelengths, in all directions."""
        step = min(waves) / 6
        n = int(self.size / step) + 1
        frequency = np.hypot(*np.meshgrid(np.fft.fftfreq(n, step), np.fft.fftfreq(n, step)))
        band = (frequency > 1 / waves[1]) & (frequency < 1 / waves[0])
        field = np.fft.ifft2(np.fft.fft2(rng.normal(size=(n, n))) * band).real
        at = np.clip(self.points / step, 0, n - 1.001)
        low, share = at.astype(int), at - at.astype(int)
        pick = lambda dx, dy: field[low[:, 1] + dy, low[:, 0] + dx]
        values = (1 - share[:, 1]) * ((1 - share[:, 0]) * pick(0, 0) + share[:, 0] * pick(1, 0)) + share[:, 1] * (
            (1 - share[:, 0]) * pick(0, 1) + share[:, 0] * pick(1, 1)
        )
        return values * rms / values.std()

    def scan(self):
        return self.smooth + (self.wrinkles + self.pores)[:, None] * self.normals

    def heights(self, positions):
        """Heights above the smooth part, along its normals: two steps of Newton for the foot point."""
        place = positions[:, :2].copy()
        for _ in range(3):
            height, slope = self.surface(place)
            normal = np.column_stack([-slope, np.ones(len(height))])
            normal /= np.linalg.norm(normal, axis=1)[:, None]
            off = positions - np.column_stack([place, height])
            above = (off * normal).sum(1)
            place = place + (off - above[:, None] * normal)[:, :2]
        return above

    # -- bands

    def grid(self):
        """Where fields are compared: a regular grid of half the edge."""
        if not hasattr(self, "_grid"):
            self._grid = _Grid(self)
        return self._grid


def _distance(points, line):
    """Distance of points from a polyline, and where along it (0 to 1) the nearest place is."""
    best, along = np.full(len(points), np.inf), np.zeros(len(points))
    for i, (a, b) in enumerate(zip(line, line[1:])):
        side = b - a
        t = np.clip(((points - a) @ side) / (side @ side), 0, 1)
        d = np.linalg.norm(points - (a + t[:, None] * side), axis=1)
        nearer = d < best
        best[nearer], along[nearer] = d[nearer], (i + t[nearer]) / (len(line) - 1)
    return best, along


def relief(points, rng, lines):
    """Heights of wrinkles along lines in x and y, of pores all over, and the distance from the lines in widths, for the front of
    a face."""
    wrinkles, reach = np.zeros(len(points)), np.full(len(points), np.inf)
    front = points[:, 2] > -10
    for ends in lines:
        ends = np.array(ends, float)
        width = rng.uniform(1.0, 1.5)
        depth = width * rng.uniform(0.2, 0.4)
        t = np.linspace(-1, 1, 40)[:, None]
        side = ends[1] - ends[0]
        across = np.array([-side[1], side[0]]) / np.linalg.norm(side)
        line = ends.mean(0) + 0.5 * t * side + rng.uniform(-1.5, 1.5) * (t**2 - 0.3) * across
        away, along = _distance_3d(points, line, front)
        fade = np.clip((1 - np.abs(2 * along - 1)) / 0.25, 0, 1)
        fade = fade**2 * (3 - 2 * fade)
        p = np.sqrt(np.minimum(away, 50 * width) ** 2 + (0.12 * width) ** 2) / width
        wrinkles += fade * depth * (p - 1) * np.exp(-p)
        reach = np.minimum(reach, away / width)
    # Pores: plane waves in random directions of space, of the wavelengths that the mesh can carry.
    waves = rng.normal(size=(60, 3)) * [1, 1, 0]  # across the front: waves into its depth would be long ones on it
    waves *= (2 * np.pi / rng.uniform(0.6, 0.9, 60) / np.linalg.norm(waves, axis=1))[:, None]
    pores = sum(np.cos(points @ wave + phase) for wave, phase in zip(waves, rng.uniform(0, 2 * np.pi, 60)))
    return wrinkles, 0.015 * pores / pores.std(), reach


def _distance_3d(points, line, front):
    """Distance from a line over the front of a surface: its points take the depth of the nearest vertex."""
    from scipy.spatial import cKDTree

    chosen = np.flatnonzero(front)
    fine = np.column_stack([np.interp(np.linspace(0, 1, 400), np.linspace(0, 1, len(line)), line[:, i]) for i in (0, 1)])
    _, nearest = cKDTree(points[chosen][:, :2]).query(fine, k=4)
    depth = points[chosen][nearest][:, :, 2].mean(1)
    curve = np.column_stack([fine, np.convolve(np.pad(depth, 10, mode="edge"), np.ones(21) / 21, "valid")])
    away, at = np.full(len(points), np.inf), np.zeros(len(points))
    away[chosen], found = cKDTree(curve).query(points[chosen])
    at[chosen] = found / (len(curve) - 1)
    return away, at


class _Grid:
    """Fields on the vertices, taken to a regular grid, where bands are told apart."""

    def __init__(self, skin):
        self.step = skin.edge / 2
        self.n = int(skin.size / self.step)
        axis = (np.arange(self.n) + 0.5) * self.step
        x, y = np.meshgrid(axis, axis)
        places = np.column_stack([x.ravel(), y.ravel()])
        simplices = Delaunay(skin.points)
        found = simplices.find_simplex(places)
        flat = simplices.transform[found]
        two = np.einsum("nij,nj->ni", flat[:, :2], places - flat[:, 2])
        self.shares = np.column_stack([two, 1 - two.sum(1)])
        self.corners = simplices.simplices[found]
        f = np.fft.fftfreq(2 * self.n, self.step)
        self.frequency = np.hypot(*np.meshgrid(f[: self.n + 1], f))

    def take(self, values):
        """A field of the vertices on the grid."""
        return (values[self.corners] * self.shares).sum(1).reshape(self.n, self.n)

    def band(self, field, shortest=None, longest=None):
        """Its wavelengths between two, mm, with flanks of 16th order; the field goes on mirrored."""
        keep = np.ones_like(self.frequency)
        if shortest is not None:
            keep /= 1 + (self.frequency * shortest) ** 16
        if longest is not None:
            keep *= 1 - 1 / (1 + (self.frequency * longest) ** 16)
        mirrored = np.block([[field, field[:, ::-1]], [field[::-1], field[::-1, ::-1]]])
        return np.fft.irfft2(np.fft.rfft2(mirrored) * keep, mirrored.shape)[: self.n, : self.n]

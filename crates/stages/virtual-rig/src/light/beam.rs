//! Parallel rays from neighbouring points, followed together.
//!
//! All rays of a beam share a direction, so that what depends on the direction only is worked out once: the order of the
//! planes of a box, and the projection of a triangle along the rays. Loops over lanes are written plainly; the compiler
//! turns them into the widest vectors that the caller's dispatch found. Nothing here contracts products and sums, so that
//! the results are the same for every width.

/// Rays in a beam.
pub(super) const LANES: usize = 16;

/// One number per ray.
pub(super) type Lanes = [f32; LANES];

/// A point; the fourth number is filling. Indices are masked to the length where they come from data, so that no check
/// remains in the loops.
pub(super) type Corner = [f32; 4];

/// What does not depend on where rays start.
#[derive(Debug, Clone, Copy)]
pub(super) struct Heading {
    /// Unit length.
    direction: [f32; 3],
    inverse: [f32; 3],
    /// Per axis which corner of a box rays pass first: 0 low, 1 high.
    entry: [usize; 3],
    /// The axis that the direction follows most (last), and the other two.
    axes: [usize; 3],
    /// Shift of the first two of `axes` per step along the last.
    shear: [f32; 2],
    /// Distance along the ray per step along the last axis.
    stretch: f32,
}

impl Heading {
    pub(super) fn new(direction: [f32; 3]) -> Self {
        let [x, y, z] = direction.map(f32::abs);
        let last = if x >= y && x >= z {
            0
        } else if y >= z {
            1
        } else {
            2
        };
        let axes = [(last + 1) % 3, (last + 2) % 3, last];
        // A component of 0 would make 0 · ∞ where a ray runs in a box's face.
        let inverse = direction.map(|d| 1.0 / if d.abs() < 1e-18 { 1e-18_f32.copysign(d) } else { d });
        Self {
            direction,
            inverse,
            entry: direction.map(|d| usize::from(d.is_sign_negative())),
            axes,
            shear: [direction[axes[0]] / direction[last], direction[axes[1]] / direction[last]],
            stretch: 1.0 / direction[last],
        }
    }
}

/// Where the rays start: relative to a centre, so that the digits go where the triangles are near.
#[derive(Debug, Clone)]
pub(super) struct Origins {
    pub(super) center: Corner,
    /// Per axis, mm from the centre.
    pub(super) offset: [Lanes; 3],
}

/// What rays met.
#[derive(Debug, Clone)]
pub(super) struct Hits {
    /// How far a ray still looks, mm; below 0: no further.
    pub(super) reach: Lanes,
    /// Triangle of the nearest hit, and the weights of its second and third corner there.
    pub(super) triangle: [u32; LANES],
    pub(super) u: Lanes,
    pub(super) v: Lanes,
}

/// No triangle.
pub(super) const NONE: u32 = u32::MAX;

impl Hits {
    /// Before anything is met; rays with a reach below 0 are not followed.
    #[inline(always)]
    pub(super) fn none(reach: Lanes) -> Self {
        Self { reach, triangle: [NONE; LANES], u: [0.0; LANES], v: [0.0; LANES] }
    }

    #[inline(always)]
    pub(super) fn all_blocked(&self) -> bool {
        let mut open = false;
        for lane in 0..LANES {
            open |= self.reach[lane] > 0.0;
        }
        !open
    }
}

/// Parallel rays.
#[derive(Debug, Clone)]
pub(super) struct Beam<'a> {
    heading: &'a Heading,
    origins: &'a Origins,
    /// Starts seen along the rays, on the first two axes.
    start: [Lanes; 2],
    /// And on the last one.
    along: Lanes,
}

impl<'a> Beam<'a> {
    #[inline(always)]
    pub(super) fn new(heading: &'a Heading, origins: &'a Origins) -> Self {
        let [a, b, c] = heading.axes;
        let mut start = [[0.0; LANES]; 2];
        for lane in 0..LANES {
            start[0][lane] = origins.offset[a][lane] - heading.shear[0] * origins.offset[c][lane];
            start[1][lane] = origins.offset[b][lane] - heading.shear[1] * origins.offset[c][lane];
        }
        Self { heading, origins, start, along: origins.offset[c] }
    }

    /// Which of two boxes lies nearer along the rays.
    #[inline(always)]
    pub(super) fn enters_first(&self, boxes: &[[Corner; 2]; 2]) -> usize {
        let mut ahead = 0.0;
        for axis in 0..3 {
            let [left, right] =
                [boxes[0][0][axis] + boxes[0][1][axis], boxes[1][0][axis] + boxes[1][1][axis]];
            ahead += self.heading.direction[axis] * (left - right);
        }
        usize::from(ahead > 0.0)
    }

    /// Whether any ray passes a box within its reach.
    #[inline(always)]
    pub(super) fn meets(&self, corners: &[Corner; 2], reach: &Lanes) -> bool {
        // Three roundings on each side of the comparison [Ize2013].
        const SLACK: f32 = 1.000_001;
        let plane = |axis: usize, corner: usize| corners[corner & 1][axis] - self.origins.center[axis];
        let entry = self.heading.entry;
        let near = [plane(0, entry[0]), plane(1, entry[1]), plane(2, entry[2])];
        let far = [plane(0, entry[0] ^ 1), plane(1, entry[1] ^ 1), plane(2, entry[2] ^ 1)];
        let [x, y, z] = &self.origins.offset;
        let inverse = self.heading.inverse;
        let mut any = false;
        for lane in 0..LANES {
            let enter = max(
                max((near[0] - x[lane]) * inverse[0], (near[1] - y[lane]) * inverse[1]),
                max((near[2] - z[lane]) * inverse[2], 0.0),
            );
            let leave = min(
                min((far[0] - x[lane]) * inverse[0], (far[1] - y[lane]) * inverse[1]),
                (far[2] - z[lane]) * inverse[2],
            );
            any |= enter <= min(leave * SLACK, reach[lane]);
        }
        any
    }

    /// Takes note of the rays that a triangle stops within their reach, from either side. Watertight: projected along
    /// the rays, an edge is the same for both its triangles [Woop2013].
    #[inline(always)]
    pub(super) fn cross<const ANY: bool>(&self, corners: &[Corner; 3], id: u32, hits: &mut Hits) {
        let Heading { axes, shear, stretch, .. } = *self.heading;
        let center = &self.origins.center;
        // Loops, not closures: those are left out when the caller is compiled for wider vectors.
        let mut seen = [[0.0; 3]; 3];
        for corner in 0..3 {
            let place = |axis: usize| corners[corner][axes[axis] & 3] - center[axes[axis] & 3];
            let along = place(2);
            for axis in 0..2 {
                seen[corner][axis] = place(axis) - shear[axis] * along;
            }
            seen[corner][2] = along;
        }
        let [p, q, r] = seen;
        for lane in 0..LANES {
            let (x, y) = (self.start[0][lane], self.start[1][lane]);
            let [px, py, qx, qy, rx, ry] = [p[0] - x, p[1] - y, q[0] - x, q[1] - y, r[0] - x, r[1] - y];
            let [a, b, c] = [rx * qy - ry * qx, px * ry - py * rx, qx * py - qy * px];
            let inside = (min(min(a, b), c) >= 0.0) | (max(max(a, b), c) <= 0.0);
            let area = a + b + c;
            let t = ((a * p[2] + b * q[2] + c * r[2]) / area - self.along[lane]) * stretch;
            let reach = hits.reach[lane];
            if ANY {
                hits.reach[lane] = if inside & (t > 0.0) & (t < reach) { -1.0 } else { reach };
            } else {
                // Of triangles that meet in the point hit, the first in the caller's list, however the tree lies.
                let nearer = (t < reach) | ((t == reach) & (id < hits.triangle[lane]));
                if inside & (t > 0.0) & nearer {
                    hits.reach[lane] = t;
                    hits.triangle[lane] = id;
                    hits.u[lane] = b / area;
                    hits.v[lane] = c / area;
                }
            }
        }
    }
}

/// Unlike [`f32::max`], one instruction: of no interest is what becomes of NaN.
#[inline(always)]
fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

#[inline(always)]
fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

//! The discrete shell energy [Grinspun2003] of one edge and one triangle, with gradients and Hessians in closed form.
//!
//! Each term is `k (q − q̄)²` of a geometric quantity q: its Gauss–Newton Hessian is `2k ∇q ∇qᵀ`, the exact one adds
//! `2k (q − q̄) ∇²q`.

use nalgebra::{Matrix3, Point3, Vector3};

/// Which second derivatives are wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Curvature {
    /// `JᵀJ`: positive semi-definite, without the change of J.
    GaussNewton,
    /// The Hessian itself.
    Exact,
}

/// A term's value, gradient and Hessian in its `N` vertices.
#[derive(Debug, Clone, Copy)]
pub struct Term<const N: usize> {
    /// Energy.
    pub energy: f64,
    /// Per vertex the derivative of the energy.
    pub gradient: [Vector3<f64>; N],
    /// Second derivatives: block (i, j) is ∂²E/∂xᵢ∂xⱼ.
    pub hessian: [[Matrix3<f64>; N]; N],
}

/// `k (q − q̄)²` from q's own derivatives; `second` is ∇²q, left out in Gauss–Newton.
fn squared<const N: usize>(
    weight: f64,
    excess: f64,
    slope: &[Vector3<f64>; N],
    second: Option<&[[Matrix3<f64>; N]; N]>,
) -> Term<N> {
    let gradient = slope.map(|s| 2.0 * weight * excess * s);
    let mut hessian = [[Matrix3::zeros(); N]; N];
    for i in 0..N {
        let row = 2.0 * weight * slope[i];
        for j in 0..N {
            hessian[i][j] = row * slope[j].transpose();
            if let Some(second) = second {
                hessian[i][j] += 2.0 * weight * excess * second[i][j];
            }
        }
    }
    Term { energy: weight * excess * excess, gradient, hessian }
}

/// Stretching of an edge: `k (‖e‖ − ‖ē‖)²`. `points`: mm; `rest`: ‖ē‖, mm.
#[must_use]
pub fn edge(points: &[Point3<f64>; 2], rest: f64, weight: f64, curvature: Curvature) -> Term<2> {
    let along = points[1] - points[0];
    let length = along.norm().max(f64::MIN_POSITIVE);
    let unit = along / length;
    let slope = [-unit, unit];
    let across = (Matrix3::identity() - unit * unit.transpose()) / length;
    let second = [[across, -across], [-across, across]];
    squared(weight, length - rest, &slope, (curvature == Curvature::Exact).then_some(&second))
}

/// Change of a triangle's area: `k (‖t‖ − ‖t̄‖)²`. `points`: mm; `rest`: ‖t̄‖, mm².
///
/// With n the unit normal and eᵢ the side opposite to vertex i: `∂A/∂xᵢ = ½ n × eᵢ`,
/// `∂²A/∂xᵢ∂xⱼ = (eᵢ·eⱼ)/(4A) n nᵀ + ½ [n]× ∂eᵢ/∂xⱼ`.
#[must_use]
pub fn triangle(points: &[Point3<f64>; 3], rest: f64, weight: f64, curvature: Curvature) -> Term<3> {
    let opposite: [Vector3<f64>; 3] = std::array::from_fn(|i| points[(i + 2) % 3] - points[(i + 1) % 3]);
    let double = opposite[0].cross(&opposite[1]);
    let area = (0.5 * double.norm()).max(f64::MIN_POSITIVE);
    let normal = double / (2.0 * area);
    let slope = opposite.map(|side| 0.5 * normal.cross(&side));
    let second = || {
        let (outer, turn) = (normal * normal.transpose(), 0.5 * normal.cross_matrix());
        std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let lean = outer * (opposite[i].dot(&opposite[j]) / (4.0 * area));
                match (j + 3 - i) % 3 {
                    0 => lean,
                    1 => lean - turn,
                    _ => lean + turn,
                }
            })
        })
    };
    let second = (curvature == Curvature::Exact).then(second);
    squared(weight, area - rest, &slope, second.as_ref())
}

/// The angle between the normals of two triangles that share the edge 0–1, positive where the surface is convex seen from
/// outside; `points`: both ends of the edge, in the direction in which the first triangle runs along it, then the apex of
/// the first and of the second triangle.
#[must_use]
pub fn dihedral_angle(points: &[Point3<f64>; 4]) -> f64 {
    let (first, second, along) = normals(points);
    first.cross(&second).dot(&along.normalize()).atan2(first.dot(&second))
}

/// Area vectors of both triangles (twice their areas long), and the edge.
fn normals(points: &[Point3<f64>; 4]) -> (Vector3<f64>, Vector3<f64>, Vector3<f64>) {
    let along = points[1] - points[0];
    let first = along.cross(&(points[2] - points[0]));
    let second = (points[3] - points[0]).cross(&along);
    (first, second, along)
}

/// Bending at an edge: `k (θ − θ̄)²`, the difference taken the short way around. `points` as in [`dihedral_angle`].
///
/// The gradient at an apex is the normal over the triangle's height, at the edge's ends what keeps forces and moments in
/// balance; the Hessian is its derivative, product rule by product rule.
#[must_use]
pub fn hinge(points: &[Point3<f64>; 4], rest: f64, weight: f64, curvature: Curvature) -> Term<4> {
    let shape = HingeShape::of(points);
    let excess = wrapped(dihedral_angle(points) - rest);
    let second = (curvature == Curvature::Exact).then(|| shape.second());
    squared(weight, excess, &shape.slope(), second.as_ref())
}

/// An angle in (−π, π].
pub(crate) fn wrapped(angle: f64) -> f64 {
    let turn = std::f64::consts::TAU;
    angle - turn * (angle / turn).round()
}

/// The two triangles at an edge.
struct HingeShape {
    along: Vector3<f64>,
    length: f64,
    /// From the edge's start to each apex.
    to_apex: [Vector3<f64>; 2],
    /// Area vectors, twice as long as the areas.
    area: [Vector3<f64>; 2],
    area_squared: [f64; 2],
    /// Where along the edge each apex stands, as a share of it.
    foot: [f64; 2],
    /// θ's derivative at each apex.
    apex: [Vector3<f64>; 2],
}

impl HingeShape {
    fn of(points: &[Point3<f64>; 4]) -> Self {
        let (first, second, along) = normals(points);
        let length = along.norm().max(f64::MIN_POSITIVE);
        let area = [first, second];
        let area_squared = area.map(|a| a.norm_squared().max(f64::MIN_POSITIVE));
        let to_apex = [points[2] - points[0], points[3] - points[0]];
        let foot = to_apex.map(|a| a.dot(&along) / (length * length));
        let apex = [0, 1].map(|i| -area[i] * (length / area_squared[i]));
        Self { along, length, to_apex, area, area_squared, foot, apex }
    }

    fn slope(&self) -> [Vector3<f64>; 4] {
        let [one, other] = self.apex;
        let [s, t] = self.foot;
        [-(one * (1.0 - s) + other * (1.0 - t)), -(one * s + other * t), one, other]
    }

    /// ∇²θ. Rows and columns in the order of the points.
    fn second(&self) -> [[Matrix3<f64>; 4]; 4] {
        let mut blocks = [[Matrix3::zeros(); 4]; 4];
        for wing in 0..2 {
            let (turned, shifted) = (self.apex_derivative(wing), self.foot_derivative(wing));
            let (apex, foot) = (self.apex[wing], self.foot[wing]);
            for j in 0..4 {
                let lever = apex * shifted[j].transpose();
                blocks[0][j] -= turned[j] * (1.0 - foot) - lever;
                blocks[1][j] -= turned[j] * foot + lever;
                blocks[2 + wing][j] += turned[j];
            }
        }
        blocks
    }

    /// How the gradient at an apex, `−‖e‖ c/‖c‖²` with c the area vector, changes with each point.
    fn apex_derivative(&self, wing: usize) -> [Matrix3<f64>; 4] {
        let (area, squared) = (self.area[wing], self.area_squared[wing]);
        let unit = self.along / self.length;
        // ∂c/∂xⱼ = [side opposite to j]×; the second triangle runs the other way around.
        let sign = if wing == 0 { 1.0 } else { -1.0 };
        let apex = self.to_apex[wing];
        let mut sides = [Vector3::zeros(); 4];
        sides[0] = sign * (apex - self.along);
        sides[1] = -sign * apex;
        sides[2 + wing] = sign * self.along;
        let flat =
            (Matrix3::identity() - area * area.transpose() * (2.0 / squared)) * (-self.length / squared);
        let mut derivative = sides.map(|side| flat * side.cross_matrix());
        let stretch = area * unit.transpose() / squared;
        derivative[0] += stretch;
        derivative[1] -= stretch;
        derivative
    }

    /// How the foot of an apex, `a·e/e²`, changes with each point.
    fn foot_derivative(&self, wing: usize) -> [Vector3<f64>; 4] {
        let (apex, foot) = (self.to_apex[wing], self.foot[wing]);
        let scale = 1.0 / (self.length * self.length);
        let end = (apex - self.along * (2.0 * foot)) * scale;
        let mut derivative = [Vector3::zeros(); 4];
        derivative[1] = end;
        derivative[2 + wing] = self.along * scale;
        derivative[0] = -(end + derivative[2 + wing]);
        derivative
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{Rng, SeedableRng};

    fn points<const N: usize>(seed: u64, spread: f64) -> [Point3<f64>; N] {
        let flat = [[0.0, 0.0], [1.0, 0.1], [0.4, 0.9], [0.6, -0.8]];
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
        let mut shaken = || spread * (random.random::<f64>() - 0.5);
        std::array::from_fn(|i| Point3::new(flat[i][0] + shaken(), flat[i][1] + shaken(), shaken()))
    }

    /// Largest deviations of gradient and Hessian from central differences, relative to their largest entries.
    fn deviations<const N: usize>(
        at: [Point3<f64>; N],
        term: impl Fn(&[Point3<f64>; N], Curvature) -> Term<N>,
    ) -> [f64; 2] {
        let step = 1e-5;
        let here = term(&at, Curvature::Exact);
        let (mut worst, mut largest) = ([0.0f64; 2], [0.0f64; 2]);
        for j in 0..N {
            for c in 0..3 {
                let (mut up, mut down) = (at, at);
                up[j][c] += step;
                down[j][c] -= step;
                let (up, down) = (term(&up, Curvature::Exact), term(&down, Curvature::Exact));
                let slope = (up.energy - down.energy) / (2.0 * step);
                worst[0] = worst[0].max((slope - here.gradient[j][c]).abs());
                largest[0] = largest[0].max(slope.abs());
                for i in 0..N {
                    for r in 0..3 {
                        let bend = (up.gradient[i][r] - down.gradient[i][r]) / (2.0 * step);
                        worst[1] = worst[1].max((bend - here.hessian[i][j][(r, c)]).abs());
                        largest[1] = largest[1].max(bend.abs());
                    }
                }
            }
        }
        [worst[0] / largest[0], worst[1] / largest[1]]
    }

    #[test]
    fn derivatives_agree_with_differences() {
        for seed in 0..40 {
            let spread = 0.02 * seed as f64;
            let found = [
                deviations(points::<2>(seed, spread), |p, c| edge(p, 0.8, 300.0, c)),
                deviations(points::<3>(seed, spread), |p, c| triangle(p, 0.4, 3e4, c)),
                deviations(points::<4>(seed, spread), |p, c| hinge(p, 0.3, 8.0, c)),
            ];
            for [gradient, hessian] in found {
                assert!(gradient < 1e-6 && hessian < 1e-6, "seed {seed}: {found:?}");
            }
        }
    }

    #[test]
    fn a_fold_beyond_half_a_turn_costs_the_short_way() {
        assert!((wrapped(3.5) - (3.5 - std::f64::consts::TAU)).abs() < 1e-15);
        let nearly_closed = |up: f64| {
            let tip = Point3::new(0.5, 1.0, 0.0);
            [Point3::origin(), Point3::new(1.0, 0.0, 0.0), tip, Point3::new(0.5, 1.0, up)]
        };
        let (over, under) = (dihedral_angle(&nearly_closed(0.01)), dihedral_angle(&nearly_closed(-0.01)));
        assert!(over * under < 0.0 && over.abs() > 3.1);
        let term = hinge(&nearly_closed(-0.01), over, 1.0, Curvature::GaussNewton);
        assert!(term.energy < 1e-3, "{}", term.energy);
    }

    #[test]
    fn forces_and_moments_balance() {
        let at = points::<4>(7, 0.5);
        let term = hinge(&at, 0.1, 1.0, Curvature::GaussNewton);
        let force: Vector3<f64> = term.gradient.iter().sum();
        let moment: Vector3<f64> = (0..4).map(|i| at[i].coords.cross(&term.gradient[i])).sum();
        assert!(force.norm() < 1e-12 && moment.norm() < 1e-12);
    }
}

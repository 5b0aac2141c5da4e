//! The inner loop: sums of triharmonic kernels at many points, one SIMD lane per point.
//!
//! Each lane goes through the same operations in the same order whatever stands in the other lanes, so a point's value
//! does not depend on how points are cut into blocks or threads.

#[cfg(all(target_arch = "x86_64", feature = "avx512"))]
use pulp::NullaryFnOnce;
use pulp::{Arch, Simd, WithSimd};

/// Points that are evaluated together; small enough for the stack and the first-level cache.
pub(crate) const BLOCK: usize = 256;
/// Registers of points per center load: hides the latency of the square root.
const GROUP: usize = 2;
/// Blocks are filled up to a multiple of this: `GROUP` registers of the widest instruction set (8 lanes).
const PADDING: usize = GROUP * 8;
/// Added to squared distances, so that the reciprocal root at a center is finite; r³ changes by less than 1e-30.
const TINY: f64 = 1e-30;

/// One array per coordinate (or per coordinate and derivative).
pub(crate) type Columns<const N: usize> = [[f64; BLOCK]; N];

/// What an interpolant sums up, in centred and scaled coordinates.
#[derive(Debug, Clone)]
pub(crate) struct Terms {
    /// Per center its position and its weight.
    pub(crate) rows: Vec<[f64; 6]>,
    /// Coefficients of 1, x, y, z, xx, yy, zz, xy, xz, yz.
    pub(crate) polynomial: [[f64; 3]; 10],
}

impl Terms {
    /// Values at the first `count` points.
    pub(crate) fn values(&self, at: &Columns<3>, count: usize, out: &mut Columns<3>) {
        self.dispatch::<3>(at, count, out);
    }

    /// Values, then per value its three derivatives, at the first `count` points.
    pub(crate) fn values_and_derivatives(&self, at: &Columns<3>, count: usize, out: &mut Columns<12>) {
        self.dispatch::<12>(at, count, out);
    }

    fn dispatch<const N: usize>(&self, at: &Columns<3>, count: usize, out: &mut Columns<N>) {
        self.dispatch_on(Arch::new(), at, count, out);
    }

    fn dispatch_on<const N: usize>(&self, arch: Arch, at: &Columns<3>, count: usize, out: &mut Columns<N>) {
        let padded = count.next_multiple_of(PADDING).min(BLOCK);
        let job = Job { terms: self, at, padded, out };
        match arch {
            #[cfg(all(target_arch = "x86_64", feature = "avx512"))]
            Arch::V4(simd) => simd.vectorize(Avx512 { simd, job }),
            arch => arch.dispatch(job),
        }
    }
}

/// The instruction set that this machine evaluates with; another one rounds differently.
pub(crate) fn instruction_set() -> &'static str {
    match Arch::new() {
        #[cfg(all(target_arch = "x86_64", feature = "avx512"))]
        Arch::V4(_) => "avx512",
        #[cfg(target_arch = "x86_64")]
        Arch::V3(_) => "avx2",
        #[cfg(target_arch = "aarch64")]
        Arch::Neon(_) => "neon",
        _ => "scalar",
    }
}

struct Job<'a, const N: usize> {
    terms: &'a Terms,
    at: &'a Columns<3>,
    padded: usize,
    out: &'a mut Columns<N>,
}

impl<const N: usize> WithSimd for Job<'_, N> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        evaluate(simd, Exact, self);
    }
}

#[cfg(all(target_arch = "x86_64", feature = "avx512"))]
struct Avx512<'a, const N: usize> {
    simd: pulp::x86::V4,
    job: Job<'a, N>,
}

#[cfg(all(target_arch = "x86_64", feature = "avx512"))]
impl<const N: usize> NullaryFnOnce for Avx512<'_, N> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        evaluate(self.simd, Estimated, self.job);
    }
}

/// How the root of a squared distance is taken.
trait Root<S: Simd>: Copy {
    fn root(self, simd: S, squared: S::f64s) -> S::f64s;
}

#[derive(Clone, Copy)]
struct Exact;

impl<S: Simd> Root<S> for Exact {
    #[inline(always)]
    fn root(self, simd: S, squared: S::f64s) -> S::f64s {
        simd.sqrt_f64s(squared)
    }
}

/// From the 14-bit estimate of AVX-512: the hardware's own root would take longer than all the rest.
#[cfg(all(target_arch = "x86_64", feature = "avx512"))]
#[derive(Clone, Copy)]
struct Estimated;

#[cfg(all(target_arch = "x86_64", feature = "avx512"))]
impl Root<pulp::x86::V4> for Estimated {
    /// With y ≈ 1/√a and e = 1 − a y², √a = a y (1 − e)^(-1/2) = a y (1 + e/2 + 3e²/8 + 5e³/16 + …). As |e| < 2⁻¹³, what
    /// is cut off is below 2⁻⁵³.
    #[inline(always)]
    fn root(self, simd: pulp::x86::V4, squared: pulp::f64x8) -> pulp::f64x8 {
        let estimate: pulp::f64x8 = pulp::cast(simd.avx512f._mm512_rsqrt14_pd(pulp::cast(squared)));
        let root = simd.mul_f64s(squared, estimate);
        let error = simd.negate_mul_add_e_f64s(root, estimate, simd.splat_f64s(1.0));
        let series = simd.mul_add_e_f64s(error, simd.splat_f64s(5.0 / 16.0), simd.splat_f64s(3.0 / 8.0));
        let series = simd.mul_add_e_f64s(error, series, simd.splat_f64s(0.5));
        simd.mul_add_e_f64s(root, simd.mul_f64s(error, series), root)
    }
}

#[inline(always)]
fn evaluate<S: Simd, R: Root<S>, const N: usize>(simd: S, root: R, job: Job<'_, N>) {
    let Job { terms, at, padded, out } = job;
    let width = GROUP * S::F64_LANES;
    let mut start = 0;
    while start < padded {
        let end = start + width;
        let mut points = [[simd.splat_f64s(0.0); 3]; GROUP];
        let mut sums = [[simd.splat_f64s(0.0); N]; GROUP];
        for axis in 0..3 {
            let column = S::as_simd_f64s(&at[axis][start..end]).0;
            for group in 0..GROUP {
                points[group][axis] = column[group];
            }
        }
        for group in 0..GROUP {
            add_polynomial(simd, &terms.polynomial, points[group], &mut sums[group]);
        }
        for row in &terms.rows {
            add_center(simd, root, row, &points, &mut sums);
        }
        for (value, column) in out.iter_mut().enumerate() {
            let column = S::as_mut_simd_f64s(&mut column[start..end]).0;
            for group in 0..GROUP {
                column[group] = sums[group][value];
            }
        }
        start = end;
    }
}

/// Adds wᵢ r³ and, where asked for, its gradient 3 wᵢ r (u − uᵢ)ᵀ.
#[inline(always)]
fn add_center<S: Simd, R: Root<S>, const N: usize>(
    simd: S,
    root: R,
    row: &[f64; 6],
    points: &[[S::f64s; 3]; GROUP],
    sums: &mut [[S::f64s; N]; GROUP],
) {
    // Loops, not closures: a closure that is not inlined leaves the instruction set.
    let mut splat = [simd.splat_f64s(0.0); 6];
    for i in 0..6 {
        splat[i] = simd.splat_f64s(row[i]);
    }
    let row = splat;
    for group in 0..GROUP {
        let point = &points[group];
        let dx = simd.sub_f64s(point[0], row[0]);
        let dy = simd.sub_f64s(point[1], row[1]);
        let dz = simd.sub_f64s(point[2], row[2]);
        let squared = simd.mul_add_e_f64s(dx, dx, simd.splat_f64s(TINY));
        let squared = simd.mul_add_e_f64s(dy, dy, squared);
        let squared = simd.mul_add_e_f64s(dz, dz, squared);
        let distance = root.root(simd, squared);
        let cubed = simd.mul_f64s(squared, distance);
        let sums = &mut sums[group];
        for value in 0..3 {
            sums[value] = simd.mul_add_e_f64s(row[3 + value], cubed, sums[value]);
        }
        if N == 12 {
            let slope = simd.mul_f64s(simd.splat_f64s(3.0), distance);
            let gradient = [simd.mul_f64s(slope, dx), simd.mul_f64s(slope, dy), simd.mul_f64s(slope, dz)];
            for value in 0..3 {
                for axis in 0..3 {
                    let sum = &mut sums[3 + 3 * value + axis];
                    *sum = simd.mul_add_e_f64s(row[3 + value], gradient[axis], *sum);
                }
            }
        }
    }
}

/// Adds the quadratic part and, where asked for, its gradient.
#[inline(always)]
fn add_polynomial<S: Simd, const N: usize>(
    simd: S,
    polynomial: &[[f64; 3]; 10],
    point: [S::f64s; 3],
    sums: &mut [S::f64s; N],
) {
    let [x, y, z] = point;
    for value in 0..3 {
        let mut a = [simd.splat_f64s(0.0); 10];
        for term in 0..10 {
            a[term] = simd.splat_f64s(polynomial[term][value]);
        }
        let [one, ax, ay, az, xx, yy, zz, xy, xz, yz] = a;
        let along_x = linear(simd, [ax, xx, xy, xz], point);
        let along_y = simd.mul_add_e_f64s(yz, z, simd.mul_add_e_f64s(yy, y, ay));
        let along_z = simd.mul_add_e_f64s(zz, z, az);
        let sum = simd.mul_add_e_f64s(along_x, x, simd.add_f64s(sums[value], one));
        let sum = simd.mul_add_e_f64s(along_y, y, sum);
        sums[value] = simd.mul_add_e_f64s(along_z, z, sum);
        if N == 12 {
            let twice = [simd.add_f64s(xx, xx), simd.add_f64s(yy, yy), simd.add_f64s(zz, zz)];
            sums[3 + 3 * value] = linear(simd, [ax, twice[0], xy, xz], point);
            sums[4 + 3 * value] = linear(simd, [ay, xy, twice[1], yz], point);
            sums[5 + 3 * value] = linear(simd, [az, xz, yz, twice[2]], point);
        }
    }
}

/// a₀ + a₁ x + a₂ y + a₃ z
#[inline(always)]
fn linear<S: Simd>(simd: S, a: [S::f64s; 4], point: [S::f64s; 3]) -> S::f64s {
    let sum = simd.mul_add_e_f64s(a[1], point[0], a[0]);
    let sum = simd.mul_add_e_f64s(a[2], point[1], sum);
    simd.mul_add_e_f64s(a[3], point[2], sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn terms() -> Terms {
        let row = |i: i32| [0, 1, 2, 3, 4, 5].map(|k| (f64::from(7 * i + 3 * k) * 0.7).sin());
        let term = |k: usize| [0.5, -0.25, 0.125].map(|x| x * (k as f64 - 4.5));
        Terms { rows: (0..40).map(row).collect(), polynomial: std::array::from_fn(term) }
    }

    /// The formula as it stands in the paper.
    fn naive(terms: &Terms, u: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = u;
        let monomials = [1.0, x, y, z, x * x, y * y, z * z, x * y, x * z, y * z];
        std::array::from_fn(|value| {
            let kernel = |row: &[f64; 6]| {
                let square: f64 = (0..3).map(|k| (u[k] - row[k]).powi(2)).sum();
                row[3 + value] * square.sqrt().powi(3)
            };
            let polynomial = monomials.iter().zip(&terms.polynomial).map(|(m, a)| m * a[value]);
            terms.rows.iter().map(kernel).sum::<f64>() + polynomial.sum::<f64>()
        })
    }

    #[test]
    fn every_instruction_set_follows_the_formula() {
        let terms = terms();
        let mut at = [[0.0; BLOCK]; 3];
        for (axis, column) in at.iter_mut().enumerate() {
            // Spread over many magnitudes, the first point on a center.
            column
                .iter_mut()
                .enumerate()
                .for_each(|(i, x)| *x = ((i * 3 + axis) as f64).cos() * 1.05f64.powi(i as i32));
            column[0] = terms.rows[0][axis];
        }
        let mut archs = vec![Arch::new(), Arch::Scalar];
        #[cfg(target_arch = "x86_64")]
        archs.extend(pulp::x86::V3::try_new().map(Arch::V3));
        for arch in archs {
            let mut out = [[0.0; BLOCK]; 12];
            terms.dispatch_on(arch, &at, BLOCK, &mut out);
            for i in 0..BLOCK {
                let u = [at[0][i], at[1][i], at[2][i]];
                let exact = naive(&terms, u);
                // What the sum's terms add up to: they cancel far away.
                let size = 40.0 * (2.0 + u.iter().map(|x| x * x).sum::<f64>().sqrt()).powi(3);
                for value in 0..3 {
                    assert!((out[value][i] - exact[value]).abs() < 1e-15 * size, "{arch:?}, point {i}");
                }
            }
        }
    }
}

//! How wrinkles come with an expression: the modulation function, measured on a film [DutreveMeyer2011, Sec. 4.4].

use crate::Error;
use crate::acquire::Acquired;
use crate::warp::Pair;

/// A measured modulation function.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Modulation {
    /// Points (share of the way to the expression, share of the wrinkles), both rising from 0 to 1.
    pub curve: Vec<[f64; 2]>,
    /// Frames as they were measured, in the order of the film.
    pub frames: Vec<[f64; 2]>,
    /// Root mean square distance of the frames from the curve.
    pub rms: f64,
    /// The same from the paper's cosine, `(cos(π(1 + x)) + 1)/2` [DutreveMeyer2011, Eq. 6].
    pub cosine_rms: f64,
    /// The power p for which `x^p` comes nearest.
    pub power: f64,
}

/// How far a face has gone from rest to its expression, by its landmarks: `AB·AC / |AC|²` over all of them, clamped to 0–1
/// [DutreveMeyer2011, Eq. 4], after the head's own motion (scale, turn, shift) is taken out.
///
/// `rest_to_frame` and `rest_to_end`: the same landmarks in the same order.
#[must_use]
pub fn way(rest_to_frame: &[Pair], rest_to_end: &[Pair]) -> f64 {
    let (here, end) = (own_motion(rest_to_frame), own_motion(rest_to_end));
    let dot =
        |a: &[[f64; 2]], b: &[[f64; 2]]| a.iter().zip(b).map(|(a, b)| a[0] * b[0] + a[1] * b[1]).sum::<f64>();
    (dot(&here, &end) / dot(&end, &end).max(1e-12)).clamp(0.0, 1.0)
}

/// Displacements without the similarity that is nearest to them.
fn own_motion(pairs: &[Pair]) -> Vec<[f64; 2]> {
    let count = pairs.len().max(1) as f64;
    let mean = |of: fn(&Pair) -> [f64; 2]| {
        [0, 1].map(|axis| pairs.iter().map(|pair| of(pair)[axis]).sum::<f64>() / count)
    };
    let (a, b) = (mean(|pair| pair.from), mean(|pair| pair.to));
    let (mut along, mut across, mut square) = (0.0, 0.0, 1e-12);
    for Pair { from, to, .. } in pairs {
        let (p, q) = ([from[0] - a[0], from[1] - a[1]], [to[0] - b[0], to[1] - b[1]]);
        along += p[0] * q[0] + p[1] * q[1];
        across += p[0] * q[1] - p[1] * q[0];
        square += p[0] * p[0] + p[1] * p[1];
    }
    let (c, s) = (along / square, across / square);
    let left = |Pair { from, to, .. }: &Pair| {
        let p = [from[0] - a[0], from[1] - a[1]];
        [to[0] - b[0] - (c * p[0] - s * p[1]), to[1] - b[1] - (s * p[0] + c * p[1])]
    };
    pairs.iter().map(left).collect()
}

/// How much of an expression's wrinkles a frame shows: its slopes projected onto theirs.
#[must_use]
pub fn shown(frame: &Acquired, end: &Acquired) -> f64 {
    let (mut both, mut own) = (0.0, 1e-12);
    for at in 0..end.weight.values.len() {
        if end.weight.values[at] <= 0.0 {
            continue;
        }
        for axis in 0..2 {
            let [here, there] =
                [frame, end].map(|map| map.normals[axis].values[at] / map.normals[2].values[at].max(0.05));
            both += here * there;
            own += there * there;
        }
    }
    both / own
}

/// The rising curve through frames (share of the way, share of the wrinkles) that comes nearest to them [Ayer1955].
///
/// # Errors
/// If fewer than 3 frames lie on the way.
pub fn fit_modulation(frames: &[[f64; 2]]) -> Result<Modulation, Error> {
    let mut points: Vec<[f64; 2]> = frames.to_vec();
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    points.dedup_by(|a, b| a[0] - b[0] < 1e-6);
    if points.len() < 3 {
        return Err(Error::FewFrames { count: points.len(), what: "different shares of the way" });
    }
    let curve = ends(&rising(&points));
    let rms = |model: &dyn Fn(f64) -> f64| {
        let square: f64 = frames.iter().map(|[x, y]| (model(*x) - y).powi(2)).sum();
        (square / frames.len() as f64).sqrt()
    };
    let cosine = |x: f64| ((std::f64::consts::PI * (1.0 + x)).cos() + 1.0) / 2.0;
    let power = |k: i32| 0.3 * 1.02f64.powi(k);
    let best = (0..=140).min_by(|a, b| rms(&|x| x.powf(power(*a))).total_cmp(&rms(&|x| x.powf(power(*b)))));
    Ok(Modulation {
        rms: rms(&|x| look_up(&curve, x)),
        cosine_rms: rms(&cosine),
        power: power(best.unwrap_or(60)),
        frames: frames.to_vec(),
        curve,
    })
}

/// Pools neighbours that fall until all rise.
fn rising(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    // Mean of x, mean of y, how many.
    let mut pools: Vec<[f64; 3]> = Vec::new();
    for [x, y] in points {
        pools.push([*x, y.clamp(0.0, 1.0), 1.0]);
        while let [.., before, last] = &pools[..] {
            if before[1] <= last[1] {
                break;
            }
            let count = before[2] + last[2];
            let mean = |i: usize| (before[i] * before[2] + last[i] * last[2]) / count;
            let pool = [mean(0), mean(1), count];
            pools.truncate(pools.len() - 2);
            pools.push(pool);
        }
    }
    pools.iter().map(|pool| [pool[0], pool[1]]).collect()
}

/// The same curve from (0, 0) to (1, 1).
fn ends(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let most = points.last().map_or(1.0, |last| last[1]).max(1e-9);
    let inner = points.iter().filter(|point| point[0] > 1e-3 && point[0] < 1.0 - 1e-3);
    let inner = inner.map(|point| [point[0], (point[1] / most).clamp(0.0, 1.0)]);
    std::iter::once([0.0, 0.0]).chain(inner).chain([[1.0, 1.0]]).collect()
}

fn look_up(curve: &[[f64; 2]], x: f64) -> f64 {
    let at = curve.iter().position(|point| point[0] >= x).unwrap_or(curve.len() - 1).max(1);
    let ([x0, y0], [x1, y1]) = (curve[at - 1], curve[at]);
    y0 + (y1 - y0) * ((x - x0) / (x1 - x0).max(1e-12)).clamp(0.0, 1.0)
}

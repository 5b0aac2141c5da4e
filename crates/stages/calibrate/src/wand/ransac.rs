//! Models from samples: the one that most data agree with [FischlerBolles1981].

use rand::Rng;
use rand_chacha::ChaCha8Rng;

/// Which data agree with the model that costs least.
pub(super) struct Consensus<M> {
    pub(super) model: M,
    pub(super) inliers: Vec<bool>,
}

/// Draws `tries` samples of `size` out of `count` data, fits each, and returns the model with the least cost, in which a
/// datum costs its squared error, at most `limit`² [TorrZisserman2000].
pub(super) fn consensus<M>(
    rng: &mut ChaCha8Rng,
    [count, size, tries]: [usize; 3],
    limit: f64,
    fit: impl Fn(&[usize]) -> Option<M>,
    error: impl Fn(&M, usize) -> f64,
) -> Option<Consensus<M>> {
    if count < size {
        return None;
    }
    let mut best: Option<(f64, M)> = None;
    for _ in 0..tries {
        let Some(model) = fit(&sample(rng, count, size)) else { continue };
        let cost: f64 = (0..count).map(|i| error(&model, i).min(limit).powi(2)).sum();
        if best.as_ref().is_none_or(|(least, _)| cost < *least) {
            best = Some((cost, model));
        }
    }
    let (_, model) = best?;
    let inliers = (0..count).map(|i| error(&model, i) < limit).collect();
    Some(Consensus { model, inliers })
}

/// Different numbers below `count`.
fn sample(rng: &mut ChaCha8Rng, count: usize, size: usize) -> Vec<usize> {
    let mut drawn = Vec::with_capacity(size);
    while drawn.len() < size {
        let next = rng.random_range(0..count);
        if !drawn.contains(&next) {
            drawn.push(next);
        }
    }
    drawn
}

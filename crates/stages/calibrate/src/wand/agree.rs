//! Which sightings of one point agree.

use camera::Camera;
use nalgebra::{Point3, Vector2};

/// The point that most sightings agree on, and who they are.
pub(super) fn agreed(
    cameras: &[Camera],
    seen: &[(usize, Vector2<f64>)],
    limit: &dyn Fn(usize) -> f64,
) -> (Option<Point3<f64>>, Vec<usize>) {
    let place = |views: &[(usize, Vector2<f64>)]| {
        Camera::nearest_to_rays(views.iter().map(|(c, pixel)| (&cameras[*c], *pixel)))
    };
    let near = |point: &Point3<f64>, slack: f64| -> Vec<(usize, Vector2<f64>)> {
        let is_near = |(c, pixel): &&(usize, Vector2<f64>)| {
            let projected = cameras[*c].project(point);
            projected.is_some_and(|projected| (projected - pixel).norm() <= slack * limit(*c))
        };
        seen.iter().filter(is_near).copied().collect()
    };
    let everyone = place(seen).filter(|point| near(point, 1.0).len() == seen.len());
    if let Some(point) = everyone.filter(|_| seen.len() >= 2) {
        return (Some(point), seen.iter().map(|(c, _)| *c).collect());
    }
    // Somebody is wrong, and would drag a common point along: every two are asked who agrees with them.
    let pairs = (0..seen.len()).flat_map(|a| (a + 1..seen.len()).map(move |b| [seen[a], seen[b]]));
    let mut most: Vec<(usize, Vector2<f64>)> = Vec::new();
    for pair in pairs {
        let group = place(&pair).map(|point| near(&point, PAIR_SLACK)).unwrap_or_default();
        if group.len() > most.len() {
            most = group;
        }
    }
    let Some(point) = place(&most).filter(|_| most.len() > 2 || seen.len() == 2) else {
        return (None, Vec::new());
    };
    let group = near(&point, 1.0);
    if group.len() < 2 {
        return (None, Vec::new());
    }
    (place(&group), group.into_iter().map(|(c, _)| c).collect())
}

/// What two cameras make of a point is less sure than what all do.
const PAIR_SLACK: f64 = 3.0;

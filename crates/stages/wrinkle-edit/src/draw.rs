//! Wrinkles that somebody drew: places in an image, widths and depths along them, at one frame or at several.

use crate::carry::Motion;
use crate::change::state;
use crate::moment::Moment;
use crate::scope::Scope;
use crate::spline::{Place, Walk, drawn};
use artifact::{Curve2d, Section};
use std::collections::BTreeMap;

/// A wrinkle drawn in a camera.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Drawn {
    /// Its id, its camera, its frames.
    pub(crate) scope: Scope,
    /// By the frame whose image it was drawn in.
    pub(crate) keys: BTreeMap<i64, Key>,
    /// Wrinkles that it moves with.
    pub(crate) follow: Vec<String>,
}

/// How a wrinkle looks in a frame.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Key {
    pub(crate) controls: Vec<Place>,
    pub(crate) shape: Shape,
}

/// Its profile: widths and depths, px, at equal distances along it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Shape {
    pub(crate) widths: Vec<f64>,
    pub(crate) depths: Vec<f64>,
    pub(crate) epsilon: f64,
    pub(crate) kappa: f64,
}

/// A value of a list that is spread along a length of 1.
fn along(values: &[f64], share: f64) -> f64 {
    let place = share.clamp(0.0, 1.0) * (values.len() - 1) as f64;
    let before = (place as usize).min(values.len().saturating_sub(2));
    let after = (before + 1).min(values.len() - 1);
    values[before] + (place - before as f64) * (values[after] - values[before])
}

impl Shape {
    /// w, d, ε, κ at a share of the length.
    fn at(&self, share: f64) -> [f64; 4] {
        [along(&self.widths, share), along(&self.depths, share), self.epsilon, self.kappa]
    }
}

/// A key near a frame, how the skin has moved since, and how much it counts.
struct Near<'a> {
    key: &'a Key,
    motion: Motion,
    weight: f64,
}

impl Drawn {
    pub(crate) fn id(&self) -> &str {
        self.scope.ids.first().map_or("", String::as_str)
    }

    pub(crate) fn camera(&self) -> &str {
        self.scope.cameras.first().map_or("", String::as_str)
    }

    /// Draws it into a frame; `all` are all frames that it hangs on. False where the wrinkles that it follows are not to be seen.
    ///
    /// Between two keys control points and profiles go straight from one to the other, each after the motion of the skin since its own
    /// frame; before the first and after the last key they stay.
    pub(crate) fn draw(&self, moment: &mut Moment, all: &[Moment], step_px: f64) -> bool {
        let near = self.near(moment, all);
        let weight: f64 = near.iter().map(|near| near.weight).sum();
        if weight == 0.0 {
            return false;
        }
        let count = near[0].key.controls.len();
        let control = |i: usize| {
            near.iter().map(|near| near.weight * near.motion.place(near.key.controls[i])).sum::<Place>()
                / weight
        };
        let controls: Vec<Place> = (0..count).map(control).collect();
        let curve = drawn(&controls);
        let strength = self.scope.strength(moment.frame);
        let shape = |share: f64| {
            let mut mean = [0.0; 4];
            for near in &near {
                let at = near.key.shape.at(share);
                (0..4).for_each(|k| mean[k] += near.weight / weight * at[k]);
            }
            mean[1] *= strength;
            mean
        };
        let sections = sections(&curve, step_px, shape);
        moment.put(self.camera(), self.id(), Some(sections), Some(curve));
        true
    }

    /// The keys before and after a frame.
    fn near(&self, moment: &Moment, all: &[Moment]) -> Vec<Near<'_>> {
        let before = self.keys.range(..=moment.frame).next_back();
        let after = self.keys.range(moment.frame..).next();
        let weights = match (before, after) {
            (Some((a, _)), Some((b, _))) if a != b => {
                let share = (moment.frame - a) as f64 / (b - a) as f64;
                [1.0 - share, share]
            }
            (Some(_), _) => [1.0, 0.0],
            (None, _) => [0.0, 1.0],
        };
        let keys = [before, after].into_iter().zip(weights).filter(|(_, weight)| *weight > 0.0);
        keys.filter_map(|(key, weight)| {
            let (frame, key) = key?;
            Some(Near { key, motion: self.motion(*frame, moment, all)?, weight })
        })
        .collect()
    }

    fn motion(&self, since: i64, moment: &Moment, all: &[Moment]) -> Option<Motion> {
        if self.follow.is_empty() || since == moment.frame {
            return Some(Motion::none());
        }
        let from = all.iter().find(|other| other.frame == since)?;
        Motion::of(from, moment, self.camera(), &self.follow)
    }
}

/// Sections along a curve as `cross-section` lays them: at equal distances near the step, from end to end, at right angles to it.
fn sections(curve: &Curve2d, step_px: f64, shape: impl Fn(f64) -> [f64; 4]) -> Vec<Section> {
    let walk = Walk::of(curve);
    let count = (walk.len() / step_px).floor().max(1.0);
    let section = |i: usize| {
        let share = i as f64 / count;
        let (u, at, normal) = walk.at(share * walk.len());
        let [w_px, d_px, epsilon, kappa] = shape(share);
        let (tilt_rad, deviation, residual) = (None, None, None);
        Section {
            u,
            at,
            normal,
            w_px,
            d_px,
            epsilon,
            kappa,
            tilt_rad,
            deviation,
            residual,
            state: state(d_px),
        }
    };
    (0..=count as usize).map(section).collect()
}

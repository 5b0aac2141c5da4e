//! How bright a groove is under the open sky: closed forms over its two horizons.
//!
//! Along a straight groove of Lambertian paint the sky that a point sees is a wedge between two horizons. Integrating along the
//! groove leaves `E = ½ (cos(e_R − θ) + cos(e_L + θ))`, θ the slope's angle, e the horizons' [BickelBotsch2007, Eq. 7].

use crate::profile::steepness_of_scale;
use crate::relief::Relief;
use crate::walls::{Around, Walls};
use std::f64::consts::PI;

/// Nodes across a groove.
pub(crate) const NODES: usize = 64;
/// The outermost node, in width scales.
const REACH: f64 = 6.5;
/// How much closer nodes lie at the crease.
const CROWDING: f64 = 4.0;

/// Number of parameters of a groove.
pub(crate) const PARAMETERS: usize = 7;
/// Places of parameters: ln w, ln(d/w), ε, κ, c, g, t. The first five shape the section.
pub(crate) const WIDTH: usize = 0;
pub(crate) const RATIO: usize = 1;
pub(crate) const EPSILON: usize = 2;
pub(crate) const KAPPA: usize = 3;
pub(crate) const BEND: usize = 4;
pub(crate) const SKEW: usize = 5;
pub(crate) const TILT: usize = 6;
/// Parameters that shape the section.
const SHAPE: usize = 5;
/// The surroundings are bent up to about so many width scales from the crease; beyond, they run out level.
const BENT: f64 = 4.0;

/// A groove as it is lit and seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Groove {
    /// Width in the image, px.
    pub(crate) w: f64,
    /// Depth over width.
    pub(crate) ratio: f64,
    /// Rounding.
    pub(crate) epsilon: f64,
    /// Asymmetry.
    pub(crate) kappa: f64,
    /// Curvature of what the groove lies in, 1/px; positive where that is hollow.
    pub(crate) bend: f64,
    /// How the sky's radiance changes towards p > 0: `L = 1 + g ω_p`.
    pub(crate) skew: f64,
    /// Tangent of the angle by which the camera stands on the side p > 0 of the normal.
    pub(crate) tilt: f64,
    /// Share of the light that the paint throws back.
    pub(crate) albedo: f64,
    /// Where its crease lies beside the curve, px.
    pub(crate) aside: f64,
}

/// Places in the image and brightness of a groove's nodes, with derivatives by [`WIDTH`] … [`TILT`].
#[derive(Debug, Clone)]
pub(crate) struct Lit {
    /// Distance in the image from the crease, px, rising.
    pub(crate) at: [f64; NODES],
    /// Brightness; 1 where all of the sky is seen.
    pub(crate) light: [f64; NODES],
    pub(crate) at_by: [[f64; PARAMETERS]; NODES],
    pub(crate) light_by: [[f64; PARAMETERS]; NODES],
    /// How many of the nodes the camera sees; they stand first.
    pub(crate) count: usize,
}

/// A node on the section, in width scales: place X, height Z, slope M, with derivatives by [`WIDTH`] … [`BEND`].
#[derive(Debug, Clone, Copy, Default)]
struct Node {
    x: f64,
    z: f64,
    slope: f64,
    /// Only κ moves nodes.
    x_by_kappa: f64,
    z_by: [f64; SHAPE],
    slope_by: [f64; SHAPE],
}

/// Unsigned places of the nodes right of the crease, in width scales. None is at the crease, where slopes may jump.
pub(crate) fn places() -> [f64; NODES] {
    let half = NODES as f64 / 2.0;
    std::array::from_fn(|i| {
        let share = (i as f64 + 0.5 - half) / (half - 0.5);
        REACH * (CROWDING * share).sinh() / CROWDING.sinh()
    })
}

fn section(groove: &Groove, relief: Option<&Relief>, places: &[f64; NODES]) -> [Node; NODES] {
    let Groove { ratio, epsilon, kappa, .. } = *groove;
    let (factor, growth) = steepness_of_scale(epsilon);
    let depth = ratio * factor;
    let rest = 1.0 - epsilon * epsilon;
    let (scale, scale_growth) = (groove.w / rest.sqrt(), epsilon / rest);
    places.map(|v| {
        let side = 1.0 + kappa * v.signum();
        let round = v.hypot(epsilon);
        let fall = (-round).exp();
        let (z, lean) = (depth * (round - 1.0) * fall, v / round);
        let slope = depth * (2.0 - round) * fall * lean / side;
        let z_by_epsilon = growth * z + depth * (2.0 - round) * fall * epsilon / round;
        let twist = -2.0 / (round * round) - 2.0 / round + 1.0;
        let slope_by_epsilon = growth * slope + depth * fall * twist * lean * epsilon / side;
        // What the groove lies in: ½ c X₀² (1 − e^(−X²/X₀²)).
        let x = v * side;
        let fade = (-(x / BENT).powi(2)).exp();
        let (hollow, hollow_slope) = (0.5 * scale * BENT * BENT * (1.0 - fade), scale * x * fade);
        let hollow_twist = scale * (1.0 - 2.0 * (x / BENT).powi(2)) * fade;
        let (bent, bent_slope) = (groove.bend * hollow, groove.bend * hollow_slope);
        let x_by_kappa = v.abs();
        let [ground, ground_slope, ground_twist] = relief.map_or([0.0; 3], |relief| {
            let [z, slope, twist] = relief.at(groove.aside + scale * x);
            [(z - relief.at(groove.aside)[0]) / scale, slope, twist * scale]
        });
        // By the scale: what the ground's height in width scales changes by, and its slope.
        let (ground_growth, ground_turn) = (x * ground_slope - ground, x * ground_twist);
        Node {
            x,
            z: z + bent + ground,
            slope: slope + bent_slope + ground_slope,
            x_by_kappa,
            z_by: [
                bent + ground_growth,
                z,
                z_by_epsilon + scale_growth * (bent + ground_growth),
                (bent_slope + ground_slope) * x_by_kappa,
                hollow,
            ],
            slope_by: [
                bent_slope + ground_turn,
                slope,
                slope_by_epsilon + scale_growth * (bent_slope + ground_turn),
                -slope * v.signum() / side + (groove.bend * hollow_twist + ground_twist) * x_by_kappa,
                hollow_slope,
            ],
        }
    })
}

/// A horizon: tangent of its elevation, with derivatives by [`WIDTH`] … [`BEND`].
#[derive(Debug, Clone, Copy, Default)]
struct Horizon {
    slope: f64,
    by: [f64; SHAPE],
}

/// The horizons of all nodes on the side that `order` comes from: it visits the nodes from that side's end.
fn horizons(nodes: &[Node; NODES], order: impl Iterator<Item = usize>, sign: f64) -> [Horizon; NODES] {
    let mut found = [Horizon::default(); NODES];
    let mut hull: [usize; NODES] = [0; NODES];
    let mut count = 0;
    for i in order {
        let node = &nodes[i];
        let rise = |j: usize| (nodes[j].z - node.z) / (nodes[j].x - node.x).abs();
        while count >= 2 && rise(hull[count - 1]) <= rise(hull[count - 2]) {
            count -= 1;
        }
        // The open horizon, and the ground at the point itself.
        let own = sign * node.slope;
        found[i] = match own > 0.0 {
            true => Horizon { slope: own, by: node.slope_by.map(|by| sign * by) },
            false => Horizon::default(),
        };
        if count > 0 && rise(hull[count - 1]) > found[i].slope {
            found[i] = sight(node, &nodes[hull[count - 1]]);
        }
        hull[count] = i;
        count += 1;
    }
    found
}

/// The line of sight from one node to another one.
fn sight(from: &Node, to: &Node) -> Horizon {
    let run = (to.x - from.x).abs();
    let slope = (to.z - from.z) / run;
    let run_by_kappa = (to.x - from.x).signum() * (to.x_by_kappa - from.x_by_kappa);
    let mut by = std::array::from_fn(|k| (to.z_by[k] - from.z_by[k]) / run);
    by[KAPPA] -= slope * run_by_kappa / run;
    Horizon { slope, by }
}

/// Cosine of the angle between a horizon and the ground at a point, both as slopes, with derivatives by the two.
fn cosine(horizon: f64, ground: f64) -> [f64; 3] {
    let (far, near) = (1.0 / (1.0 + horizon * horizon), 1.0 / (1.0 + ground * ground));
    let lengths = (far * near).sqrt();
    let turn = (ground - horizon) * lengths;
    [(1.0 + horizon * ground) * lengths, turn * far, -turn * near]
}

/// Sine and cosine of `2 atan(horizon) + α`, from those of α.
fn twice_and(horizon: f64, sine: f64, cosine: f64) -> (f64, f64) {
    let square = horizon * horizon;
    let (twice_sine, twice_cosine) = (2.0 * horizon / (1.0 + square), (1.0 - square) / (1.0 + square));
    (twice_sine * cosine + twice_cosine * sine, twice_cosine * cosine - twice_sine * sine)
}

/// What a sky that gets brighter by one unit towards p > 0 adds to a point between horizons at slopes `left` and `right` on ground
/// of a slope, with derivatives by the three: `4/(3π) C`, `C = ½ (hi − lo) cos φ + ¼ (sin(2 hi − φ) − sin(2 lo − φ))` with
/// lo = e_R, hi = π − e_L, φ = θ + π/2.
fn skewed(left: f64, right: f64, slope: f64) -> [f64; 4] {
    let open = PI - (left + right).atan2(1.0 - left * right);
    let along = 1.0 / (1.0 + slope * slope).sqrt();
    let (sine, cosine) = (slope * along, along);
    let [(sine_left, cosine_left), (sine_right, cosine_right)] =
        [(left, sine), (right, -sine)].map(|(horizon, sine)| twice_and(horizon, sine, cosine));
    let share = 4.0 / (3.0 * PI);
    let by = |angle: f64, slope: f64| share * angle / (1.0 + slope * slope);
    [
        share * (-0.5 * open * sine + 0.25 * (cosine_right - cosine_left)),
        by(0.5 * (sine + sine_left), left),
        by(0.5 * (sine - sine_right), right),
        by(-0.5 * open * cosine + 0.25 * (sine_right + sine_left), slope),
    ]
}

/// What walls take from a point between horizons at slopes `left` and `right` on ground of a slope, with derivatives by the three.
fn taken(walls: &Walls, left: f64, right: f64, slope: f64) -> [f64; 4] {
    let (on_left, on_right) = (walls.loss(0, left), walls.loss(1, right));
    let along = 1.0 / (1.0 + slope * slope).sqrt();
    let seen = |left: [f64; 2], right: [f64; 2]| [left[0] + slope * left[1], right[0] - slope * right[1]];
    let [from_left, from_right] = seen(on_left.value, on_right.value);
    let [left_growth, right_growth] = seen(on_left.growth, on_right.growth);
    let turn = -slope * along.powi(3) * (from_left + from_right);
    [
        along * (from_left + from_right),
        along * left_growth,
        along * right_growth,
        along * (on_left.value[1] - on_right.value[1]) + turn,
    ]
}

/// The light that a point throws back after all bounces, as a share of what it would without any shadow, from its irradiance:
/// `B = E / (1 − ρ (1 − E))`, with the derivative.
///
/// A closed form for a wedge that sees walls as bright as itself where it sees no sky; off the crease within 0.3 % of radiosity.
pub(crate) fn with_bounces(irradiance: f64, albedo: f64) -> [f64; 2] {
    let rest = 1.0 - albedo * (1.0 - irradiance);
    [irradiance / rest, (1.0 - albedo) / (rest * rest)]
}

impl Lit {
    /// The nodes of a groove at [`places`], without those that a wall hides from the camera.
    pub(crate) fn of(groove: &Groove, around: &Around, places: &[f64; NODES]) -> Self {
        let nodes = section(groove, around.relief.as_ref(), places);
        let right = horizons(&nodes, (0..NODES).rev(), 1.0);
        let left = horizons(&nodes, 0..NODES, -1.0);
        let mut lit = Self {
            at: [0.0; NODES],
            light: [0.0; NODES],
            at_by: [[0.0; PARAMETERS]; NODES],
            light_by: [[0.0; PARAMETERS]; NODES],
            count: NODES,
        };
        for i in 0..NODES {
            lit.shade(i, groove, around.walls.as_ref(), &nodes[i], [&left[i], &right[i]]);
        }
        lit.project(groove, &nodes);
        if groove.tilt != 0.0 {
            lit.hide(groove.tilt);
        }
        lit
    }

    fn shade(
        &mut self,
        i: usize,
        groove: &Groove,
        walls: Option<&Walls>,
        node: &Node,
        [left, right]: [&Horizon; 2],
    ) {
        let [near, near_by_far, near_by_ground] = cosine(right.slope, node.slope);
        let [other, other_by_far, other_by_ground] = cosine(left.slope, -node.slope);
        let [skew, skew_by_left, skew_by_right, skew_by_slope] = skewed(left.slope, right.slope, node.slope);
        let mut by_right = 0.5 * near_by_far + groove.skew * skew_by_right;
        let mut by_left = 0.5 * other_by_far + groove.skew * skew_by_left;
        let mut by_slope = 0.5 * (near_by_ground - other_by_ground) + groove.skew * skew_by_slope;
        let mut irradiance = 0.5 * (near + other) + groove.skew * skew;
        let mut open = 1.0;
        if let Some(walls) = walls {
            let [taken, taken_by_left, taken_by_right, taken_by_slope] =
                taken(walls, left.slope, right.slope, node.slope);
            irradiance -= taken;
            by_left -= taken_by_left;
            by_right -= taken_by_right;
            by_slope -= taken_by_slope;
            open = 1.0 / with_bounces(walls.open(), groove.albedo)[0];
        }
        let [light, gain] = with_bounces(irradiance, groove.albedo).map(|value| open * value);
        self.light[i] = light;
        for k in 0..SHAPE {
            self.light_by[i][k] =
                gain * (by_right * right.by[k] + by_left * left.by[k] + by_slope * node.slope_by[k]);
        }
        self.light_by[i][SKEW] = gain * skew;
    }

    /// Places in the image: `q = w_s (X − (Z − Z₀) t)`, w_s = w / √(1 − ε²): along the section as the camera shortens it.
    fn project(&mut self, groove: &Groove, nodes: &[Node; NODES]) {
        let Groove { w, ratio, epsilon, tilt, .. } = *groove;
        let rest = 1.0 - epsilon * epsilon;
        let scale = w / rest.sqrt();
        let (factor, growth) = steepness_of_scale(epsilon);
        let bottom = -ratio * factor * (1.0 - epsilon) * (-epsilon).exp();
        // ∂/∂ε of (ε − 1) e^(−ε) is (2 − ε) e^(−ε).
        let bottom_by_epsilon = growth * bottom + ratio * factor * (2.0 - epsilon) * (-epsilon).exp();
        for (i, node) in nodes.iter().enumerate() {
            let rise = node.z - bottom;
            let at = scale * (node.x - rise * tilt);
            self.at[i] = at;
            for k in 0..SHAPE {
                let bottom_by = [0.0, bottom, bottom_by_epsilon, 0.0, 0.0][k];
                self.at_by[i][k] = -scale * tilt * (node.z_by[k] - bottom_by);
            }
            self.at_by[i][WIDTH] += at;
            self.at_by[i][EPSILON] += at * epsilon / rest;
            self.at_by[i][KAPPA] += scale * node.x_by_kappa;
            self.at_by[i][TILT] = -scale * rise;
        }
    }

    /// Leaves out the nodes that stand behind a wall: those that the image shows out of their order.
    fn hide(&mut self, tilt: f64) {
        let mut seen = [true; NODES];
        let mut edge = if tilt > 0.0 { f64::INFINITY } else { f64::NEG_INFINITY };
        for step in 0..NODES {
            // Seen from the right, walls on the right stand before what lies left of them.
            let i = if tilt > 0.0 { NODES - 1 - step } else { step };
            seen[i] = if tilt > 0.0 { self.at[i] < edge } else { self.at[i] > edge };
            if seen[i] {
                edge = self.at[i];
            }
        }
        self.count = 0;
        for i in (0..NODES).filter(|&i| seen[i]) {
            let to = self.count;
            (self.at[to], self.light[to]) = (self.at[i], self.light[i]);
            (self.at_by[to], self.light_by[to]) = (self.at_by[i], self.light_by[i]);
            self.count += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::walls::Skyline;

    fn groove() -> Groove {
        Groove {
            w: 6.0,
            ratio: 0.4,
            epsilon: 0.25,
            kappa: 0.15,
            bend: 0.012,
            skew: 0.1,
            tilt: 0.3,
            albedo: 0.3,
            aside: 1.5,
        }
    }

    fn changed(groove: &Groove, parameter: usize, by: f64) -> Groove {
        let mut changed = *groove;
        match parameter {
            WIDTH => changed.w *= by.exp(),
            RATIO => changed.ratio *= by.exp(),
            EPSILON => changed.epsilon += by,
            KAPPA => changed.kappa += by,
            BEND => changed.bend += by,
            SKEW => changed.skew += by,
            _ => changed.tilt += by,
        }
        changed
    }

    /// Beside a nose: the ground rises, and the sky begins high on one side.
    fn nose() -> Around {
        let ground: Vec<[f64; 2]> =
            (-40..=40).map(f64::from).map(|x| [x, 0.002 * x * x + 0.0001 * x * x * x]).collect();
        let mut skyline = Skyline::default();
        skyline[1] = [0.1, 0.3, 0.5, 0.7, 0.6, 0.4, 0.1, 0.0];
        Around { walls: Walls::of(&skyline), relief: Relief::through(&ground) }
    }

    #[test]
    fn derivatives_are_those_of_differences() {
        let open = Around::default();
        for (name, groove, around) in [
            ("all", groove(), &open),
            ("hollow", Groove { kappa: -0.3, bend: 0.03, ..groove() }, &open),
            ("round", Groove { bend: -0.01, epsilon: 0.6, tilt: -0.2, ..groove() }, &open),
            ("beside a nose", groove(), &nose()),
        ] {
            let lit = Lit::of(&groove, around, &places());
            for parameter in 0..PARAMETERS {
                let step = 1e-6;
                let [less, more] =
                    [-step, step].map(|by| Lit::of(&changed(&groove, parameter, by), around, &places()));
                for node in 0..NODES {
                    let light = (more.light[node] - less.light[node]) / (2.0 * step);
                    let at = (more.at[node] - less.at[node]) / (2.0 * step);
                    let (by, at_by) = (lit.light_by[node][parameter], lit.at_by[node][parameter]);
                    assert!(
                        (light - by).abs() < 1e-4 * (1.0 + by.abs()),
                        "{name} light {node} by {parameter}: {light} {by}"
                    );
                    assert!(
                        (at - at_by).abs() < 1e-4 * (1.0 + at_by.abs()),
                        "{name} at {node} by {parameter}: {at} {at_by}"
                    );
                }
            }
        }
    }
}

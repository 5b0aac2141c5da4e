//! Everything that stays the same over a take: the face, its paint, the cameras, the light at rest.

use crate::Error;
use crate::act::{Clip, Performance};
use crate::body::{Base, Body, Fineness};
use crate::clock::Schedule;
use crate::light::{self, Plan};
use crate::paint::{Dot, HalfWidth, Layers, Outline, Stroke, StrokeCoordinates, Texture};
use crate::scenario::{self, Scenario};
use crate::take::headband::Headband;
use crate::take::station::{Station, stations};
use crate::wrinkle::{self, Wrinkles};
use mesh::vertex_normals;
use nalgebra::{Point2, Vector3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;

/// A studio that is set up for a scenario.
pub struct Studio {
    pub(super) scenario: Scenario,
    pub(super) body: Body,
    pub(super) wrinkles: Wrinkles,
    pub(super) layers: Layers,
    /// The face without paint.
    pub(super) bare: Layers,
    pub(super) headband: Headband,
    pub(super) stations: BTreeMap<String, Station>,
    pub(super) performance: Performance,
    pub(super) events: Performance,
    pub(super) plan: Plan,
    /// Light on the face at rest, per vertex.
    pub(super) baked: Vec<[f32; 3]>,
}

/// Finer triangles reach this far from a wrinkle line, mm.
const FINE_REACH_MM: f64 = 8.0;
/// Around painted wrinkles the light is looked at closely; this far from the line, in widths.
const CLOSE_LOOK: f64 = 4.0;

/// What is given beside a scenario.
#[derive(Default)]
pub struct Given {
    /// The face; the parametric one if absent.
    pub base: Option<Base>,
    /// Recorded weights.
    pub clip: Option<Clip>,
}

impl Studio {
    /// Sets up a studio.
    ///
    /// # Errors
    /// A parameter that makes no sense, a performance that the face cannot give, a line that misses the face, a camera that
    /// sees nothing of it.
    pub fn set_up(scenario: Scenario, given: Given) -> Result<Self, Error> {
        scenario.validate()?;
        let lines = wrinkle::lines(scenario.seed, &scenario.lines);
        let paths: Vec<Vec<Point2<f64>>> = lines.iter().map(|line| line.path.clone()).collect();
        let fineness = Fineness { reach_mm: FINE_REACH_MM, crease_mm: scenario.crease_mm };
        let body = match given.base {
            Some(base) => base.body(scenario.vertices, &paths, fineness),
            None => Body::parametric(scenario.seed, scenario.vertices, &paths, fineness),
        };
        let body = body.with_pores(scenario.pores_mm);
        let rest = &body.mesh.positions;
        let wrinkles = Wrinkles::place(rest, &body.triangles, &body.domain, &lines, &scenario.folds)?;
        let normals = vertex_normals(rest, &body.triangles);
        let strokes = strokes(&scenario, &wrinkles);
        let layers =
            Layers::build(rest, &normals, &body.triangles, dots(&scenario, &body, &normals), strokes);
        let bare = Layers::build(rest, &normals, &body.triangles, Vec::new(), Vec::new());
        let (performance, events) = perform(&scenario, &body, given.clip)?;
        let headband = Headband::of(&body, &scenario);
        let stations = stations(&scenario, &body, &normals)?;
        let (plan, baked) = light_at_rest(&scenario, &body, &wrinkles, &normals);
        Ok(Self {
            scenario,
            body,
            wrinkles,
            layers,
            bare,
            headband,
            stations,
            performance,
            events,
            plan,
            baked,
        })
    }

    /// Refuses a flash that a camera misses: each has a shutter of its own.
    pub(super) fn check_flash(&self, schedule: &Schedule) -> Result<(), Error> {
        let Some(flash) = &self.scenario.flash else { return Ok(()) };
        schedule.cameras.iter().try_for_each(|camera| {
            let alone = Schedule { cameras: vec![camera.clone()] };
            flash.check(&alone, self.scenario.extent.rate, self.stations[&camera.0].exposure_s)
        })
    }

    /// What the studio was set up for.
    #[must_use]
    pub fn scenario(&self) -> &Scenario {
        &self.scenario
    }

    /// The face.
    #[must_use]
    pub fn body(&self) -> &Body {
        &self.body
    }

    /// The cameras by id.
    #[must_use]
    pub fn stations(&self) -> &BTreeMap<String, Station> {
        &self.stations
    }

    /// The paint on the face.
    #[must_use]
    pub fn layers(&self) -> &Layers {
        &self.layers
    }

    /// The lines along which the face folds.
    #[must_use]
    pub fn wrinkles(&self) -> &Wrinkles {
        &self.wrinkles
    }

    /// Names of the balls on the headband.
    #[must_use]
    pub fn head_markers(&self) -> Vec<String> {
        self.headband.names().map(ToString::to_string).collect()
    }

    /// Names of all markers: the dots, then the balls on the headband.
    #[must_use]
    pub fn marker_names(&self) -> Vec<String> {
        let dots = self.layers.dots().iter().map(|dot| dot.id.clone());
        dots.chain(self.headband.names().map(ToString::to_string)).collect()
    }
}

fn perform(
    scenario: &Scenario,
    body: &Body,
    clip: Option<Clip>,
) -> Result<(Performance, Performance), Error> {
    use crate::act::Timeline;
    let shapes = body.shape_names();
    let performance = match (&scenario.performance, clip) {
        (scenario::Performance::Standard, None) => {
            Timeline::standard(scenario.extent.performance_s(), scenario.seed).bind(shapes)
        }
        (scenario::Performance::Events(timeline), None) => {
            timeline.bind_at(scenario::Performance::EVENTS, shapes)
        }
        (scenario::Performance::Recording(params), Some(clip)) => clip.bind(params, shapes),
        (scenario::Performance::Recording(_), None) => Err(Error::parameter(
            "performance",
            "is a recording, but no recorded weights are given beside the scenario",
        )),
        (_, Some(_)) => {
            Err(Error::parameter("performance", "recorded weights are given, so it must be a recording"))
        }
    }?;
    let events = Timeline { events: scenario.events.clone(), seed: scenario.seed }.bind(shapes)?;
    Ok((performance, events))
}

/// A dot on each marker's place, of its own size and form.
fn dots(scenario: &Scenario, body: &Body, normals: &[Vector3<f64>]) -> Vec<Dot> {
    let mut rng = ChaCha8Rng::seed_from_u64(scenario.seed ^ 0x0000_d075);
    let rest = &body.mesh.positions;
    let [low, high] = scenario.paint.dot_radius_mm;
    let markers = body.markers();
    let places: Vec<u32> = markers.iter().map(|marker| marker.vertex).collect();
    let corner_of = corners_of(&places, &body.triangles);
    let dot = |(marker, corner): (&crate::body::MarkerPlace, Option<(u32, usize)>)| {
        let radius = rng.random_range(low..=high);
        let outline = match scenario.paint.out_of_round {
            0.0 => Outline::round(radius),
            share => Outline::out_of_round(radius, share, rng.random()),
        };
        let (triangle, corner) = corner?;
        let mut weights = [0.0; 3];
        weights[corner] = 1.0;
        let at = (triangle, weights);
        let dot = Dot::at(&marker.name, outline, at, &body.triangles, rest, normals);
        Some(Dot { paint: scenario.paint.dot_color, ..dot })
    };
    markers.iter().zip(corner_of).filter_map(dot).collect()
}

/// Per vertex a triangle that it is a corner of, and which corner.
fn corners_of(vertices: &[u32], triangles: &[[u32; 3]]) -> Vec<Option<(u32, usize)>> {
    let mut found: BTreeMap<u32, (u32, usize)> = BTreeMap::new();
    let wanted: std::collections::BTreeSet<u32> = vertices.iter().copied().collect();
    for (number, triangle) in triangles.iter().enumerate() {
        for (corner, vertex) in triangle.iter().enumerate() {
            if wanted.contains(vertex) {
                found.entry(*vertex).or_insert((number as u32, corner));
            }
        }
    }
    vertices.iter().map(|vertex| found.get(vertex).copied()).collect()
}

/// A brush is not led more evenly than over this length, mm.
const BRUSH_MM: f64 = 7.0;
/// Knots of a stroke's half-width between two of these lengths.
const KNOTS: usize = 8;
/// Shortest and longest stretch where paint is gone, mm.
const GAP_MM: [f64; 2] = [1.0, 5.0];
/// A stroke starts and ends this far before its line does, mm, at most.
const SHORT_MM: f64 = 3.0;

fn strokes(scenario: &Scenario, wrinkles: &Wrinkles) -> Vec<(Stroke, StrokeCoordinates)> {
    let plan = &scenario.paint;
    let one = |(number, line): (usize, &wrinkle::WrinkleLine)| {
        let mut rng = ChaCha8Rng::seed_from_u64(scenario.seed ^ (0x57_0000 + number as u64));
        let widths = wrinkles.widths(number);
        let length = widths.last().map_or(0.0, |last| last.0);
        let mut half = || {
            let [low, high] = plan.stroke_width;
            let count = 2 + (length / BRUSH_MM).ceil() as usize;
            let wills: Vec<f64> = (0..count).map(|_| low + (high - low) * rng.random::<f64>()).collect();
            let knots = (0..=(count - 2) * KNOTS).map(|knot| {
                let x = knot as f64 * BRUSH_MM / KNOTS as f64;
                let ease = 0.5 - 0.5 * (std::f64::consts::PI * (knot % KNOTS) as f64 / KNOTS as f64).cos();
                let [from, to] = [wills[knot / KNOTS], wills[knot / KNOTS + 1]];
                [x, width_at(&widths, x) * (from + (to - from) * ease)]
            });
            HalfWidth::through(knots.collect())
        };
        let (left, right) = (half(), half());
        let range = [rng.random_range(0.0..SHORT_MM), length - rng.random_range(0.0..SHORT_MM)];
        let missing = gaps(&mut rng, range, plan.missing);
        let coordinates = wrinkles.coordinates(number);
        let places = StrokeCoordinates {
            vertices: coordinates.vertices,
            coordinates: coordinates.x_mm.into_iter().zip(coordinates.p_mm).map(|(x, p)| [x, p]).collect(),
        };
        let stroke = Stroke {
            id: line.id.clone(),
            paint: plan.stroke_colors.get(&line.paint).copied().unwrap_or_default(),
            left,
            right,
            range,
            missing,
            smear_mm: plan.smear_mm,
            texture: Texture { deviation: plan.texture, seed: scenario.seed ^ (0x7e_0000 + number as u64) },
        };
        (stroke, places)
    };
    wrinkles.lines().enumerate().map(one).collect()
}

/// The base width of a line at x, mm.
fn width_at(widths: &[(f64, f64)], x: f64) -> f64 {
    let after = widths.partition_point(|station| station.0 < x).min(widths.len().saturating_sub(1));
    widths.get(after).map_or(0.0, |station| station.1)
}

fn gaps(rng: &mut ChaCha8Rng, [from, to]: [f64; 2], share: f64) -> Vec<[f64; 2]> {
    let mut left = share * (to - from).max(0.0);
    let mut gaps = Vec::new();
    while left > 0.0 {
        let length = rng.random_range(GAP_MM[0]..GAP_MM[1]).min(left);
        let start = from + rng.random::<f64>() * (to - from - length);
        gaps.push([start, start + length]);
        left -= length;
    }
    gaps
}

/// Which vertices are looked at closely in every wrinkle frame, and the light of the others.
fn light_at_rest(
    scenario: &Scenario,
    body: &Body,
    wrinkles: &Wrinkles,
    normals: &[Vector3<f64>],
) -> (Plan, Vec<[f32; 3]>) {
    let mut close = vec![false; body.mesh.positions.len()];
    for number in 0..wrinkles.lines().len() {
        let widths = wrinkles.widths(number);
        let coordinates = wrinkles.coordinates(number);
        for ((vertex, x), p) in coordinates.vertices.iter().zip(&coordinates.x_mm).zip(&coordinates.p_mm) {
            close[*vertex as usize] |= p.abs() <= CLOSE_LOOK * width_at(&widths, *x);
        }
    }
    let none = vec![false; close.len()];
    let rest = &body.mesh.positions;
    let surface = light::Surface { positions: rest, normals, triangles: &body.triangles };
    let scene = light::Scene::build(rest, &body.triangles, &[]);
    // The gradient belongs to the world; the head hardly turns.
    let world_from_face = crate::take::Spaces::world_from_face();
    let gradient = world_from_face.inverse_transform_vector(&Vector3::from(scenario.light.gradient));
    let ambient = light::Ambient { gradient: gradient.into(), ..scenario.light.clone() };
    let baked = light::shade(&scene, &surface, &Plan::new(&none, &body.triangles), &body.albedo, &ambient);
    (Plan::new(&close, &body.triangles).with_baked(baked.clone()), baked)
}

//! large-scale and wrinkled.

use crate::perturb::*;
use artifact::{Space, ValleyPoint, ValleysFrame, ValleysHeader, Wrinkle};
use nalgebra::{Point3, Vector3};
use virtual_rig::score::{self, Metric, ScoreError, WrinkledFrame, WrinkledScene};

const COUNT: usize = 121;
const STEP: f64 = 0.5;
const W: f64 = 1.0;
const D: f64 = 0.4;
const FRAMES: [i64; 2] = [FIRST, FIRST + 1];

/// A square of 60 mm, bent; vertex (i, j) at column i.
fn sheet() -> (Vec<Point3<f64>>, Vec<[u32; 3]>) {
    let point = |i: usize| {
        let (x, y) = ((i % COUNT) as f64 * STEP, (i / COUNT) as f64 * STEP);
        Point3::new(x, y, 20.0 - 0.002 * (x - 30.0).powi(2))
    };
    let quad = |i: usize| {
        let at = (i / (COUNT - 1) * COUNT + i % (COUNT - 1)) as u32;
        let next = at + COUNT as u32;
        [[at, at + 1, next + 1], [at, next + 1, next]]
    };
    ((0..COUNT * COUNT).map(point).collect(), (0..(COUNT - 1).pow(2)).flat_map(quad).collect())
}

/// The paper's profile about the line x = 30, cut off at 5 w.
fn fold(x: f64) -> f64 {
    let p = (x - 30.0).abs() / W;
    if p <= 5.0 { D * (p - 1.0) * (-p).exp() } else { 0.0 }
}

/// What a bulge rises between two valleys 6 mm apart, beside what both profiles do.
fn bulge(x: f64) -> f64 {
    0.2 * (-0.5 * (x - 33.0).powi(2)).exp()
}

struct Scene {
    two: bool,
    rest: Vec<Point3<f64>>,
    triangles: Vec<[u32; 3]>,
    normals: Vec<Vector3<f64>>,
    header: ValleysHeader,
    valleys: Vec<ValleysFrame>,
}

impl Scene {
    fn new() -> Self {
        let (rest, triangles) = sheet();
        let normals = mesh::vertex_normals(&rest, &triangles);
        let header = ValleysHeader {
            mesh: mesh_ref(rest.len()),
            wrinkles: vec![Wrinkle { id: "brow".into(), paint: None }],
            rate: None,
            take: Some(take("t1")),
            space: Space::Face,
        };
        // From y = 10 to 50 along column 60; the first corner of a quad's first triangle is its vertex.
        let point = |row: usize| ValleyPoint {
            x_mm: row as f64 * STEP,
            face: (2 * (row * (COUNT - 1) + 60)) as u32,
            barycentric: [1.0, 0.0, 0.0],
            at_mm: [30.0, row as f64 * STEP, 20.0 - D],
            normal: [0.0, 0.0, 1.0],
            across: [1.0, 0.0, 0.0],
            w_mm: W,
            d_mm: D,
            epsilon: 0.0,
            kappa: 0.0,
        };
        let points: Vec<ValleyPoint> = (0..120).map(point).collect();
        let frame = |frame| ValleysFrame { frame, valleys: [("brow".to_string(), points.clone())].into() };
        let valleys = FRAMES.map(frame).into();
        Self { two: false, rest, triangles, normals, header, valleys }
    }

    /// The sheet with heights added along its normals.
    fn raised(&self, height: impl Fn(&Point3<f64>) -> f64) -> Vec<Point3<f64>> {
        self.rest.iter().zip(&self.normals).map(|(point, normal)| point + height(point) * normal).collect()
    }

    fn truth(&self) -> Vec<Point3<f64>> {
        self.raised(|point| self.height(point.x))
    }

    fn height(&self, x: f64) -> f64 {
        if self.two { fold(x) + fold(x - 6.0) + bulge(x) } else { fold(x) }
    }

    /// With a second valley 6 mm beside the first.
    fn with_neighbor() -> Self {
        let mut scene = Self { two: true, ..Self::new() };
        scene.header.wrinkles.push(Wrinkle { id: "eye".into(), paint: None });
        for frame in &mut scene.valleys {
            let mut points = frame.valleys["brow"].clone();
            points.iter_mut().for_each(|point| {
                point.face += 2 * 12;
                point.at_mm[0] += 6.0;
            });
            frame.valleys.insert("eye".into(), points);
        }
        scene
    }

    fn score(&self, result: &[Point3<f64>], own: Option<&[Point3<f64>]>) -> Vec<Metric> {
        let index = sequence(self.rest.len(), &FRAMES);
        let scene = WrinkledScene {
            truth: &index,
            result: &index,
            valleys: (&self.header, &self.valleys),
            rest: &self.rest,
            triangles: &self.triangles,
        };
        let frame = |_| {
            Ok::<_, ScoreError>(WrinkledFrame {
                truth: self.truth(),
                truth_large_scale: self.rest.clone(),
                result: result.to_vec(),
                result_large_scale: own.map(<[_]>::to_vec),
            })
        };
        score::wrinkled(&scene, frame).unwrap()
    }

    fn in_region(&self) -> impl Iterator<Item = usize> {
        (0..self.rest.len()).filter(|&v| {
            ((self.rest[v] - Point3::new(30.0, self.rest[v].y, self.rest[v].z)).norm()) <= 2.9 * W
        })
    }
}

#[test]
fn large_scale_truth_fed_back_is_perfect_and_known_errors_are_recovered() {
    let scene = Scene::new();
    let index = sequence(scene.rest.len(), &[1, 2, 3, 4]);
    let result_index = sequence(scene.rest.len(), &[2, 3, 4, 9]);
    let same = |_| Ok::<_, ScoreError>((scene.rest.clone(), scene.rest.clone()));
    assert_perfect(&score::large_scale(&index, &index, same).unwrap(), &[]);

    let mut asked = Vec::new();
    let mut lengths = Vec::new();
    let off = |frame: i64| {
        asked.push(frame);
        let mut random = random(frame as u64);
        let moved = scene.rest.iter().map(|point| {
            let offset = Vector3::from_fn(|_, _| 0.3 * normal(&mut random));
            lengths.push(offset.norm());
            point + offset
        });
        Ok::<_, ScoreError>((scene.rest.clone(), moved.collect()))
    };
    let metrics = score::large_scale(&index, &result_index, off).unwrap();
    assert_eq!(asked, [2, 3, 4]);
    lengths.sort_unstable_by(f64::total_cmp);
    assert_recovered(&metrics, "rms_mm", rms(&lengths));
    assert_recovered(&metrics, "mean_mm", lengths.iter().sum::<f64>() / lengths.len() as f64);
    assert_recovered(&metrics, "p95_mm", lengths[lengths.len() * 95 / 100]);
    assert_recovered(&metrics, "max_mm", lengths[lengths.len() - 1]);
    assert_eq!(value(&metrics, "missing"), 1.0);
    assert_eq!(metric(&metrics, "rms_mm").context["frames_extra"], 1);
}

#[test]
fn wrinkled_truth_fed_back_is_perfect() {
    let scene = Scene::new();
    assert_perfect(&scene.score(&scene.truth(), Some(&scene.rest)), &["bulge_height_rel"]);
    let metrics = scene.score(&scene.truth(), None);
    assert_perfect(&metrics, &["outside_moved", "bulge_height_rel"]);
    assert!(metric(&metrics, "outside_moved").reason.is_some());
}

#[test]
fn no_wrinkles_at_all_score_one() {
    let scene = Scene::new();
    let metrics = scene.score(&scene.rest, Some(&scene.rest));
    assert_eq!(value(&metrics, "region_error_ratio"), 1.0);
    assert_eq!(value(&metrics, "region_raw_ratio"), 1.0);
    assert_eq!(value(&metrics, "outside_moved"), 0.0);
    assert!((value(&metrics, "valley_depth_rel") - 1.0).abs() < 1e-9);
}

#[test]
fn wrinkles_too_deep_are_recovered_as_ratio_and_depth() {
    let scene = Scene::new();
    let metrics = scene.score(&scene.raised(|point| 1.1 * fold(point.x)), Some(&scene.rest));
    assert_recovered(&metrics, "region_error_ratio", 0.1);
    assert_recovered(&metrics, "region_raw_ratio", 0.1);
    assert_recovered(&metrics, "valley_depth_rel", 0.1);
    assert_recovered(&metrics, "valley_depth_p90", 0.1);
}

#[test]
fn bulges_between_neighbors_are_recovered() {
    let scene = Scene::with_neighbor();
    assert_perfect(&scene.score(&scene.truth(), Some(&scene.rest)), &[]);
    let metrics = scene.score(&scene.raised(|point| 0.8 * scene.height(point.x)), None);
    assert_recovered(&metrics, "bulge_height_rel", 0.2);
    // Valleys alone, without the bulge between them.
    let highest =
        |field: &dyn Fn(f64) -> f64| (0..=12).map(|i| field(30.0 + 0.5 * f64::from(i))).fold(0.0, f64::max);
    let alone = |x: f64| scene.height(x) - bulge(x);
    let planted = 1.0 - highest(&alone) / highest(&|x| scene.height(x));
    assert_recovered(&scene.score(&scene.raised(|point| alone(point.x)), None), "bulge_height_rel", planted);

    // The same valleys too narrow to be neighbours.
    let mut far = Scene::with_neighbor();
    far.valleys
        .iter_mut()
        .flat_map(|frame| frame.valleys.values_mut().flatten())
        .for_each(|point| point.w_mm = 0.7);
    assert_eq!(metric(&far.score(&far.truth(), None), "bulge_height_rel").value, None);
}

#[test]
fn the_filter_keeps_short_errors_and_drops_long_ones() {
    let scene = Scene::new();
    // Waves of 2.5 mm along the valley pass the filter, waves of 100 mm do not.
    let short = |y: f64| 0.05 * (std::f64::consts::TAU * y / 2.5).sin();
    let long = |y: f64| 0.5 * (std::f64::consts::TAU * y / 100.0).cos();
    let planted = rms(&scene.in_region().map(|v| short(scene.rest[v].y)).collect::<Vec<_>>());
    let metrics = scene.score(&scene.raised(|point| fold(point.x) + short(point.y)), None);
    assert_recovered(&metrics, "region_rms_mm", planted);
    let metrics = scene.score(&scene.raised(|point| fold(point.x) + short(point.y) + long(point.y)), None);
    let found = value(&metrics, "region_rms_mm");
    assert!((found - planted).abs() < 0.05 * planted, "{found}, planted {planted}");
    assert!(value(&metrics, "region_raw_rms_mm") > 5.0 * planted);
}

#[test]
fn sliding_along_the_skin_is_raw_error_only() {
    let scene = Scene::new();
    let slid: Vec<Point3<f64>> = scene.truth().iter().map(|point| point + Vector3::y() * 0.2).collect();
    let metrics = scene.score(&slid, None);
    assert!(value(&metrics, "region_rms_mm") < 1e-12);
    assert_recovered(&metrics, "region_raw_rms_mm", 0.2);
    assert_recovered(&metrics, "rms_mm", 0.2);
}

#[test]
fn what_moves_far_from_wrinkles_is_recovered() {
    let scene = Scene::new();
    let near = scene.raised(|point| if (point.x - 30.0).abs() < 6.9 * W { 1.5 * fold(point.x) } else { 0.0 });
    assert_eq!(value(&scene.score(&near, Some(&scene.rest)), "outside_moved"), 0.0);
    let far = scene.raised(|point| fold(point.x) + if point.x < 5.0 { 0.07 } else { 0.0 });
    assert_recovered(&scene.score(&far, Some(&scene.rest)), "outside_moved", 0.07);
}

#[test]
fn frames_without_valleys_are_counted() {
    let mut scene = Scene::new();
    scene.valleys.remove(0);
    let metrics = scene.score(&scene.truth(), Some(&scene.rest));
    assert_eq!(metric(&metrics, "region_rms_mm").context["frames_without_valleys"], 1);
    scene.valleys.clear();
    let metrics = scene.score(&scene.truth(), Some(&scene.rest));
    assert_eq!(metric(&metrics, "region_error_ratio").value, None);
    assert_eq!(value(&metrics, "rms_mm"), 0.0);
}

//! Takes small enough to know by heart, and errors of known size.

use artifact::{
    CameraRig, Clock, FileRef, LargeScale, MarkerFrame, MarkerHeader, MeshRef, Rate, Sample2d, SampleStatus,
    SequenceForm, Shown, SyncCamera, SyncFrame, SyncHeader, SyncSource, TakeRef, TrackState, Tracks2dFrame,
    Tracks2dHeader, Trajectories, Unit,
};
use camera::{BrownConrady, Camera, Lens};
use nalgebra::{Point2, Point3, Vector2, Vector3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use virtual_rig::score::Metric;

pub(crate) const FIRST: i64 = 1001;

pub(crate) fn random(seed: u64) -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(seed)
}

/// The value of a metric; panics with its reason.
pub(crate) fn value(metrics: &[Metric], name: &str) -> f64 {
    let metric = metric(metrics, name);
    metric.value.unwrap_or_else(|| panic!("{name}: {:?}", metric.reason))
}

pub(crate) fn metric<'a>(metrics: &'a [Metric], name: &str) -> &'a Metric {
    metrics.iter().find(|metric| metric.name == name).unwrap_or_else(|| panic!("no metric {name}"))
}

/// Every metric is at its very best: errors exactly 0, shares exactly 1; `unmeasured` ones may have no value.
pub(crate) fn assert_perfect(metrics: &[Metric], unmeasured: &[&str]) {
    for metric in metrics {
        let best = if metric.unit == "share" { 1.0 } else { 0.0 };
        match metric.value {
            Some(value) => assert_eq!(value, best, "{}", metric.name),
            None => assert!(unmeasured.contains(&metric.name), "{}: {:?}", metric.name, metric.reason),
        }
    }
}

/// Within 1 % of what was planted.
pub(crate) fn assert_recovered(metrics: &[Metric], name: &str, planted: f64) {
    let found = value(metrics, name);
    assert!((found - planted).abs() <= 0.01 * planted.abs(), "{name}: {found}, planted {planted}");
}

pub(crate) fn take(id: &str) -> TakeRef {
    TakeRef { take: id.into(), session: "s1".into(), sha256: format!("{id:0<64}") }
}

pub(crate) fn mesh_ref(vertex_count: usize) -> MeshRef {
    MeshRef {
        file: FileRef { name: "scan.obj".into(), sha256: "a".repeat(64) },
        unit: Unit::Mm,
        vertex_count,
    }
}

pub(crate) fn sequence(vertex_count: usize, frames: &[i64]) -> LargeScale {
    LargeScale {
        mesh: mesh_ref(vertex_count),
        cache: "x.pc2".into(),
        form: SequenceForm::Pc2,
        rate: Some(Rate::per_second(50)),
        frames: frames.to_vec(),
        take: Some(take("t1")),
    }
}

/// 8 × 6 markers on a bent sheet about the origin that moves a little, 40 frames from 1001.
pub(crate) fn markers() -> Trajectories {
    let ids: Vec<String> = (0..48).map(|i| format!("p{i:02}")).collect();
    let header = MarkerHeader {
        unit: Unit::Mm,
        rate: Some(Rate::per_second(50)),
        markers: ids.clone(),
        take: Some(take("t1")),
    };
    let frame = |frame: i64| {
        let time = (frame - FIRST) as f64 * 0.1;
        let point = |i: usize| {
            let (x, y) = ((i % 8) as f64 * 15.0 - 52.0, (i / 8) as f64 * 18.0 - 45.0);
            Some(Point3::new(x + 2.0 * time.sin(), y + (time + x).cos(), 40.0 - 0.006 * (x * x + y * y)))
        };
        MarkerFrame { frame, points: (0..48).map(point).collect(), status: vec![SampleStatus::Measured; 48] }
    };
    Trajectories { header, frames: (FIRST..FIRST + 40).map(frame).collect() }
}

/// Six cameras in a fan half a metre before the sheet, with distortion.
pub(crate) fn rig() -> CameraRig {
    let camera = |i: usize| {
        let angle = (i as f64 - 2.5) * 0.25;
        let eye = Point3::new(600.0 * angle.sin(), 80.0 * (i as f64 - 2.0), 600.0 * angle.cos());
        Camera {
            image_size: [656, 490],
            lens: Lens {
                focal_px: Vector2::new(1100.0 + 5.0 * i as f64, 1098.0),
                center_px: Vector2::new(327.0, 246.0),
                distortion: BrownConrady { k1: -0.11, k2: 0.05, p1: 4e-4, p2: -3e-4, k3: 0.0 },
            },
            cam_from_world: Camera::pose_looking_at(eye, Point3::new(0.0, 0.0, 30.0), Vector3::y()),
        }
    };
    let cameras = (0..6).map(|i| (format!("m{}", i + 1), camera(i).into())).collect();
    CameraRig { cameras, take: Some(take("t1")) }
}

/// The markers in the images of the rig, all of them seen.
pub(crate) fn tracks() -> (Tracks2dHeader, Vec<Tracks2dFrame>) {
    let (rig, markers) = (rig(), markers());
    let header = Tracks2dHeader {
        cameras: rig.cameras.keys().cloned().collect(),
        markers: markers.header.markers.clone(),
        rate: markers.header.rate,
        take: markers.header.take.clone(),
    };
    let sample = |camera: &Camera, point: &Option<Point3<f64>>| {
        let pixel = camera.project(point.as_ref()?)?;
        Some(Sample2d::seen(Point2::from(pixel)))
    };
    let frame = |frame: &MarkerFrame| Tracks2dFrame {
        frame: frame.frame,
        cameras: (rig.cameras.values())
            .map(|camera| Some(frame.points.iter().map(|point| sample(&camera.camera, point)).collect()))
            .collect(),
    };
    let frames = markers.frames.iter().map(frame).collect();
    (header, frames)
}

/// Every sample of all images, as places (frame, camera, marker).
pub(crate) fn samples(frames: &mut [Tracks2dFrame]) -> impl Iterator<Item = &mut Option<Sample2d>> {
    frames.iter_mut().flat_map(|frame| frame.cameras.iter_mut().flatten().flatten())
}

/// Moves every sample by a random vector; returns the root mean square of their lengths.
pub(crate) fn shake_pixels(frames: &mut [Tracks2dFrame], sigma: f64, seed: u64) -> f64 {
    let mut random = random(seed);
    let (mut squares, mut count) = (0.0, 0);
    for sample in samples(frames).flatten() {
        let offset = Vector2::new(normal(&mut random), normal(&mut random)) * sigma / 2f64.sqrt();
        sample.at += offset;
        squares += offset.norm_squared();
        count += 1;
    }
    (squares / f64::from(count)).sqrt()
}

/// Moves every marker by a random vector; returns the lengths in rising order.
pub(crate) fn shake_points(frames: &mut [MarkerFrame], sigma: f64, seed: u64) -> Vec<f64> {
    let mut random = random(seed);
    let mut lengths = Vec::new();
    for point in frames.iter_mut().flat_map(|frame| frame.points.iter_mut().flatten()) {
        let offset = Vector3::from_fn(|_, _| normal(&mut random)) * sigma / 3f64.sqrt();
        *point += offset;
        lengths.push(offset.norm());
    }
    lengths.sort_unstable_by(f64::total_cmp);
    lengths
}

pub(crate) fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|x| x * x).sum::<f64>() / values.len() as f64).sqrt()
}

/// A number of mean 0 and deviation 1 (Box and Muller).
pub(crate) fn normal(random: &mut ChaCha8Rng) -> f64 {
    let (a, b): (f64, f64) = (1.0 - random.random::<f64>(), random.random());
    (-2.0 * a.ln()).sqrt() * (std::f64::consts::TAU * b).cos()
}

/// Hides a sample as the truth does: where it would be, and what shows of the dot.
pub(crate) fn hide(sample: &mut Option<Sample2d>, visible_share: f64) {
    if let Some(sample) = sample {
        sample.state = TrackState::Predicted;
        sample.confidence = visible_share;
    }
}

/// Six cameras, one of them slower, 200 frames; an image dropped and one doubled.
pub(crate) fn time_base() -> (SyncHeader, Vec<SyncFrame>) {
    let camera = |i: usize| SyncCamera {
        rate: Rate::per_second(if i == 5 { 25 } else { 50 }),
        every: if i == 5 { 2 } else { 1 },
        phase: FIRST,
        offset_frames: 0.07 * i as f64 - 0.1,
        drift_ppm: 3.0 * i as f64,
        source: SyncSource::Timestamps,
    };
    let header = SyncHeader {
        rate: Rate::per_second(50),
        clock: Clock::Timestamps,
        cameras: (0..6).map(|i| (format!("m{}", i + 1), camera(i))).collect(),
        take: Some(take("t1")),
    };
    let shows = |id: &str, frame: i64| match (id, frame - FIRST) {
        ("m2", 30) => None,
        ("m2", at) => Some(Shown { index: at - i64::from(at > 30), time_s: None, doubled: false }),
        ("m3", at) => Some(Shown { index: at, time_s: None, doubled: at == 80 }),
        ("m6", at) => Some(Shown { index: at / 2, time_s: None, doubled: false }),
        (_, at) => Some(Shown { index: at, time_s: None, doubled: false }),
    };
    let frame = |frame: i64| SyncFrame {
        frame,
        shows: (header.cameras.iter())
            .filter(|(_, camera)| camera.is_due(frame))
            .map(|(id, _)| (id.clone(), shows(id, frame)))
            .collect(),
    };
    let frames = (FIRST..FIRST + 200).map(frame).collect();
    (header, frames)
}

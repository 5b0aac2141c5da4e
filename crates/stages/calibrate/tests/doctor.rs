//! The doctor finds what is planted, in the camera in which it is, and nothing in a healthy rig.
#![allow(clippy::unwrap_used, reason = "helpers of tests are tests too")]

mod rig;

use calibrate::doctor::{
    Evidence, Examination, Kind, KnownLength, LengthEnds, Params, Patient, Sighting, at_frame_times, examine,
};
use camera::Camera;
use nalgebra::{Isometry3, Point3, Rotation3, Unit, UnitQuaternion, Vector2, Vector3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

const SEEDS: std::ops::RangeInclusive<u64> = 1..=3;
const CAMERAS: usize = 8;

/// Evidence as pixels per camera, by point and frame.
struct Filmed {
    cameras: Vec<Camera>,
    /// Per point its path.
    paths: Vec<Vec<Point3<f64>>>,
    /// Per camera, point and frame.
    seen: Vec<Vec<Vec<Option<Vector2<f64>>>>>,
}

fn film(seed: u64, paths: Vec<Vec<Point3<f64>>>, noise_px: f64) -> Filmed {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let cameras = rig::cameras(seed);
    let mut see =
        |camera: &Camera| paths.iter().map(|path| rig::track(camera, path, noise_px, &mut rng)).collect();
    let seen = cameras.iter().map(&mut see).collect();
    Filmed { cameras, paths, seen }
}

/// A wand.
fn wand(seed: u64, noise_px: f64) -> Filmed {
    film(seed, vec![rig::wand_path(200, 90.0, seed)], noise_px)
}

/// A talking face: markers that sway by millimetres, the lower ones more, on a head that nods.
fn face(seed: u64, noise_px: f64) -> Filmed {
    let path = |point: &Point3<f64>| {
        let at = |frame: usize| {
            let t = frame as f64 / 50.0;
            let jaw = ((-point.y - 10.0) / 60.0).clamp(0.0, 1.0);
            let opened = point + Vector3::new(0.0, -8.0, -2.0) * jaw * (9.0 * t).sin().max(0.0);
            let nod = UnitQuaternion::from_scaled_axis(Vector3::new(
                0.05 * (2.2 * t).sin(),
                0.08 * (1.3 * t).sin(),
                0.0,
            ));
            nod * opened
        };
        (0..60).map(at).collect()
    };
    film(seed, rig::face().iter().map(path).collect(), noise_px)
}

impl Filmed {
    fn evidence(&self) -> Evidence {
        let patient = |(id, camera): (&&str, &Camera)| Patient {
            id: id.to_string(),
            camera: camera.clone(),
            footage_size: Some(if id.starts_with('m') { [656, 490] } else { [1384, 1038] }),
        };
        let mut sightings = Vec::new();
        for point in 0..self.paths.len() {
            for frame in 0..self.paths[point].len() {
                let view = |c: usize| Some((c, self.seen[c][point][frame]?));
                let views = (0..self.cameras.len()).filter_map(view).collect();
                sightings.push(Sighting { frame: frame as i64, name: point.to_string(), views });
            }
        }
        let patients = rig::IDS.iter().zip(&self.cameras).map(patient).collect();
        Evidence { patients, sightings, lengths: Vec::new() }
    }

    fn examined(&self) -> Examination {
        examine(&self.evidence(), &Params::default())
    }

    fn middle(&self) -> Point3<f64> {
        let all: Vec<&Point3<f64>> = self.paths.iter().flatten().collect();
        Point3::from(all.iter().map(|point| point.coords).sum::<Vector3<f64>>() / all.len() as f64)
    }
}

/// Something that goes wrong with a camera; the same for a camera and a seed.
type Plant = fn(&mut Filmed, usize, &mut ChaCha8Rng);

fn axis(rng: &mut ChaCha8Rng) -> Unit<Vector3<f64>> {
    Unit::new_normalize(Vector3::from([(); 3].map(|()| rig::gauss(rng))))
}

fn turn(filmed: &mut Filmed, c: usize, rng: &mut ChaCha8Rng) {
    let turn = Rotation3::from_axis_angle(&axis(rng), 0.3_f64.to_radians());
    let camera = &mut filmed.cameras[c];
    camera.cam_from_world =
        Isometry3::from_parts(Vector3::zeros().into(), turn.into()) * camera.cam_from_world;
}

fn roll(filmed: &mut Filmed, c: usize, _: &mut ChaCha8Rng) {
    let turn = UnitQuaternion::from_scaled_axis(Vector3::z() * 0.3_f64.to_radians());
    let camera = &mut filmed.cameras[c];
    camera.cam_from_world = Isometry3::from_parts(Vector3::zeros().into(), turn) * camera.cam_from_world;
}

fn zoom(filmed: &mut Filmed, c: usize, rng: &mut ChaCha8Rng) {
    filmed.cameras[c].lens.focal_px *= if rng.random() { 1.02 } else { 0.98 };
}

/// The focal length is wrong, and the camera moved along its view until its images fit again, as a bundle adjustment does.
fn hide_zoom(filmed: &mut Filmed, c: usize, rng: &mut ChaCha8Rng) {
    let middle = filmed.middle();
    let camera = &mut filmed.cameras[c];
    let before = camera.lens.focal_px.x;
    let depth = (camera.cam_from_world * middle).z;
    zoom(filmed, c, rng);
    let camera = &mut filmed.cameras[c];
    camera.cam_from_world.translation.vector.z += depth * (camera.lens.focal_px.x / before - 1.0);
}

fn delay(filmed: &mut Filmed, c: usize, rng: &mut ChaCha8Rng) {
    let is_late: bool = rng.random();
    for track in &mut filmed.seen[c] {
        if is_late {
            track.rotate_right(1)
        } else {
            track.rotate_left(1)
        }
        let end = if is_late { 0 } else { track.len() - 1 };
        track[end] = None;
    }
}

fn mirror(filmed: &mut Filmed, c: usize, _: &mut ChaCha8Rng) {
    let width = f64::from(filmed.cameras[c].image_size[0]);
    filmed.seen[c].iter_mut().flatten().flatten().for_each(|pixel| pixel.x = width - 1.0 - pixel.x);
}

/// The other pose of a board that was tilted by 10 to 40 degrees: the scene tips over by twice the tilt.
fn flip(filmed: &mut Filmed, c: usize, rng: &mut ChaCha8Rng) {
    let tilt = rng.random_range(10.0_f64..40.0).to_radians();
    let direction = rng.random_range(0.0..std::f64::consts::TAU);
    let middle = filmed.middle();
    let camera = &mut filmed.cameras[c];
    let at = (camera.cam_from_world * middle).coords;
    let sight = at.normalize();
    let aside = sight.cross(&Vector3::y()).normalize();
    let across = Unit::new_normalize(aside * direction.cos() + sight.cross(&aside) * direction.sin());
    let tip = UnitQuaternion::from_axis_angle(&across, 2.0 * tilt);
    let about = Isometry3::from_parts((at - tip * at).into(), tip);
    camera.cam_from_world = about * camera.cam_from_world;
}

fn missize(filmed: &mut Filmed, c: usize, rng: &mut ChaCha8Rng) {
    let size = &mut filmed.cameras[c].image_size;
    *size = match rng.random_range(0..3) {
        0 => size.map(|side| 2 * side),
        1 => [size[1], size[0]],
        _ => [640, 480],
    };
}

/// Plants something in each camera and seed: it is found there, named rightly, and no other camera is blamed.
fn assert_caught(name: &str, kinds: &[Kind], plant: Plant, scene: fn(u64, f64) -> Filmed) {
    for seed in SEEDS {
        for c in 0..CAMERAS {
            let noise_px = if c % 2 == 0 { 0.05 } else { 0.1 };
            let mut filmed = scene(seed, noise_px);
            let mut rng = ChaCha8Rng::seed_from_u64(100 * seed + c as u64);
            plant(&mut filmed, c, &mut rng);
            let findings = filmed.examined().findings;
            let place = format!("{name}, seed {seed}, {}: {findings:?}", rig::IDS[c]);
            assert!(findings.iter().all(|finding| finding.camera.as_deref() == Some(rig::IDS[c])), "{place}");
            assert!(findings.iter().any(|finding| kinds.contains(&finding.kind)), "{place}");
        }
    }
}

#[test]
fn a_turned_camera_is_named() {
    assert_caught("turned, wand", &[Kind::Turned], turn, wand);
    assert_caught("turned, face", &[Kind::Turned], turn, face);
    assert_caught("rolled, wand", &[Kind::Turned], roll, wand);
}

#[test]
fn a_wrong_focal_length_is_named() {
    assert_caught("zoomed, wand", &[Kind::Zoomed], zoom, wand);
    assert_caught("zoomed, face", &[Kind::Zoomed], zoom, face);
    assert_caught("hidden zoom, wand", &[Kind::Zoomed, Kind::Moved], hide_zoom, wand);
}

#[test]
fn a_frame_out_of_step_is_named() {
    assert_caught("late, wand", &[Kind::Late], delay, wand);
    assert_caught("late, face", &[Kind::Late], delay, face);
}

#[test]
fn a_mirrored_video_is_named() {
    assert_caught("mirrored, wand", &[Kind::Mirrored], mirror, wand);
    assert_caught("mirrored, face", &[Kind::Mirrored], mirror, face);
}

#[test]
fn cameras_whose_names_were_exchanged_are_named() {
    let mut filmed = face(1, 0.05);
    filmed.cameras.swap(0, 2);
    let findings = filmed.examined().findings;
    let named: Vec<(Option<&str>, Kind)> =
        findings.iter().map(|finding| (finding.camera.as_deref(), finding.kind)).collect();
    assert_eq!(named, [(Some("m1"), Kind::Exchanged), (Some("m3"), Kind::Exchanged)]);
    assert!(findings[0].what.contains("calibrated as m3"), "{}", findings[0].what);
}

#[test]
fn a_rig_that_is_mirrored_as_a_whole_is_named_as_a_whole() {
    let mut filmed = face(1, 0.05);
    (0..CAMERAS).for_each(|c| mirror(&mut filmed, c, &mut ChaCha8Rng::seed_from_u64(1)));
    let findings = filmed.examined().findings;
    assert!(
        findings.iter().any(|finding| finding.camera.is_none() && finding.kind == Kind::Mirrored),
        "{findings:?}"
    );
}

#[test]
fn a_blind_camera_is_told_and_nothing_at_all_too() {
    let mut filmed = face(1, 0.05);
    filmed.seen[3].iter_mut().for_each(|track| track.fill(None));
    let examination = filmed.examined();
    assert!(examination.compared && examination.findings.is_empty(), "{:?}", examination.findings);
    assert_eq!(examination.unjudged, ["camera m4: it sees no point that another camera sees"]);
    for seen in &mut filmed.seen[1..] {
        seen.iter_mut().for_each(|track| track.fill(None));
    }
    assert!(!filmed.examined().compared);
}

#[test]
fn a_boards_other_pose_is_named() {
    assert_caught("flipped, wand", &[Kind::Flipped], flip, wand);
    assert_caught("flipped, face", &[Kind::Flipped], flip, face);
}

#[test]
fn a_wrong_image_size_is_named() {
    assert_caught("size", &[Kind::ImageSize], missize, wand);
}

#[test]
fn a_healthy_rig_is_not_blamed() {
    for seed in 1..=8 {
        for noise_px in [0.02, 0.05, 0.1] {
            for (name, scene) in [("wand", wand as fn(u64, f64) -> Filmed), ("face", face)] {
                let examination = scene(seed, noise_px).examined();
                assert!(
                    examination.findings.is_empty(),
                    "{name} {seed} {noise_px}: {:?}",
                    examination.findings
                );
            }
        }
    }
}

#[test]
fn a_board_printed_too_small_shows_in_its_squares() {
    let mut evidence = face(1, 0.05).evidence();
    // Neighbours in the first frame, 16 mm apart in x as the face was made; their true distances stand for a board's squares.
    let filmed = face(1, 0.0);
    let length = |point: usize, factor: f64| KnownLength {
        ends: LengthEnds::Sightings([point * 60, (point + 1) * 60]),
        mm: factor * (filmed.paths[point][0] - filmed.paths[point + 1][0]).norm(),
    };
    evidence.lengths = (0..80).filter(|point| point % 9 < 8).map(|point| length(point, 1.0)).collect();
    assert!(examine(&evidence, &Params::default()).findings.is_empty());
    evidence.lengths = (0..80).filter(|point| point % 9 < 8).map(|point| length(point, 1.02)).collect();
    let findings = examine(&evidence, &Params::default()).findings;
    assert_eq!(findings.len(), 1, "{findings:?}");
    assert!(findings[0].kind == Kind::Length && (findings[0].number + 0.02).abs() < 0.003, "{findings:?}");
}

#[test]
fn the_distance_of_two_cameras_is_a_known_length() {
    let mut evidence = face(1, 0.05).evidence();
    let eye = |c: usize| evidence.patients[c].camera.eye_in_world();
    let mm = 1.02 * (eye(0) - eye(3)).norm();
    evidence.lengths = vec![KnownLength { ends: LengthEnds::Cameras([0, 3]), mm }];
    let findings = examine(&evidence, &Params::default()).findings;
    assert!(findings.len() == 1 && findings[0].kind == Kind::Length, "{findings:?}");
}

#[test]
fn a_camera_whose_clock_is_known_to_be_off_is_judged_at_its_own_times() {
    let mut filmed = face(1, 0.05);
    for track in &mut filmed.seen[2] {
        track.rotate_right(1);
        track[0] = None;
    }
    let mut evidence = filmed.evidence();
    let kinds = |evidence: &Evidence| -> Vec<Kind> {
        examine(evidence, &Params::default()).findings.iter().map(|finding| finding.kind).collect()
    };
    assert_eq!(kinds(&evidence), [Kind::Late]);
    evidence.sightings =
        at_frame_times(&evidence.sightings, |camera, _| if camera == 2 { -1.0 } else { 0.0 });
    assert_eq!(kinds(&evidence), []);
}

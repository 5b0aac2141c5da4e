//! What needs no other camera: sizes, focal lengths, coverage.

use super::{CameraReport, Evidence, Examination, Finding, Kind, Params, Patient};
use nalgebra::Vector2;

/// Focal lengths of real lenses, as shares of the image's width.
const FOCAL_RANGE: [f64; 2] = [0.3, 25.0];
/// How far the focal lengths of cameras with images of one size may lie apart.
const SIBLINGS: f64 = 1.5;
/// How far the principal point may lie off the middle, as a share of the diagonal.
const CENTER: f64 = 0.15;

/// Points that lie outside the image by more than this do not come from it, px.
const BEYOND_PX: f64 = 2.0;

pub(super) fn examine(evidence: &Evidence, params: &Params) -> Examination {
    let mut examination = Examination::default();
    for (c, patient) in evidence.patients.iter().enumerate() {
        let pixels: Vec<Vector2<f64>> = evidence
            .sightings
            .iter()
            .flat_map(|sighting| {
                sighting.views.iter().filter(|(camera, _)| *camera == c).map(|(_, pixel)| *pixel)
            })
            .collect();
        let coverage = (!pixels.is_empty()).then(|| coverage(patient.camera.image_size, &pixels));
        let findings = [
            image_size(patient, &pixels),
            focal(patient, evidence),
            aspect(patient, params),
            center(patient),
            fold(patient),
            coverage.and_then(|share| thin(patient, share, params)),
        ];
        examination.findings.extend(findings.into_iter().flatten());
        let camera = patient.id.clone();
        examination.cameras.push(CameraReport {
            camera,
            sightings: 0,
            residual_px: None,
            late_frames: None,
            coverage,
        });
    }
    if evidence.patients.iter().any(|patient| patient.footage_size.is_none()) {
        examination
            .unchecked
            .push("image sizes against the footage: no take manifest says the footage's".into());
    }
    examination
}

impl Finding {
    pub(super) fn of(patient: &Patient, kind: Kind, number: f64, unit: &'static str, what: String) -> Self {
        Self { camera: Some(patient.id.clone()), kind, number, unit, what, advice: kind.advice() }
    }
}

fn image_size(patient: &Patient, pixels: &[Vector2<f64>]) -> Option<Finding> {
    let [width, height] = patient.camera.image_size;
    if let Some([wide, high]) = patient.footage_size.filter(|size| *size != [width, height]) {
        let what = format!("is calibrated for {width} × {height} px, but its footage has {wide} × {high} px");
        return Some(Finding::of(
            patient,
            Kind::ImageSize,
            f64::from(wide) / f64::from(width),
            "footage / calibration",
            what,
        ));
    }
    let half = Vector2::new(f64::from(width), f64::from(height)) / 2.0;
    let beyond =
        |pixel: &&Vector2<f64>| ((*pixel + Vector2::repeat(0.5) - half).abs() - half).max() > BEYOND_PX;
    let outside = pixels.iter().filter(beyond).count();
    (outside > 0).then(|| {
        let what = format!("{outside} points lie outside its image of {width} × {height} px");
        Finding::of(patient, Kind::ImageSize, outside as f64, "points", what)
    })
}

fn focal(patient: &Patient, evidence: &Evidence) -> Option<Finding> {
    let focal = patient.camera.lens.focal_px.x;
    let share = focal / f64::from(patient.camera.image_size[0]);
    if !(FOCAL_RANGE[0]..=FOCAL_RANGE[1]).contains(&share) {
        let what = format!("its focal length is {share:.2} times the image's width");
        return Some(Finding::of(patient, Kind::Focal, share, "widths", what));
    }
    let mut siblings: Vec<f64> = evidence
        .patients
        .iter()
        .filter(|other| other.camera.image_size == patient.camera.image_size)
        .map(|other| other.camera.lens.focal_px.x)
        .collect();
    siblings.sort_by(f64::total_cmp);
    let ratio = focal / siblings[siblings.len() / 2];
    (siblings.len() >= 3 && !(1.0 / SIBLINGS..=SIBLINGS).contains(&ratio)).then(|| {
        let what =
            format!("its focal length is {ratio:.2} times that of the cameras with the same image size");
        Finding::of(patient, Kind::Focal, ratio, "ratio", what)
    })
}

fn aspect(patient: &Patient, params: &Params) -> Option<Finding> {
    let focal = patient.camera.lens.focal_px;
    let off = focal.y / focal.x - 1.0;
    (off.abs() > params.aspect).then(|| {
        let what = format!("its pixels are not square: the focal lengths differ by {:.1} %", 100.0 * off);
        Finding::of(patient, Kind::Aspect, off, "share", what)
    })
}

fn center(patient: &Patient) -> Option<Finding> {
    let size = Vector2::from(patient.camera.image_size.map(f64::from));
    let off = patient.camera.lens.center_px - (size - Vector2::repeat(1.0)) / 2.0;
    let share = off.norm() / size.norm();
    (share > CENTER).then(|| {
        let what =
            format!("its principal point is {:.0}, {:.0} px off the middle of the image", off.x, off.y);
        Finding::of(patient, Kind::Center, share, "diagonals", what)
    })
}

/// Where along the diagonals the lens is asked.
const PLACES: [[f64; 2]; 8] =
    [[0., 0.], [1., 0.], [0., 1.], [1., 1.], [0.5, 0.], [0.5, 1.], [0., 0.5], [1., 0.5]];

fn fold(patient: &Patient) -> Option<Finding> {
    let [width, height] = patient.camera.image_size.map(|side| f64::from(side) - 1.0);
    let folded =
        |[x, y]: &[f64; 2]| patient.camera.lens.unproject(Vector2::new(x * width, y * height)).is_none();
    let count = PLACES.iter().filter(|place| folded(place)).count();
    (count > 0).then(|| {
        let what = format!("its distortion folds within the image, at {count} of its {} ends", PLACES.len());
        Finding::of(patient, Kind::Fold, count as f64, "places", what)
    })
}

fn thin(patient: &Patient, share: f64, params: &Params) -> Option<Finding> {
    (share < params.coverage).then(|| {
        let what = format!("the points cover {:.0} % of its image", 100.0 * share);
        Finding::of(patient, Kind::Coverage, share, "share", what)
    })
}

/// The share of an image within the convex hull of pixels (monotone chain [Andrew1979]).
fn coverage(image_size: [u32; 2], pixels: &[Vector2<f64>]) -> f64 {
    let mut sorted = pixels.to_vec();
    sorted.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let mut twice = 0.0;
    for _ in 0..2 {
        let mut chain: Vec<Vector2<f64>> = Vec::new();
        for &pixel in &sorted {
            while let [.., a, b] = chain[..] {
                if (b - a).perp(&(pixel - b)) > 0.0 {
                    break;
                }
                chain.pop();
            }
            chain.push(pixel);
        }
        twice += chain.windows(2).map(|pair| pair[0].perp(&pair[1])).sum::<f64>();
        sorted.reverse();
    }
    0.5 * twice.abs() / image_size.map(f64::from).iter().product::<f64>()
}

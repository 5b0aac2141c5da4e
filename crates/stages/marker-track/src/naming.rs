//! Names for dots that were not labelled in a camera, from the cameras that follow them.
//!
//! The cameras stand still, so where a point lies in two of them says where it lies in a third. How is learnt from the markers
//! that all three have followed: a polynomial of degree two in the four coordinates, which takes in the perspective and the
//! lenses over the range of the face, and needs no calibration. A dot that nobody has, where that places a marker that is missing
//! there, is the marker's.

use artifact::{Sample2d, TrackState, Tracks2dFrame};
use nalgebra::{DMatrix, Point2};
use std::collections::BTreeMap;

/// Terms of the polynomial: 1, the four coordinates, their ten products.
const TERMS: usize = 15;
/// Fewer common points teach nothing.
const FEWEST: usize = 10 * TERMS;
/// Frames that are learnt from; neighbours in time say the same.
const FRAMES: usize = 80;
/// Coordinates are measured in this, px, so that all terms are of one size.
const UNIT_PX: f64 = 200.0;
/// Held against terms that the points do not determine.
const RIDGE: f64 = 1e-7;
/// Pairs of cameras that place known markers worse than this place no unknown ones, px.
pub(crate) const WORST_PX: f64 = 1.5;
/// A dot is a marker's within this distance, px,
const REACH_PX: f64 = 2.0;
/// … if no dot nor other marker is nearer than this many times that distance.
const ALONE: f64 = 2.0;
/// … in at least so many of the images from so many before to as many after: what lies before a hidden marker by chance soon
/// moves off.
pub(crate) const AGREEING: usize = 4;
pub(crate) const AROUND: usize = 3;
/// Points less sure than this teach nothing and place nothing.
const SURE: f64 = 0.5;
/// A name from other cameras is less sure than one from a label.
const CONFIDENCE: f64 = 0.6;

/// Per frame and camera the dots that no marker has, px.
pub type Strays = Vec<Vec<Vec<[f64; 2]>>>;

/// Names stray dots, in place, and returns how many. `strays[frame][camera]` holds the dots of `frames[frame]`.
pub fn name_strays(frames: &mut [Tracks2dFrame], strays: &Strays) -> usize {
    let cameras = frames.first().map_or(0, |frame| frame.cameras.len());
    let mut models = Models::new();
    for (frame, strays) in frames.iter().zip(strays) {
        for camera in (0..cameras).filter(|&camera| !strays[camera].is_empty()) {
            let wanted = missing(frame, camera).into_iter();
            for [first, second] in wanted.flat_map(|marker| pairs(frame, camera, marker, cameras)) {
                let triple = [first, second, camera];
                models.entry(triple).or_insert_with(|| Model::learn(frames, triple));
            }
        }
    }
    let mut found: BTreeMap<[usize; 2], Vec<(usize, [f64; 2])>> = BTreeMap::new();
    for (index, (frame, strays)) in frames.iter().zip(strays).enumerate() {
        for (camera, strays) in strays.iter().enumerate().filter(|(_, strays)| !strays.is_empty()) {
            for (marker, dot) in claims(frame, camera, cameras, strays, &models) {
                found.entry([camera, marker]).or_default().push((index, dot));
            }
        }
    }
    found.iter().map(|([camera, marker], dots)| keep_agreeing(frames, *camera, *marker, dots)).sum()
}

pub(crate) type Models = BTreeMap<[usize; 3], Option<Model>>;

/// Strays of an image that lie where a missing marker must be: the marker and the dot.
fn claims(
    frame: &Tracks2dFrame,
    camera: usize,
    cameras: usize,
    strays: &[[f64; 2]],
    models: &Models,
) -> Vec<(usize, [f64; 2])> {
    let places: Vec<(usize, [f64; 2])> = missing(frame, camera)
        .into_iter()
        .filter_map(|marker| Some((marker, place(frame, camera, marker, cameras, models)?)))
        .collect();
    let mut found = Vec::new();
    for &(marker, at) in &places {
        let mut near: Vec<(f64, [f64; 2])> = strays.iter().map(|dot| (apart(*dot, at), *dot)).collect();
        near.sort_by(|a, b| a.0.total_cmp(&b.0));
        let Some(&(off, dot)) = near.first().filter(|(off, _)| *off <= REACH_PX) else { continue };
        let next = near.get(1).map_or(f64::INFINITY, |(off, _)| *off);
        let rivals = places.iter().filter(|(other, _)| *other != marker).map(|(_, other)| apart(*other, dot));
        let rival = rivals.fold(f64::INFINITY, f64::min);
        if next.min(rival) > ALONE * off {
            found.push((marker, dot));
        }
    }
    found
}

/// Names a marker's dots where it has one in enough of the images around; returns how many.
fn keep_agreeing(
    frames: &mut [Tracks2dFrame],
    camera: usize,
    marker: usize,
    dots: &[(usize, [f64; 2])],
) -> usize {
    let has_image = |index: &usize| frames[*index].cameras[camera].is_some();
    let images: Vec<usize> = (0..frames.len()).filter(has_image).collect();
    let places: Vec<usize> =
        dots.iter().map(|(index, _)| images.partition_point(|image| image < index)).collect();
    let agreeing = |at: usize| places.iter().filter(|place| place.abs_diff(at) <= AROUND).count();
    let enough = AGREEING.min(images.len());
    let kept = dots.iter().zip(&places).filter(|(_, at)| agreeing(**at) >= enough);
    let kept: Vec<(usize, [f64; 2])> = kept.map(|(dot, _)| *dot).collect();
    for &(index, dot) in &kept {
        if let Some(samples) = frames[index].cameras[camera].as_mut() {
            let at = Point2::from(dot);
            samples[marker] = Some(Sample2d { at, state: TrackState::Seen, confidence: CONFIDENCE });
        }
    }
    kept.len()
}

/// Markers that are not seen in a camera.
fn missing(frame: &Tracks2dFrame, camera: usize) -> Vec<usize> {
    let Some(samples) = &frame.cameras[camera] else { return Vec::new() };
    let is_missing = |sample: &Option<Sample2d>| sample.is_none_or(|s| s.state == TrackState::Predicted);
    (0..samples.len()).filter(|&marker| is_missing(&samples[marker])).collect()
}

/// Pairs of other cameras that surely see a marker.
fn pairs(frame: &Tracks2dFrame, camera: usize, marker: usize, cameras: usize) -> Vec<[usize; 2]> {
    let seeing: Vec<usize> =
        (0..cameras).filter(|&other| other != camera && sure(frame, other, marker).is_some()).collect();
    let pair = |(index, &first): (usize, &usize)| {
        seeing[index + 1..].iter().map(move |&second| [first, second]).collect::<Vec<_>>()
    };
    seeing.iter().enumerate().flat_map(pair).collect()
}

fn sure(frame: &Tracks2dFrame, camera: usize, marker: usize) -> Option<[f64; 2]> {
    let sample = frame.cameras[camera].as_ref()?[marker]?;
    (sample.state != TrackState::Predicted && sample.confidence >= SURE).then(|| sample.at.into())
}

/// Where other cameras say that a marker is: the middle of what their pairs say.
fn place(
    frame: &Tracks2dFrame,
    camera: usize,
    marker: usize,
    cameras: usize,
    models: &Models,
) -> Option<[f64; 2]> {
    let places = places(frame, camera, marker, cameras, models);
    (!places.is_empty()).then(|| middle(&places))
}

/// What each pair of other cameras says.
pub(crate) fn places(
    frame: &Tracks2dFrame,
    camera: usize,
    marker: usize,
    cameras: usize,
    models: &Models,
) -> Vec<[f64; 2]> {
    let by_pair = |pair: [usize; 2]| {
        let model = models.get(&[pair[0], pair[1], camera])?.as_ref()?;
        Some(model.place([sure(frame, pair[0], marker)?, sure(frame, pair[1], marker)?]))
    };
    pairs(frame, camera, marker, cameras).into_iter().filter_map(by_pair).collect()
}

pub(crate) fn middle(places: &[[f64; 2]]) -> [f64; 2] {
    [0, 1].map(|axis| crate::paint::median(&mut places.iter().map(|at| at[axis]).collect::<Vec<_>>()))
}

/// From places in two cameras to the place in a third.
pub(crate) struct Model {
    /// `TERMS` × 2.
    weights: DMatrix<f64>,
}

impl Model {
    /// None where too few points are common, or do not fit.
    pub(crate) fn learn(frames: &[Tracks2dFrame], [first, second, third]: [usize; 3]) -> Option<Self> {
        let step = frames.len().div_ceil(FRAMES).max(1);
        let mut points = Vec::new();
        for frame in frames.iter().step_by(step) {
            let markers = frame.cameras[third].as_ref().map_or(0, Vec::len);
            points.extend((0..markers).filter_map(|marker| {
                let from = [sure(frame, first, marker)?, sure(frame, second, marker)?];
                Some((from, sure(frame, third, marker)?))
            }));
        }
        // A second round leaves out what does not fit, such as a marker that was taken for another.
        let mut model = Self::fit(&points)?;
        points.retain(|(from, to)| apart(model.place(*from), *to) <= 3.0 * WORST_PX);
        model = Self::fit(&points)?;
        let squares: f64 = points.iter().map(|(from, to)| apart(model.place(*from), *to).powi(2)).sum();
        ((squares / points.len() as f64).sqrt() <= WORST_PX).then_some(model)
    }

    fn fit(points: &[([[f64; 2]; 2], [f64; 2])]) -> Option<Self> {
        if points.len() < FEWEST {
            return None;
        }
        let mut normal = DMatrix::identity(TERMS, TERMS) * (RIDGE * points.len() as f64);
        let mut right = DMatrix::zeros(TERMS, 2);
        for (from, to) in points {
            let terms = terms(*from);
            for (row, a) in terms.iter().enumerate() {
                for (column, b) in terms.iter().enumerate() {
                    normal[(row, column)] += a * b;
                }
                (0..2).for_each(|axis| right[(row, axis)] += a * to[axis]);
            }
        }
        Some(Self { weights: normal.cholesky()?.solve(&right) })
    }

    fn place(&self, from: [[f64; 2]; 2]) -> [f64; 2] {
        let terms = terms(from);
        [0, 1].map(|axis| (0..TERMS).map(|term| terms[term] * self.weights[(term, axis)]).sum())
    }
}

fn terms(from: [[f64; 2]; 2]) -> [f64; TERMS] {
    // About the middle of images of usual size; the fit does not depend on it.
    let x = [from[0][0], from[0][1], from[1][0], from[1][1]].map(|x| x / UNIT_PX - 1.5);
    let mut terms = [1.0; TERMS];
    terms[1..5].copy_from_slice(&x);
    let products = (0..4).flat_map(|i| (i..4).map(move |j| x[i] * x[j]));
    terms[5..].iter_mut().zip(products).for_each(|(term, product)| *term = product);
    terms
}

pub(crate) fn apart(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

//! From two photographs to normals: warp, ratio, slopes.

use crate::error::Error;
use crate::flow::refined;
use crate::frame::Frame;
use crate::hair::bare;
use crate::light::estimated_light;
use crate::mask::{coherence, facing, feathered};
use crate::normals::{mixed, over, tilted};
use crate::outline::outline;
use crate::paper::paper_normals;
use crate::params::{Light, Mode, Params};
use crate::parts::Part;
use crate::plane::Plane;
use crate::ratio::ratio;
use crate::warp::{Field, Pair, Warp};
use crate::{blur, estimator};

/// A photograph: its linear luminance (white is 1), and where it can be trusted: 1, or 0 where it is clipped, unlit or transparent.
#[derive(Debug, Clone, PartialEq)]
pub struct Photo {
    /// Linear luminance.
    pub light: Plane,
    /// What can be used.
    pub usable: Plane,
}

/// What is known of the neutral face.
#[derive(Debug, Clone, Default)]
pub struct Face {
    /// The same places in both photographs: from the neutral one to the expression.
    pub pairs: Vec<Pair>,
    /// Distance of the pupils in the neutral photograph, px.
    pub io_px: f64,
    /// Parts that are no skin.
    pub parts: Vec<Part>,
    /// Where somebody painted the region of interest, 0–1, of the neutral photograph's size; all of it if absent.
    pub painted: Option<Plane>,
    /// Fine normals of the neutral skin, in the frame of its picture: x right, y up.
    pub neutral: Option<[Plane; 3]>,
    /// Rough normals of the neutral face towards the camera, for the light and the cheeks' edge.
    pub rough: Option<[Plane; 3]>,
}

/// How the region of interest is found, beside the method itself.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Region {
    /// Landmarks may be missed by a thin plate with this smoothing.
    pub smoothing: f64,
    /// Whether the warp is refined by what the pictures show.
    pub refine: bool,
    /// Whether parts that are no skin, edges and blotches are left out.
    pub masks: bool,
    /// Whether the light is found from the rough normals, where these are given and none is stated.
    pub find_light: bool,
}

impl Region {
    /// What goes with a method: all for ours, nothing for the paper's, whose masks are painted.
    #[must_use]
    pub fn of(mode: Mode) -> Self {
        let ours = mode == Mode::Estimator;
        Self { smoothing: 1e-3, refine: ours, masks: ours, find_light: ours }
    }
}

/// A normal map and all that led to it, in the frame of the neutral photograph.
#[derive(Debug, Clone)]
pub struct Acquired {
    /// Unit normals: x right, y up, z towards the camera; (0, 0, 1), or the neutral normal, where nothing was found.
    pub normals: [Plane; 3],
    /// Height over the neutral skin, px; with the paper's method there is none.
    pub height: Option<Plane>,
    /// The expression's light, brought to the neutral photograph.
    pub warped: Plane,
    /// The ratio of light, exposure taken out; 1 where nothing can be compared.
    pub ratio: Plane,
    /// How much each pixel counts, 0–1.
    pub weight: Plane,
    /// What of the ratio no wrinkle explains: its difference from a smooth one, over the noise.
    pub residual: Plane,
    /// Why pixels do not count: 1 clipped, 2 unlit, 3 beyond the other picture, 4 folded, 5 shining, 6 misregistered.
    pub doubt: Plane,
    /// The light that was reckoned with.
    pub light: Option<Light>,
    /// Findings.
    pub report: Report,
}

/// Counts and residuals of an acquisition.
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize)]
pub struct Report {
    /// Landmarks used.
    pub landmarks: usize,
    /// Median distance by which the others miss a landmark, px.
    pub left_out_median_px: f64,
    /// Pixels of the region in which the warp folds.
    pub folded_px: usize,
    /// Median correction of the warp, px.
    pub refined_median_px: f64,
    /// Noise of the ratio.
    pub noise: f64,
    /// Exposure of the expression over the neutral photograph.
    pub exposure: f64,
    /// Pixels that count.
    pub counted_px: usize,
}

/// Ratios above this many noise levels over 1 shine.
const SHINE: f64 = 6.0;
/// Differences beyond this many noise levels at fine structure are registration's fault.
const MISFIT: f64 = 6.0;

/// Normals of the expression's wrinkles.
///
/// # Errors
/// If parameters are out of range, planes differ in size, landmarks are too few, or nothing can be compared.
pub fn acquire(
    neutral: &Photo,
    expression: &Photo,
    face: &Face,
    region: &Region,
    params: &Params,
) -> Result<Acquired, Error> {
    params.check()?;
    check_sizes(neutral, face)?;
    if neutral.light == expression.light {
        return Err(Error::Identical);
    }
    let warp = Warp::fit(&face.pairs, face.io_px, region.smoothing)?;
    let frame = Frame::of(neutral, face, region);
    let work = Work::new(neutral, expression, face, region, &frame, &warp)?;
    let light = params.light.or_else(|| work.found_light(face, region, &frame));
    let params = Params { light, ..params.clone() };
    work.finish(face, region, &frame, &params)
}

/// Refuses planes that do not have the neutral photograph's size.
fn check_sizes(neutral: &Photo, face: &Face) -> Result<(), Error> {
    let wanted = [neutral.light.width, neutral.light.height];
    let named =
        [("mask", face.painted.as_ref()), ("neutral normal map", face.neutral.as_ref().map(|n| &n[0]))];
    for (name, plane) in named {
        if let Some(plane) = plane.filter(|plane| !plane.fits(&neutral.light)) {
            return Err(Error::Size { name: name.to_string(), found: [plane.width, plane.height], wanted });
        }
    }
    Ok(())
}

/// What has been worked out so far, over the frame.
struct Work {
    neutral: Plane,
    warped: Plane,
    /// What can be compared, 0 or 1.
    usable: Plane,
    /// The region of interest, soft.
    weight: Plane,
    doubt: Plane,
    report: Report,
}

impl Work {
    fn new(
        neutral: &Photo,
        expression: &Photo,
        face: &Face,
        region: &Region,
        frame: &Frame,
        warp: &Warp,
    ) -> Result<Self, Error> {
        let light = frame.crop(&neutral.light);
        let here = frame.crop(&neutral.usable);
        let mut field = Field::of(warp, frame.first, frame.size[0], frame.size[1]);
        let mut report = Report { landmarks: face.pairs.len(), ..Report::default() };
        report.left_out_median_px = crate::plane::median(warp.left_out().iter());
        let folds = field.folds();
        let outline = outline(face, frame, region);
        let inner = outline.with(&folds, |inside, fold| inside * (1.0 - fold));
        report.folded_px = count(&outline.with(&folds, |inside, fold| inside * fold));
        if region.refine {
            let weight = blur::blurred(&inner.with(&here, |a, b| a * b), 0.02 * face.io_px);
            let log = |plane: &Plane| plane.map(|light| light.max(1e-4).ln());
            let better = refined(&field, &log(&light), &log(&expression.light), &weight, face.io_px);
            report.refined_median_px = better.median_px;
            field = better.field;
        }
        let warped = field.fetch(&expression.light);
        let covered = field.covered(expression.light.width, expression.light.height);
        let there = field.fetch(&expression.usable).map(|usable| f64::from(u8::from(usable > 0.999)));
        let usable = here.with(&there, |a, b| a * b).with(&covered, |a, b| a * b);
        let usable = usable.with(&folds, |usable, fold| usable * (1.0 - fold));
        let weight = usable.with(&outline, |usable, inside| usable * inside);
        let weight = match region.masks {
            true => weight.with(&bare(&light, &weight, face.io_px), |weight, bare| weight * bare),
            false => weight,
        };
        if count(&weight) < 64 {
            return Err(Error::NothingToCompare {
                why: "too few are lit and unclipped in both photographs",
                fix: "check the landmarks and the mask, and that neither photograph is black or overexposed",
            });
        }
        let doubt = doubts([&here, &there, &covered, &folds]);
        Ok(Self { neutral: light, warped, usable, weight, doubt, report })
    }

    /// The light by the neutral photograph's own shading.
    fn found_light(&self, face: &Face, region: &Region, frame: &Frame) -> Option<Light> {
        let rough = face.rough.as_ref().filter(|_| region.find_light)?;
        let rough = [0, 1, 2].map(|axis| frame.crop(&rough[axis]));
        estimated_light(&self.neutral, &rough, &self.weight)
    }

    fn finish(
        mut self,
        face: &Face,
        region: &Region,
        frame: &Frame,
        params: &Params,
    ) -> Result<Acquired, Error> {
        let io = face.io_px;
        let safe = |plane: &Plane| plane.map(|light| light.max(1e-6));
        let [ratio, exposure] = ratio(&safe(&self.neutral), &safe(&self.warped), &self.weight, io, params);
        self.report.exposure = crate::plane::median(crate::ratio::counted(&exposure, &self.weight)).exp();
        let ratio = match region.masks {
            true => ratio.with(&self.usable, |ratio, usable| if usable > 0.0 { ratio } else { 1.0 }),
            false => ratio,
        };
        let painted = face.painted.as_ref().map(|painted| frame.crop(painted));
        let weight = self.soft_weight(face, frame, region, &ratio, painted.as_ref(), params);
        let (normals, height) = match params.mode {
            Mode::Paper => self.by_paper(face, frame, &ratio, &weight, params),
            Mode::Estimator => self.by_estimator(face, frame, &ratio, &weight, params),
        };
        self.report.counted_px = count(&weight);
        let residual = self.judge(&ratio, &weight, io, params);
        let put = |plane: &Plane, value: f64| frame.restore(plane, value);
        let [nx, ny, nz] = &normals;
        let flat = [0.0, 0.0, 1.0];
        let mut whole = [nx, ny, nz].map(|plane| plane.clone());
        for axis in 0..3 {
            whole[axis] = match &face.neutral {
                Some(neutral) if frame.size != frame.whole => {
                    over(&neutral[axis], &normals[axis], frame.first)
                }
                _ => put(&normals[axis], flat[axis]),
            };
        }
        Ok(Acquired {
            normals: whole,
            height: height.map(|height| put(&height, 0.0)),
            warped: put(&self.warped, 0.0),
            ratio: put(&ratio, 1.0),
            weight: put(&weight, 0.0),
            residual: put(&residual, 0.0),
            doubt: put(&self.doubt, 0.0),
            light: params.light,
            report: self.report,
        })
    }

    /// The region with soft borders.
    fn soft_weight(
        &self,
        face: &Face,
        frame: &Frame,
        region: &Region,
        ratio: &Plane,
        painted: Option<&Plane>,
        params: &Params,
    ) -> Plane {
        let io = face.io_px;
        let painted =
            painted.map(|painted| if region.masks { feathered(painted, io) } else { painted.clone() });
        let mut weight = match region.masks {
            true => feathered(&self.weight, io),
            false => self.usable.map(|_| 1.0),
        };
        if region.masks {
            let smooth = blur::blurred(ratio, 2.0 * params.blur_io * io);
            weight = weight.with(&coherence(&smooth, io), |weight, stripes| weight * stripes);
        }
        if let Some(rough) = face.rough.as_ref().filter(|_| region.masks) {
            weight = weight.with(&facing(&frame.crop(&rough[2])), |weight, facing| weight * facing);
        }
        painted.map_or(weight.clone(), |painted| weight.with(&painted, |weight, painted| weight * painted))
    }

    fn by_paper(
        &self,
        face: &Face,
        frame: &Frame,
        ratio: &Plane,
        weight: &Plane,
        params: &Params,
    ) -> ([Plane; 3], Option<Plane>) {
        let neutral_z = match &face.neutral {
            Some(neutral) => frame.crop(&neutral[2]),
            None => ratio.map(|_| 1.0),
        };
        let normals = paper_normals(ratio, &neutral_z, params.blur_io * face.io_px);
        let neutral = face.neutral.as_ref().map(|neutral| [0, 1, 2].map(|axis| frame.crop(&neutral[axis])));
        (mixed(&normals, neutral.as_ref(), weight), None)
    }

    fn by_estimator(
        &mut self,
        face: &Face,
        frame: &Frame,
        ratio: &Plane,
        weight: &Plane,
        params: &Params,
    ) -> ([Plane; 3], Option<Plane>) {
        let found = estimator::estimated(ratio, weight, face.io_px, params);
        self.report.noise = found.noise;
        // Where nothing counts nothing stays of the surface's slow changes either.
        let height = found.height;
        let slopes = height.gradient().map(|plane| {
            plane.with(
                weight,
                |slope, weight| if weight > 0.0 { slope * (weight / 0.1).min(1.0) } else { 0.0 },
            )
        });
        let neutral = face.neutral.as_ref().map(|neutral| [0, 1, 2].map(|axis| frame.crop(&neutral[axis])));
        (
            tilted(&slopes, neutral.as_ref()),
            Some(height.with(weight, |height, weight| if weight > 0.0 { height } else { 0.0 })),
        )
    }

    /// Marks what shines or does not fit, and says how much of the ratio is left over.
    fn judge(&mut self, ratio: &Plane, weight: &Plane, io: f64, params: &Params) -> Plane {
        let smooth = blur::blurred(ratio, (params.blur_io + 0.012) * io);
        let noise = self.report.noise.max(1e-4);
        let residual = ratio.with(&smooth, |ratio, smooth| (ratio - smooth).abs() / noise);
        let shining = blur::blurred(ratio, params.blur_io * io).map(|ratio| (ratio - 1.0) / noise);
        for (at, doubt) in self.doubt.values.iter_mut().enumerate() {
            if *doubt == 0.0 && weight.values[at] > 0.0 {
                *doubt = match () {
                    () if shining.values[at] > SHINE => 5.0,
                    () if residual.values[at] > MISFIT => 6.0,
                    () => 0.0,
                };
            }
        }
        residual
    }
}

fn count(plane: &Plane) -> usize {
    plane.values.iter().filter(|value| **value > 0.0).count()
}

fn doubts([here, there, covered, folds]: [&Plane; 4]) -> Plane {
    let mut doubt = here.map(|usable| if usable > 0.0 { 0.0 } else { 1.0 });
    for (at, doubt) in doubt.values.iter_mut().enumerate() {
        *doubt = match () {
            () if *doubt > 0.0 => *doubt,
            () if covered.values[at] == 0.0 => 3.0,
            () if folds.values[at] > 0.0 => 4.0,
            () if there.values[at] == 0.0 => 2.0,
            () => 0.0,
        };
    }
    doubt
}

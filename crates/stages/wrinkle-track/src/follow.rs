//! Wrinkles from image to image: which patch of paint is which wrinkle, and what became of those without one.

use crate::assign::{Share, Stroke, assigned, common_shift};
use crate::bits::Patch;
use crate::classify::Classified;
use crate::light::Picture;
use crate::params::TrackParams;
use crate::region::Region;
use crate::spline::{self, Place};
use crate::start::{MarkedWrinkle, NamedPlace, lies_on};
use crate::valley::{Valley, valley};
use artifact::{Curve2d, CurveState};

/// The wrinkles of one camera.
#[derive(Debug, Clone)]
pub struct Follower {
    params: TrackParams,
    wrinkles: Vec<Wrinkle>,
    strays: usize,
    clipped: f64,
}

#[derive(Debug, Clone)]
struct Wrinkle {
    paint: u8,
    /// Where it was last; none of one that has not appeared.
    stroke: Option<Stroke>,
    controls: Option<Vec<Place>>,
    /// Its usual area, px².
    area: f64,
    /// Images since it was found.
    missed: usize,
}

/// The usual area follows the present one by this share from image to image.
const AREA_PACE: f64 = 0.1;
/// A wrinkle of less than this share of its usual area is not found: what is left is a rest.
const LEAST_SHARE: f64 = 0.05;
/// Of a curve through a part of a patch: where the part ends is a guess.
const CUT_CONFIDENCE: f64 = 0.5;
/// Each image without the wrinkle halves the confidence.
const HELD_CONFIDENCE: f64 = 0.5;

impl Follower {
    /// A follower that knows the wrinkles of `ids` by how they are marked; those that are not marked may be named later.
    #[must_use]
    pub fn new(ids: &[String], marked: &[MarkedWrinkle], params: TrackParams) -> Self {
        let wrinkle = |id: &String| {
            let found = marked.iter().find(|wrinkle| wrinkle.id == *id);
            let region = found.map(|found| &found.region);
            let plain = |region: &Region| valley(region, &vec![0.0; region.area()], None, &params);
            let controls = region.and_then(plain).map(|valley| valley.controls);
            Wrinkle {
                paint: found.map_or(0, |found| found.paint),
                stroke: region.map(|region| Stroke::new(region, controls.as_deref())),
                controls,
                area: region.map_or(0.0, |region| region.area() as f64),
                missed: 0,
            }
        };
        let wrinkles = ids.iter().map(wrinkle).collect();
        Self { params, wrinkles, strays: 0, clipped: 0.0 }
    }

    /// Patches of paint in the last image that belong to no wrinkle.
    #[must_use]
    pub fn strays(&self) -> usize {
        self.strays
    }

    /// Share of the last image's painted pixels that are black or saturated.
    #[must_use]
    pub fn clipped(&self) -> f64 {
        self.clipped
    }

    /// The curves of an image, one per wrinkle; none where it is not to be seen. `named` are wrinkles that appear in this image:
    /// their number among the ids, and a place on them.
    pub fn step(
        &mut self,
        picture: &Picture,
        classified: &Classified,
        named: &[(usize, NamedPlace)],
    ) -> Vec<Option<Curve2d>> {
        let patches = self.patches(classified);
        self.introduce(&patches, named);
        let strokes: Vec<(u8, Option<&Stroke>)> =
            self.wrinkles.iter().map(|wrinkle| (wrinkle.paint, wrinkle.stroke.as_ref())).collect();
        let shift = common_shift(&strokes, &patches);
        let (shares, strays) = assigned(&strokes, &patches, shift, &self.params);
        self.strays = strays;
        self.note_clipped(picture, &shares);
        let params = self.params;
        let pairs = self.wrinkles.iter_mut().zip(shares);
        pairs.map(|(wrinkle, share)| wrinkle.update(picture, share, shift, &params)).collect()
    }

    /// Tidied patches, with their paint.
    fn patches(&self, classified: &Classified) -> Vec<(u8, Patch)> {
        let most = self.wrinkles.iter().map(|wrinkle| wrinkle.paint).max().unwrap_or(0);
        let most = most.max(classified.paints.iter().copied().max().unwrap_or(0));
        let of_paint = |paint: u8| {
            let bits = tidied(&classified.of_paint(paint), self.params.tidy_px);
            bits.patches(self.params.least_area_px).into_iter().map(move |patch| (paint, patch))
        };
        (1..=most).flat_map(of_paint).collect()
    }

    fn introduce(&mut self, patches: &[(u8, Patch)], named: &[(usize, NamedPlace)]) {
        for (index, name) in named {
            let Some((paint, patch)) = patches.iter().find(|(_, patch)| lies_on(patch, name.at)) else {
                continue;
            };
            let region = Region::new(patch.pixels().collect());
            let wrinkle = &mut self.wrinkles[*index];
            if wrinkle.stroke.is_none() {
                wrinkle.paint = *paint;
                wrinkle.area = region.area() as f64;
                wrinkle.stroke = Some(Stroke::new(&region, None));
            }
        }
    }

    fn note_clipped(&mut self, picture: &Picture, shares: &[Option<Share>]) {
        let pixels = shares.iter().flatten().flat_map(|share| &share.region.pixels);
        let (mut all, mut clipped) = (0usize, 0usize);
        for [x, y] in pixels {
            all += 1;
            clipped += usize::from(picture.is_clipped(y * picture.width + x));
        }
        self.clipped = clipped as f64 / all.max(1) as f64;
    }
}

/// Classified pixels without specks and pinholes.
#[must_use]
pub fn tidied(bits: &crate::bits::Bits, steps: usize) -> crate::bits::Bits {
    bits.opened(steps).closed(steps)
}

impl Wrinkle {
    fn update(
        &mut self,
        picture: &Picture,
        share: Option<Share>,
        shift: Place,
        params: &TrackParams,
    ) -> Option<Curve2d> {
        let least = (LEAST_SHARE * self.area).max(params.least_area_px as f64);
        let share = share.filter(|share| share.region.area() as f64 >= least);
        let found = share.and_then(|share| {
            let light = light(picture, &share.region);
            let valley = valley(&share.region, &light, self.controls.as_deref(), params)?;
            Some((share, valley))
        });
        match found {
            Some((share, valley)) => Some(self.found(&share, valley)),
            None => self.lost(picture, shift, params),
        }
    }

    fn found(&mut self, share: &Share, valley: Valley) -> Curve2d {
        let area = share.region.area() as f64;
        let cut = if share.is_cut { CUT_CONFIDENCE } else { 1.0 };
        let confidence = cut * (area / self.area).min(1.0) * valley.on_paint;
        self.missed = 0;
        let stroke = Stroke::new(&share.region, Some(&valley.controls));
        self.stroke = Some(if share.is_cut {
            stroke.with_width_of(self.stroke.as_ref())
        } else {
            self.area += AREA_PACE * (area - self.area);
            stroke
        });
        let curve = Curve2d {
            controls: valley.controls.iter().map(|control| [control.x, control.y]).collect(),
            state: CurveState::Seen,
            confidence,
            paint: valley.paint,
        };
        self.controls = Some(valley.controls);
        curve
    }

    /// The wrinkle goes with the others, and is kept for a while.
    fn lost(&mut self, picture: &Picture, shift: Place, params: &TrackParams) -> Option<Curve2d> {
        self.missed += 1;
        self.stroke.as_mut()?.shift(shift);
        let controls = self.controls.as_mut()?;
        controls.iter_mut().for_each(|control| *control += shift);
        let is_in_image = spline::sampled(controls, 9).iter().any(|at| {
            (0.0..picture.width as f64).contains(&at.x) && (0.0..picture.height as f64).contains(&at.y)
        });
        (self.missed <= params.hold && is_in_image).then(|| Curve2d {
            controls: controls.iter().map(|control| [control.x, control.y]).collect(),
            state: CurveState::Held,
            confidence: HELD_CONFIDENCE.powi(self.missed as i32),
            paint: Vec::new(),
        })
    }
}

/// The light of a region's pixels; black and saturated ones have that of the median, and draw the curve nowhere.
fn light(picture: &Picture, region: &Region) -> Vec<f64> {
    let number = |[x, y]: &[usize; 2]| y * picture.width + x;
    let gray = |pixel: &[usize; 2]| picture.luminance(number(pixel));
    let mut sound: Vec<f64> =
        region.pixels.iter().filter(|pixel| !picture.is_clipped(number(pixel))).map(gray).collect();
    sound.sort_by(f64::total_cmp);
    let median = sound.get(sound.len() / 2).copied().unwrap_or(0.0);
    let of = |pixel: &[usize; 2]| if picture.is_clipped(number(pixel)) { median } else { gray(pixel) };
    region.pixels.iter().map(of).collect()
}

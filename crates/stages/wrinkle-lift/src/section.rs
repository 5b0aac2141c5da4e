//! From a section in an image to a place on the face.

use crate::ground::{Seen, Spot};
use crate::level::levelled;
use crate::params::Params;
use crate::scene::{Hit, Scene, Spaces};
use crate::view::View;
use artifact::{ProfileShape, Section, SectionState};
use nalgebra::{Matrix2x3, Matrix3, Point3, Vector2, Vector3};

/// A section on the face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lifted {
    /// The place of the surface without the wrinkle, over the valley's bottom.
    pub spot: Spot,
    /// Where it is, mm.
    pub foot: Point3<f64>,
    /// Width, mm.
    pub w_mm: f64,
    /// Depth, mm; 0 where there is no valley.
    pub d_mm: f64,
    /// Rounding ε.
    pub epsilon: f64,
    /// Asymmetry κ, positive where the side on the right along the section's curve, seen from outside, is the wider one.
    pub kappa: f64,
    /// Angle between the view and the surface's normal, rad.
    pub view_rad: f64,
    /// Length on the surface, along the curve, of a pixel, mm.
    pub pixel_mm: f64,
    /// Standard deviation of the place, mm.
    pub place_mm: f64,
    /// Standard deviation of width and depth, as share.
    pub shape_rel: f64,
}

/// Why a section could not be brought onto the face.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Lost {
    /// It could not be measured in the image.
    Unmeasured,
    /// Its ray meets nothing.
    Missed,
    /// Its ray meets the back of the skin first, through an opening.
    Hidden,
    /// It is seen too obliquely.
    Grazing,
    /// The depth of the valley takes it from place to place.
    Unsteady,
}

/// What a good crease is off by in the image, px; and by how much of its width's deviation a poor one is off, beside that.
const PLACE_PX: f64 = 0.25;
const PLACE_REL: f64 = 0.25;
/// A width or depth without a deviation is off by so much, as share.
const SHAPE_REL: f64 = 0.15;
/// No width or depth is known better than this, as share: profiles are models.
const SHAPE_FLOOR: f64 = 0.05;
/// Where the skin of a profile was set anew, so much of the change may be wrong.
const LEVEL_REL: f64 = 0.3;
/// The place above the bottom has settled when it moves less than this in the image, px.
const SETTLED_PX: f64 = 1e-3;
/// Steps to get there; two or three are usual.
const MOST_STEPS: usize = 20;

/// One image: what it shows, from where.
pub(crate) struct Shot<'a> {
    pub(crate) scene: &'a Scene<'a>,
    pub(crate) spaces: &'a Spaces,
    pub(crate) view: View<'a>,
    pub(crate) params: &'a Params,
}

/// The surface around a hit, as the camera sees it.
struct Patch {
    normal: Vector3<f64>,
    /// ∂ pixel / ∂ point of face space, px/mm.
    pixels: Matrix2x3<f64>,
    /// (∂c/∂x)⁻¹: head space from face space, for small steps.
    back: Matrix3<f64>,
    view_rad: f64,
}

impl Shot<'_> {
    /// Brings a section onto the face. `tangent`: unit direction of the curve in the image there, along growing u.
    ///
    /// The crease is the bottom of the valley, d below the groove-free surface along its normal; the ray through it meets that surface
    /// d·tan τ away. So the place F over the bottom is looked for whose bottom F − d n is seen in the crease's pixel: the ray is cast
    /// through crease + (pixel of F − pixel of F − d n) until it stays. A length w·n in the image becomes the vector of the tangent plane
    /// that is seen as such; its part across the valley is the width, and d = w · (d/w).
    ///
    /// # Errors
    /// Why there is no such place.
    pub(crate) fn lift(
        &self,
        section: &Section,
        tangent: Vector2<f64>,
        seen: &mut Seen,
    ) -> Result<Lifted, Lost> {
        if section.state == SectionState::Failed {
            return Err(Lost::Unmeasured);
        }
        let crease = Vector2::from(section.at);
        let mut pixel = crease;
        for _ in 0..MOST_STEPS {
            let hit = self.cast(pixel)?;
            let patch = self.patch(&hit, seen)?;
            let lifted = self.measured(section, tangent, &hit, &patch)?;
            let shifted = match self.params.parallax {
                true => crease + self.shift(&hit, &patch, lifted.d_mm).ok_or(Lost::Unsteady)?,
                false => crease,
            };
            let moved = (shifted - pixel).norm();
            pixel = shifted;
            if moved < SETTLED_PX {
                return Ok(lifted);
            }
        }
        Err(Lost::Unsteady)
    }

    fn cast(&self, pixel: Vector2<f64>) -> Result<Hit, Lost> {
        let ray = self.view.ray(pixel).ok_or(Lost::Missed)?;
        let hit = self.scene.cast(&self.view.eye(), &ray).ok_or(Lost::Missed)?;
        if hit.from_outside { Ok(hit) } else { Err(Lost::Hidden) }
    }

    fn patch(&self, hit: &Hit, seen: &mut Seen) -> Result<Patch, Lost> {
        let Scene { ground, in_face, .. } = self.scene;
        let normal = ground.normal(&hit.spot, in_face, self.params.normal_mm, seen);
        let back = self.spaces.slope(&hit.point).ok_or(Lost::Missed)?;
        let pixels = self.view.slope(&hit.point).ok_or(Lost::Missed)? * back;
        // The ray in face space: what the pixels do not see.
        let ray = pixels.row(0).cross(&pixels.row(1)).transpose();
        let cos = ray.dot(&normal).abs() / ray.norm();
        let view_rad = cos.clamp(0.0, 1.0).acos();
        match view_rad <= self.params.max_view_deg.to_radians() {
            true => Ok(Patch { normal, pixels, back, view_rad }),
            false => Err(Lost::Grazing),
        }
    }

    /// How far the bottom is seen off its place on the surface, px.
    fn shift(&self, hit: &Hit, patch: &Patch, d_mm: f64) -> Option<Vector2<f64>> {
        let bottom = hit.point - patch.back * (patch.normal * d_mm);
        Some(self.view.project(&hit.point)? - self.view.project(&bottom)?)
    }

    fn measured(
        &self,
        section: &Section,
        tangent: Vector2<f64>,
        hit: &Hit,
        patch: &Patch,
    ) -> Result<Lifted, Lost> {
        let rows = [patch.pixels.row(0), patch.pixels.row(1)].map(|row| row.into_owned());
        let seen = Matrix3::from_rows(&[rows[0], rows[1], patch.normal.transpose()]);
        let surface = seen.try_inverse().ok_or(Lost::Grazing)?;
        let on_surface = |image: Vector2<f64>| surface * Vector3::new(image.x, image.y, 0.0);
        let step = on_surface(tangent);
        let across = step.cross(&patch.normal).try_normalize(0.0).ok_or(Lost::Grazing)?;
        let shape = believed(section, self.params.bulge);
        let reach = on_surface(Vector2::from(section.normal) * shape.w).dot(&across);
        let w_mm = reach.abs();
        let ratio = if shape.w > 0.0 { shape.d / shape.w } else { 0.0 };
        let d_mm = ratio * w_mm;
        let (place_mm, shape_rel) =
            deviations(section, &shape, d_mm, patch.view_rad, (patch.pixels * across).norm());
        Ok(Lifted {
            spot: hit.spot,
            foot: self.scene.ground.at(&hit.spot, &self.scene.in_face),
            w_mm,
            d_mm,
            epsilon: shape.epsilon,
            // A section whose normal points to the other side counts its sides the other way round.
            kappa: if reach < 0.0 { 0.0 - shape.kappa } else { shape.kappa },
            view_rad: patch.view_rad,
            pixel_mm: step.norm(),
            place_mm,
            shape_rel,
        })
    }
}

/// The profile of a section, px: its skin lies where its bulges are believable. Numbers without a deviation, which a person set or which
/// are known otherwise, are taken at their word; measured ones keep theirs when they are scaled.
fn believed(section: &Section, bulge: f64) -> ProfileShape {
    match section.deviation.is_some() {
        true => levelled(section.shape(), bulge),
        false => section.shape(),
    }
}

/// Standard deviations of the place (mm) and of width and depth (share): a wrong depth moves the place by d·tan τ, and a skin that was set
/// anew is known less well.
fn deviations(
    section: &Section,
    shape: &ProfileShape,
    d_mm: f64,
    view_rad: f64,
    px_per_mm: f64,
) -> (f64, f64) {
    let share = |part: f64, whole: f64| if whole > 0.0 { part / whole } else { 0.0 };
    let of_depth = section.deviation.map_or(SHAPE_REL, |spread| share(spread.d_px, section.d_px));
    let of_width = section.deviation.map_or(SHAPE_REL, |spread| share(spread.w_px, section.w_px));
    let set_anew = LEVEL_REL * (share(shape.d, section.d_px).max(1.0)).ln();
    let depth_rel = if section.d_px > 0.0 { of_depth.hypot(set_anew) } else { 0.0 };
    let crease_px = PLACE_PX.hypot(PLACE_REL * of_width * section.w_px);
    let place = (crease_px / px_per_mm.max(1e-6)).hypot(depth_rel * d_mm * view_rad.tan());
    // Seen obliquely a valley hides part of itself, and the model of its light matters more.
    let shape = of_width.hypot(of_depth).hypot(set_anew).clamp(SHAPE_FLOOR, 1.0) / view_rad.cos();
    (place, shape)
}

/// Unit directions of a curve in the image at its sections, along growing u: from the sections beside each.
pub(crate) fn tangents(sections: &[Section]) -> Vec<Vector2<f64>> {
    let at = |i: usize| Vector2::from(sections[i].at);
    let last = sections.len().saturating_sub(1);
    let tangent = |i: usize| {
        let step = at((i + 1).min(last)) - at(i.saturating_sub(1));
        // The right side of a curve is its tangent (x, y) turned to (−y, x).
        let [x, y] = sections[i].normal;
        step.try_normalize(0.0).unwrap_or(Vector2::new(y, -x))
    };
    (0..sections.len()).map(tangent).collect()
}

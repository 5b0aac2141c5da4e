//! All wrinkles of an image.

use crate::Picture;
use crate::albedo::estimate_albedo;
use crate::ground::Surface;
use crate::measure::{Measured, Painted, failed, measure, painted};
use crate::params::Params;
use artifact::{Curve2d, Section};
use rayon::prelude::*;

/// What an image shows of its wrinkles.
#[derive(Debug, Clone)]
pub struct ImageSections {
    /// Per curve, in their order.
    pub wrinkles: Vec<ImageWrinkle>,
    /// The share of the light that the paints' brightest channel throws back.
    pub albedo: f64,
}

/// One of them.
#[derive(Debug, Clone)]
pub struct ImageWrinkle {
    /// Its sections, all failed where it has no paint.
    pub sections: Vec<Section>,
    /// Its paint and what was measured there.
    pub paint: Option<(Painted, Measured)>,
}

impl ImageSections {
    /// Measures the wrinkles along these curves. `light`: linear light by code; `surface`: the skin without wrinkles, where it is known.
    ///
    /// The same for any number of threads; other images do not matter.
    #[must_use]
    pub fn of(
        picture: &Picture<'_>,
        light: &[f64; 256],
        curves: &[&Curve2d],
        surface: Option<&Surface<'_>>,
        params: &Params,
    ) -> Self {
        let paint = |curve: &&Curve2d| {
            let painted = painted(picture, light, curve, params)?;
            Some(match surface {
                Some(surface) => painted.over(surface),
                None => painted,
            })
        };
        let paints: Vec<Option<Painted>> = curves.par_iter().map(paint).collect();
        let estimate = || estimate_albedo(paints.iter().flatten().map(|painted| &painted.band));
        let albedo = params.albedo.unwrap_or_else(estimate);
        let wrinkle = |(curve, paint): (&&Curve2d, Option<Painted>)| match paint {
            Some(paint) => {
                let measured = measure(&paint, params, albedo);
                ImageWrinkle { sections: measured.sections.clone(), paint: Some((paint, measured)) }
            }
            None => ImageWrinkle { sections: failed(curve, params), paint: None },
        };
        Self { wrinkles: curves.par_iter().zip(paints).map(wrinkle).collect(), albedo }
    }

    /// Painted pixels that were left out because they are saturated, and because they are black.
    #[must_use]
    pub fn clipped(&self) -> [usize; 2] {
        let bands = || self.wrinkles.iter().flat_map(|wrinkle| &wrinkle.paint).map(|(paint, _)| &paint.band);
        [bands().map(|band| band.saturated).sum(), bands().map(|band| band.black).sum()]
    }
}

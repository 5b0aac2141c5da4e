//! `valleys/1`: valley curves of wrinkles on the mesh, in 3D, over frames [BickelBotsch2007, Sec. 5.3].

use crate::finite::{unit_vector, within};
use crate::ids::check_ids;
use crate::sections::check_profile;
use crate::wrinkles_2d::check_rising;
use crate::{Kind, MeshRef, ProfileShape, Rate, Stream, TakeRef, Violation, Wrinkle, finite};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The kind of valley curves in 3D.
pub struct Valleys;

/// What holds for all frames.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ValleysHeader {
    /// The rest mesh.
    pub mesh: MeshRef,
    /// The wrinkles.
    pub wrinkles: Vec<Wrinkle>,
    /// Frames per second; absent where the source did not say.
    pub rate: Option<Rate>,
    /// The take.
    pub take: Option<TakeRef>,
    /// The space of points and directions.
    pub space: Space,
}

/// A space of 3D coordinates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Space {
    /// That of the scan: the head stands still.
    Face,
}

/// All valleys in one frame, in memory and in the file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ValleysFrame {
    /// Absolute frame number.
    pub frame: i64,
    /// Per wrinkle id its points, in the order of the curve. No entry: the wrinkle is not there.
    pub valleys: BTreeMap<String, Vec<ValleyPoint>>,
}

/// A point of a valley's bottom, with the profile across it. The families of profiles are those of `sections`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ValleyPoint {
    /// Place along the valley, mm of the rest mesh's surface; rising.
    pub x_mm: f64,
    /// Triangle of the rest mesh, as `Mesh::triangles` counts them (each polygon a fan from its first corner), 0-based …
    pub face: u32,
    /// … and where in it, by the shares of its three corners.
    pub barycentric: [f64; 3],
    /// The valley's bottom, mm.
    pub at_mm: [f64; 3],
    /// Unit normal of the surface without the wrinkle.
    pub normal: [f64; 3],
    /// Unit vector across the valley, from its left to its right side, seen from outside and going along growing x.
    pub across: [f64; 3],
    /// Width w, mm: from the crease to where the profile crosses the surrounding skin.
    pub w_mm: f64,
    /// Depth d, mm: how far the bottom lies below the surface without the wrinkle, along its normal; 0 where there is no valley.
    pub d_mm: f64,
    /// Rounding ε, 0 ≤ ε < 1.
    pub epsilon: f64,
    /// Asymmetry κ, −1 < κ < 1: positive where the right side is the wider one.
    pub kappa: f64,
}

impl ValleyPoint {
    /// Its profile, in mm over the distance along [`ValleyPoint::across`].
    #[must_use]
    pub fn shape(&self) -> ProfileShape {
        ProfileShape { w: self.w_mm, d: self.d_mm, epsilon: self.epsilon, kappa: self.kappa }
    }
}

impl Kind for Valleys {
    const NAME: &'static str = "valleys";
    const VERSION: u32 = 1;
}

impl Stream for Valleys {
    type Header = ValleysHeader;
    type Frame = ValleysFrame;
    type Line = ValleysFrame;

    fn check(header: &ValleysHeader) -> Result<(), Violation> {
        header.rate.map_or(Ok(()), |rate| rate.check("rate"))?;
        check_ids("wrinkles", "wrinkle", header.wrinkles.iter().map(|wrinkle| &wrinkle.id))
    }

    fn encode(header: &ValleysHeader, frame: &ValleysFrame) -> Result<ValleysFrame, Violation> {
        check_frame(header, frame)?;
        Ok(frame.clone())
    }

    fn decode(header: &ValleysHeader, line: ValleysFrame) -> Result<ValleysFrame, Violation> {
        check_frame(header, &line)?;
        Ok(line)
    }

    fn number(frame: &ValleysFrame) -> i64 {
        frame.frame
    }
}

fn check_frame(header: &ValleysHeader, frame: &ValleysFrame) -> Result<(), Violation> {
    for (id, points) in &frame.valleys {
        let place = format!("frame {}, wrinkle {id}", frame.frame);
        if !header.wrinkles.iter().any(|wrinkle| &wrinkle.id == id) {
            return Err(Violation::new(place, "is not among the header's wrinkles"));
        }
        for (i, point) in points.iter().enumerate() {
            check_point(&format!("{place}, point {i}"), point)?;
        }
        check_rising(&place, "x_mm", points.iter().map(|point| point.x_mm))?;
    }
    Ok(())
}

/// How far barycentric coordinates may be from a point of the triangle.
const BARYCENTRIC_TOLERANCE: f64 = 1e-6;

fn check_point(place: &str, point: &ValleyPoint) -> Result<(), Violation> {
    finite(place, point.at_mm.iter().chain(&point.barycentric).chain([&point.x_mm]))?;
    let shares = point.barycentric;
    if shares.iter().any(|share| *share < -BARYCENTRIC_TOLERANCE) {
        return Err(Violation::new(place, format!("the shares {shares:?} lie outside the triangle")));
    }
    let sum = shares.iter().sum::<f64>();
    within(place, "the sum of the shares", sum, 1.0 - BARYCENTRIC_TOLERANCE..=1.0 + BARYCENTRIC_TOLERANCE)?;
    unit_vector(place, "the normal", &point.normal)?;
    unit_vector(place, "the direction across", &point.across)?;
    check_profile(place, "mm", [point.w_mm, point.d_mm, point.epsilon, point.kappa])
}

//! What is brought home, and what is true of it.

use artifact::Landmarks;
use serde::Serialize;

/// A pair of photographs of a face, and what is true of it.
#[derive(Debug, Clone)]
pub struct FacePair {
    /// Side of all pictures, px.
    pub side: usize,
    /// The face at rest, 8-bit sRGB.
    pub neutral: Vec<u8>,
    /// With its expression.
    pub expression: Vec<u8>,
    /// Landmarks of the face at rest.
    pub neutral_landmarks: Landmarks,
    /// With its expression.
    pub expression_landmarks: Landmarks,
    /// True normals of the wrinkles over the face without them, in the frame of the picture at rest: x right, *y up*, z outwards;
    /// zero where a pixel shows anything but skin.
    pub normals: Vec<[f64; 3]>,
    /// What was drawn.
    pub truth: FaceTruth,
}

/// What was drawn for a pair.
#[derive(Debug, Clone, Serialize)]
pub struct FaceTruth {
    /// Exposure of the expression over that at rest, slow changes over the picture apart.
    pub exposure: f64,
    /// The head's motion between the pictures: turn about x, y, z (rad), shift (mm).
    pub motion: [f64; 6],
    /// Deepest fold, mm.
    pub deepest_mm: f64,
}

/// A picture on the way to the expression.
#[derive(Debug, Clone)]
pub struct FilmFrame {
    /// 8-bit sRGB.
    pub picture: Vec<u8>,
    /// Its landmarks.
    pub landmarks: Landmarks,
    /// How far the muscles have come, 0 to 1.
    pub way: f64,
    /// How much of the expression's wrinkles truly shows: slopes projected onto theirs.
    pub shown: f64,
}

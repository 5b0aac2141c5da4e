//! `sections/1`: cross-sections of wrinkles, measured in the images [BickelBotsch2007, Sec. 5.2].

use crate::finite::{unit_vector, within};
use crate::ids::PerCamera;
use crate::wrinkles_2d::{check_rising, known};
use crate::{Kind, Profile, ProfileShape, Rate, Stream, TakeRef, Violation, Wrinkle, finite};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The kind of cross-sections.
pub struct Sections;

/// What holds for all frames.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SectionsHeader {
    /// Camera ids.
    pub cameras: Vec<String>,
    /// The wrinkles.
    pub wrinkles: Vec<Wrinkle>,
    /// The family of profiles.
    pub profile: Profile,
    /// Frames per second of the mocap clock; absent where the source did not say.
    pub rate: Option<Rate>,
    /// The take.
    pub take: Option<TakeRef>,
}

/// All cross-sections in one frame, in memory and in the file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SectionsFrame {
    /// Absolute frame number.
    pub frame: i64,
    /// Per camera id, per wrinkle id its sections at rising u. No entry of a camera: it has no image of the frame; no entry of a
    /// wrinkle: it is not to be seen.
    pub sections: PerCamera<Vec<Section>>,
}

/// A cross-section: the profile across a wrinkle at one place of its curve. Lengths are those in the image.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Section {
    /// Parameter of the wrinkle's curve (`wrinkles-2d`).
    pub u: f64,
    /// The crease, px; pixel (0, 0) is the centre of the top-left pixel.
    pub at: [f64; 2],
    /// Unit vector across the wrinkle in the image, from its left to its right side (those of `wrinkles-2d`): along growing p.
    pub normal: [f64; 2],
    /// Width w, px: from the crease to where the profile crosses the surrounding skin.
    pub w_px: f64,
    /// Depth d, px: 0 exactly where there is no valley.
    pub d_px: f64,
    /// Rounding ε, 0 ≤ ε < 1.
    pub epsilon: f64,
    /// Asymmetry κ, −1 < κ < 1: positive where the right side is the wider one.
    pub kappa: f64,
    /// Tilt of the view across the wrinkle, rad: positive where the camera stands on the right side. Absent where the geometry
    /// was not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tilt_rad: Option<f64>,
    /// Standard deviations.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub deviation: Option<SectionDeviation>,
    /// Root mean square misfit of the intensities, as share of the unshadowed paint's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub residual: Option<f64>,
    /// What the numbers are.
    pub state: SectionState,
}

/// Standard deviations of a section.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SectionDeviation {
    /// Of the width, px.
    pub w_px: f64,
    /// Of the depth, px.
    pub d_px: f64,
}

/// What the numbers of a section are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SectionState {
    /// Measured: d is positive.
    Measured,
    /// No valley here: d is 0, and w says nothing.
    Flat,
    /// Could not be measured; the numbers are those of the neighbours, or say nothing.
    Failed,
    /// Set by a person.
    Edited,
}

impl Section {
    /// Its profile, in px over the distance along [`Section::normal`].
    #[must_use]
    pub fn shape(&self) -> ProfileShape {
        ProfileShape { w: self.w_px, d: self.d_px, epsilon: self.epsilon, kappa: self.kappa }
    }
}

impl Kind for Sections {
    const NAME: &'static str = "sections";
    const VERSION: u32 = 1;
}

impl Stream for Sections {
    type Header = SectionsHeader;
    type Frame = SectionsFrame;
    type Line = SectionsFrame;

    fn check(header: &SectionsHeader) -> Result<(), Violation> {
        header.rate.map_or(Ok(()), |rate| rate.check("rate"))?;
        known(&header.cameras, &header.wrinkles).check()
    }

    fn encode(header: &SectionsHeader, frame: &SectionsFrame) -> Result<SectionsFrame, Violation> {
        check_frame(header, frame)?;
        Ok(frame.clone())
    }

    fn decode(header: &SectionsHeader, line: SectionsFrame) -> Result<SectionsFrame, Violation> {
        check_frame(header, &line)?;
        Ok(line)
    }

    fn number(frame: &SectionsFrame) -> i64 {
        frame.frame
    }
}

fn check_frame(header: &SectionsHeader, frame: &SectionsFrame) -> Result<(), Violation> {
    let known = known(&header.cameras, &header.wrinkles);
    known.check_values(frame.frame, &frame.sections, |place, sections| {
        for section in sections {
            check_section(&format!("{place}, u {}", section.u), header.profile, section)?;
        }
        check_rising(place, "u", sections.iter().map(|section| section.u))
    })
}

fn check_section(place: &str, profile: Profile, section: &Section) -> Result<(), Violation> {
    finite(place, [section.u, section.at[0], section.at[1]].iter().chain(&section.tilt_rad))?;
    within(place, "u", section.u, 0.0..)?;
    unit_vector(place, "the normal", &section.normal)?;
    check_profile(place, "px", [section.w_px, section.d_px, section.epsilon, section.kappa])?;
    if profile == Profile::S && (section.epsilon != 0.0 || section.kappa != 0.0) {
        let what = "has a rounding or an asymmetry, which the profile s has not";
        return Err(Violation::new(place, what));
    }
    for spread in section.deviation.iter().flat_map(|spread| [spread.w_px, spread.d_px]) {
        within(place, "the deviation", spread, 0.0..f64::INFINITY)?;
    }
    if let Some(residual) = section.residual {
        within(place, "the residual", residual, 0.0..f64::INFINITY)?;
    }
    let depth = section.d_px;
    match section.state {
        SectionState::Flat if depth != 0.0 => {
            Err(Violation::new(place, format!("is flat with a depth of {depth} px")))
        }
        SectionState::Measured if depth == 0.0 || section.w_px == 0.0 => {
            Err(Violation::new(place, "is measured, but has no width or no depth; say flat or failed"))
        }
        _ => Ok(()),
    }
}

/// Refuses widths, depths, roundings and asymmetries that no profile has.
pub(crate) fn check_profile(
    place: &str,
    unit: &str,
    [w, d, epsilon, kappa]: [f64; 4],
) -> Result<(), Violation> {
    within(place, &format!("w_{unit}"), w, 0.0..f64::INFINITY)?;
    within(place, &format!("d_{unit}"), d, 0.0..f64::INFINITY)?;
    within(place, "epsilon", epsilon, 0.0..1.0)?;
    match kappa.abs() < 1.0 {
        true => Ok(()),
        false => Err(Violation::new(place, format!("kappa {kappa} is not between -1 and 1"))),
    }
}

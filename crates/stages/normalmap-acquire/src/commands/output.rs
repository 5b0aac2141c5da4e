//! Maps as pictures.

use artifact::picture::{write_gray16, write_rgb8, write_rgb16};
use artifact::{GreenAxis, Staged, stage_bytes};
use clap::builder::{PossibleValuesParser, TypedValueParser as _};
use normalmap_acquire::{Acquired, Plane, height_shares, normal_codes};
use serde_json::json;
use std::path::{Path, PathBuf};

/// What is written and how
#[derive(clap::Args)]
#[command(next_help_heading = "Output")]
pub(crate) struct Output {
    /// Bits of each channel of the normal map: 8 or 16
    #[arg(long, value_name = "BITS", default_value_t = 8, value_parser = bits)]
    bits: u8,
    /// Which way green points: opengl (up) or directx (down)
    #[arg(long, value_name = "NAME", default_value = "opengl", value_parser = PossibleValuesParser::new(GreenAxis::NAMES).try_map(|name| name.parse::<GreenAxis>()))]
    green: GreenAxis,
    /// Also write heights, a grey PNG of 16 bits; a file beside it says what its values are
    #[arg(long, value_name = "FILE")]
    displacement: Option<PathBuf>,
    /// Size of a pixel of the neutral photograph on the skin, so that heights are in mm
    #[arg(long, value_name = "MM")]
    pixel_mm: Option<f64>,
    /// Also write the normals as numbers, NumPy: x right, y up, z of each pixel (of the texel with --texture-landmarks)
    #[arg(long, value_name = "FILE")]
    npy: Option<PathBuf>,
    /// Folder for every step between: warped, ratio, mask, residual, confidence
    #[arg(long, value_name = "DIR")]
    pub(crate) debug: Option<PathBuf>,
}

fn bits(text: &str) -> Result<u8, String> {
    match text {
        "8" => Ok(8),
        "16" => Ok(16),
        _ => Err("say 8 or 16".to_string()),
    }
}

impl Output {
    /// Paths beside the normal map itself.
    pub(crate) fn paths(&self) -> Vec<PathBuf> {
        let debug = self.debug.iter().map(|folder| folder.join("ratio.png"));
        self.displacement.iter().chain(&self.npy).cloned().chain(debug).collect()
    }

    /// A normal map.
    pub(crate) fn normals(&self, path: &Path, normals: &[Plane; 3]) -> artifact::Result<Staged> {
        let (width, height) = (normals[0].width, normals[0].height);
        match self.bits {
            8 => {
                let codes = normal_codes(normals, self.green, 255.0);
                write_rgb8(path, width, height, &codes.iter().map(|code| *code as u8).collect::<Vec<_>>())
            }
            _ => {
                let codes = normal_codes(normals, self.green, 65535.0);
                write_rgb16(path, width, height, &codes.iter().map(|code| *code as u16).collect::<Vec<_>>())
            }
        }
    }

    /// Normals as numbers.
    pub(crate) fn numbers(&self, [x, y, z]: &[Plane; 3]) -> artifact::Result<Option<Staged>> {
        let rows = || {
            x.values
                .iter()
                .zip(&y.values)
                .zip(&z.values)
                .flat_map(|((x, y), z)| [*x, *y, *z])
                .collect::<Vec<f64>>()
        };
        let write = |path: &PathBuf| artifact::npy::write(path, [x.values.len(), 3], &rows());
        self.npy.as_ref().map(write).transpose()
    }

    /// Heights, and what they mean.
    pub(crate) fn displacement(&self, height: Option<&Plane>) -> anyhow::Result<Vec<Staged>> {
        let Some(path) = &self.displacement else { return Ok(vec![]) };
        let Some(height) = height else {
            anyhow::bail!(
                "--displacement: the paper's method has no heights\n  to do: leave --mode paper or --displacement out"
            );
        };
        if let Some(mm) = self.pixel_mm.filter(|mm| !(1e-4..=100.0).contains(mm)) {
            anyhow::bail!("--pixel-mm {mm}: must lie between 0.0001 and 100 mm");
        }
        let (shares, span_px) = height_shares(height);
        let codes: Vec<u16> = shares.iter().map(|share| (share * 65535.0).round() as u16).collect();
        // 0 must be a code of its own.
        let scale = json!({
            "zero": 0.5,
            "span_px": span_px,
            "span_mm": self.pixel_mm.map(|mm| mm * span_px),
            "meaning": "height = (value / 65535 - zero) * span; px are those of the neutral photograph",
        });
        Ok(vec![
            write_gray16(path, height.width, height.height, &codes)?,
            stage_bytes(&path.with_extension("scale.json"), &serde_json::to_vec_pretty(&scale)?)?,
        ])
    }

    /// Every step between.
    pub(crate) fn steps(&self, found: &Acquired) -> anyhow::Result<Vec<Staged>> {
        let Some(folder) = &self.debug else { return Ok(vec![]) };
        let gray = |name: &str, plane: &Plane, value: fn(f64) -> f64| {
            let codes: Vec<u16> =
                plane.values.iter().map(|x| (value(*x).clamp(0.0, 1.0) * 65535.0).round() as u16).collect();
            write_gray16(&folder.join(name), plane.width, plane.height, &codes)
        };
        let encoded = |light: f64| {
            if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 }
        };
        let doubts: Vec<u8> =
            found.doubt.values.iter().flat_map(|doubt| DOUBTS[(*doubt as usize).min(6)]).collect();
        Ok(vec![
            gray("warped.png", &found.warped, encoded)?,
            gray("ratio.png", &found.ratio, |ratio| 0.5 * ratio)?,
            gray("mask.png", &found.weight, |weight| weight)?,
            gray("residual.png", &found.residual, |residual| residual / 10.0)?,
            write_rgb8(&folder.join("confidence.png"), found.doubt.width, found.doubt.height, &doubts)?,
        ])
    }
}

/// Colours of reasons: none, clipped or unlit at rest, in the expression, beyond its edge, folded, shining, misregistered.
const DOUBTS: [[u8; 3]; 7] =
    [[255, 255, 255], [200, 0, 0], [90, 0, 0], [60, 60, 60], [160, 0, 200], [255, 200, 0], [0, 120, 255]];

//! Photographs as light: what a camera's file says of its codes and of how it was held is honoured.

use crate::icc::{Curve, Profile, parse};
use crate::source::read_bytes;
use crate::{Error, Result, Transfer};
use image::{DynamicImage, ImageDecoder, ImageReader};
use std::io::Cursor;
use std::path::Path;
use table::per_pixel;

/// A photograph as linear light; row 0 is the top, turned as its file says.
#[derive(Debug, Clone, PartialEq)]
pub struct Photograph {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Bits per channel.
    pub bits: u8,
    /// Linear luminance, white is 1.
    pub luminance: Vec<f64>,
    /// Where a channel is at its end, so that its light is not known.
    pub clipped: Vec<bool>,
    /// Where codes' light comes from, for people.
    pub codes: String,
    /// Whether the file was turned or mirrored to stand upright.
    pub turned: bool,
}

/// Luminance of the channels of sRGB and Rec. 709.
const LUMA: [f64; 3] = [0.212_6, 0.715_2, 0.072_2];
/// Codes from this share of white on are at their end.
const END: f64 = 0.99;

/// Reads a PNG or JPEG as light. Codes mean what the file's ICC profile says, else its gamma (PNG), else `stated`, else sRGB; orientation
/// is that of its EXIF data. `stated` wins over the file where it is given.
///
/// # Errors
/// If the file cannot be read, holds CMYK, a profile that is not understood, or transparent pixels.
pub fn read_photograph(path: &Path, stated: Option<Transfer>) -> Result<Photograph> {
    let bytes = read_bytes(path)?;
    refuse_print(path, &bytes)?;
    let broken = |error: &dyn std::fmt::Display| {
        Error::new(path, format!("is no PNG or JPEG picture that can be read: {error}"))
            .fix("check that this is the right file and that it was not cut; save it again as PNG or JPEG")
    };
    let reader =
        ImageReader::new(Cursor::new(&bytes)).with_guessed_format().map_err(|error| broken(&error))?;
    let mut decoder = reader.into_decoder().map_err(|error| broken(&error))?;
    let orientation = decoder.orientation().map_err(|error| broken(&error))?;
    let icc = decoder.icc_profile().map_err(|error| broken(&error))?;
    let mut picture = DynamicImage::from_decoder(decoder).map_err(|error| broken(&error))?;
    picture.apply_orientation(orientation);
    refuse_transparent(path, &picture)?;
    let (profile, codes) = meaning(path, &bytes, icc.as_deref(), stated)?;
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    let bits = 8 * picture.color().bytes_per_pixel() / picture.color().channel_count();
    let (luminance, clipped) = match bits {
        8 => per_pixel(picture.into_rgb8().as_raw(), u8::MAX.into(), &profile),
        _ => per_pixel(picture.into_rgb16().as_raw(), u16::MAX.into(), &profile),
    };
    let turned = orientation != image::metadata::Orientation::NoTransforms;
    Ok(Photograph { width, height, bits, luminance, clipped, codes, turned })
}

impl Photograph {
    /// A frame of a video: 8-bit RGB, row after row, whose codes mean what is stated, else sRGB.
    ///
    /// # Panics
    /// If the bytes do not fill the picture: that is a bug of the caller.
    #[must_use]
    pub fn of_rgb8(width: usize, height: usize, rgb: &[u8], stated: Option<Transfer>) -> Self {
        assert_eq!(rgb.len(), 3 * width * height, "three bytes a pixel");
        let (luminance, clipped) = per_pixel(rgb, u8::MAX.into(), &plain(stated.unwrap_or(Transfer::Srgb)));
        let codes = match stated {
            Some(transfer) => format!("{transfer}, as stated"),
            None => "sRGB, assumed of a video".to_string(),
        };
        Self { width, height, bits: 8, luminance, clipped, codes, turned: false }
    }
}

mod table {
    use super::{END, Profile};

    /// Luminance and ends of all pixels, by a table of each channel's codes.
    pub(super) fn per_pixel<T: Copy + Into<u32>>(
        codes: &[T],
        white: u32,
        profile: &Profile,
    ) -> (Vec<f64>, Vec<bool>) {
        let table = |channel: usize| -> Vec<f64> {
            let light = |code: u32| profile.curves[channel].light(f64::from(code) / f64::from(white));
            (0..=white).map(|code| profile.luma[channel] * light(code)).collect()
        };
        let tables = [table(0), table(1), table(2)];
        let end = (END * f64::from(white)) as u32;
        let pixel = |pixel: &[T]| {
            let codes: [u32; 3] = [pixel[0].into(), pixel[1].into(), pixel[2].into()];
            let light =
                tables[0][codes[0] as usize] + tables[1][codes[1] as usize] + tables[2][codes[2] as usize];
            (light, codes.iter().any(|code| *code >= end))
        };
        codes.chunks_exact(3).map(pixel).unzip()
    }
}

/// Channels of sRGB's colours that mean what a transfer function says.
fn plain(transfer: Transfer) -> Profile {
    let curve = Curve::Table((0..=65535).map(|code| transfer.light(f64::from(code) / 65535.0)).collect());
    Profile { curves: [curve.clone(), curve.clone(), curve], luma: LUMA }
}

/// What codes mean, and how that is known.
fn meaning(
    path: &Path,
    bytes: &[u8],
    icc: Option<&[u8]>,
    stated: Option<Transfer>,
) -> Result<(Profile, String)> {
    if let Some(transfer) = stated {
        return Ok((plain(transfer), format!("{transfer}, as stated")));
    }
    if let Some(icc) = icc {
        let profile = parse(icc).map_err(|what| {
            Error::new(path, format!("its colour profile (ICC) {what}"))
                .fix("convert the picture to sRGB, or say --transfer")
        })?;
        return Ok((profile, "its ICC profile".to_string()));
    }
    match png_gamma(bytes) {
        Some(gamma) => Ok((plain(Transfer::Gamma(gamma)), format!("its gamma of {gamma:.3}"))),
        None => Ok((plain(Transfer::Srgb), "sRGB, assumed: the file does not say".to_string())),
    }
}

/// The gamma of a PNG that says so and does not say that it is sRGB.
fn png_gamma(bytes: &[u8]) -> Option<f64> {
    let mut at = 8;
    let mut gamma = None;
    while bytes.starts_with(b"\x89PNG") {
        let size = u32::from_be_bytes(bytes.get(at..at + 4)?.try_into().ok()?) as usize;
        match bytes.get(at + 4..at + 8)? {
            b"sRGB" | b"IDAT" | b"IEND" if gamma.is_none() => return None,
            b"IDAT" | b"IEND" => break,
            b"sRGB" => return None,
            b"gAMA" => gamma = Some(u32::from_be_bytes(bytes.get(at + 8..at + 12)?.try_into().ok()?)),
            _ => {}
        }
        at += 12 + size;
    }
    // 45455 is what sRGB writes for programs that know gammas only.
    gamma
        .filter(|gamma| (10_000..=1_000_000).contains(gamma) && !(45_000..=45_900).contains(gamma))
        .map(|gamma| 1e5 / f64::from(gamma))
}

/// JPEGs of four channels are for print.
fn refuse_print(path: &Path, bytes: &[u8]) -> Result<()> {
    let mut at = 2;
    while bytes.starts_with(&[0xff, 0xd8]) && bytes.get(at) == Some(&0xff) {
        let Some(marker) = bytes.get(at + 1) else { break };
        if matches!(marker, 0xc0..=0xc3 | 0xc5..=0xc7 | 0xc9..=0xcb | 0xcd..=0xcf) {
            return match bytes.get(at + 9) {
                Some(4) => Err(Error::new(path, "is a picture for print (CMYK)")
                    .fix("convert it to sRGB; a photograph as the camera wrote it is better still")),
                _ => Ok(()),
            };
        }
        let Some(&[high, low]) = bytes.get(at + 2..at + 4).and_then(|pair| pair.first_chunk()) else { break };
        at += if *marker == 0xff { 1 } else { 2 + usize::from(high) * 256 + usize::from(low) };
    }
    Ok(())
}

fn refuse_transparent(path: &Path, picture: &DynamicImage) -> Result<()> {
    if !picture.color().has_alpha() {
        return Ok(());
    }
    let alpha = picture.to_rgba16();
    match alpha.enumerate_pixels().find(|(_, _, pixel)| pixel.0[3] < u16::MAX) {
        Some((column, row, _)) => Err(Error::new(path, "is transparent, so that its light is not known")
            .at(format!("column {column}, row {row}"))
            .fix("give the photograph as it was taken; regions are chosen by a mask of their own")),
        None => Ok(()),
    }
}

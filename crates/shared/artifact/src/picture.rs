//! Pictures: PNG in and out, JPEG in.
//!
//! Code values are taken as they stand: colour profiles (ICC), gamma chunks and EXIF orientation are passed over, and which
//! transfer function holds is for the caller to say (the take manifest does).

pub use crate::image8::{Image8, NoPicture, Picture};
pub use crate::subsampling::is_subsampled;

use crate::source::read_bytes;
use crate::{Error, Result, Sink, Staged};
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{DynamicImage, ExtendedColorType, ImageEncoder, ImageFormat};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::Path;

/// A grey picture; row 0 is the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Gray {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Code values as a share of white, 0–1, row after row.
    pub pixels: Vec<f64>,
}

/// A colour picture; row 0 is the top.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Rgb {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Code values, row after row.
    pub codes: Codes,
}

/// Code values of red, green and blue, pixel after pixel.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Codes {
    /// 8 bits each.
    Bits8(Vec<u8>),
    /// 16 bits each.
    Bits16(Vec<u16>),
}

impl Rgb {
    /// All code values in 8 bits, rounded to the nearest.
    #[must_use]
    pub fn to_8_bits(&self) -> Vec<u8> {
        match &self.codes {
            Codes::Bits8(codes) => codes.clone(),
            Codes::Bits16(codes) => codes.iter().map(|code| ((u32::from(*code) + 128) / 257) as u8).collect(),
        }
    }

    /// The same as an image of its own.
    #[must_use]
    pub fn into_8_bits(self) -> Image8 {
        let rgb = match self.codes {
            Codes::Bits8(codes) => codes,
            Codes::Bits16(_) => self.to_8_bits(),
        };
        Image8 { width: self.width, height: self.height, rgb }
    }

    /// The red, green and blue of a pixel as shares of white, 0–1.
    ///
    /// # Panics
    /// If the pixel lies outside the picture.
    #[must_use]
    pub fn at(&self, column: usize, row: usize) -> [f64; 3] {
        let first = 3 * (row * self.width + column);
        std::array::from_fn(|channel| match &self.codes {
            Codes::Bits8(codes) => f64::from(codes[first + channel]) / f64::from(u8::MAX),
            Codes::Bits16(codes) => f64::from(codes[first + channel]) / f64::from(u16::MAX),
        })
    }
}

/// Reads a PNG of 8 or 16 bits as grey values; colours become their luma, transparency is ignored.
///
/// # Errors
/// If the file cannot be read or is no whole PNG.
pub fn read_gray(path: &Path) -> Result<Gray> {
    let bytes = read_bytes(path)?;
    let picture = decode(path, &bytes, ImageFormat::Png)?.into_luma16();
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    let pixels = picture.into_raw().into_iter().map(|value| f64::from(value) / f64::from(u16::MAX)).collect();
    Ok(Gray { width, height, pixels })
}

/// Reads a PNG of 8 or 16 bits, or a JPEG, as colours; which of the two it is, its first bytes say. Grey becomes a colour of
/// three equal values, transparency is ignored; fewer than 8 bits become 8.
///
/// # Errors
/// If the file cannot be read or is no whole PNG or JPEG.
pub fn read_rgb(path: &Path) -> Result<Rgb> {
    let bytes = read_bytes(path)?;
    let format = match bytes.starts_with(&[0xff, 0xd8]) {
        true => ImageFormat::Jpeg,
        false => ImageFormat::Png,
    };
    let picture = decode(path, &bytes, format)?;
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    let codes = match picture.color().bytes_per_pixel() / picture.color().channel_count() {
        1 => Codes::Bits8(picture.into_rgb8().into_raw()),
        _ => Codes::Bits16(picture.into_rgb16().into_raw()),
    };
    Ok(Rgb { width, height, codes })
}

/// A picture in which somebody marked things in colours.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Marked {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Red, green and blue of what is marked, row after row; none where the picture is transparent or black.
    pub marks: Vec<Option<[u8; 3]>>,
}

/// Reads a PNG in which somebody marked things in colours on a transparent or black ground.
///
/// # Errors
/// If the file cannot be read or is no whole PNG.
pub fn read_marked(path: &Path) -> Result<Marked> {
    let bytes = read_bytes(path)?;
    let picture = decode(path, &bytes, ImageFormat::Png)?.into_rgba8();
    let mark = |pixel: &image::Rgba<u8>| {
        let [red, green, blue, alpha] = pixel.0;
        (alpha >= 128 && [red, green, blue] != [0; 3]).then_some([red, green, blue])
    };
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    Ok(Marked { width, height, marks: picture.pixels().map(mark).collect() })
}

/// What a picture's file says of itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Head {
    /// Width, height, px.
    pub size: [u32; 2],
    /// Bits per channel.
    pub bits: u8,
}

/// The size and depth of a PNG or JPEG by its first bytes, if its last ones are there; pixels are decoded only where these
/// do not tell.
///
/// # Errors
/// If the file cannot be read, is no PNG or JPEG, or is cut.
pub fn read_head(path: &Path) -> Result<Head> {
    if let Some(head) = png_head(path).map_err(|cause| Error::io(path, "read", &cause))? {
        return Ok(head);
    }
    let bytes = read_bytes(path)?;
    let is_jpeg = bytes.starts_with(&[0xff, 0xd8]);
    let tail = &bytes[bytes.len().saturating_sub(1024)..];
    if is_jpeg && !tail.windows(2).any(|pair| pair == [0xff, 0xd9]) {
        return Err(Error::new(path, "is cut: the end of the JPEG picture is missing").fix("copy it again"));
    }
    if let Some(size) = jpeg_size(&bytes).filter(|_| is_jpeg) {
        return Ok(Head { size, bits: 8 });
    }
    let Rgb { width, height, codes } = read_rgb(path)?;
    let bits = if matches!(codes, Codes::Bits8(_)) { 8 } else { 16 };
    Ok(Head { size: [width as u32, height as u32], bits })
}

/// Of a PNG that ends as it should, what its header says; none where this is not clear.
#[allow(clippy::disallowed_methods, reason = "this is a room where files are read")]
fn png_head(path: &Path) -> std::io::Result<Option<Head>> {
    const BEGIN: &[u8] = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR";
    const END: &[u8] = b"\0\0\0\0IEND\xae\x42\x60\x82";
    let mut file = std::fs::File::open(path)?;
    if file.metadata()?.len() < 64 {
        return Ok(None);
    }
    let (mut first, mut last) = ([0; 25], [0; 12]);
    file.read_exact(&mut first)?;
    file.seek(SeekFrom::End(-12))?;
    file.read_exact(&mut last)?;
    let side = |at: usize| first[at..at + 4].iter().fold(0, |side, byte| side << 8 | u32::from(*byte));
    let head = Head { size: [side(16), side(20)], bits: first[24].max(8) };
    Ok((first.starts_with(BEGIN) && last == END).then_some(head))
}

/// Width and height by the first frame header of a JPEG.
fn jpeg_size(bytes: &[u8]) -> Option<[u32; 2]> {
    let word = |at: usize| Some(u32::from(*bytes.get(at)?) << 8 | u32::from(*bytes.get(at + 1)?));
    let mut at = 2;
    while bytes.get(at) == Some(&0xff) {
        match bytes.get(at + 1)? {
            0xff => at += 1,
            // Tables of codes and of arithmetic coding have numbers among those of the frame headers.
            0xc0..=0xc3 | 0xc5..=0xc7 | 0xc9..=0xcb | 0xcd..=0xcf => {
                return Some([word(at + 7)?, word(at + 5)?]);
            }
            _ => at += 2 + word(at + 2)? as usize,
        }
    }
    None
}

fn decode(path: &Path, bytes: &[u8], format: ImageFormat) -> Result<DynamicImage> {
    image::load_from_memory_with_format(bytes, format).map_err(|error| {
        let name = if format == ImageFormat::Jpeg { "JPEG" } else { "PNG" };
        Error::new(path, format!("is not a {name} picture: {error}")).fix(format!(
            "check that this is the right file and that it was not cut; save it as {name} again"
        ))
    })
}

/// Writes a PNG of 8 bits; `rgb` holds red, green, blue of each pixel, row after row from the top. Compression is that for
/// speed.
///
/// # Errors
/// If the size is none or does not fit the values, or the file cannot be written.
pub fn write_rgb8(path: &Path, width: usize, height: usize, rgb: &[u8]) -> Result<Staged> {
    check_size(path, width, height, rgb.len(), 3)?;
    write_png(path, width, height, ExtendedColorType::Rgb8, rgb)
}

/// The same as bytes, for whoever sends pictures instead of keeping them; `name` is for messages.
///
/// # Errors
/// If the size is none or does not fit the values.
pub fn png_rgb8(name: &Path, width: usize, height: usize, rgb: &[u8]) -> Result<Vec<u8>> {
    check_size(name, width, height, rgb.len(), 3)?;
    let mut bytes = Vec::new();
    encode_png(&mut bytes, name, width, height, ExtendedColorType::Rgb8, rgb)?;
    Ok(bytes)
}

/// Writes a PNG of 16 bits; otherwise like [`write_rgb8`].
///
/// # Errors
/// As [`write_rgb8`].
pub fn write_rgb16(path: &Path, width: usize, height: usize, rgb: &[u16]) -> Result<Staged> {
    check_size(path, width, height, rgb.len(), 3)?;
    // The encoder takes the machine's byte order.
    let bytes: Vec<u8> = rgb.iter().flat_map(|code| code.to_ne_bytes()).collect();
    write_png(path, width, height, ExtendedColorType::Rgb16, &bytes)
}

/// Writes a PNG of 16 bits of grey; otherwise like [`write_rgb8`].
///
/// # Errors
/// As [`write_rgb8`].
pub fn write_gray16(path: &Path, width: usize, height: usize, gray: &[u16]) -> Result<Staged> {
    check_size(path, width, height, gray.len(), 1)?;
    let bytes: Vec<u8> = gray.iter().flat_map(|code| code.to_ne_bytes()).collect();
    write_png(path, width, height, ExtendedColorType::L16, &bytes)
}

fn check_size(path: &Path, width: usize, height: usize, values: usize, channels: usize) -> Result<()> {
    let pixels = width.checked_mul(height).filter(|&pixels| pixels > 0);
    let fits = pixels.is_some_and(|pixels| channels * pixels == values);
    match fits && u32::try_from(width.max(height)).is_ok() {
        true => Ok(()),
        false => {
            Err(Error::new(path, format!("{values} values make no picture of {width} × {height} pixels")))
        }
    }
}

fn write_png(
    path: &Path,
    width: usize,
    height: usize,
    color: ExtendedColorType,
    bytes: &[u8],
) -> Result<Staged> {
    let mut sink = Sink::create(path)?;
    encode_png(&mut sink, path, width, height, color, bytes)?;
    sink.finish()
}

fn encode_png(
    to: &mut impl Write,
    path: &Path,
    width: usize,
    height: usize,
    color: ExtendedColorType,
    bytes: &[u8],
) -> Result<()> {
    PngEncoder::new_with_quality(to, CompressionType::Fast, FilterType::Adaptive)
        .write_image(bytes, width as u32, height as u32, color)
        .map_err(|error| match error {
            image::ImageError::IoError(cause) => Error::io(path, "write", &cause),
            other => Error::new(path, format!("cannot be written as PNG: {other}")),
        })
}

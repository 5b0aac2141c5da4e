//! Two images, pixel by pixel.

use crate::summary::{Moments, rank95};
use crate::{Error, Part, Report, Summary};
use image::{ColorType, DynamicImage};

/// Absolute differences of all channel values, in levels (0–255 or 0–65535, as the images have), as a whole and per
/// channel.
///
/// # Errors
/// [`Error::ImageSize`]; [`Error::PixelFormat`] where bit depth or channels differ, or are neither 8 nor 16 bits.
pub fn compare_images(image: &DynamicImage, other: &DynamicImage) -> Result<Report, Error> {
    let (format, other_format) = (image.color(), other.color());
    let (Some(levels), Some(other_levels)) = (levels(image), levels(other)) else {
        return Err(Error::PixelFormat { format: name(format), other: name(other_format) });
    };
    if format != other_format {
        return Err(Error::PixelFormat { format: name(format), other: name(other_format) });
    }
    let size = |image: &DynamicImage| [image.width(), image.height()];
    if size(image) != size(other) {
        return Err(Error::ImageSize { size: size(image), other: size(other) });
    }
    let names = channel_names(usize::from(format.channel_count()));
    let mut channels: Vec<Levels> = names.iter().map(|_| Levels::new()).collect();
    for (at, (&level, &other)) in levels.iter().zip(&other_levels).enumerate() {
        let channel = at % names.len();
        channels[channel].add(level.abs_diff(other), at / names.len());
    }
    let width = image.width() as usize;
    let pixel = |at: usize| format!("pixel {}, {}", at % width, at / width);
    let mut all = Levels::new();
    channels.iter().for_each(|channel| all.absorb(channel));
    let worst = channels.iter().position(|channel| channel.moments.max == all.moments.max).unwrap_or(0);
    let place = format!("{}, {}", pixel(channels[worst].max_at), names[worst]);
    let mut report = Report::new("levels", all.summary(place));
    let part = |(name, channel): (&&str, &Levels)| Part {
        name: (*name).to_string(),
        summary: channel.summary(pixel(channel.max_at)),
    };
    report.details = names.iter().zip(&channels).map(part).collect();
    Ok(report)
}

fn levels(image: &DynamicImage) -> Option<Vec<u16>> {
    let widen = |bytes: &[u8]| bytes.iter().map(|&byte| u16::from(byte)).collect();
    match image {
        DynamicImage::ImageLuma8(image) => Some(widen(image.as_raw())),
        DynamicImage::ImageLumaA8(image) => Some(widen(image.as_raw())),
        DynamicImage::ImageRgb8(image) => Some(widen(image.as_raw())),
        DynamicImage::ImageRgba8(image) => Some(widen(image.as_raw())),
        DynamicImage::ImageLuma16(image) => Some(image.as_raw().clone()),
        DynamicImage::ImageLumaA16(image) => Some(image.as_raw().clone()),
        DynamicImage::ImageRgb16(image) => Some(image.as_raw().clone()),
        DynamicImage::ImageRgba16(image) => Some(image.as_raw().clone()),
        _ => None,
    }
}

fn channel_names(count: usize) -> &'static [&'static str] {
    match count {
        1 => &["gray"],
        2 => &["gray", "alpha"],
        3 => &["red", "green", "blue"],
        _ => &["red", "green", "blue", "alpha"],
    }
}

fn name(format: ColorType) -> String {
    let bits = format.bits_per_pixel() / u16::from(format.channel_count());
    format!("{}-bit {}", bits, channel_names(usize::from(format.channel_count())).join("/"))
}

/// Differences of one channel: how often each level occurs.
struct Levels {
    moments: Moments,
    counts: Vec<u64>,
    max_at: usize,
}

impl Levels {
    fn new() -> Self {
        Self { moments: Moments::default(), counts: vec![0; 1 << 16], max_at: 0 }
    }

    fn add(&mut self, difference: u16, pixel: usize) {
        if f64::from(difference) > self.moments.max {
            self.max_at = pixel;
        }
        self.moments.add(f64::from(difference));
        self.counts[usize::from(difference)] += 1;
    }

    fn absorb(&mut self, other: &Self) {
        self.moments.absorb(&other.moments);
        self.counts.iter_mut().zip(&other.counts).for_each(|(count, other)| *count += other);
    }

    fn summary(&self, place: String) -> Summary {
        let rank = rank95(self.moments.count);
        let mut below = 0;
        let p95 = self.counts.iter().position(|count| {
            below += count;
            below > rank
        });
        self.moments.summary(p95.unwrap_or(0) as f64, place)
    }
}

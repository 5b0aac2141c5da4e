//! A picture of a time base: per camera how late it is over the take, and where images are missing.

use artifact::canvas::{Canvas, Color, FontError};
use artifact::{SyncCamera, SyncFrame, SyncHeader};

const MARGIN: usize = 12;
/// Width of a camera's caption.
const CAPTIONS: usize = 190;
/// Width of what is drawn over the frames.
const PLOT: usize = 900;
/// Height of a camera's lags, of the strip of its gaps, of a line of text.
const LAGS: usize = 64;
const STRIP: usize = 10;
const LINE: usize = 17;
/// Lags are drawn on no larger scale than this, ms.
const LEAST_MS: f64 = 0.5;

const INK: Color = [40, 44, 52];
const PALE: Color = [238, 241, 244];
const AXIS: Color = [200, 206, 212];
const LAG: Color = [31, 95, 153];
const STAMP: Color = [150, 180, 205];
const SHOWN: Color = [203, 226, 208];
const MISSING: Color = [206, 40, 40];
const DOUBLED: Color = [226, 140, 20];

/// Draws a time base. Per camera: its lag by its line (dark) and by its time stamps (pale), and below it a strip that is red
/// where a frame that it should show has no image, orange where the image repeats another.
///
/// # Errors
/// If the built-in font is damaged.
pub fn draw(header: &SyncHeader, frames: &[SyncFrame]) -> Result<Canvas, FontError> {
    let row = LAGS + STRIP + MARGIN;
    let height = 2 * MARGIN + header.cameras.len() * row + 2 * LINE;
    let mut canvas = Canvas::new(2 * MARGIN + CAPTIONS + PLOT, height)?;
    let tracks: Vec<Track> =
        header.cameras.iter().map(|(id, camera)| Track::of(id, camera, header, frames)).collect();
    let largest = tracks.iter().map(Track::largest_ms).fold(LEAST_MS, f64::max);
    for (i, track) in tracks.iter().enumerate() {
        track.draw(&mut canvas, MARGIN + i * row, largest);
    }
    let foot = MARGIN + header.cameras.len() * row;
    let left = MARGIN + CAPTIONS;
    let (first, last) =
        (frames.first().map_or(0, |frame| frame.frame), frames.last().map_or(0, |frame| frame.frame));
    canvas.write(&format!("frame {first}"), [left, foot], INK);
    canvas.write(&format!("frame {last}"), [left + PLOT - 80, foot], INK);
    let legend = format!(
        "height: ±{largest:.2} ms, up is late; dark: the camera's line, pale: its time stamps; red: missing, orange: doubled"
    );
    canvas.write(&legend, [left, foot + LINE], INK);
    Ok(canvas)
}

/// What is drawn of a camera: one entry per column of the picture.
struct Track {
    captions: [String; 4],
    /// The lag by the line, ms.
    lags: Vec<Option<f64>>,
    /// The smallest and the largest lag by time stamps, ms.
    stamps: Vec<Option<[f64; 2]>>,
    /// The colour of the strip; none where no frame is due.
    strip: Vec<Option<Color>>,
}

impl Track {
    fn of(id: &str, camera: &SyncCamera, header: &SyncHeader, frames: &[SyncFrame]) -> Self {
        let ms = 1e3 / header.rate.hz();
        let column = |i: usize| i * PLOT / frames.len().max(1);
        // A slow camera's image, or that of a short take, is wider than a column.
        let width = (camera.every as usize * PLOT).div_ceil(frames.len().max(1));
        let stamped = stamp_lags(id, camera, header, frames);
        let mut track = Self {
            captions: Default::default(),
            lags: vec![None; PLOT],
            stamps: vec![None; PLOT],
            strip: vec![None; PLOT],
        };
        let (mut missing, mut doubled) = (0, 0);
        for (i, frame) in frames.iter().enumerate() {
            let Some(shown) = frame.shows.get(id) else { continue };
            let color = match shown {
                None => MISSING,
                Some(shown) if shown.doubled => DOUBLED,
                Some(_) => SHOWN,
            };
            missing += usize::from(shown.is_none());
            doubled += usize::from(color == DOUBLED);
            let lag = camera.lag_frames(frame.frame) * ms;
            for x in column(i)..(column(i) + width).min(PLOT) {
                // A lost image shows, however many frames share its column.
                if track.strip[x] != Some(MISSING) {
                    track.strip[x] = Some(color);
                }
                track.lags[x] = Some(lag);
                if let Some(stamp) = stamped[i] {
                    let [low, high] = track.stamps[x].unwrap_or([stamp, stamp]);
                    track.stamps[x] = Some([low.min(stamp), high.max(stamp)]);
                }
            }
        }
        track.captions = [
            format!("{id}: {}", camera.rate),
            format!("offset {:+.3} ms", camera.offset_frames * ms),
            format!("drift {:+.1} ppm", camera.drift_ppm),
            format!("{missing} missing, {doubled} doubled"),
        ];
        track
    }

    fn largest_ms(&self) -> f64 {
        let stamps = self.stamps.iter().flatten().flatten();
        self.lags.iter().flatten().chain(stamps).fold(0.0, |largest, lag| largest.max(lag.abs()))
    }

    fn draw(&self, canvas: &mut Canvas, top: usize, largest: f64) {
        for (i, caption) in self.captions.iter().enumerate() {
            canvas.write(caption, [MARGIN, top + i * LINE], INK);
        }
        let left = MARGIN + CAPTIONS;
        let half = (LAGS / 2) as f64;
        let y = |ms: f64| top + (half - ms / largest * (half - 2.0)).round() as usize;
        canvas.fill([left, top], [PLOT, LAGS], PALE);
        canvas.fill([left, y(0.0)], [PLOT, 1], AXIS);
        for (x, stamps) in self.stamps.iter().enumerate() {
            if let Some([low, high]) = stamps {
                canvas.fill([left + x, y(*high)], [1, y(*low) - y(*high) + 1], STAMP);
            }
        }
        for (x, lag) in self.lags.iter().enumerate() {
            if let Some(lag) = lag {
                canvas.fill([left + x, y(*lag)], [1, 2], LAG);
            }
        }
        for (x, color) in self.strip.iter().enumerate() {
            if let Some(color) = color {
                canvas.fill([left + x, top + LAGS + 1], [1, STRIP], *color);
            }
        }
    }
}

/// Per frame how late the image was by its time stamp, ms. The stamps' zero is their own: they are laid on the line.
fn stamp_lags(id: &str, camera: &SyncCamera, header: &SyncHeader, frames: &[SyncFrame]) -> Vec<Option<f64>> {
    let ms = 1e3 / header.rate.hz();
    let beside = |frame: &SyncFrame| {
        let time_s = frame.shows.get(id).copied().flatten()?.time_s?;
        Some(1e3 * time_s - (frame.frame as f64 + camera.lag_frames(frame.frame)) * ms)
    };
    let differences: Vec<Option<f64>> = frames.iter().map(beside).collect();
    let zero = crate::line::median(&differences.iter().flatten().copied().collect::<Vec<_>>());
    let lag = |(frame, difference): (&SyncFrame, &Option<f64>)| {
        Some(difference.as_ref()? - zero + camera.lag_frames(frame.frame) * ms)
    };
    frames.iter().zip(&differences).map(lag).collect()
}

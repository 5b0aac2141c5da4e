//! Where the data lies and how it is cut into frames.
//!
//! A C3D says most of this twice, in its header and in its parameters. Where the two disagree, the size of the file
//! decides, with a warning; where that does not decide either, the file is refused.

use super::parameters::Parameters;
use super::{BLOCK, word};
use crate::{Error, Result, Violation};
use std::fmt::{self, Display};
use std::path::Path;

/// How numbers are stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Storage {
    /// 16-bit integers times POINT:SCALE.
    Integer,
    /// 32-bit floats.
    Real,
}

impl Storage {
    fn of_scale(scale: f64) -> Self {
        if scale < 0.0 { Self::Real } else { Self::Integer }
    }

    /// Bytes of a number.
    pub(super) fn size(self) -> u64 {
        match self {
            Self::Integer => 2,
            Self::Real => 4,
        }
    }
}

impl Display for Storage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Integer => "integers",
            Self::Real => "reals",
        })
    }
}

/// Where the data lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Layout {
    /// First byte of the first frame.
    pub(super) start: u64,
    pub(super) storage: Storage,
    pub(super) points: u64,
    /// Analog values in a frame.
    pub(super) analog: u64,
    pub(super) frames: u64,
}

impl Layout {
    /// Bytes of a frame. What does not fit a number does not fit the file either.
    pub(super) fn stride(&self) -> u64 {
        self.points.saturating_mul(4).saturating_add(self.analog).saturating_mul(self.storage.size())
    }

    fn end(&self) -> u64 {
        self.start.saturating_add(self.frames.saturating_mul(self.stride()))
    }

    /// Whether the frames fill the file, up to the padding of its last block.
    fn fits(&self, bytes: &[u8]) -> bool {
        let (end, size) = (self.end(), bytes.len() as u64);
        end <= size && (size - end < BLOCK as u64 || bytes[end as usize..].iter().all(|&byte| byte == 0))
    }
}

/// What the header and the parameters say about one thing.
struct Statements<T> {
    what: &'static str,
    said: Vec<(&'static str, T)>,
}

impl<T: Copy + PartialEq + Display> Statements<T> {
    fn new(what: &'static str, said: Vec<(&'static str, Option<T>)>) -> Self {
        Self { what, said: said.into_iter().filter_map(|(by, value)| Some((by, value?))).collect() }
    }

    fn values(&self) -> Vec<T> {
        let mut values = Vec::new();
        for &(_, value) in &self.said {
            if !values.contains(&value) {
                values.push(value);
            }
        }
        values
    }

    fn disagreement(&self) -> Option<String> {
        let said: Vec<String> = self.said.iter().map(|(by, value)| format!("{by} says {value}")).collect();
        (self.values().len() > 1).then(|| format!("{}: {}", self.what, said.join(", ")))
    }
}

struct Claims {
    start: Statements<u64>,
    storage: Statements<Storage>,
    points: Statements<u64>,
    analog: Statements<u64>,
    frames: Statements<u64>,
}

impl Claims {
    fn read(bytes: &[u8], parameters: &Parameters) -> std::result::Result<Self, Violation> {
        let block = |block: u64| (block > 1).then(|| (block - 1) * BLOCK as u64);
        let scale = super::real(bytes, 12);
        let scale_parameter = parameters.number("POINT", "SCALE")?;
        let samples = u64::from(word(bytes, 18));
        let channels = parameters.count("ANALOG", "USED")?.filter(|&channels| channels == 0 || samples > 0);
        Ok(Self {
            start: Statements::new(
                "start of the data (byte)",
                vec![
                    ("the header", block(u64::from(word(bytes, 16)))),
                    ("POINT:DATA_START", parameters.count("POINT", "DATA_START")?.and_then(block)),
                ],
            ),
            storage: Statements::new(
                "storage",
                vec![
                    ("the header", (scale != 0.0 && scale.is_finite()).then(|| Storage::of_scale(scale))),
                    ("POINT:SCALE", scale_parameter.filter(|&scale| scale != 0.0).map(Storage::of_scale)),
                ],
            ),
            points: Statements::new(
                "points",
                vec![
                    ("the header", Some(u64::from(word(bytes, 2)))),
                    ("POINT:USED", parameters.count("POINT", "USED")?),
                ],
            ),
            analog: Statements::new(
                "analog values per frame",
                vec![
                    ("the header", Some(u64::from(word(bytes, 4)))),
                    ("ANALOG:USED", channels.map(|channels| channels.saturating_mul(samples))),
                ],
            ),
            frames: frame_counts(bytes, parameters)?,
        })
    }

    fn layouts(&self) -> Vec<Layout> {
        let mut layouts = Vec::new();
        for start in self.start.values() {
            for storage in self.storage.values() {
                for points in self.points.values() {
                    for analog in self.analog.values() {
                        for frames in self.frames.values() {
                            layouts.push(Layout { start, storage, points, analog, frames });
                        }
                    }
                }
            }
        }
        layouts
    }

    fn disagreements(&self) -> Vec<String> {
        [
            self.start.disagreement(),
            self.storage.disagreement(),
            self.points.disagreement(),
            self.analog.disagreement(),
            self.frames.disagreement(),
        ]
        .into_iter()
        .flatten()
        .collect()
    }

    /// The first thing that nobody says.
    fn unsaid(&self) -> Option<&'static str> {
        let start = self.start.said.is_empty().then_some(self.start.what);
        let storage =
            self.storage.said.is_empty().then_some("POINT:SCALE, so whether it holds integers or reals");
        start.or(storage).or(self.frames.said.is_empty().then_some("frames"))
    }
}

/// First and last frame by TRIAL:ACTUAL_START_FIELD and _END_FIELD: two 16-bit words each, the low one first.
pub(super) fn trial_range(parameters: &Parameters) -> std::result::Result<Option<(u64, u64)>, Violation> {
    let field = |name| {
        let words = parameters.numbers("TRIAL", name)?;
        let word = |index: usize| words.get(index).copied().unwrap_or(0.0).rem_euclid(65536.0) as u64;
        Ok((!words.is_empty()).then(|| word(0) + 65536 * word(1)))
    };
    let range = (field("ACTUAL_START_FIELD")?, field("ACTUAL_END_FIELD")?);
    Ok(match range {
        (Some(first), Some(last)) if first <= last => Some((first, last)),
        _ => None,
    })
}

/// Counts of more than 65535 frames do not fit the words of the header and of POINT:FRAMES, which then stop at 65535
/// or start again at 0; where a wider statement explains them so, they do not count as disagreeing.
fn frame_counts(bytes: &[u8], parameters: &Parameters) -> std::result::Result<Statements<u64>, Violation> {
    let (first, last) = (u64::from(word(bytes, 6)), u64::from(word(bytes, 8)));
    let trial = trial_range(parameters)?;
    let trial_count = trial.map(|(first, last)| last - first + 1);
    let long = parameters.count("POINT", "LONG_FRAMES")?;
    let explained = |count: u64| {
        [trial_count, long]
            .into_iter()
            .flatten()
            .any(|wide| wide != count && wide > count && (count >= 65534 || count == wide % 65536))
    };
    // The header's frame numbers may also stop at 65535 when the count does not.
    let saturated = |(trial_first, trial_last): (u64, u64)| {
        let stops = |frame: u64, wide: u64| frame == wide.min(65535) || frame == wide % 65536;
        trial_last > 65535 && stops(first, trial_first) && stops(last, trial_last)
    };
    let header = (first <= last).then(|| last - first + 1);
    let header = header.filter(|&count| !explained(count) && !trial.is_some_and(saturated));
    Ok(Statements::new(
        "frames",
        vec![
            ("the header", header),
            ("POINT:FRAMES", parameters.count("POINT", "FRAMES")?.filter(|&count| !explained(count))),
            ("POINT:LONG_FRAMES", long),
            ("TRIAL", trial_count),
        ],
    ))
}

/// Decides where the data lies.
pub(super) fn decide(
    path: &Path,
    bytes: &[u8],
    parameters: &Parameters,
    warnings: &mut Vec<String>,
) -> Result<Layout> {
    let claims = Claims::read(bytes, parameters).map_err(|violation| violation.in_file(path))?;
    if let Some(unsaid) = claims.unsaid() {
        return Err(Error::new(path, format!("neither the header nor the parameters say its {unsaid}"))
            .at("header (byte 0)")
            .fix("export it again"));
    }
    let layouts = claims.layouts();
    let some = |layout: &&Layout| layout.points > 0 && layout.frames > 0;
    if !layouts.iter().any(|layout| some(&layout)) {
        return Err(without_points(path, &layouts));
    }
    let fitting: Vec<Layout> = layouts.iter().filter(some).filter(|l| l.fits(bytes)).copied().collect();
    let disagreements = claims.disagreements();
    if let Some((layout, reason)) = chosen(&fitting) {
        warnings.extend(disagreements.into_iter().map(|said| format!("{said}; {reason}")));
        return Ok(layout);
    }
    if let (true, &[layout]) = (fitting.is_empty(), &layouts[..]) {
        return more_frames_than_said(path, bytes, layout, warnings);
    }
    let none = if fitting.is_empty() { "none fits" } else { "more than one fits" };
    let what = format!(
        "contradicts itself ({}), and of what it says {none} the size of the file",
        disagreements.join("; ")
    );
    Err(Error::new(path, what).at("header (byte 0)").fix("it may be cut short; copy or export it again"))
}

/// The one layout that fits and why; where several differ by frames in the padding only, the shortest: what lies
/// there may be no frames.
fn chosen(fitting: &[Layout]) -> Option<(Layout, &'static str)> {
    match fitting {
        [] => None,
        &[layout] => Some((layout, "the size of the file decided")),
        &[first, ..] => {
            let same = |layout: &Layout| Layout { frames: first.frames, ..*layout } == first;
            let shortest = fitting.iter().min_by_key(|layout| layout.frames).copied();
            shortest
                .filter(|_| fitting.iter().all(same))
                .map(|layout| (layout, "both fit the file; the fewer are read"))
        }
    }
}

fn without_points(path: &Path, layouts: &[Layout]) -> Error {
    let analog = layouts.iter().map(|layout| layout.analog).max().unwrap_or(0);
    let frames = layouts.iter().map(|layout| layout.frames).max().unwrap_or(0);
    let what = match (frames, analog) {
        (0, _) => "holds no frames".to_string(),
        (_, 0) => "holds no points".to_string(),
        _ => format!("holds analog data only ({analog} values per frame), no points"),
    };
    Error::new(path, what).at("header (byte 2)").fix("export it with its 3D markers")
}

/// Some writers stop counting at 65535 and say so nowhere; anything else that does not fit is refused.
fn more_frames_than_said(
    path: &Path,
    bytes: &[u8],
    layout: Layout,
    warnings: &mut Vec<String>,
) -> Result<Layout> {
    let (end, size) = (layout.end(), bytes.len() as u64);
    if end > size {
        return Err(cut_short(path, size, layout));
    }
    if layout.frames >= 65534 {
        let used = bytes.iter().rposition(|&byte| byte != 0).map_or(0, |last| last as u64 + 1);
        let frames = (used.saturating_sub(layout.start)).div_ceil(layout.stride());
        let found = Layout { frames, ..layout };
        if found.fits(bytes) {
            warnings.push(format!(
                "says {} frames, the most that its header can count; its data holds {frames}",
                layout.frames
            ));
            return Ok(found);
        }
    }
    let what = format!(
        "says {} points in {} frames, {} bytes from byte {}, but the data does not end there: {} bytes follow",
        layout.points,
        layout.frames,
        end - layout.start,
        layout.start,
        size - end
    );
    Err(Error::new(path, what).at(format!("byte {end}")).fix("the header is wrong; export it again"))
}

fn cut_short(path: &Path, size: u64, layout: Layout) -> Error {
    let whole = size.saturating_sub(layout.start) / layout.stride();
    let what = format!(
        "is cut short, or its header lies: it holds {whole} whole frames of {} ({} points each)",
        layout.frames, layout.points
    );
    Error::new(path, what).at(format!("byte {size}, its end")).fix("copy or export it again")
}

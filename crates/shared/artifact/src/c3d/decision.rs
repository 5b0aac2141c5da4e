//! Which of the layouts that a file claims is its real one.
//!
//! A C3D says most of this twice, in its header and in its parameters. Where the two disagree, the size of the file
//! decides, with a warning; where that does not decide either, the file is refused.

use super::claims::Claims;
use super::layout::Layout;
use super::parameters::Parameters;
use crate::{Error, Result};
use std::path::Path;

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

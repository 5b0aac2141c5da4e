//! Other numbers for sections that are there: scaled, set, or copied from another frame.

use crate::carry::lengths;
use artifact::{Section, SectionState};

/// What a section's numbers say.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Quantity {
    /// d, px.
    Depth,
    /// w, px.
    Width,
    /// d/w: the depth follows.
    Ratio,
    /// ε.
    Rounding,
    /// κ.
    Asymmetry,
}

/// Multiplies depths or widths; at part of the strength, by as much less. A depth of nothing is flat. Deviations grow alike; what
/// could not be measured stays so.
pub(crate) fn scale(section: &mut Section, what: Quantity, by: f64, strength: f64) {
    let by = 1.0 + strength * (by - 1.0);
    let spread = section.deviation.as_mut();
    match what {
        Quantity::Width => {
            section.w_px *= by;
            if let Some(spread) = spread {
                spread.w_px *= by;
            }
        }
        _ => {
            section.d_px *= by;
            if let Some(spread) = spread {
                spread.d_px *= by;
            }
        }
    }
    if by == 0.0 {
        section.state = SectionState::Flat;
    }
    if !matches!(section.state, SectionState::Failed | SectionState::Flat) {
        section.state = state(section.d_px);
    }
}

/// Sets a number of all sections of a wrinkle; at part of the strength, goes part of the way there. A section that has no width, and
/// shall have a depth, gets that of the nearest one with a width.
///
/// # Errors
/// If none has a width.
pub(crate) fn set(sections: &mut [Section], what: Quantity, to: f64, strength: f64) -> Result<(), String> {
    let widths: Vec<[f64; 2]> = sections
        .iter()
        .filter(|section| section.w_px > 0.0)
        .map(|section| [section.u, section.w_px])
        .collect();
    for section in sections {
        let toward = |from: f64, to: f64| from + strength * (to - from);
        match what {
            Quantity::Width if section.w_px == 0.0 => section.w_px = to,
            Quantity::Width => section.w_px = toward(section.w_px, to),
            Quantity::Rounding => section.epsilon = toward(section.epsilon, to),
            Quantity::Asymmetry => section.kappa = toward(section.kappa, to),
            Quantity::Depth | Quantity::Ratio => {
                if section.w_px == 0.0 {
                    section.w_px = nearest(&widths, section.u)
                        .ok_or("none of its sections has a width; set the width first")?;
                }
                let depth = if what == Quantity::Ratio { to * section.w_px } else { to };
                section.d_px = toward(section.d_px, depth);
            }
        }
        if matches!(what, Quantity::Depth | Quantity::Ratio) || section.state == SectionState::Measured {
            section.state = state(section.d_px);
        }
        (section.deviation, section.residual) = (None, None);
    }
    Ok(())
}

fn nearest(widths: &[[f64; 2]], u: f64) -> Option<f64> {
    let off = |width: &&[f64; 2]| (width[0] - u).abs();
    widths.iter().min_by(|a, b| off(a).total_cmp(&off(b))).map(|width| width[1])
}

/// What a section with numbers of a person's is.
pub(crate) fn state(depth: f64) -> SectionState {
    if depth == 0.0 { SectionState::Flat } else { SectionState::Edited }
}

/// Gives the sections of a wrinkle the profiles of another frame's, at equal shares of the length; at part of the strength, goes part
/// of the way there.
pub(crate) fn copy(from: &[Section], to: &mut [Section], strength: f64) {
    let (known, places) = (lengths(from), lengths(to));
    let (Some(whole), Some(end)) = (known.last(), places.last()) else { return };
    for (section, place) in to.iter_mut().zip(&places) {
        let wanted = whole * place / end.max(1e-12);
        let after =
            known.partition_point(|length| *length < wanted).clamp(1.min(from.len() - 1), from.len() - 1);
        let before = after.saturating_sub(1);
        let share = ((wanted - known[before]) / (known[after] - known[before]).max(1e-12)).clamp(0.0, 1.0);
        let number = |of: fn(&Section) -> f64| {
            let there = of(&from[before]) + share * (of(&from[after]) - of(&from[before]));
            of(section) + strength * (there - of(section))
        };
        let (w_px, d_px) = (number(|section| section.w_px), number(|section| section.d_px));
        let (epsilon, kappa) = (number(|section| section.epsilon), number(|section| section.kappa));
        // A valley without a width is none.
        let d_px = if w_px > 0.0 { d_px } else { 0.0 };
        let (deviation, residual) = (None, None);
        *section =
            Section { w_px, d_px, epsilon, kappa, deviation, residual, state: state(d_px), ..*section };
    }
}

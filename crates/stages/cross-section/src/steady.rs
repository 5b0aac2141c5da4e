//! Sections smoothed over time.

use artifact::{Section, SectionState, SectionsFrame};

/// Deviations of ln(d/w) below this do not make a section count more.
const LEAST_DEVIATION: f64 = 0.02;

/// A frame with the widths and depths of its measured sections smoothed over `reach` images to both sides of it, in `frames` at `at`.
///
/// ln w, ln(d/w), ε and κ are means with weights that fall linearly with the distance in images and with the variance; sections are told apart
/// by their share of the wrinkle's length. Places and states stay: faces move, and a valley that is not there has no depth. A frame hangs on
/// `reach` frames to both sides only.
#[must_use]
pub fn steadied(frames: &[SectionsFrame], at: usize, reach: usize) -> SectionsFrame {
    let mut steady = frames[at].clone();
    let window = at.saturating_sub(reach)..(at + reach + 1).min(frames.len());
    for (camera, wrinkles) in &mut steady.sections {
        for (id, sections) in wrinkles {
            let last = sections.len().saturating_sub(1).max(1) as f64;
            for (index, section) in sections.iter_mut().enumerate() {
                if section.state != SectionState::Measured {
                    continue;
                }
                let near = window.clone().filter_map(|other| {
                    let found = frames[other].sections.get(camera)?.get(id)?;
                    let place = (index as f64 / last * found.len().saturating_sub(1) as f64).round() as usize;
                    let found = found.get(place).filter(|found| found.state == SectionState::Measured)?;
                    Some((1.0 - other.abs_diff(at) as f64 / (reach + 1) as f64, *found))
                });
                blend(section, near);
            }
        }
    }
    steady
}

fn blend(section: &mut Section, near: impl Iterator<Item = (f64, Section)>) {
    let mut sums = [0.0; 5];
    for (nearness, other) in near {
        let spread = other.deviation.map_or(0.1, |deviation| deviation.d_px / other.d_px);
        let weight = nearness / spread.max(LEAST_DEVIATION).powi(2);
        let values = [1.0, other.w_px.ln(), (other.d_px / other.w_px).ln(), other.epsilon, other.kappa];
        sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value);
    }
    let [weight, width, ratio, epsilon, kappa] = sums;
    section.w_px = (width / weight).exp();
    section.d_px = (ratio / weight).exp() * section.w_px;
    (section.epsilon, section.kappa) = (epsilon / weight, kappa / weight);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(number: i64, w_px: f64, state: SectionState) -> SectionsFrame {
        let d_px = if state == SectionState::Measured { 0.4 * w_px } else { 0.0 };
        let section = |u: i32| Section {
            u: f64::from(u),
            at: [f64::from(u), 0.0],
            normal: [0.0, 1.0],
            w_px,
            d_px,
            epsilon: 0.2,
            kappa: 0.0,
            tilt_rad: None,
            deviation: None,
            residual: None,
            state,
        };
        let wrinkles = [("brow".to_string(), (0..5).map(section).collect())].into();
        SectionsFrame { frame: number, sections: [("w1".to_string(), wrinkles)].into() }
    }

    #[test]
    fn noise_is_averaged_and_places_stay() {
        let widths = [5.0, 5.2, 4.8, 5.1, 4.9];
        let frames: Vec<SectionsFrame> =
            (0..5).map(|i| frame(i, widths[i as usize], SectionState::Measured)).collect();
        let steady = steadied(&frames, 2, 2);
        let section = steady.sections["w1"]["brow"][3];
        assert!((section.w_px - 5.0).abs() < 0.1 && (section.d_px / section.w_px - 0.4).abs() < 1e-12);
        assert_eq!(section.at, [3.0, 0.0]);
        assert!((steadied(&frames, 2, 0).sections["w1"]["brow"][3].w_px - 4.8).abs() < 1e-12);
    }

    #[test]
    fn what_is_flat_stays_flat_and_counts_for_nothing() {
        let frames = [frame(0, 5.0, SectionState::Measured), frame(1, 9.0, SectionState::Flat)];
        assert_eq!(steadied(&frames, 1, 1), frames[1]);
        assert!((steadied(&frames, 0, 1).sections["w1"]["brow"][0].w_px - 5.0).abs() < 1e-12);
    }
}

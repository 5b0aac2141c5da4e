//! How the skin around drawn wrinkles moves in an image: as the wrinkles that they follow.

use crate::moment::Moment;
use crate::spline::Place;
use artifact::Section;
use nalgebra::Rotation2;

/// A motion of the image's plane without stretch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Motion {
    turn: Rotation2<f64>,
    from: Place,
    to: Place,
}

/// Places along a followed wrinkle that are compared.
const PLACES: usize = 16;

impl Motion {
    /// No motion.
    pub(crate) fn none() -> Self {
        Self { turn: Rotation2::identity(), from: Place::zeros(), to: Place::zeros() }
    }

    /// The rigid motion with the least squares that takes the creases of wrinkles from one frame to another, places at equal shares of
    /// a wrinkle's length taken for the same; none where no wrinkle is to be seen in both.
    pub(crate) fn of(from: &Moment, to: &Moment, camera: &str, ids: &[String]) -> Option<Self> {
        let pairs: Vec<[Place; 2]> = ids
            .iter()
            .filter_map(|id| {
                Some((spread(from.sections_of(camera, id)?)?, spread(to.sections_of(camera, id)?)?))
            })
            .flat_map(|(from, to)| from.into_iter().zip(to).map(|(from, to)| [from, to]))
            .collect();
        if pairs.is_empty() {
            return None;
        }
        let [from, to] = [0, 1].map(|k| pairs.iter().map(|pair| pair[k]).sum::<Place>() / pairs.len() as f64);
        let (mut along, mut across) = (0.0, 0.0);
        for pair in &pairs {
            let (a, b) = (pair[0] - from, pair[1] - to);
            along += a.dot(&b);
            across += a.perp(&b);
        }
        Some(Self { turn: Rotation2::new(across.atan2(along)), from, to })
    }

    pub(crate) fn place(&self, place: Place) -> Place {
        self.to + self.turn * (place - self.from)
    }

    /// A section that is carried along.
    pub(crate) fn section(&self, section: &Section) -> Section {
        let (at, normal) = (self.place(section.at.into()), self.turn * Place::from(section.normal));
        Section { at: at.into(), normal: normal.into(), ..*section }
    }
}

/// Places of the crease at equal shares of its length.
fn spread(sections: &[Section]) -> Option<Vec<Place>> {
    let lengths = lengths(sections);
    let whole = *lengths.last().filter(|length| **length > 0.0)?;
    let place = |i: usize| {
        let length = whole * i as f64 / (PLACES - 1) as f64;
        let after = lengths.partition_point(|other| *other < length).clamp(1, lengths.len() - 1);
        let share = (length - lengths[after - 1]) / (lengths[after] - lengths[after - 1]).max(1e-12);
        let [from, to] = [sections[after - 1].at, sections[after].at].map(Place::from);
        from + share.clamp(0.0, 1.0) * (to - from)
    };
    Some((0..PLACES).map(place).collect())
}

/// The length along the crease of each section.
pub(crate) fn lengths(sections: &[Section]) -> Vec<f64> {
    let mut length = 0.0;
    let steps = sections.windows(2).map(|pair| {
        length += (Place::from(pair[1].at) - Place::from(pair[0].at)).norm();
        length
    });
    std::iter::once(0.0).chain(steps).take(sections.len()).collect()
}

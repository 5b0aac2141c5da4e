//! Places along a polyline in space.

use nalgebra::Point3;

/// A polyline with the arc length at each of its points, mm.
#[derive(Debug, Clone)]
pub(crate) struct Line {
    points: Vec<Point3<f64>>,
    arcs: Vec<f64>,
}

/// A place of a polyline.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Place {
    /// Arc length; beyond the ends the line goes on straight.
    pub(crate) arc: f64,
    /// How far the point is from there, mm.
    pub(crate) distance: f64,
}

/// The direction beyond an end is that of this much of the line, mm: one short segment may point anywhere.
const END_MM: f64 = 3.0;

impl Line {
    pub(crate) fn new(points: Vec<Point3<f64>>) -> Self {
        let arcs = arcs(&points);
        Self { points, arcs }
    }

    pub(crate) fn length(&self) -> f64 {
        self.arcs.last().copied().unwrap_or(0.0)
    }

    /// The place nearest to a point; of an empty line none.
    pub(crate) fn locate(&self, point: &Point3<f64>) -> Option<Place> {
        let first = self.points.first()?;
        let mut best = Place { arc: 0.0, distance: (point - first).norm() };
        for i in 0..self.points.len() - 1 {
            let (from, along) = (self.points[i], self.points[i + 1] - self.points[i]);
            let square = along.norm_squared();
            let share =
                if square > 0.0 { ((point - from).dot(&along) / square).clamp(0.0, 1.0) } else { 0.0 };
            let distance = (point - (from + along * share)).norm();
            if distance < best.distance {
                best = Place { arc: self.arcs[i] + share * (self.arcs[i + 1] - self.arcs[i]), distance };
            }
        }
        Some(self.beyond(point, best))
    }

    /// A point nearest to an end may lie beyond it.
    fn beyond(&self, point: &Point3<f64>, nearest: Place) -> Place {
        let last = self.points.len() - 1;
        let (end, sign) = match nearest.arc {
            arc if arc <= 0.0 => (0, -1.0),
            arc if arc >= self.length() => (last, 1.0),
            _ => return nearest,
        };
        let inner = match end {
            0 => self.arcs.iter().position(|arc| *arc >= END_MM).unwrap_or(last),
            _ => self.arcs.iter().rposition(|arc| *arc <= self.length() - END_MM).unwrap_or(0),
        };
        let Some(outwards) = (self.points[end] - self.points[inner]).try_normalize(0.0) else {
            return nearest;
        };
        let off = point - self.points[end];
        let ahead = off.dot(&outwards).max(0.0);
        Place { arc: nearest.arc + sign * ahead, distance: (off - outwards * ahead).norm() }
    }
}

/// Arc lengths at the points of a polyline, from 0 on, mm.
pub(crate) fn arcs(points: &[Point3<f64>]) -> Vec<f64> {
    let mut sum = 0.0;
    let mut arcs = vec![0.0; points.len()];
    for i in 1..points.len() {
        sum += (points[i] - points[i - 1]).norm();
        arcs[i] = sum;
    }
    arcs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_lie_along_the_line_and_beyond_its_ends() {
        let line = Line::new([[0., 0., 0.], [4., 0., 0.], [4., 6., 0.]].map(Point3::from).to_vec());
        assert_eq!(line.length(), 10.0);
        let place = |x: f64, y: f64| line.locate(&Point3::new(x, y, 0.0)).unwrap();
        assert_eq!(place(1.0, 2.0), Place { arc: 1.0, distance: 2.0 });
        assert_eq!(place(5.0, 3.0), Place { arc: 7.0, distance: 1.0 });
        assert_eq!(place(4.0, 8.0), Place { arc: 12.0, distance: 0.0 });
        assert_eq!(place(-2.0, 1.0), Place { arc: -2.0, distance: 1.0 });
        assert!(Line::new(Vec::new()).locate(&Point3::origin()).is_none());
    }
}

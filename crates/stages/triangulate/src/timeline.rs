//! Errors and coverage over time, in a fixed number of columns: when they are full, each two become one.

use artifact::SampleStatus;

/// Columns at most; an even number.
const COLUMNS: usize = 1024;
/// What a marker can be in a frame: measured, single-camera, neighbour-filled, interpolated, missing.
pub const STATES: usize = 5;

/// Errors and coverage over time.
#[derive(Debug, Clone, PartialEq)]
pub struct Timeline {
    /// Number of the first frame.
    pub first: i64,
    /// Frames in a column.
    pub span: i64,
    camera_count: usize,
    marker_count: usize,
    /// Columns, in their order.
    pub columns: Vec<Column>,
}

/// Some successive frames.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Per camera the sum of squared reprojection errors, px², their number, and the number of outliers.
    pub cameras: Vec<(f64, usize, usize)>,
    /// Per marker how many frames it was in each state.
    pub markers: Vec<[u32; STATES]>,
}

impl Timeline {
    pub(crate) fn new(camera_count: usize, marker_count: usize) -> Self {
        Self { first: i64::MIN, span: 1, camera_count, marker_count, columns: Vec::new() }
    }

    pub(crate) fn add_residual(&mut self, frame: i64, camera: usize, square: f64) {
        let sums = &mut self.column(frame).cameras[camera];
        sums.0 += square;
        sums.1 += 1;
    }

    pub(crate) fn add_outlier(&mut self, frame: i64, camera: usize) {
        self.column(frame).cameras[camera].2 += 1;
    }

    pub(crate) fn add_status(&mut self, frame: i64, marker: usize, status: Option<SampleStatus>) {
        let state = match status {
            Some(SampleStatus::Measured) => 0,
            Some(SampleStatus::SingleCamera) => 1,
            Some(SampleStatus::NeighborFilled) => 2,
            Some(SampleStatus::Interpolated) => 3,
            None => 4,
        };
        self.column(frame).markers[marker][state] += 1;
    }

    fn column(&mut self, frame: i64) -> &mut Column {
        if self.columns.is_empty() {
            self.first = frame;
        }
        let index = |timeline: &Self| ((frame - timeline.first) / timeline.span).max(0) as usize;
        while index(self) >= COLUMNS {
            self.halve();
        }
        let at = index(self);
        if self.columns.len() <= at {
            let cameras = vec![(0.0, 0, 0); self.camera_count];
            self.columns.resize(at + 1, Column { cameras, markers: vec![[0; STATES]; self.marker_count] });
        }
        &mut self.columns[at]
    }

    fn halve(&mut self) {
        self.span *= 2;
        let pairs = self.columns.chunks(2).map(|pair| {
            let mut sum = pair[0].clone();
            pair[1..].iter().for_each(|other| sum.add(other));
            sum
        });
        self.columns = pairs.collect();
    }
}

impl Column {
    fn add(&mut self, other: &Self) {
        for (sum, camera) in self.cameras.iter_mut().zip(&other.cameras) {
            *sum = (sum.0 + camera.0, sum.1 + camera.1, sum.2 + camera.2);
        }
        for (sums, states) in self.markers.iter_mut().zip(&other.markers) {
            sums.iter_mut().zip(states).for_each(|(sum, state)| *sum += state);
        }
    }
}

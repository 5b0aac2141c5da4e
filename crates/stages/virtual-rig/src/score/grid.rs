//! Points near a place.

use nalgebra::Point3;

/// Points sorted into cubes, so that the ones near a place are found without looking at all.
#[derive(Debug)]
pub(super) struct Grid {
    cell: f64,
    low: Point3<f64>,
    size: [usize; 3],
    /// Where each cube's points start in `points`.
    starts: Vec<u32>,
    points: Vec<u32>,
}

/// Cubes at most: a stray point far away must not ask for all memory.
const MAX_CELLS: f64 = 1e7;

impl Grid {
    /// Sorts points into cubes of about `cell`.
    pub(super) fn of(points: &[Point3<f64>], cell: f64) -> Self {
        let (low, high) = mesh::bounding_box(points);
        let extent = (high - low).add_scalar(cell);
        let cell = cell.max((extent.product() / MAX_CELLS).cbrt());
        let size: [usize; 3] = std::array::from_fn(|axis| (extent[axis] / cell) as usize + 1);
        let mut grid =
            Self { cell, low, size, starts: vec![0; size.iter().product::<usize>() + 1], points: Vec::new() };
        let places: Vec<usize> = points.iter().map(|point| grid.index(grid.place(point))).collect();
        places.iter().for_each(|&place| grid.starts[place + 1] += 1);
        for place in 1..grid.starts.len() {
            grid.starts[place] += grid.starts[place - 1];
        }
        let mut fill = grid.starts.clone();
        grid.points = vec![0; points.len()];
        for (point, &place) in places.iter().enumerate() {
            grid.points[fill[place] as usize] = point as u32;
            fill[place] += 1;
        }
        grid
    }

    fn place(&self, point: &Point3<f64>) -> [usize; 3] {
        // Casts saturate at zero.
        std::array::from_fn(|axis| {
            (((point[axis] - self.low[axis]) / self.cell) as usize).min(self.size[axis] - 1)
        })
    }

    fn index(&self, place: [usize; 3]) -> usize {
        (place[2] * self.size[1] + place[1]) * self.size[0] + place[0]
    }

    /// Calls `visit` for all points in the cubes that a box of half size `reach` around `center` touches, in a fixed order.
    pub(super) fn near(&self, center: &Point3<f64>, reach: f64, mut visit: impl FnMut(usize)) {
        let half = nalgebra::Vector3::repeat(reach);
        let (from, to) = (self.place(&(center - half)), self.place(&(center + half)));
        for z in from[2]..=to[2] {
            for y in from[1]..=to[1] {
                let row = self.index([from[0], y, z])..=self.index([to[0], y, z]);
                let range = self.starts[*row.start()] as usize..self.starts[row.end() + 1] as usize;
                self.points[range].iter().for_each(|&point| visit(point as usize));
            }
        }
    }
}

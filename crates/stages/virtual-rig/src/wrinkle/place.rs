//! Lines onto the rest surface.

use crate::Error;
use crate::wrinkle::arc::Outline;
use crate::wrinkle::band;
use crate::wrinkle::form::Form;
use crate::wrinkle::lines::WrinkleLine;
use crate::wrinkle::params::Params;
use crate::wrinkle::reach::{Beside, Coordinates, vertices_beside};
use crate::wrinkle::section::Station;
use crate::wrinkle::smooth::{smoothed, strides};
use crate::wrinkle::surface::{Atlas, Cut, Ground, Neighbors, Spot};
use nalgebra::{Point2, Point3, Vector3};
use rayon::prelude::*;

/// Step along a line's path when it is laid onto the surface, mm of the domain.
const LAY_STEP: f64 = 0.2;
/// Between two steps a line goes no farther on the surface: there it leaps to another sheet, mm.
const LEAP_MM: f64 = 2.0;
/// What of a line lies on the mesh must be at least this long, mm.
const SHORTEST: f64 = 3.0;
/// Normals are averaged along a line over about this length, mm.
const FRAME_MM: f64 = 2.0;

/// Wrinkles on a rest surface, ready to fold.
#[derive(Debug, Clone)]
pub struct Wrinkles {
    pub(super) params: Params,
    pub(super) lines: Vec<Placed>,
    vertex_count: usize,
}

/// A line on the surface.
#[derive(Debug, Clone)]
pub(super) struct Placed {
    pub(super) line: WrinkleLine,
    pub(super) stations: Vec<Station>,
    pub(super) beside: Vec<Beside>,
}

impl Wrinkles {
    /// Lays lines onto a rest surface.
    ///
    /// `rest`: #V × 3, mm; `triangles`: counter-clockwise seen from outside; `domain`: #V × 2, each vertex's place on
    /// the unrolled average face, mm (vertices without one: not a number). Parts of a line beyond the mesh are cut off.
    ///
    /// # Errors
    /// [`Error::Parameter`] if a parameter makes no sense, or naming a line that does not lie on the mesh.
    ///
    /// # Panics
    /// If `domain` and `rest` differ in length: that is a bug of the caller.
    pub fn place(
        rest: &[Point3<f64>],
        triangles: &[[u32; 3]],
        domain: &[Point2<f64>],
        lines: &[WrinkleLine],
        params: &Params,
    ) -> Result<Self, Error> {
        params.check()?;
        assert_eq!(rest.len(), domain.len(), "each vertex has its place in the domain");
        let paths: Vec<Vec<Point2<f64>>> = lines.iter().map(|line| dense(&line.path)).collect();
        let atlas = Atlas::new(domain, triangles, paths.iter().flatten().copied());
        let laid: Vec<Vec<(Point2<f64>, Point3<f64>)>> =
            paths.iter().map(|path| lay(path, &atlas, rest)).collect();
        for (line, laid) in lines.iter().zip(&laid) {
            check_length(line, length(laid))?;
        }
        let radius = |line: &WrinkleLine| radius(line, params);
        let widest = lines.iter().map(radius).fold(0.0, f64::max);
        let near = near_vertices(rest, &laid, widest + 2.0);
        let neighbors = Neighbors::new(triangles, |vertex| near[vertex as usize]);
        let ground = Ground { points: rest, triangles, neighbors };
        let mut stations: Vec<Vec<Station>> =
            (0..lines.len()).map(|i| sections(&ground, &atlas, &lines[i], &laid[i], params)).collect();
        band::set(&mut stations, params);
        let placed = stations.into_iter().zip(lines).map(|(stations, line)| {
            let beside = vertices_beside(&stations, rest, radius(line));
            Placed { line: line.clone(), stations, beside }
        });
        Ok(Self { params: params.clone(), lines: placed.collect(), vertex_count: rest.len() })
    }

    /// The lines, in the order in which they were given.
    pub fn lines(&self) -> impl ExactSizeIterator<Item = &WrinkleLine> {
        self.lines.iter().map(|placed| &placed.line)
    }

    /// How many vertices the mesh has.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.vertex_count
    }

    /// The vertices beside a line, up to 4 widths and 2 mm to each side, in its coordinates.
    ///
    /// # Panics
    /// If there is no such line: that is a bug of the caller.
    #[must_use]
    pub fn coordinates(&self, line: usize) -> Coordinates {
        let Placed { stations, beside, .. } = &self.lines[line];
        let mut found = Coordinates::default();
        for at in beside {
            let (one, other) = (&stations[at.station as usize], &stations[at.station as usize + 1]);
            let mix = |a: f64, b: f64| a + at.share * (b - a);
            if at.p.abs() <= paint_reach(mix(one.width, other.width)) {
                found.vertices.push(at.vertex);
                found.x_mm.push(mix(one.x, other.x));
                found.p_mm.push(at.p);
            }
        }
        found
    }

    /// Widths of a line at rest: per section its place x and its width, mm.
    ///
    /// # Panics
    /// If there is no such line: that is a bug of the caller.
    #[must_use]
    pub fn widths(&self, line: usize) -> Vec<(f64, f64)> {
        self.lines[line].stations.iter().map(|station| (station.x, station.width)).collect()
    }
}

fn paint_reach(width: f64) -> f64 {
    4.0 * width + 2.0
}

/// How far from a line anything is looked for, mm: at the widest place of its widest form.
fn radius(line: &WrinkleLine, params: &Params) -> f64 {
    let widest = params.fixed.map_or(line.width_mm * (1.0 + 0.3 * line.variation), |fixed| fixed.w_mm);
    (params.reach * widest).max(paint_reach(widest)) + 1.0
}

fn check_length(line: &WrinkleLine, length: f64) -> Result<(), Error> {
    let what = match length {
        0.0 => "lies wholly beyond the mesh; leave it out, or check the landmarks".to_string(),
        length if length < SHORTEST => {
            format!(
                "only {length:.1} mm of it lie on the mesh; leave it out, or give it {SHORTEST} mm and more"
            )
        }
        _ => return Ok(()),
    };
    Err(Error::Parameter { place: format!("lines: {}", line.id), what })
}

/// A path in steps of at most [`LAY_STEP`].
fn dense(path: &[Point2<f64>]) -> Vec<Point2<f64>> {
    let mut points: Vec<Point2<f64>> = path.first().copied().into_iter().collect();
    for pair in path.windows(2) {
        let count = ((pair[1] - pair[0]).norm() / LAY_STEP).ceil().max(1.0) as usize;
        points.extend((1..=count).map(|i| pair[0] + (pair[1] - pair[0]) * (i as f64 / count as f64)));
    }
    points
}

/// The longest run of a path that lies on one sheet of the mesh, with its points in space.
fn lay(path: &[Point2<f64>], atlas: &Atlas, rest: &[Point3<f64>]) -> Vec<(Point2<f64>, Point3<f64>)> {
    let on = path.iter().map(|&at| atlas.find(at, rest).map(|spot| (at, spot.at(rest))));
    let mut runs: Vec<Vec<(Point2<f64>, Point3<f64>)>> = vec![Vec::new()];
    for laid in on {
        let hangs_on = |run: &Vec<(Point2<f64>, Point3<f64>)>| {
            let last = run.last().zip(laid);
            last.is_some_and(|(last, laid)| (laid.1 - last.1).norm() <= LEAP_MM)
        };
        match (laid, runs.last_mut()) {
            (Some(laid), Some(run)) if hangs_on(run) => run.push(laid),
            (Some(laid), _) => runs.push(vec![laid]),
            (None, _) => runs.push(Vec::new()),
        }
    }
    // The first of equally long runs.
    runs.into_iter().fold(Vec::new(), |best, run| if run.len() > best.len() { run } else { best })
}

fn length(laid: &[(Point2<f64>, Point3<f64>)]) -> f64 {
    laid.windows(2).map(|pair| (pair[1].1 - pair[0].1).norm()).sum()
}

/// Which vertices are so near to a line that sections may pass their triangles.
fn near_vertices(rest: &[Point3<f64>], laid: &[Vec<(Point2<f64>, Point3<f64>)>], radius: f64) -> Vec<bool> {
    // Every few points of a line will do: they are 0.2 mm apart.
    let marks: Vec<Point3<f64>> =
        laid.iter().flat_map(|line| line.iter().step_by(8).map(|at| at.1)).collect();
    let (low, high) = mesh::bounding_box(&marks);
    let in_box =
        |point: &Point3<f64>| (0..3).all(|i| (low[i] - radius..=high[i] + radius).contains(&point[i]));
    let is_near = |point: &Point3<f64>| {
        in_box(point) && marks.iter().any(|mark| (mark - point).norm_squared() < (radius + 2.0).powi(2))
    };
    rest.par_iter().map(is_near).collect()
}

/// The sections of one line.
fn sections(
    ground: &Ground,
    atlas: &Atlas,
    line: &WrinkleLine,
    laid: &[(Point2<f64>, Point3<f64>)],
    params: &Params,
) -> Vec<Station> {
    let length = length(laid);
    let form = Form::of(line, params, length);
    let count = (length / params.station_mm).ceil().max(4.0);
    let spacing = length / count;
    let spots = even_spots(laid, ground.points, atlas, count as usize, spacing);
    let frames = frames(&spots, ground.points, spacing);
    let reach = radius(line, params);
    let station = |(i, (spot, frame)): (usize, (&Spot, Cut))| {
        let x = spacing * i as f64;
        let mut station = Station::new(ground, *spot, frame, x, params.station_mm, reach);
        station.uptake = form.uptake(x);
        station.width = form.width(x);
        station.shape = form.shape(x);
        station.outline = Outline::of(&station.shape, params.reach);
        station
    };
    let places: Vec<(usize, (&Spot, Cut))> = spots.iter().zip(frames).enumerate().collect();
    places.into_par_iter().map(station).collect()
}

/// Material points of a line at even distances on the surface.
fn even_spots(
    laid: &[(Point2<f64>, Point3<f64>)],
    rest: &[Point3<f64>],
    atlas: &Atlas,
    count: usize,
    spacing: f64,
) -> Vec<Spot> {
    let find = |at| atlas.find(at, rest);
    let mut lengths = vec![0.0];
    for pair in laid.windows(2) {
        lengths.push(lengths[lengths.len() - 1] + (pair[1].1 - pair[0].1).norm());
    }
    let place = |i: usize| {
        let (k, share) = crate::wrinkle::section::locate(&lengths, spacing * i as f64);
        let (from, to) = (laid[k].0, laid[k + 1].0);
        // Rounding may push the last one over the edge.
        find(from + (to - from) * share).or_else(|| find(from)).or_else(|| find(to))
    };
    (0..=count).filter_map(place).collect()
}

/// Orthonormal frames along a line.
fn frames(spots: &[Spot], rest: &[Point3<f64>], spacing: f64) -> Vec<Cut> {
    let even = strides(FRAME_MM / spacing);
    let points: Vec<Point3<f64>> = spots.iter().map(|spot| spot.at(rest)).collect();
    let last = points.len() - 1;
    let chord = |i: usize| points[(i + 2).min(last)] - points[i.saturating_sub(2)];
    let tangents: Vec<Vector3<f64>> = (0..points.len()).map(|i| chord(i).normalize()).collect();
    let normals: Vec<Vector3<f64>> = spots.iter().map(|spot| spot.normal(rest)).collect();
    let (tangents, normals) = (smoothed(&tangents, &even), smoothed(&normals, &even));
    let frame = |i: usize| {
        let across = normals[i].cross(&tangents[i]).normalize();
        Cut { origin: points[i], along: across.cross(&normals[i]).normalize(), across }
    };
    (0..points.len()).map(frame).collect()
}

//! Proposes where on a face its markers should be painted.
//!
//! Where markers stand matters more than how their motion is interpolated. The rules that this stage follows were measured on
//! an expression set with true surfaces (the README has the figures): some markers on the edge of the lips and
//! at the edges of the lids, the rest even along the surface, denser near lips and lids, mirrored where the face is.
//!
//! [`plan`] finds mouth and eyes among the openings of the scan, the frame and the mirror plane of the face, and the
//! skin that can be painted and seen; it sets the features, fills up with farthest points and evens them out.
//! [`Raster`] draws the face for the picture that goes with the plan.
//!
//! ```
//! use marker_plan::{Error, Params, plan};
//! use mesh::Mesh;
//! // A triangle has no mouth.
//! let mesh = Mesh::from_triangles(vec![[0., 0., 0.], [100., 0., 0.], [0., 100., 0.]], &[[0, 1, 2]]);
//! assert!(matches!(plan(&mesh, &Params::default()), Err(Error::Openings { .. })));
//! ```

mod error;
mod face;
mod features;
mod geodesic;
mod params;
mod raster;
mod skin;
mod spread;
mod symmetry;

pub use error::Error;
pub use face::Frame;
pub use params::Params;
pub use raster::{NOTHING, Raster, View};

use face::Rims;
use features::Scene;
use mesh::{Connectivity, Mesh};
use nalgebra::Point3;
use skin::Skin;
use spread::{Spot, Spread};

/// A marker to paint.
#[derive(Debug, Clone, PartialEq)]
pub struct Planned {
    /// Its id: `lip_corner_l`, `lid_upper_r`, or `m07_l`; `_l` and `_r` are the face's own left and right.
    pub marker: String,
    /// The scan's vertex that it sits on.
    pub vertex: u32,
    /// Index of its mirror image; its own in the middle of the face; `None` where the face is not symmetric.
    pub mirror: Option<usize>,
}

/// Where the markers go.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// The markers: lips, lids, then the rest from the forehead down.
    pub markers: Vec<Planned>,
    /// The face's frame.
    pub frame: Frame,
    /// How far the skin is from its own mirror image, root mean square, mm.
    pub asymmetry_mm: f64,
    /// Least distance between two markers, mm.
    pub least_distance_mm: f64,
    /// Largest distance of open skin from its nearest marker, mm, along the surface.
    pub largest_gap_mm: f64,
}

/// Proposes markers on a scan (mm) whose mouth and eyes are open.
///
/// Of the [`Params::count`] markers some stand beside the edges of lips and lids. The rest are farthest points along the surface
/// [EldarLindenbaum1997] in a metric that is stretched near lips and lids, evened out by Lloyd's iteration; in mirrored
/// pairs where the face is symmetric. None stands in nostrils, folds, or near the border of the scan, and no two closer than
/// [`Params::least_distance_mm`]. The same scan and parameters give the same plan.
///
/// # Errors
/// A parameter out of range; mouth and eyes that cannot be told; too little skin for so many markers.
pub fn plan(mesh: &Mesh, params: &Params) -> Result<Plan, Error> {
    params.check()?;
    let triangles = mesh.triangles();
    let points = &mesh.positions;
    let around = Connectivity::of(points.len(), &triangles);
    let normals = mesh::vertex_normals(points, &triangles);
    let (rims, frame) = face::find(&around, points, &triangles, params)?;
    let skin = skin::look(mesh, &triangles, &around, &normals, (&rims, &frame), params);
    let (frame, asymmetry_mm) = symmetry::refine(mesh, &skin.open, frame);
    let density = density(points, &rims, &skin, params);
    let edge = mesh::edge_length_median(points, &triangles);
    let near_plane = |vertex: &u32| frame.place(&points[*vertex as usize]).x.abs() <= edge;
    let spread = Spread {
        points,
        triangles: &triangles,
        density: &density,
        areas: &mesh::mixed_voronoi_areas(points, &triangles),
        frame: &frame,
        skin: &skin,
        params,
        middle: skin.open.iter().copied().filter(near_plane).collect(),
    };
    let (starts, rings) = around.one_rings();
    let neighbors = |vertex: u32| &rings[starts[vertex as usize]..starts[vertex as usize + 1]];
    let scene = Scene { points, triangles: &triangles, neighbors: &neighbors, frame: &frame, skin: &skin };
    let (mut spots, mut names) = (Vec::new(), Vec::new());
    for feature in features::left_half(&scene, &rims, params) {
        set_feature(&scene, &spread, feature, &mut spots, &mut names);
    }
    spread.fill(&mut spots, params.count);
    if spots.len() < params.count {
        let (placed, least_distance_mm) = (spots.len(), params.least_distance_mm);
        return Err(Error::NoRoom { placed, count: params.count, least_distance_mm });
    }
    let markers = named(&spots, names, points, &frame);
    let vertices: Vec<u32> = markers.iter().map(|marker| marker.vertex).collect();
    Ok(Plan {
        least_distance_mm: least_distance(points, &vertices),
        largest_gap_mm: largest_gap(points, &triangles, &skin, &vertices),
        markers,
        frame,
        asymmetry_mm,
    })
}

/// How much a millimetre counts at each vertex.
fn density(points: &[Point3<f64>], rims: &Rims, skin: &Skin, params: &Params) -> Vec<f64> {
    let line =
        |rim: &[u32]| -> Vec<Point3<f64>> { rim.iter().map(|&vertex| points[vertex as usize]).collect() };
    let (lips, lids) = ([line(&rims.mouth)], [line(&rims.eyes[0]), line(&rims.eyes[1])]);
    let near = |loops: &[Vec<Point3<f64>>], point: &Point3<f64>| {
        let share = mesh::distance_to_loops(loops, point) / params.falloff_mm;
        (-share * share).exp()
    };
    let at = |point: &Point3<f64>| {
        let lips = (params.lip_density - 1.0) * near(&lips, point);
        let lids = (params.lid_density - 1.0) * near(&lids, point);
        1.0 + lips.max(lids)
    };
    let outskirts = skin.outskirts.iter().map(|&beside| if beside { params.outskirt_density } else { 1.0 });
    points.iter().zip(outskirts).map(|(point, outskirts)| at(point) * outskirts).collect()
}

/// Adds a feature of the left half and its mirror image.
fn set_feature(
    scene: &Scene<'_>,
    spread: &Spread<'_>,
    feature: features::Feature,
    spots: &mut Vec<Spot>,
    names: &mut Vec<String>,
) {
    let first = spots.len();
    let mut set = |vertex: u32, mirror: usize, name: String| {
        spots.push(Spot { vertex, mirror: Some(mirror), fixed: true });
        names.push(name);
    };
    if feature.middle {
        return set(feature.vertex, first, feature.name);
    }
    let image = symmetry::mirrored(scene.frame.place(&scene.points[feature.vertex as usize]));
    let frontal: Vec<u32> =
        (0..scene.points.len() as u32).filter(|&vertex| scene.skin.frontal[vertex as usize]).collect();
    let partner = spread
        .partner(feature.vertex)
        .or_else(|| symmetry::nearest(scene.points, &frontal, scene.frame, image).map(|(vertex, _)| vertex));
    set(feature.vertex, first + 1, format!("{}_l", feature.name));
    set(partner.unwrap_or(feature.vertex), first, format!("{}_r", feature.name));
}

/// Names for the markers beside the features, from the forehead down; mirror images share a number.
fn named(spots: &[Spot], features: Vec<String>, points: &[Point3<f64>], frame: &Frame) -> Vec<Planned> {
    let place = |spot: &Spot| frame.place(&points[spot.vertex as usize]);
    let mut rest: Vec<usize> =
        (features.len()..spots.len()).filter(|&i| spots[i].mirror.is_none_or(|mirror| mirror >= i)).collect();
    rest.sort_by(|&a, &b| place(&spots[b]).y.total_cmp(&place(&spots[a]).y).then(a.cmp(&b)));
    let mut order: Vec<(usize, String)> = features.into_iter().enumerate().collect();
    for (number, spot) in rest.into_iter().enumerate() {
        let id = format!("m{:02}", number + 1);
        match spots[spot].mirror {
            Some(mirror) if mirror != spot => {
                let (left, right) = if place(&spots[spot]).x > 0.0 { (spot, mirror) } else { (mirror, spot) };
                order.extend([(left, format!("{id}_l")), (right, format!("{id}_r"))]);
            }
            _ => order.push((spot, id)),
        }
    }
    let mut renamed = vec![0; spots.len()];
    order.iter().enumerate().for_each(|(new, (old, _))| renamed[*old] = new);
    let planned = |(old, marker): (usize, String)| {
        let mirror = spots[old].mirror.map(|mirror| renamed[mirror]);
        Planned { marker, vertex: spots[old].vertex, mirror }
    };
    order.into_iter().map(planned).collect()
}

fn least_distance(points: &[Point3<f64>], vertices: &[u32]) -> f64 {
    let at = |i: usize| points[vertices[i] as usize];
    let pairs = (0..vertices.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
    pairs.map(|(i, j)| (at(i) - at(j)).norm()).fold(f64::INFINITY, f64::min)
}

fn largest_gap(points: &[Point3<f64>], triangles: &[[u32; 3]], skin: &Skin, vertices: &[u32]) -> f64 {
    let distance = geodesic::distances(points, triangles, vertices);
    skin.open
        .iter()
        .map(|&vertex| distance[vertex as usize])
        .filter(|gap| gap.is_finite())
        .fold(0.0, f64::max)
}

//! From trajectories and picked vertices to a warp.

use crate::fit::{InterpolantFit, Pairs, fit_interpolant};
use crate::folding::folding;
use crate::likeness;
use crate::map::map_of;
use crate::params::FitParams;
use crate::rest::{self, RestPoint};
use crate::warning::{Warning, is_doubtful_scale};
use crate::{Error, Result};
use artifact::{Correspondence, FileRef, TakeRef, Trajectories, Warp, WarpFit};
use nalgebra::Point3;
use operators::{Inverse, InvertParams};
use std::collections::BTreeMap;

/// A leave-one-out error this many times the median, and above a floor in mm, makes a pick suspicious.
const SUSPICIOUS: (f64, f64) = (4.0, 3.0);

/// Where trajectories come from, as the warp refers to it.
#[derive(Debug, Clone, PartialEq)]
pub struct Source {
    /// The file.
    pub trajectories: FileRef,
    /// Its take, if known.
    pub take: Option<TakeRef>,
}

/// A fitted warp, and what a user should know about it.
#[derive(Debug, Clone, PartialEq)]
pub struct FittedWarp {
    /// The artifact.
    pub warp: Warp,
    /// What is doubtful, worst last.
    pub warnings: Vec<Warning>,
    /// Markers whose leave-one-out error is not defined: the others do not determine the polynomial.
    pub irreplaceable: Vec<String>,
}

/// Fits the correspondence warp c: mocap → face [BickelBotsch2007, Sec. 4.1, Eq. 1].
///
/// Centers are the markers in the rest frame (the frame most similar to the scan), values the vertices that they were
/// picked on. `positions`: the mesh that was picked on, #V points, mm.
///
/// # Errors
/// If fewer than four (quadratic: ten) markers can be used, two coincide, they lie on a line, or the correspondence was
/// picked on another mesh.
pub fn fit_warp(
    trajectories: &Trajectories,
    source: Source,
    correspondence: &Correspondence,
    positions: &[Point3<f64>],
    params: &FitParams,
) -> Result<FittedWarp> {
    params.check()?;
    let mut sites = Sites::of(trajectories, correspondence, positions, params)?;
    let pairs = |from, to, space| Pairs { markers: &sites.markers, from, to, space };
    let forward = fit_interpolant(pairs(&sites.mocap, &sites.face, "mocap space"), params.degree)?;
    let backward = fit_interpolant(pairs(&sites.face, &sites.mocap, "face space"), params.degree)?;
    let map = map_of(&forward.interpolant);
    let inverse = Inverse::of(map.clone(), map_of(&backward.interpolant), InvertParams::default());
    let folding = folding(&map, &inverse, &sites.face, positions, params.near_mm);
    let mut warnings = std::mem::take(&mut sites.warnings);
    warnings.extend(doubts(&sites, &forward, &backward));
    if let Some(&vertex) = folding.unreached.first() {
        warnings.push(Warning::Unreached { count: folding.unreached.len(), vertex });
    }
    if folding.smallest_determinant <= 0.0 {
        let place = folding.vertex.map_or("a marker".to_string(), |vertex| format!("vertex {vertex}"));
        warnings.push(Warning::Folded { determinant: folding.smallest_determinant, place });
    }
    let irreplaceable = sites.markers.iter().zip(&forward.leave_one_out_mm);
    let irreplaceable =
        irreplaceable.filter(|(_, error)| error.is_none()).map(|(id, _)| id.clone()).collect();
    let fit = sites.diagnostics(&forward, folding.smallest_determinant);
    let warp = Warp {
        face_from_mocap: forward.interpolant,
        mocap_from_face: backward.interpolant,
        markers: sites.markers,
        vertices: sites.vertices,
        mesh: correspondence.mesh.clone(),
        rest_frame: sites.rest_frame,
        trajectories: source.trajectories,
        take: source.take,
        fit,
    };
    Ok(FittedWarp { warp, warnings, irreplaceable })
}

fn doubts(sites: &Sites, forward: &InterpolantFit, backward: &InterpolantFit) -> Vec<Warning> {
    let scale = forward.similarity.scaling();
    let doubts = [
        fit_warnings(forward, "c"),
        fit_warnings(backward, "the map back, where c's inverse starts"),
        is_doubtful_scale(scale).then_some(Warning::Units { scale }),
        likeness::doubt(&sites.mocap, &sites.face, &forward.similarity),
        suspicious(&sites.markers, &forward.leave_one_out_mm),
    ];
    doubts.into_iter().flatten().collect()
}

fn fit_warnings(fit: &InterpolantFit, of: &'static str) -> Option<Warning> {
    let (rank, terms) = (fit.polynomial_rank, fit.polynomial_terms);
    (rank < terms).then_some(Warning::TermsDropped { rank, terms, of })
}

/// The marker with the largest leave-one-out error, if it stands out.
fn suspicious(markers: &[String], errors: &[Option<f64>]) -> Option<Warning> {
    let mut known: Vec<(f64, &String)> =
        markers.iter().zip(errors).filter_map(|(marker, error)| Some(((*error)?, marker))).collect();
    known.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (&(error_mm, marker), median_mm) = (known.last()?, known[known.len() / 2].0);
    let stands_out = error_mm > SUSPICIOUS.0 * median_mm && error_mm > SUSPICIOUS.1;
    stands_out.then(|| Warning::Suspicious { marker: marker.clone(), error_mm, median_mm })
}

/// The pairs that can be used.
struct Sites {
    rest_frame: i64,
    markers: Vec<String>,
    vertices: Vec<u32>,
    mocap: Vec<Point3<f64>>,
    face: Vec<Point3<f64>>,
    left_out: BTreeMap<String, String>,
    warnings: Vec<Warning>,
}

impl Sites {
    fn of(
        trajectories: &Trajectories,
        correspondence: &Correspondence,
        positions: &[Point3<f64>],
        params: &FitParams,
    ) -> Result<Self> {
        let mut left_out = BTreeMap::new();
        let (mut tracks, mut pairs, mut targets) = (Vec::new(), Vec::new(), Vec::new());
        for pair in &correspondence.pairs {
            let target = positions.get(pair.vertex as usize);
            let same = |target: &&Point3<f64>| (**target - Point3::from(pair.position_mm)).norm() < 1e-6;
            let Some(target) = target.filter(same) else {
                return Err(Error::OtherMesh { marker: pair.marker.clone(), vertex: pair.vertex });
            };
            match trajectories.marker(&pair.marker) {
                Some(track) => {
                    tracks.push(track);
                    pairs.push(pair);
                    targets.push(*target);
                }
                None => _ = left_out.insert(pair.marker.clone(), "not in the trajectories".to_string()),
            }
        }
        let rest = rest::choose(trajectories, &tracks, &targets, params.rest_frame)?;
        let rest_frame = trajectories.frames[rest].frame;
        let mut sites = Self::empty(rest_frame, left_out);
        for ((&track, pair), target) in tracks.iter().zip(pairs).zip(targets) {
            let point = rest::rest_point(trajectories, rest, track, params.fill_frames);
            sites.place(&pair.marker, pair.vertex, point, target, params.fill_frames);
        }
        sites.name_unpicked(trajectories, correspondence);
        Ok(sites)
    }

    fn empty(rest_frame: i64, left_out: BTreeMap<String, String>) -> Self {
        let (markers, vertices, mocap, face) = Default::default();
        let warning = |(marker, reason): (&String, &String)| Warning::LeftOut {
            marker: marker.clone(),
            reason: reason.clone(),
        };
        let warnings = left_out.iter().map(warning).collect();
        Self { rest_frame, markers, vertices, mocap, face, left_out, warnings }
    }

    fn place(&mut self, marker: &str, vertex: u32, at: RestPoint, target: Point3<f64>, reach: u32) {
        let frame = self.rest_frame;
        let marker = marker.to_string();
        let Some(point) = at.point() else {
            let reason = format!("missing in the rest frame {frame} and within {reach} frames of it");
            self.warnings.push(Warning::LeftOut { marker: marker.clone(), reason: reason.clone() });
            self.left_out.insert(marker, reason);
            return;
        };
        if matches!(at, RestPoint::Filled(_)) {
            self.warnings.push(Warning::FilledAtRest { marker: marker.clone(), frame });
        }
        self.markers.push(marker);
        self.vertices.push(vertex);
        self.mocap.push(point);
        self.face.push(target);
    }

    /// Markers that were not picked are no reason to worry, but the warp says so.
    fn name_unpicked(&mut self, trajectories: &Trajectories, correspondence: &Correspondence) {
        let picked = |id: &&String| correspondence.pairs.iter().any(|pair| pair.marker == **id);
        for id in trajectories.header.markers.iter().filter(|id| !picked(id)) {
            self.left_out.insert(id.clone(), "not picked on the scan".to_string());
        }
    }

    fn diagnostics(&self, fit: &InterpolantFit, smallest_determinant: f64) -> WarpFit {
        let residual = |(from, to): (&Point3<f64>, &Point3<f64>)| (to - fit.similarity * from).norm();
        let residuals: Vec<f64> = self.mocap.iter().zip(&self.face).map(residual).collect();
        let square: f64 = residuals.iter().map(|residual| residual * residual).sum();
        let by_marker = self.markers.iter().cloned();
        WarpFit {
            condition: fit.condition,
            polynomial_rank: fit.polynomial_rank,
            similarity_rms_mm: (square / residuals.len() as f64).sqrt(),
            similarity_scale: fit.similarity.scaling(),
            leave_one_out_mm: by_marker
                .clone()
                .zip(&fit.leave_one_out_mm)
                .filter_map(|(marker, error)| Some((marker, (*error)?)))
                .collect(),
            similarity_residual_mm: by_marker.zip(residuals).collect(),
            smallest_determinant,
            left_out: self.left_out.clone(),
        }
    }
}

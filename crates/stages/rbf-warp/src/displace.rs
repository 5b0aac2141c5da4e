//! Marker motion as displacements of handle vertices: `d_{i,t} = c(m_{i,t}) − f_{i,0}` [BickelBotsch2007, Sec. 4.1].

use crate::map::map_of;
use artifact::{FileRef, Handle, HandleFrame, HandlesHeader, MarkerFrame, MarkerHeader, TakeRef, Warp};
use nalgebra::Point3;
use operators::RbfMap;

/// Maps frames of markers through a warp.
#[derive(Debug, Clone)]
pub struct Displacer {
    map: RbfMap,
    /// Per handle the marker's index in the frames.
    tracks: Vec<Option<usize>>,
    /// Per handle f_{i,0} = c(m_{i,0}), mm.
    rest: Vec<Point3<f64>>,
}

impl Displacer {
    /// Prepares for frames with this header. The rest positions f_{i,0} are taken as c at its own centers, which equals
    /// the vertices up to rounding and makes the rest frame's displacements exactly zero.
    #[must_use]
    pub fn new(warp: &Warp, markers: &MarkerHeader) -> Self {
        let map = map_of(&warp.face_from_mocap);
        let mut rest = map.centers();
        map.map_all(&mut rest);
        let track = |id: &String| markers.markers.iter().position(|marker| marker == id);
        Self { map, tracks: warp.markers.iter().map(track).collect(), rest }
    }

    /// Ids of the warp's markers that the frames do not have; their displacements are missing throughout.
    #[must_use]
    pub fn absent<'a>(&self, warp: &'a Warp) -> Vec<&'a str> {
        let absent = warp.markers.iter().zip(&self.tracks).filter(|(_, track)| track.is_none());
        absent.map(|(id, _)| id.as_str()).collect()
    }

    /// Displacements in face space, mm; a missing marker's is missing.
    #[must_use]
    pub fn frame(&self, frame: &MarkerFrame) -> HandleFrame {
        let at = |track: &Option<usize>| track.and_then(|track| frame.points[track]);
        let points: Vec<Option<Point3<f64>>> = self.tracks.iter().map(at).collect();
        let mut images: Vec<Point3<f64>> = points.iter().flatten().copied().collect();
        self.map.map_all(&mut images);
        let mut images = images.into_iter();
        let displacement = |(point, rest): (&Option<Point3<f64>>, &Point3<f64>)| {
            // Only points that are there have an image.
            point.and_then(|_| images.next()).map(|image| image - rest)
        };
        let displacements = points.iter().zip(&self.rest).map(displacement).collect();
        HandleFrame { frame: frame.frame, displacements, weights: vec![None; self.tracks.len()] }
    }
}

/// The header of displacements made from markers with this header by a warp.
#[must_use]
pub fn handles_header(warp: &Warp, warp_file: FileRef, markers: &MarkerHeader) -> HandlesHeader {
    let handle = |(marker, &vertex): (&String, &u32)| Handle { marker: marker.clone(), vertex };
    HandlesHeader {
        mesh: warp.mesh.clone(),
        rate: markers.rate,
        handles: warp.markers.iter().zip(&warp.vertices).map(handle).collect(),
        take: markers.take.clone(),
        warp: Some(warp_file),
    }
}

/// Why a warp may not be used for these markers: it is neither fitted to this very file nor to a take of the same
/// session (markers keep their place on the skin within a session only). `None` = it may.
#[must_use]
pub fn mismatch(warp: &Warp, markers: &FileRef, take: Option<&TakeRef>) -> Option<String> {
    if !markers.sha256.is_empty() && markers.sha256 == warp.trajectories.sha256 {
        return None;
    }
    match (&warp.take, take) {
        (Some(fitted), Some(given)) if fitted.sha256 == given.sha256 || fitted.session == given.session => {
            None
        }
        (Some(fitted), Some(given)) => Some(format!(
            "the warp was fitted to {fitted} of session {}, the markers are of {given} of session {}",
            fitted.session, given.session
        )),
        _ => Some(format!(
            "the warp was fitted to {}, the markers are {markers}, and nothing says that both are of one session",
            warp.trajectories
        )),
    }
}

//! Where skin lies in the picture.

use crate::acquire::{Face, Region};
use crate::frame::Frame;
use crate::mask::{hull, inside};
use crate::plane::Plane;

/// Where skin lies: within the landmarks, without the parts that are none.
pub(crate) fn outline(face: &Face, frame: &Frame, region: &Region) -> Plane {
    let [width, height] = frame.size;
    let places: Vec<[f64; 2]> = face.pairs.iter().map(|pair| pair.from).collect();
    let mut outline = inside(&hull(&places), frame.first, width, height);
    if !region.masks {
        return outline;
    }
    let place = |id: &String| face.pairs.iter().find(|pair| pair.id == *id).map(|pair| pair.from);
    for (ids, out) in &face.parts {
        let line: Vec<[f64; 2]> = ids.iter().filter_map(place).collect();
        let center =
            [0, 1].map(|axis| line.iter().map(|at| at[axis]).sum::<f64>() / line.len().max(1) as f64);
        let pushed: Vec<[f64; 2]> = line.iter().map(|at| outwards(*at, center, out * face.io_px)).collect();
        if pushed.len() > 2 {
            let part = inside(&hull(&pushed), frame.first, width, height);
            outline = outline.with(&part, |outline, part| outline * (1.0 - part));
        }
    }
    outline
}

/// A place further from a centre.
fn outwards(at: [f64; 2], center: [f64; 2], by: f64) -> [f64; 2] {
    let away = [at[0] - center[0], at[1] - center[1]];
    let length = away[0].hypot(away[1]).max(1e-9);
    [0, 1].map(|axis| at[axis] + by * away[axis] / length)
}

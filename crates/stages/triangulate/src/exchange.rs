//! Labels exchanged in the images of one camera: the camera is left out of both markers, and each is seen where the other
//! should be.

use crate::Swap;
use crate::point::Scale;
use crate::solve::{Rig, Solved};
use nalgebra::Vector2;

/// An exchange that shows again after so many frames is another one …
const FORGOTTEN: i64 = 25;
/// … or after so many, if both markers were where they should be: views of little weight pass as such.
const OVER: i64 = 5;

/// A marker that a camera saw, but elsewhere.
struct Stray {
    camera: usize,
    marker: usize,
    /// px
    expected: Vector2<f64>,
    /// px
    seen: Vector2<f64>,
}

/// An exchange, in the course of time.
struct Exchange {
    camera: usize,
    markers: [usize; 2],
    first: i64,
    last: i64,
}

/// Watches frames in their order.
#[derive(Default)]
pub(crate) struct ExchangeWatch {
    open: Vec<Exchange>,
    closed: Vec<Exchange>,
}

impl ExchangeWatch {
    pub(crate) fn see(&mut self, frame: &Solved, rig: &Rig, scale: Scale) {
        self.close(frame);
        let strays = strays(frame, rig);
        for (i, a) in strays.iter().enumerate() {
            for b in strays[i + 1..].iter().filter(|b| b.camera == a.camera) {
                let off = (a.seen - b.expected).norm().max((b.seen - a.expected).norm());
                if off < scale.outlier {
                    self.note(frame.frame, a.camera, [a.marker, b.marker]);
                }
            }
        }
    }

    /// Ends exchanges that have not shown for long, or whose markers are where they should be.
    fn close(&mut self, frame: &Solved) {
        let is_used = |marker: usize, camera: usize| {
            frame.fix(marker).is_some_and(|fix| fix.used.iter().any(|(used, _)| *used == camera))
        };
        let is_over = |exchange: &mut Exchange| {
            let since = frame.frame - exchange.last;
            let is_well = || exchange.markers.iter().all(|&marker| is_used(marker, exchange.camera));
            since > FORGOTTEN || (since > OVER && is_well())
        };
        self.closed.extend(self.open.extract_if(.., is_over));
    }

    fn note(&mut self, frame: i64, camera: usize, markers: [usize; 2]) {
        let is_it = |exchange: &&mut Exchange| exchange.camera == camera && exchange.markers == markers;
        match self.open.iter_mut().find(is_it) {
            Some(exchange) => exchange.last = frame,
            None => self.open.push(Exchange { camera, markers, first: frame, last: frame }),
        }
    }

    /// What was found, in the order of frames.
    pub(crate) fn finish(mut self, cameras: &[String], markers: &[String]) -> Vec<Swap> {
        self.closed.append(&mut self.open);
        self.closed.sort_by_key(|exchange| (exchange.first, exchange.camera, exchange.markers));
        let swap = |exchange: &Exchange| Swap {
            markers: exchange.markers.map(|marker| markers[marker].clone()),
            camera: Some(cameras[exchange.camera].clone()),
            first: exchange.first,
            last: exchange.last,
        };
        self.closed.iter().map(swap).collect()
    }
}

/// What the cameras saw that were left out.
fn strays(frame: &Solved, rig: &Rig) -> Vec<Stray> {
    let dropped =
        frame.fixes().flat_map(|(marker, fix)| fix.dropped.iter().map(move |off| (marker, fix, off)));
    let stray = |(marker, fix, (camera, off)): (usize, &crate::point::Fix, &(usize, Vector2<f64>))| {
        let expected = rig.views[*camera].pixel(&fix.position)?;
        Some(Stray { camera: *camera, marker, expected, seen: expected + off })
    };
    dropped.filter_map(stray).collect()
}

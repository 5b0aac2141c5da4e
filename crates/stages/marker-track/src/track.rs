//! What is remembered of a marker in one camera.

use crate::Params;
use crate::dots::Dot;
use crate::tracker::Hint;

/// How fast the usual area follows a dot that is all there, and one that seems partly hidden.
const AREA_RATES: [f64; 2] = [0.1, 0.005];
/// A dot within these shares of its usual area is all there.
const WHOLE: [f64; 2] = [0.8, 1.3];
/// The gate of a hidden marker grows by this much per frame, px.
const GATE_GROWTH: f64 = 0.5;
/// A hidden marker's confidence halves in this many frames.
const HALF_LIFE: f64 = 5.0;
/// No confidence is less.
const LEAST_CONFIDENCE: f64 = 0.01;
/// Dots that touch are shared out by guess.
const SHARED_CONFIDENCE: f64 = 0.7;
/// A marker that was hidden takes a dot only if no other marker is expected in its gate around the dot, nor nearer than this many
/// times its own guide: where one passes behind the other, the dot is that of the one in front.
const UNSURE: f64 = 1.5;
/// Radius of a dot that was never seen, px.
const UNSEEN_RADIUS: f64 = 3.0;

/// What is remembered of a marker.
#[derive(Debug, Clone, Default)]
pub(crate) struct Track {
    /// Whether it was ever found, and is in the image.
    pub(crate) alive: bool,
    /// px
    pub(crate) at: [f64; 2],
    /// px per frame
    velocity: [f64; 2],
    /// Its usual area, px².
    pub(crate) area: Option<f64>,
    /// The largest share of paint that its pixels usually have.
    pub(crate) peak: Option<f64>,
    /// Its area when it was last seen, px².
    last_area: Option<f64>,
    /// Frames since it was last seen.
    pub(crate) hidden: f64,
    pub(crate) confidence: f64,
    /// Where it was when it was labelled, px: with the neighbours' places then, it says where it belongs among them.
    pub(crate) home: Option<[f64; 2]>,
}

/// Where a marker should be.
#[derive(Debug, Clone)]
pub(crate) struct Prediction {
    /// px
    pub(crate) at: [f64; 2],
    /// How far from there it is looked for, px.
    pub(crate) gate: f64,
    /// Usual radius of the dot, px.
    pub(crate) radius: f64,
    /// Its area as of late, px².
    pub(crate) area: f64,
    /// Whether 3D markers say so.
    pub(crate) guided: bool,
    /// Whether the dot can be seen; known of guided markers only.
    pub(crate) facing: bool,
}

impl Prediction {
    pub(crate) fn at(at: [f64; 2], gate: f64) -> Self {
        let area = std::f64::consts::PI * UNSEEN_RADIUS * UNSEEN_RADIUS;
        Self { at, gate, radius: UNSEEN_RADIUS, area, guided: false, facing: true }
    }

    /// Whether a dot that another marker finds `off` from its guide, of its gate, may be this one's instead: nearer to it although
    /// it faces away, or, if the other was hidden just now, in reach at all.
    pub(crate) fn owns(&self, dot: [f64; 2], off: f64, gate: f64, unsure: bool) -> bool {
        let away = (dot[0] - self.at[0]).hypot(dot[1] - self.at[1]);
        (!self.facing && away < off) || (unsure && away < gate.max(UNSURE * off))
    }

    pub(crate) fn reaches(&self, place: [f64; 2]) -> bool {
        let off = [place[0] - self.at[0], place[1] - self.at[1]];
        self.facing && off[0] * off[0] + off[1] * off[1] <= self.gate * self.gate
    }
}

impl Track {
    /// Puts the marker where a person saw it.
    pub(crate) fn set(&mut self, at: [f64; 2]) {
        let home = self.home;
        *self = Self { alive: true, at, confidence: LEAST_CONFIDENCE, hidden: 1.0, home, ..Self::default() };
    }

    /// Whether it is worth being looked for without a guide where others have one: it was seen just before, or is labelled.
    pub(crate) fn is_known(&self) -> bool {
        self.hidden == 0.0 || self.home.is_some()
    }

    fn radius(&self) -> f64 {
        self.area.map_or(UNSEEN_RADIUS, |area| (area / std::f64::consts::PI).sqrt())
    }

    /// Its area when it was last seen, if that was in the image before, or else the usual one, px².
    fn late_area(&self) -> f64 {
        let late = self.last_area.filter(|_| self.hidden == 0.0);
        late.unwrap_or(std::f64::consts::PI * self.radius() * self.radius())
    }

    /// At constant velocity; a hidden marker stands still until its neighbours tell.
    pub(crate) fn predicted(&self, frames: f64) -> Prediction {
        let steps = if self.hidden > 0.0 { 0.0 } else { frames };
        let at = std::array::from_fn(|k| self.at[k] + steps * self.velocity[k]);
        Prediction { radius: self.radius(), area: self.late_area(), ..Prediction::at(at, 0.0) }
    }

    /// Where 3D markers say.
    pub(crate) fn guided(&self, hint: Hint, gate: f64) -> Prediction {
        // What is seen, or was labelled, can be seen, whatever the patch of markers around it says.
        let facing = hint.facing || self.home.is_some() || (self.alive && self.hidden == 0.0);
        let (radius, area) = (self.radius(), self.late_area());
        Prediction { at: hint.at, gate, radius, area, guided: true, facing }
    }

    /// How far from its prediction the marker is looked for, with the next one `spacing` away.
    pub(crate) fn gate(&self, spacing: f64, frames: f64, params: &Params) -> f64 {
        let most = params.most_gate_px.max(params.least_gate_px);
        let open = (params.gate * spacing).clamp(params.least_gate_px, most);
        match self.hidden > 0.0 {
            true => (params.least_gate_px + GATE_GROWTH * self.hidden).min(open),
            false => open * frames.max(1.0).sqrt(),
        }
    }

    pub(crate) fn see(&mut self, dot: &Dot, prediction: &Prediction, frames: f64) {
        let at = dot.spot.at;
        let off = (at[0] - prediction.at[0]).hypot(at[1] - prediction.at[1]) / prediction.gate;
        let known = self.alive && self.hidden == 0.0 && frames > 0.0;
        self.velocity = match known {
            true => std::array::from_fn(|k| (at[k] - self.at[k]) / frames),
            false => [0.0; 2],
        };
        let share = self.area.map_or(1.0, |usual| dot.spot.area / usual);
        let trust = if dot.shared { SHARED_CONFIDENCE } else { 1.0 };
        // An unexpected place makes unsure, but what is seen is seen.
        let surprise = 0.5 + 0.5 * (-2.0 * off * off).exp();
        self.confidence = (share.min(1.0) * trust * surprise).clamp(LEAST_CONFIDENCE, 1.0);
        if !dot.shared {
            let whole = (WHOLE[0]..=WHOLE[1]).contains(&share);
            let rate = AREA_RATES[usize::from(!whole)];
            self.area = Some(self.area.map_or(dot.spot.area, |usual| usual + rate * (dot.spot.area - usual)));
            self.peak = Some(self.peak.map_or(dot.peak, |usual| usual + rate * (dot.peak - usual)));
        }
        (self.alive, self.at, self.hidden) = (true, at, 0.0);
        self.last_area = Some(dot.spot.area);
    }

    /// The marker is not to be seen; it goes with its prediction, or where its neighbours go.
    pub(crate) fn miss(&mut self, prediction: &Prediction, frames: f64, neighbors: Option<[f64; 2]>) {
        if !self.alive && !prediction.guided {
            return;
        }
        let by_neighbors = neighbors.filter(|_| !prediction.guided && self.alive);
        self.at = match by_neighbors {
            Some(by) => std::array::from_fn(|k| self.at[k] + by[k]),
            None => prediction.at,
        };
        self.alive = true;
        self.hidden += frames.max(1.0);
        self.velocity = [0.0; 2];
        self.confidence = (0.5 * (-self.hidden / HALF_LIFE).exp2()).max(LEAST_CONFIDENCE);
    }
}

//! One wrinkle from what all cameras saw of it.

use crate::line::{Line, arcs};
use crate::params::Params;
use crate::section::Lifted;
use crate::track::Track;
use nalgebra::Point3;

/// A place of a merged wrinkle; near the surface, not on it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sample {
    /// The place over the bottom, mm.
    pub(crate) foot: Point3<f64>,
    /// A triangle close to it.
    pub(crate) face: u32,
    pub(crate) w_mm: f64,
    pub(crate) d_mm: f64,
    pub(crate) epsilon: f64,
    pub(crate) kappa: f64,
}

/// A merged wrinkle.
#[derive(Debug, Clone, Default)]
pub(crate) struct Merged {
    pub(crate) samples: Vec<Sample>,
    /// Where two cameras saw a place: how far apart they put it, mm.
    pub(crate) apart_mm: Vec<f64>,
    /// Lengths without a section that were bridged, and that split the wrinkle, mm.
    pub(crate) bridged_mm: f64,
    pub(crate) split_mm: f64,
}

/// A track over the common arc length.
struct Span {
    camera: usize,
    /// Rising.
    places: Vec<f64>,
    points: Vec<Lifted>,
}

/// What a span says at a place.
#[derive(Clone, Copy)]
struct Word {
    camera: usize,
    sample: Sample,
    /// Weights of the place, and of width and depth.
    place: f64,
    shape: f64,
    /// 0 at an end beyond which another span goes on, 1 inside.
    share: f64,
}

/// Merges the tracks of a wrinkle [BickelBotsch2007, Sec. 5.3]: along the longest one, each point weighs as much as its camera knows of it.
/// Where one camera's part ends and another's goes on, its weight falls to zero over `blend_mm`, so that nothing jumps.
///
/// Points lie every `step_mm`, or a little closer so that both ends are among them. Gaps up to `gap_mm` are bridged; in longer ones d is 0.
pub(crate) fn merged(tracks: Vec<Track>, params: &Params) -> Merged {
    let mut spans = spans(tracks);
    let (low, high) = spans.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), span| {
        (low.min(span.places[0]), high.max(span.places[span.places.len() - 1]))
    });
    if spans.is_empty() || high <= low {
        return Merged::default();
    }
    spans.iter_mut().for_each(|span| span.snap(low, high, params.blend_mm));
    let count = ((high - low) / params.step_mm).ceil().max(1.0) as usize;
    let step = (high - low) / count as f64;
    let mut merged = Merged::default();
    let mut samples: Vec<Option<Sample>> = Vec::with_capacity(count + 1);
    for i in 0..=count {
        let place = if i == count { high } else { low + i as f64 * step };
        let mut words = spoken(&spans, place, params);
        merged.apart_mm.extend(reconcile(&mut words, params));
        samples.push(blended(&words));
    }
    let length = |count: usize| count as f64 * step;
    fill(&mut samples, |count| {
        let bridged = length(count + 1) <= params.gap_mm + step;
        *(if bridged { &mut merged.bridged_mm } else { &mut merged.split_mm }) += length(count);
        bridged
    });
    merged.samples = samples.into_iter().flatten().collect();
    merged
}

/// Tracks over the arc length of the longest, all in its direction.
fn spans(mut tracks: Vec<Track>) -> Vec<Span> {
    let feet = |track: &Track| track.points.iter().map(|point| point.foot).collect::<Vec<_>>();
    let lines: Vec<Line> = tracks.iter().map(|track| Line::new(feet(track))).collect();
    let longer = |a: &usize, b: &usize| lines[*a].length().total_cmp(&lines[*b].length()).then(b.cmp(a));
    let Some(longest) = (0..lines.len()).max_by(longer) else { return Vec::new() };
    let reference = &lines[longest];
    let span = |(i, track): (usize, &mut Track)| {
        let mut places: Vec<f64> = match i == longest {
            true => arcs(&feet(track)),
            false => feet(track).iter().filter_map(|foot| Some(reference.locate(foot)?.arc)).collect(),
        };
        if places.first() > places.last() {
            places.reverse();
            track.points.reverse();
            track.points.iter_mut().for_each(|point| point.kappa = 0.0 - point.kappa);
        }
        rising(track.camera, &places, &track.points)
    };
    tracks.iter_mut().enumerate().map(span).filter(|span| span.places.len() > 1).collect()
}

/// The points that go forwards.
fn rising(camera: usize, places: &[f64], points: &[Lifted]) -> Span {
    let mut span = Span { camera, places: Vec::new(), points: Vec::new() };
    for (place, point) in places.iter().zip(points) {
        if span.places.last().is_none_or(|last| place - last > 1e-6) {
            span.places.push(*place);
            span.points.push(*point);
        }
    }
    span
}

/// Ends so close together are one end: how far paint shows it differs from camera to camera, mm.
const SNAP_MM: f64 = 2.0;

impl Span {
    /// Stretches a span that ends a little before the wrinkle does, so that their ends fall together; over `blend_mm`, so that places
    /// keep their order.
    fn snap(&mut self, low: f64, high: f64, blend_mm: f64) {
        let [first, last] = self.ends();
        let reach = blend_mm.max(2.0 * SNAP_MM).min(0.5 * (last - first));
        let stretch = |gap: f64| if gap <= SNAP_MM.min(0.5 * reach) { gap } else { 0.0 };
        let (before, after) = (stretch(first - low), stretch(high - last));
        let share = |from_end: f64| (1.0 - from_end / reach).max(0.0);
        for place in &mut self.places {
            *place += after * share(last - *place) - before * share(*place - first);
        }
        // Exactly, so that rounding makes no second end.
        if let [one, .., other] = &mut self.places[..] {
            *one = if before > 0.0 { low } else { *one };
            *other = if after > 0.0 { high } else { *other };
        }
    }

    fn ends(&self) -> [f64; 2] {
        [self.places[0], self.places[self.places.len() - 1]]
    }

    fn covers(&self, place: f64) -> bool {
        let [low, high] = self.ends();
        (low..=high).contains(&place)
    }

    fn word(&self, place: f64, share: f64) -> Word {
        let after = self.places.partition_point(|x| *x <= place).clamp(1, self.places.len() - 1);
        let (a, b) = (&self.points[after - 1], &self.points[after]);
        let part = (place - self.places[after - 1]) / (self.places[after] - self.places[after - 1]);
        let mix = |value: fn(&Lifted) -> f64| value(a) + part * (value(b) - value(a));
        let sample = Sample {
            foot: a.foot + (b.foot - a.foot) * part,
            face: if part < 0.5 { a.spot.face } else { b.spot.face },
            w_mm: mix(|point| point.w_mm),
            d_mm: mix(|point| point.d_mm),
            epsilon: mix(|point| point.epsilon),
            kappa: mix(|point| point.kappa),
        };
        let [placed, shaped] = [mix(|point| point.place_mm), mix(|point| point.shape_rel)];
        Word {
            camera: self.camera,
            sample,
            place: placed.max(1e-6).powi(-2),
            shape: shaped.max(1e-6).powi(-2),
            share,
        }
    }
}

fn spoken(spans: &[Span], place: f64, params: &Params) -> Vec<Word> {
    let share = |span: &Span| {
        let goes_on = |end: f64, outwards: f64| {
            spans.iter().any(|other| {
                let far = other.ends()[usize::from(outwards > 0.0)];
                other.camera != span.camera && other.covers(end) && outwards * (far - end) > 1e-6
            })
        };
        let [low, high] = span.ends();
        let taper = |end: f64, outwards: f64| match goes_on(end, outwards) {
            true => ((place - end).abs() / params.blend_mm).min(1.0),
            false => 1.0,
        };
        taper(low, -1.0) * taper(high, 1.0)
    };
    spans.iter().filter(|span| span.covers(place)).map(|span| span.word(place, share(span))).collect()
}

/// Where cameras are farther apart than `disagree_mm`, the less sure ones lose weight. Gives how far they are apart.
fn reconcile(words: &mut [Word], params: &Params) -> Vec<f64> {
    let weight = |word: &Word| word.place * word.share;
    let Some(surest) = words.iter().copied().reduce(|a, b| if weight(&b) > weight(&a) { b } else { a })
    else {
        return Vec::new();
    };
    let mut apart = Vec::new();
    for word in words.iter_mut().filter(|word| word.camera != surest.camera) {
        let off = (word.sample.foot - surest.sample.foot).norm();
        apart.push(off);
        word.share /= 1.0 + (off / params.disagree_mm).powi(4);
    }
    apart
}

/// The mean of what cameras say. Where one saw a valley and another none, the form is that of the first; the other's word counts for
/// depths that it could have missed.
fn blended(words: &[Word]) -> Option<Sample> {
    let first = words.first()?;
    let is_open = |word: &Word| word.sample.d_mm > 0.0;
    let has_form = |word: &&Word| is_open(word) || !words.iter().any(is_open);
    let mut sums = [0.0; 2];
    let mut foot = nalgebra::Vector3::zeros();
    let mut shape = [0.0; 4];
    let mut nearest = (0.0, first.sample.face);
    // Where all shares are zero they count alike.
    let weights = |word: &Word| [word.place, word.shape].map(|weight| weight * word.share.max(1e-9));
    for word in words {
        let weight = weights(word)[0];
        sums[0] += weight;
        foot += word.sample.foot.coords * weight;
        if weight > nearest.0 {
            nearest = (weight, word.sample.face);
        }
    }
    for word in words.iter().filter(has_form) {
        let (weight, Sample { w_mm, d_mm, epsilon, kappa, .. }) = (weights(word)[1], word.sample);
        sums[1] += weight;
        let values = [w_mm, d_mm, epsilon, kappa];
        (0..4).for_each(|i| shape[i] += weight * values[i]);
    }
    let [w_mm, d_mm, epsilon, kappa] = shape.map(|sum| sum / sums[1]);
    let flat = words.iter().filter(|word| !is_open(word)).map(|word| word.share).fold(0.0, f64::max);
    let d_mm = d_mm * (1.0 - flat * (1.0 - credible(d_mm, w_mm)));
    let d_mm = if d_mm < FLAT_MM { 0.0 } else { d_mm };
    Some(Sample { foot: (foot / sums[0]).into(), face: nearest.1, w_mm, d_mm, epsilon, kappa })
}

/// A camera that sees no valley could have missed none that is deeper than the second of these, as d/w, and any that is shallower than
/// the first: there flat skin, too, reads as a valley.
const SHALLOW: [f64; 2] = [0.1, 0.2];

/// What is shallower is rounding.
const FLAT_MM: f64 = 1e-6;

/// How far a valley is believed against a camera that sees none: from 0 to 1 over the doubtful depths.
fn credible(d_mm: f64, w_mm: f64) -> f64 {
    let x = ((d_mm / w_mm.max(1e-9) - SHALLOW[0]) / (SHALLOW[1] - SHALLOW[0])).clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

/// Fills what no camera saw from what lies beside it. `is_bridged` says of so many missing points whether the valley goes on there; else
/// its depth is 0.
fn fill(samples: &mut [Option<Sample>], mut is_bridged: impl FnMut(usize) -> bool) {
    let known: Vec<usize> = (0..samples.len()).filter(|&i| samples[i].is_some()).collect();
    for pair in known.windows(2).filter(|pair| pair[1] > pair[0] + 1) {
        let (Some(a), Some(b)) = (samples[pair[0]], samples[pair[1]]) else { continue };
        let bridged = is_bridged(pair[1] - pair[0] - 1);
        for i in pair[0] + 1..pair[1] {
            let share = (i - pair[0]) as f64 / (pair[1] - pair[0]) as f64;
            let mix = |from: f64, to: f64| from + share * (to - from);
            samples[i] = Some(Sample {
                foot: a.foot + (b.foot - a.foot) * share,
                face: if share < 0.5 { a.face } else { b.face },
                w_mm: mix(a.w_mm, b.w_mm),
                d_mm: if bridged { mix(a.d_mm, b.d_mm) } else { 0.0 },
                epsilon: mix(a.epsilon, b.epsilon),
                kappa: mix(a.kappa, b.kappa),
            });
        }
    }
}

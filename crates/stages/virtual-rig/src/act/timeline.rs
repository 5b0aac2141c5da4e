//! Events in time.

use super::band::Band;
use super::presets::{Parts, SPEECH_NAME, resolve, resolve_speech};
use super::{Performance, Source, refuse};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Something that the face does once: it comes, stays, and goes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Event {
    /// A shape of the body, or a preset: `brow_raise`, `frown`, `smile`, `squint`, `jaw`, `speech`, `blink` …
    pub action: String,
    /// When it begins, s.
    pub start_s: f64,
    /// How long it takes to come, s.
    #[serde(default = "quarter")]
    pub rise_s: f64,
    /// How long it stays, s.
    #[serde(default)]
    pub hold_s: f64,
    /// How long it takes to go, s.
    #[serde(default = "quarter")]
    pub fall_s: f64,
    /// How strong it becomes, 0 to 1.
    #[serde(default = "one")]
    pub strength: f64,
}

fn quarter() -> f64 {
    0.25
}

fn one() -> f64 {
    1.0
}

/// What a face does: events, in any order, also at the same time.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Timeline {
    /// What happens when.
    pub events: Vec<Event>,
    /// Other seeds speak otherwise.
    pub seed: u64,
}

/// Frequencies of speech, Hz: jaw and lips make two to six syllables a second.
const SPEECH_HZ: [f64; 2] = [2.0, 6.0];
/// Nothing comes or goes in less, s.
const FASTEST_S: f64 = 0.005;

impl Event {
    /// How much of the event there is at a time: 0 to `strength`, with two continuous derivatives.
    #[must_use]
    pub fn envelope(&self, time_s: f64) -> f64 {
        let since = time_s - self.start_s;
        let left = self.rise_s + self.hold_s + self.fall_s - since;
        self.strength * ease(since / self.rise_s) * ease(left / self.fall_s)
    }

    fn check(&self, place: &str) -> Result<(), crate::Error> {
        let rule = |name: &str, value: f64, holds: bool, says: &str| match holds {
            true => Ok(()),
            false => Err(refuse(format!("{place}.{name}"), format!("{value} {says}"))),
        };
        rule("start_s", self.start_s, self.start_s.is_finite(), "is no time")?;
        for (name, value) in [("rise_s", self.rise_s), ("fall_s", self.fall_s)] {
            let says = format!("s is too fast or no duration; say {FASTEST_S} or more");
            rule(name, value, value >= FASTEST_S && value.is_finite(), &says)?;
        }
        rule("hold_s", self.hold_s, self.hold_s >= 0.0 && self.hold_s.is_finite(), "s is no duration")?;
        rule("strength", self.strength, (0.0..=1.0).contains(&self.strength), "is not from 0 to 1")
    }
}

impl Timeline {
    /// The same with one more event: it begins at `start_s`, takes `[rise, hold, fall]` seconds.
    #[must_use]
    pub fn with(
        mut self,
        action: &str,
        start_s: f64,
        [rise_s, hold_s, fall_s]: [f64; 3],
        strength: f64,
    ) -> Self {
        self.events.push(Event { action: action.to_string(), start_s, rise_s, hold_s, fall_s, strength });
        self
    }

    /// Refuses durations and strengths that make no sense.
    ///
    /// # Errors
    /// Names the event; `place` is where the list of them stands.
    pub fn check(&self, place: &str) -> Result<(), crate::Error> {
        self.events.iter().enumerate().try_for_each(|(i, event)| event.check(&format!("{place}[{i}]")))
    }

    /// Resolves every event on the shapes of a body.
    ///
    /// # Errors
    /// As [`Timeline::check`]; names an action that is neither a shape nor a preset, or a preset whose shapes the body
    /// lacks.
    pub fn bind(&self, shapes: &[String]) -> Result<Performance, crate::Error> {
        self.bind_at("events", shapes)
    }

    /// As [`Timeline::bind`]; `place` is where the list of events stands.
    pub(crate) fn bind_at(&self, place: &str, shapes: &[String]) -> Result<Performance, crate::Error> {
        self.check(place)?;
        let bound = |(i, event): (usize, &Event)| {
            let place = format!("{place}[{i}].action");
            let parts = match event.action.as_str() {
                SPEECH_NAME if !shapes.iter().any(|shape| shape == SPEECH_NAME) => {
                    let voice = |channel: usize| Band::new(self.seed, (16 * i + channel) as u64, SPEECH_HZ);
                    let parts = resolve_speech(&place, shapes)?;
                    parts
                        .into_iter()
                        .enumerate()
                        .map(|(channel, part)| (part, Some(voice(channel))))
                        .collect()
                }
                action => vec![(resolve(&place, action, shapes)?, None)],
            };
            Ok(BoundEvent { event: event.clone(), parts })
        };
        let events: Result<Vec<BoundEvent>, crate::Error> =
            self.events.iter().enumerate().map(bound).collect();
        Ok(Performance { shape_count: shapes.len(), source: Source::Events(events?) })
    }

    /// One weight per shape at a time, s.
    ///
    /// # Errors
    /// As [`Timeline::bind`], which is the way for many times.
    pub fn weights(&self, time_s: f64, shapes: &[String]) -> Result<Vec<f64>, crate::Error> {
        Ok(self.bind(shapes)?.weights(time_s))
    }
}

/// An event on the shapes of a body.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct BoundEvent {
    event: Event,
    /// What moves, and the rhythm that it moves in, if any.
    parts: Vec<(Parts, Option<Band>)>,
}

/// Events at the same time add up as 1 − Π(1 − w): smooth, and never more than 1.
pub(super) fn weights(events: &[BoundEvent], shape_count: usize, time_s: f64) -> Vec<f64> {
    let mut rest = vec![1.0; shape_count];
    for BoundEvent { event, parts } in events {
        let envelope = event.envelope(time_s);
        if envelope == 0.0 {
            continue;
        }
        for (shapes, rhythm) in parts {
            let beat = rhythm.as_ref().map_or(1.0, |band| 0.5 + 0.5 * band.at(time_s));
            shapes.iter().for_each(|&(shape, weight)| rest[shape] *= 1.0 - envelope * beat * weight);
        }
    }
    rest.into_iter().map(|rest| 1.0 - rest).collect()
}

/// 0 below 0, 1 above 1, with two vanishing derivatives at each end.
pub(super) fn ease(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * x * (x * (6.0 * x - 15.0) + 10.0)
}

//! Which picture of which time stands where in which file.

use super::{Clock, Faults, Trigger};
use crate::Error;
use artifact::Rate;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// A camera, as far as time goes.
#[derive(Debug, Clone, PartialEq)]
pub struct Timed {
    /// The camera's id.
    pub id: String,
    /// When it exposes.
    pub clock: Clock,
    /// What goes wrong.
    pub faults: Faults,
}

/// A picture in a camera's file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Entry {
    /// Its place in the file, from 0.
    pub index: usize,
    /// Which of the camera's exposures it is, lost ones counted.
    pub exposure: i64,
    /// The motion capture's frame that it belongs to, counted from the first one: with a shared trigger the one that
    /// triggered it, else the same by count, later by as many whole frames as the camera's clock was set late. Exposures of
    /// one camera never share a frame, however far it drifts. Below 0 or beyond the last frame, nothing was captured then.
    pub mocap_frame: i64,
    /// The true middle of the exposure, s; the motion capture's frame 0 is at 0.
    pub time_s: f64,
    /// The time that the camera wrote beside it, s.
    pub stamp_s: f64,
    /// Whether it shows the picture before it again.
    pub is_double: bool,
}

/// What stands in all cameras' files.
#[derive(Debug, Clone, PartialEq)]
pub struct Schedule {
    /// The cameras' ids and pictures, in the order in which the cameras were given.
    pub cameras: Vec<(String, Vec<Entry>)>,
}

impl Schedule {
    /// Plans a take of so many seconds. The motion capture's frames are at k / `rate`, k from 0, below the duration; a
    /// camera's exposure n belongs to frame n · every + phase, plus [`Clock::late_frames`]. Faults by chance depend on the seed and the camera's place
    /// in the list only, each exposure by itself: another rate of faults or a longer take does not change the rest.
    ///
    /// # Errors
    /// If a parameter makes no sense, or a camera's file would be empty.
    pub fn plan(cameras: &[Timed], rate: Rate, duration_s: f64, seed: u64) -> Result<Self, Error> {
        let refuse = |place: String, what: String| Err(Error::Parameter { place, what });
        if rate.check("rate").is_err() {
            let what = format!("{} frames in {} seconds is no rate", rate.frames, rate.seconds);
            return refuse("rate".into(), what);
        }
        if !(duration_s.is_finite() && duration_s > 0.0) {
            return refuse("duration_s".into(), format!("{duration_s} s is no duration"));
        }
        let mut planned = Vec::with_capacity(cameras.len());
        for (number, Timed { id, clock, faults }) in cameras.iter().enumerate() {
            clock.check(&format!("cameras.{id}.clock"), rate.hz())?;
            faults.check(&format!("cameras.{id}.faults"))?;
            let camera = Camera { clock, faults, rate, seed, number: number as u64 };
            let entries = camera.entries(duration_s);
            if entries.is_empty() {
                let what = "no picture is left in its file; take a longer duration or fewer faults";
                return refuse(format!("cameras.{id}"), what.into());
            }
            planned.push((id.clone(), entries));
        }
        Ok(Self { cameras: planned })
    }
}

/// Slack so that a duration of 10 / 50 s holds 10 frames, not 11.
const SLACK: f64 = 1e-6;

struct Camera<'a> {
    clock: &'a Clock,
    faults: &'a Faults,
    rate: Rate,
    seed: u64,
    number: u64,
}

/// What chance does to an exposure.
struct Chance {
    drop: f64,
    double: f64,
    /// Standard normal.
    jitter: f64,
    stamp_jitter: f64,
}

impl Camera<'_> {
    fn entries(&self, duration_s: f64) -> Vec<Entry> {
        let (every, phase) = (i64::from(self.clock.every), i64::from(self.clock.phase));
        let mocap_frames = (duration_s * self.rate.hz() - SLACK).ceil() as i64;
        let exposures = (mocap_frames - phase + every - 1).div_euclid(every);
        let mut entries = Vec::new();
        for exposure in self.faults.late_start..exposures {
            let chance = self.chance(exposure);
            if self.is_dropped(exposure, &chance) {
                continue;
            }
            let mut entry = self.entry(exposure, &chance);
            entry.index = entries.len();
            entries.push(entry);
            if self.is_doubled(exposure, &chance) {
                entries.push(Entry { index: entry.index + 1, is_double: true, ..entry });
            }
        }
        if let (true, Some(first)) =
            (self.clock.stamps_from_first, entries.first().map(|entry| entry.stamp_s))
        {
            entries.iter_mut().for_each(|entry| entry.stamp_s -= first);
        }
        entries
    }

    /// When an exposure is, and what the camera thinks of it.
    fn entry(&self, exposure: i64, chance: &Chance) -> Entry {
        let Clock { offset_s, drift_ppm, .. } = *self.clock;
        let slowness = 1.0 + 1e-6 * drift_ppm;
        let frame = exposure * i64::from(self.clock.every) + i64::from(self.clock.phase);
        let even_s = (frame * i64::from(self.rate.seconds)) as f64 / f64::from(self.rate.frames);
        let due_s = match self.clock.trigger {
            Trigger::Shared => even_s,
            Trigger::Own => offset_s + slowness * even_s,
        };
        let time_s = due_s + self.clock.jitter_s * chance.jitter;
        let stamp_s = (time_s - offset_s) / slowness + self.clock.stamp_jitter_s * chance.stamp_jitter;
        let mocap_frame = frame + self.clock.late_frames(self.rate.hz());
        Entry { index: 0, exposure, mocap_frame, time_s, stamp_s, is_double: false }
    }

    fn is_dropped(&self, exposure: i64, chance: &Chance) -> bool {
        let named = self.faults.dropped.contains(&exposure);
        // What is to be doubled shall be there.
        named || (chance.drop < self.faults.drop_share && !self.faults.doubled.contains(&exposure))
    }

    fn is_doubled(&self, exposure: i64, chance: &Chance) -> bool {
        self.faults.doubled.contains(&exposure) || chance.double < self.faults.double_share
    }

    /// The numbers of an exposure, whatever became of the ones before it.
    fn chance(&self, exposure: i64) -> Chance {
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed ^ 0xc10c_c10c);
        rng.set_stream(self.number);
        // Sixteen words of the stream per exposure; the middle of the stream is exposure 0.
        rng.set_word_pos(16 * (i128::from(exposure) + (1 << 40)).unsigned_abs());
        let [drop, double] = [rng.random(), rng.random()];
        let [jitter, stamp_jitter] = [normal(&mut rng), normal(&mut rng)];
        Chance { drop, double, jitter, stamp_jitter }
    }
}

/// A standard normal number, at most 3.5 to either side (Box–Muller).
fn normal(rng: &mut ChaCha8Rng) -> f64 {
    let (u, v): (f64, f64) = (rng.random(), rng.random());
    let radius = (-2.0 * (1.0 - u).ln()).sqrt();
    (radius * (std::f64::consts::TAU * v).cos()).clamp(-3.5, 3.5)
}

//! A recorded performance: the synthetic face acts, a mocap system sees its markers.
//!
//! The recording is not in the scan's space: the markers are carried over by a known map that is nearly, but not quite,
//! a similarity, and the head moves. What a chain of stages should find is known: [`Performance::surface`].

use crate::face::{Face, Marker, Weights};
use artifact::{
    HeadPoseFrame, HeadPoseHeader, MarkerFrame, MarkerHeader, Rate, SampleStatus, TakeRef, Trajectories, Unit,
};
use nalgebra::{Isometry3, Point3, Rotation3, Translation3, UnitQuaternion, Vector3};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// How the recording differs from the scan.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// Size of the bend that no rigid motion and no scale explains, mm; at most 1.3 times this in the face.
    pub bend_mm: f64,
    /// Scale from scan to recording.
    pub scale: f64,
    /// Largest turn of the head, rad.
    pub head_turn_rad: f64,
    /// Largest shift of the head, mm.
    pub head_shift_mm: f64,
    /// Standard deviation of the measurement per coordinate, mm.
    pub noise_mm: f64,
    /// Whether two markers are hidden for four frames each.
    pub dropouts: bool,
    /// Seed of the noise.
    pub seed: u64,
}

impl Default for Recording {
    fn default() -> Self {
        Self {
            bend_mm: 2.0,
            scale: 1.01,
            head_turn_rad: 5f64.to_radians(),
            head_shift_mm: 8.0,
            noise_mm: 0.0,
            dropouts: false,
            seed: 1,
        }
    }
}

/// Hidden markers: id, first hidden frame after the start.
const DROPOUTS: [(&str, usize); 2] = [("lip_lower_1", 4), ("cheek_l_1", 12)];
/// Frames that a hidden marker stays hidden.
const DROPOUT_LENGTH: usize = 4;
/// Where the head turns, in face space, mm: the top of the neck.
const PIVOT: Point3<f64> = Point3::new(0.0, -40.0, -60.0);

/// A face that acts: neutral, jaw open, smile, brows raised with eyes closed, neutral.
#[derive(Debug, Clone)]
pub struct Performance {
    /// Who acts.
    pub face: Face,
    /// The markers on the face.
    pub markers: Vec<Marker>,
    /// Number of the first frame.
    pub first_frame: i64,
    /// Frames per second.
    pub rate: Rate,
    /// Per frame the expression.
    pub weights: Vec<Weights>,
}

impl Performance {
    /// The performance in `frame_count` frames from 1001 on, at 50 Hz.
    #[must_use]
    pub fn new(face: Face, frame_count: usize) -> Self {
        let last = frame_count.saturating_sub(1).max(1) as f64;
        let weights = (0..frame_count).map(|frame| acted(frame as f64 / last)).collect();
        let markers = face.markers();
        Self { face, markers, first_frame: 1001, rate: Rate::per_second(50), weights }
    }

    /// Absolute frame numbers.
    #[must_use]
    pub fn frames(&self) -> Vec<i64> {
        (0..self.weights.len() as i64).map(|frame| self.first_frame + frame).collect()
    }

    /// The true surface in a frame (counted from 0), in the scan's space, mm.
    #[must_use]
    pub fn surface(&self, frame: usize) -> Vec<Point3<f64>> {
        self.face.deform(&self.weights[frame])
    }

    /// Marker ids, the headband's last.
    #[must_use]
    pub fn marker_names(&self) -> Vec<String> {
        let band = self.face.headband().into_iter().map(|(name, _)| name);
        self.markers.iter().map(|marker| marker.name.clone()).chain(band).collect()
    }

    /// What the mocap system writes, in its own space (= world).
    #[must_use]
    pub fn record(&self, recording: &Recording, take: Option<TakeRef>) -> Trajectories {
        let names = self.marker_names();
        let mut rng = ChaCha8Rng::seed_from_u64(recording.seed);
        let mut noisy =
            |point: Point3<f64>| point + Vector3::from_fn(|_, _| normal(&mut rng)) * recording.noise_mm;
        let frames = (0..self.weights.len()).map(|frame| {
            let pose = self.world_from_head(recording, frame);
            let seen = self.true_markers(frame).into_iter().zip(&names).map(|(point, name)| {
                let measured = noisy(pose * recording.mocap_from_face(point));
                (!recording.hides(name, frame)).then_some(measured)
            });
            MarkerFrame {
                frame: self.first_frame + frame as i64,
                points: seen.collect(),
                status: vec![SampleStatus::Measured; names.len()],
            }
        });
        let frames = frames.collect();
        Trajectories {
            header: MarkerHeader { unit: Unit::Mm, rate: Some(self.rate), markers: names, take },
            frames,
        }
    }

    /// Marker positions in the scan's space, the headband's last, mm.
    #[must_use]
    pub fn true_markers(&self, frame: usize) -> Vec<Point3<f64>> {
        let surface = self.surface(frame);
        let band = self.face.headband().into_iter().map(|(_, point)| point);
        self.markers.iter().map(|marker| surface[marker.vertex as usize]).chain(band).collect()
    }

    /// Where the head is in a frame; the identity in the first one. Head space is mocap space in that frame.
    #[must_use]
    pub fn world_from_head(&self, recording: &Recording, frame: usize) -> Isometry3<f64> {
        let phase = TAU * frame as f64 / self.weights.len().max(2) as f64;
        let turn = Vector3::new(0.6 * phase.sin(), (0.5 * phase).sin(), 0.4 * (2.0 * phase).sin());
        let rotation = UnitQuaternion::from_scaled_axis(turn * (0.8 * recording.head_turn_rad));
        let shift = Vector3::new((0.5 * phase).sin(), 0.4 * phase.sin(), 0.4 * (1.5 * phase).sin());
        let pivot = recording.mocap_from_face(PIVOT).coords;
        let about_pivot = Translation3::from(pivot) * rotation * Translation3::from(-pivot);
        Translation3::from(shift * (0.85 * recording.head_shift_mm)) * about_pivot
    }

    /// The true head poses as an artifact holds them.
    #[must_use]
    pub fn head_poses(
        &self,
        recording: &Recording,
        take: Option<TakeRef>,
    ) -> (HeadPoseHeader, Vec<HeadPoseFrame>) {
        let markers = self.face.headband().into_iter().map(|(name, _)| name).collect();
        let header =
            HeadPoseHeader { rate: Some(self.rate), reference_frame: self.first_frame, markers, take };
        let pose = |frame: usize| HeadPoseFrame {
            frame: self.first_frame + frame as i64,
            world_from_head: Some(self.world_from_head(recording, frame)),
            residual_mm: Some(0.0),
            markers_used: self.face.headband().len(),
        };
        (header, (0..self.weights.len()).map(pose).collect())
    }
}

impl Recording {
    /// Carries a point of the scan's space into mocap space (the head at its first pose), mm.
    #[must_use]
    pub fn mocap_from_face(&self, point: Point3<f64>) -> Point3<f64> {
        let q = point.coords / 100.0;
        let bend = Vector3::new(
            0.6 * q.x * q.y,
            0.5 * q.y * q.z - 0.2 * q.x * q.x,
            0.8 * q.x * q.x - 0.5 * q.y * q.y,
        );
        let turned = Rotation3::from_euler_angles(-0.10, 0.35, 0.04) * (point.coords + self.bend_mm * bend);
        Point3::from(self.scale * turned + Vector3::new(120.0, 1460.0, -240.0))
    }

    fn hides(&self, marker: &str, frame: usize) -> bool {
        let hidden = |&(name, first): &(&str, usize)| {
            name == marker && (first..first + DROPOUT_LENGTH).contains(&frame)
        };
        self.dropouts && DROPOUTS.iter().any(hidden)
    }
}

/// The expression at a time from 0 to 1. Each comes and goes as a squared cosine; at a peak nothing else is on.
fn acted(time: f64) -> Weights {
    let pulse = |peak: f64, half: f64| {
        let off = (time - peak) / half;
        if off.abs() < 1.0 { (FRAC_PI_2 * off).cos().powi(2) } else { 0.0 }
    };
    Weights {
        jaw_open: pulse(0.25, 0.25),
        smile: pulse(0.5, 0.25),
        brow_raise: pulse(0.75, 0.25),
        blink: pulse(0.75, 0.17),
        ..Weights::default()
    }
}

/// A normally distributed number (Box–Muller).
fn normal(rng: &mut ChaCha8Rng) -> f64 {
    let (u, v): (f64, f64) = (rng.random_range(f64::MIN_POSITIVE..1.0), rng.random());
    (-2.0 * u.ln()).sqrt() * (2.0 * PI * v).cos()
}

//! Finds markers in 3D from their images in calibrated cameras.
//!
//! [`Triangulator`] takes the frames of tracks one by one and gives the frames of trajectories back, a window of frames in
//! memory; [`triangulate`] does so for a take in memory.
//!
//! 1. *Time*: with a time base, tracks of images taken beside the frame's time are interpolated to it.
//! 2. *Points*: the point nearest to the rays, then Gauss–Newton on the reprojection error; views that are off are left out.
//!    Each point has its covariance and the cameras that it was found from.
//! 3. *Filter*: spatio-temporal bilateral, along the neighbours' affine motion; or as the paper says.
//! 4. *Gaps*: one camera and the neighbours, the neighbours, or time; each sample says which.
//! 5. *Swaps*: markers under each other's name are found by implausible local strain, and reported.
//!
//! ```
//! use artifact::{CameraRig, Rate, Sample2d, Tracks2dFrame, Tracks2dHeader};
//! use camera::{BrownConrady, Camera, Lens};
//! use nalgebra::{Point3, Vector2, Vector3};
//! let lens = Lens {
//!     focal_px: Vector2::new(1450., 1450.),
//!     center_px: Vector2::new(327.5, 244.5),
//!     distortion: BrownConrady { k1: -0.1, ..Default::default() },
//! };
//! let camera = |x| Camera {
//!     image_size: [656, 490],
//!     lens,
//!     cam_from_world: Camera::pose_looking_at(Point3::new(x, 0., 1500.), Point3::origin(), Vector3::y()),
//! };
//! let rig = [("left", camera(-600.)), ("right", camera(600.))];
//! let nose = Point3::new(5., -20., 60.);
//! let seen = |camera: &Camera| Some(vec![Some(Sample2d::seen(camera.project(&nose)?.into()))]);
//! let frame = Tracks2dFrame { frame: 1001, cameras: rig.iter().map(|(_, camera)| seen(camera)).collect() };
//! let header = Tracks2dHeader {
//!     cameras: rig.iter().map(|(id, _)| id.to_string()).collect(),
//!     markers: vec!["nose".into()],
//!     rate: Some(Rate::per_second(50)),
//!     take: None,
//! };
//! let rig = CameraRig { cameras: rig.map(|(id, camera)| (id.into(), camera.into())).into(), take: None };
//! let (_, outcome) = triangulate::triangulate(&rig, &header, [frame], None, &Default::default())?;
//! assert!((outcome.frames[0].markers.points[0].unwrap() - nose).norm() < 1e-9);
//! # Ok::<(), triangulate::Error>(())
//! ```

mod affine;
mod error;
mod exchange;
mod fill;
mod filter;
mod noise;
mod paper;
mod params;
mod point;
mod report;
mod skew;
mod solve;
mod strain;
mod surface;
mod timeline;
mod triangulator;
mod view;

pub use error::Error;
pub use params::{Filter, PIXELS, Params, TIMES_MS};
pub use report::{CameraReport, MarkerReport, Report};
pub use strain::Swap;
pub use timeline::{Column, STATES, Timeline};
pub use triangulator::{Outcome, Triangulator, triangulate};

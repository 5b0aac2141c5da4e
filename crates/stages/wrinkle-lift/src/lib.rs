//! Brings wrinkles measured in the images onto the animated face [BickelBotsch2007, Sec. 5.3].
//!
//! Each section of a wrinkle is a place, a width and a depth in an image. Its ray is cast through the calibrated camera onto the mesh
//! without wrinkles, which the inverse of the warp and the head's pose have carried to where it was filmed; lengths in the image become
//! millimetres of the surface. What several cameras saw of a wrinkle becomes one valley of material points of the rest mesh.
//!
//! - [`Ground`], [`Spot`]: the mesh as a surface, places on it.
//! - [`Spaces`], [`Scene`]: the warp; the deformed mesh before the cameras, ready for rays.
//! - [`View`]: a camera as it sees the head. [`Moment`]: a time between frames.
//! - [`Lifter::frame`]: all valleys of a frame. [`arrange`]: one count of millimetres along a wrinkle, in all frames.
//! - [`flatten_fleeting`]: what a single image shows is noise.
//!
//! ```
//! use artifact::{Section, SectionState};
//! use camera::{BrownConrady, Camera, Lens};
//! use nalgebra::{Isometry3, Point3, Vector2, Vector3};
//! use operators::{Inverse, InvertParams, RbfMap, RbfSum};
//! use wrinkle_lift::{Ground, Image, Lifter, Params, Scene, Spaces};
//! // A flat face, a warp that changes nothing, a camera 500 mm before it: 2 px/mm.
//! let mesh = mesh::Mesh::from_triangles(
//!     vec![[-50., -50., 0.], [50., -50., 0.], [50., 50., 0.], [-50., 50., 0.]],
//!     &[[0, 1, 2], [0, 2, 3]],
//! );
//! let polynomial = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
//! let same = RbfMap::new(&RbfSum { origin_mm: [0.; 3], scale_mm: 1., centers: &[], weights: &[], polynomial: &polynomial });
//! let head_from_face = Inverse::of(same.clone(), same.clone(), InvertParams::default());
//! let spaces = Spaces { face_from_head: same, head_from_face };
//! let camera = Camera {
//!     image_size: [200, 200],
//!     lens: Lens { focal_px: Vector2::repeat(1000.), center_px: Vector2::repeat(100.), distortion: BrownConrady::default() },
//!     cam_from_world: Camera::pose_looking_at(Point3::new(0., 0., 500.), Point3::origin(), Vector3::y()),
//! };
//! // A valley from left to right in the image, 4 px wide and 2 px deep.
//! let section = |u: f64| Section {
//!     u, at: [80.0 + 40.0 * u, 100.0], normal: [0., 1.], w_px: 4., d_px: 2., epsilon: 0., kappa: 0.,
//!     tilt_rad: None, deviation: None, residual: None, state: SectionState::Measured,
//! };
//! let sections = [("brow".to_string(), (0..=20).map(|i| section(f64::from(i) / 20.0)).collect())].into();
//!
//! let (ground, params) = (Ground::of(&mesh), Params::default());
//! let scene = Scene::new(&ground, mesh.positions.clone(), &spaces);
//! let image = Image { id: "w1", camera: &camera, world_from_head: Isometry3::identity(), scene: &scene, sections: &sections };
//! let lifter = Lifter { ground: &ground, spaces: &spaces, params: &params };
//! let (frame, _) = lifter.frame(1001, &mesh.positions, &[image]);
//! let point = frame.valleys["brow"][20];
//! assert!(point.at_mm[1].abs() < 1e-6 && (point.at_mm[2] + 1.0).abs() < 1e-6);
//! assert!((point.w_mm - 2.0).abs() < 1e-6 && (point.d_mm - 1.0).abs() < 1e-6);
//! ```

mod error;
mod fleeting;
mod ground;
mod level;
mod lift;
mod line;
mod merge;
mod moment;
mod order;
mod params;
mod scene;
mod section;
mod tally;
mod track;
mod view;

pub use error::{Error, Result};
pub use fleeting::{edited, flatten_fleeting};
pub use ground::{Ground, Spot};
pub use lift::{Image, Lifter};
pub use moment::Moment;
pub use order::arrange;
pub use params::Params;
pub use scene::{Hit, Scene, Spaces};
pub use section::{Lifted, Lost};
pub use tally::{CameraTally, Tally, percentile};
pub use view::View;

//! Shows each wrinkle of a skinned character as its bones come near the pose that has it.
//!
//! Purpose: wrinkles for games [DutreveMeyer2011, Sec. 4]. A few *reference poses* of a character have a wrinkle map each. In any other
//! pose, each bone tells how far it went towards each of them ([`Blender::shares`]); the skin weights carry that to the vertices
//! ([`Blender::vertex_weights`]), the rasteriser to the texels, where the maps are laid over the neutral one ([`MapBlender`]). The
//! same equations stand as shader code in [`shader`], printed from one source.
//!
//! ```
//! use artifact::gltf::{Character, Node, Placement, SkinnedMesh};
//! use wrinkle_blend::{Blender, Modulation, Params, Setting, rest};
//! let node = |name: &str, parent| Node { name: name.into(), parent, rest: Placement::default() };
//! let character = Character {
//!     nodes: vec![node("head", None), node("brow", Some(0))],
//!     meshes: vec![SkinnedMesh {
//!         name: "face".into(),
//!         positions: vec![[0., 0., 0.].into(), [1., 0., 0.].into(), [0., 1., 0.].into()],
//!         uvs: vec![[0., 0.], [1., 0.], [0., 1.]],
//!         triangles: vec![[0, 1, 2]],
//!         joints: vec![0, 1],
//!         inverse_bind: vec![nalgebra::Matrix4::identity(); 2],
//!         influences: vec![vec![(0, 1.0)], vec![(1, 1.0)], vec![(0, 0.5), (1, 0.5)]],
//!     }],
//!     animations: vec![],
//! };
//! let neutral = rest(&character.nodes);
//! let lifted = |mm: f64| {
//!     let mut pose = neutral.clone();
//!     pose[1].translation.y = mm;
//!     pose
//! };
//! let setting =
//!     Setting { character: &character, mesh: 0, head_bone: Some("head"), mm_per_unit: 1.0, neutral: &neutral };
//! let poses = [("raised".to_string(), lifted(8.0))];
//! let blender = Blender::new(setting, &poses, Modulation::Cosine, &Params::default())?;
//! let half = blender.shares(&lifted(4.0));
//! assert!((half.0[0][0] - 0.5).abs() < 1e-9);
//! let mut weights = Vec::new();
//! blender.vertex_weights(&half, &mut weights);
//! assert!(weights.iter().zip([0.0, 0.5, 0.5]).all(|(found, wanted)| (found - wanted).abs() < 1e-6));
//! # Ok::<(), wrinkle_blend::Error>(())
//! ```

mod atlas;
mod blender;
mod clip;
mod crosstalk;
mod dual;
mod error;
mod fit_poses;
mod map;
mod mask;
mod modulation;
mod normal_map;
mod params;
mod skeleton;
mod skinning;

pub mod player;
pub mod shader;

pub use atlas::Atlas;
pub use blender::{Blender, Bone, NamedPose, Setting, Shares};
pub use clip::{combined, duration, placed, rest, retargeted, sample, written};
pub use crosstalk::{crosstalk, recovery};
pub use error::Error;
pub use fit_poses::{Chosen, Goal, fit_poses};
pub use map::{Blended, LEAST_Z, MapBlender, SNAP};
pub use modulation::Modulation;
pub use normal_map::NormalMap;
pub use params::{Mask, Params, Probe};
pub use skeleton::{Pose, Skeleton};
pub use skinning::skinned;

//! Photographs of a whole face, at rest and with an expression, and films of the way there: what a user of
//! [DutreveMeyer2011] brings home, with the normals that are true of it.
//!
//! The face is the rig's own: muscles pull it, its skin folds along the person's lines, and the rig's renderer films it from
//! the front. Its light ([`light`]) is a ray-traced sky, a flash beside the lens, or a mixture, with what the skin throws onto
//! itself. The truth ([`truth`]) is the tangent-space map that turns the face's large-scale surface into the wrinkled one, in
//! the frame of the photograph at rest.

mod light;
mod marks;
mod params;
mod pictures;
mod setting;
mod shoot;
mod truth;

pub use params::{FaceDegradation, FaceScenario};
pub use pictures::{FacePair, FaceTruth, FilmFrame};
pub use shoot::FaceStudio;

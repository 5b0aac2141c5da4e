//! PLY, the polygon file format: read in all three encodings, written as binary little endian.
//!
//! Kept: vertex order, polygons, vertex colours (`red`, `green`, `blue`), texture coordinates per vertex (`s`, `t`;
//! also `u`, `v` and `texture_u`, `texture_v`) or per corner (`texcoord`, as MeshLab has it). Not kept: groups and
//! materials (the format has none), normals, other properties and elements. Positions are written as doubles, so that
//! they survive; texture coordinates as floats and colours as bytes, which all readers know (MeshLab passes over `s`
//! and `t` as doubles, and takes coordinates per corner on triangles only: give it such a mesh as OBJ). PLY states no unit; the
//! caller says it.

mod read;
mod write;

pub use read::read;
pub use write::write;

//! Whose face: its rest surface, and how it moves without wrinkles.

pub mod face;

pub mod expressions;
pub mod place;
pub mod scan;
pub mod subdivide;
pub mod texture;

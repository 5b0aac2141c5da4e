//! What the face does over time.

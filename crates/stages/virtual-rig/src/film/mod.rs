//! What a camera makes of a painted face.

//! What a stage made of a take, against the truth.

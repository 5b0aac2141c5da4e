//! What shall be filmed, by whom, with what.

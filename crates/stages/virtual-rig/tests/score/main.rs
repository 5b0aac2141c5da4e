//! The two laws of every score: truth fed back scores exactly nothing, and a known error is recovered.

#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests")]

mod capture;
mod perturb;
mod pictures;
mod refusals;
mod surfaces;
mod wrinkles;

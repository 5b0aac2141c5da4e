//! The two laws of every score: truth fed back scores exactly nothing, and a known error is recovered.

mod capture;
mod perturb;
mod pictures;
mod refusals;
mod surfaces;
mod wrinkles;

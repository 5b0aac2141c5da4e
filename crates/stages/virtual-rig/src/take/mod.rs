//! A whole take, from a scenario.

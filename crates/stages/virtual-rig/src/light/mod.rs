//! How much of the sky each point of the skin sees.

//! When frames are taken, and what goes wrong with them.

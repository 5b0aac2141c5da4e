//! Boards and wands to calibrate cameras with.

//! Tests of the house as a whole: the manners of all binaries, and the golden chain. They stand in `tests/`; this
//! library is empty.

//! Dots and strokes of paint on the skin.

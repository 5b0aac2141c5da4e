//! Whose face: its rest surface, and how it moves without wrinkles.

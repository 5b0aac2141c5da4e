//! How the skin folds where the face compresses it.

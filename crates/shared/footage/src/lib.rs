//! Video files in and out: the only room that links OpenCV's video I/O.

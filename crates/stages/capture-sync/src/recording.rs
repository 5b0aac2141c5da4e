//! What a camera brings: its images in the order of its footage, with what is known of each.

use crate::Reading;
use artifact::Rate;

/// A camera's footage.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// Camera id.
    pub id: String,
    /// Frames per second, as the take says.
    pub rate: Rate,
    /// The image that belongs to the take's first frame, as the take says.
    pub first: i64,
    /// The images, by rising index.
    pub images: Vec<Image>,
}

/// An image of a camera's footage.
#[derive(Debug, Clone, PartialEq)]
pub struct Image {
    /// Its number in the footage.
    pub index: i64,
    /// When it was taken by the camera's clock, s.
    pub time_s: Option<f64>,
    /// What was read from it; none where images are not looked at.
    pub reading: Option<Reading>,
}

impl Recording {
    /// Whether every image has a time stamp.
    #[must_use]
    pub fn is_stamped(&self) -> bool {
        !self.images.is_empty() && self.images.iter().all(|image| image.time_s.is_some())
    }

    /// Whether every image was looked at.
    #[must_use]
    pub fn is_read(&self) -> bool {
        !self.images.is_empty() && self.images.iter().all(|image| image.reading.is_some())
    }
}

//! A picture in linear light.

/// A picture in linear light; row 0 is the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// Width, height, px.
    pub size: [u32; 2],
    /// Radiance as red, green, blue, row after row; 1 is what a white surface sends back under full light.
    pub radiance: Vec<[f32; 3]>,
}

impl Picture {
    /// A picture of one radiance.
    #[must_use]
    pub fn filled(size: [u32; 2], radiance: [f32; 3]) -> Self {
        Self { size, radiance: vec![radiance; size[0] as usize * size[1] as usize] }
    }
}

//! The parameters of simplification.

/// Parameters of [`super::simplify`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct SimplifyParams {
    /// Largest number of triangles of the result.
    pub faces: u32,
    /// Size of a pixel at the object, in scene units: [`crate::hull::VisualHull::footprint`]. Unless it is positive, nothing
    /// collapses.
    pub footprint: f32,
    /// Largest distance of any vertex of the original from the result, in pixels of footprint. It has precedence over
    /// `faces`. Infinity sets no bound, which takes half of the time.
    pub error_pixels: f32,
    /// How much colours count: a difference of 255 in one channel counts like this distance, in pixels of footprint.
    pub colour_pixels: f32,
}

impl SimplifyParams {
    /// At most `faces` triangles, with the measured values for the rest.
    pub const fn new(faces: u32, footprint: f32) -> Self {
        Self { faces, footprint, error_pixels: 2.0, colour_pixels: 2.0 }
    }
}

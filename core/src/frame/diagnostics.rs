//! How well each view agrees with the others.

/// How well a camera's view agrees with the others.
///
/// The silhouette is compared with the picture of the visual hull's mesh. The hull lies inside the silhouettes of all
/// views that carve it, so that what a silhouette has beyond the hull's picture is what the other views contradict.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct ViewDiagnostics {
    /// Whether the view takes part in the frame.
    pub used: bool,
    /// Intersection over union of the silhouette and the hull's picture, 0 to 1. `None` without a silhouette, or if
    /// the picture shows neither or nothing else.
    pub silhouette_overlap: Option<f32>,
    /// Median distance in pixels of the hull's outline in the picture from the silhouette's contour. Outlines are
    /// found to a quarter of a pixel. `None` without a silhouette or an outline.
    pub contour_px: Option<f32>,
    /// Median distance in pixels of a few matches with other views from their epipolar lines. `None` before
    /// [`crate::Stage::Merge`] is complete, without stereo, and where there are too few matches.
    pub epipolar_px: Option<f32>,
}

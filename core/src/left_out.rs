//! Why a view contributes nothing to its frame.

/// Why a view contributes nothing to its frame: it does not carve the hull, gives no points, is compared with no other
/// view and gives no colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum LeftOut {
    /// The camera has no picture in this frame.
    NoPicture,
    /// No pixel of the silhouette belongs to the object.
    EmptySilhouette,
    /// The silhouette is that of everything except the object: its mask is inverted.
    MaskInverted,
    /// The object lies beside the picture, or behind the camera.
    BesidePicture,
    /// The silhouette contradicts the other views in what it shows and in what it lacks.
    Contradicts,
}

impl LeftOut {
    /// Whether the reason is found with the hull, so that it no longer holds when the hull is carved again.
    pub(crate) fn is_found_with_hull(self) -> bool {
        matches!(self, Self::MaskInverted | Self::BesidePicture | Self::Contradicts)
    }
}

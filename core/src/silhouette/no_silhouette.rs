//! Why a matte gives no silhouette.

/// Why a matte gives no silhouette.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum NoSilhouette {
    /// No pixel belongs to the object.
    #[error(
        "the silhouette is empty: no pixel belongs to the object. Give a mask that is white on the object, or null where \
         there is none"
    )]
    Empty,
    /// A contour needs at least 2 x 2 pixels.
    #[error("a silhouette of {width} x {height} pixels has no contour")]
    TooSmall {
        /// Width in pixels.
        width: u32,
        /// Height in pixels.
        height: u32,
    },
}

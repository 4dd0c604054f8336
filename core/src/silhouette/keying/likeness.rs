//! How pixels compare with the painted backdrop.

/// How a pixel compares with the painted backdrop.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::silhouette) enum Likeness {
    /// As near to the paint's colour as the paint itself varies.
    Paint,
    /// Within the tolerance, but farther from the paint than the paint varies.
    Similar,
    /// Another colour.
    Other,
}

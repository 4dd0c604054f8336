//! The stages of a reconstruction.

/// Identity of a stage. Numbers and names never change, because reports, file names and the C ABI rely on them. The
/// numbers do not define the order in which the stages run; [`crate::frame::ORDER`] does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(rename_all = "lowercase"))]
#[repr(u8)]
#[non_exhaustive]
pub enum Stage {
    /// Undistortion and silhouettes (§0), one step per view.
    Views = 0,
    /// Visual hull (§0).
    Hull = 1,
    /// Frontier and implicit points (§4.4).
    Contours = 2,
    /// The optional coarse pass of detection and meshing.
    Coarse = 3,
    /// Point cloud detection (§4), one step per view.
    Detect = 4,
    /// Merging (§5).
    Merge = 5,
    /// Meshing (§6).
    Mesh = 6,
    /// Colours (§7).
    Colour = 7,
    /// Another form of the finished mesh ([`crate::Frame::form`]), with fewer triangles or a texture. It is not one of the
    /// stages of a frame: [`crate::frame::ORDER`] does not have it.
    Form = 8,
    /// The mean with neighbouring frames ([`crate::steady`]). It is not one of the stages of a frame either.
    Steady = 9,
}

impl Stage {
    /// The stage's number.
    pub const fn id(self) -> u32 {
        self as u32
    }

    /// The stage's name in reports and file names.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Views => "views",
            Self::Hull => "hull",
            Self::Contours => "contours",
            Self::Coarse => "coarse",
            Self::Detect => "detect",
            Self::Merge => "merge",
            Self::Mesh => "mesh",
            Self::Colour => "colour",
            Self::Form => "form",
            Self::Steady => "steady",
        }
    }
}

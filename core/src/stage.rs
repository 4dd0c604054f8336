//! The stages of a reconstruction.

/// Identity of a stage. Numbers and names never change: reports, file names and the C ABI rely on them. The order in which
/// stages run is not theirs; it is [`crate::frame::ORDER`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(rename_all = "lowercase"))]
#[repr(u8)]
#[non_exhaustive]
pub enum Stage {
    /// Undistortion and silhouettes, one step per view.
    Views = 0,
    /// Visual hull (§0).
    Hull = 1,
    /// Frontier and implicit points (§4.4).
    Contours = 2,
    /// The coarse pass of detection and meshing, if there is one.
    Coarse = 3,
    /// Point cloud detection (§4), one step per view.
    Detect = 4,
    /// Merging (§5).
    Merge = 5,
    /// Meshing (§6).
    Mesh = 6,
    /// Colours (§7).
    Colour = 7,
}

impl Stage {
    /// Number of the stage.
    pub const fn id(self) -> u32 {
        self as u32
    }

    /// Name as used in reports and file names.
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
        }
    }
}

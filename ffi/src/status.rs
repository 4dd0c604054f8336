//! Results of calls, and names of stages.

use pcmvs_core::Stage;
use std::ffi::{CStr, c_char};

/// Result of a call. Numbers never change; new ones are only added at the end, so a caller must take a number it does
/// not know for a failure.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum pcmvs_status {
    /// Done.
    Ok = 0,
    /// A pointer that must not be NULL is.
    NullPointer = 1,
    /// A handle is of another kind, was freed (as far as its memory has not been reused), or never was one.
    InvalidHandle = 2,
    /// A struct's `struct_size` is less than any version's, or the part that this library does not know is not zero:
    /// the caller asks for something that only a newer library can do.
    InvalidStruct = 3,
    /// An argument is out of range.
    InvalidArgument = 4,
    /// The handle is in use by a call that excludes this one: on another thread, or in whose callback this one is made.
    Busy = 5,
    /// The call needs a stage that has not run yet, or comes too late.
    WrongOrder = 6,
    /// The progress callback asked to stop.
    Cancelled = 7,
    /// A camera's calibration cannot be used.
    Camera = 8,
    /// A picture does not fit its camera or its own description.
    Image = 9,
    /// A silhouette cannot be used.
    Silhouette = 10,
    /// Two cameras stand at the same place and look the same way.
    DuplicateCamera = 11,
    /// Fewer cameras, or fewer silhouettes, than the method needs.
    TooFewViews = 12,
    /// The silhouettes do not meet in space.
    EmptyHull = 13,
    /// The points bound no surface.
    NoSurface = 14,
    /// More memory is needed than allowed.
    OutOfMemory = 15,
    /// The buffer is too small; ask for the size first.
    BufferTooSmall = 16,
    /// The write callback refused.
    WriteFailed = 17,
    /// A bug in the library. The handle only takes `pcmvs_..._error` and `pcmvs_..._free` from now on; other handles
    /// are not affected.
    Panic = 18,
    /// Something that this version of the ABI has no number for; the message says what.
    Other = 19,
}

impl pcmvs_status {
    /// All of them, each at the place of its number.
    const ALL: [Self; 20] = [
        Self::Ok,
        Self::NullPointer,
        Self::InvalidHandle,
        Self::InvalidStruct,
        Self::InvalidArgument,
        Self::Busy,
        Self::WrongOrder,
        Self::Cancelled,
        Self::Camera,
        Self::Image,
        Self::Silhouette,
        Self::DuplicateCamera,
        Self::TooFewViews,
        Self::EmptyHull,
        Self::NoSurface,
        Self::OutOfMemory,
        Self::BufferTooSmall,
        Self::WriteFailed,
        Self::Panic,
        Self::Other,
    ];

    const fn name(self) -> &'static CStr {
        match self {
            Self::Ok => c"ok",
            Self::NullPointer => c"null pointer",
            Self::InvalidHandle => c"invalid handle",
            Self::InvalidStruct => c"invalid struct",
            Self::InvalidArgument => c"invalid argument",
            Self::Busy => c"busy",
            Self::WrongOrder => c"wrong order",
            Self::Cancelled => c"cancelled",
            Self::Camera => c"camera",
            Self::Image => c"image",
            Self::Silhouette => c"silhouette",
            Self::DuplicateCamera => c"duplicate camera",
            Self::TooFewViews => c"too few views",
            Self::EmptyHull => c"empty hull",
            Self::NoSurface => c"no surface",
            Self::OutOfMemory => c"out of memory",
            Self::BufferTooSmall => c"buffer too small",
            Self::WriteFailed => c"write failed",
            Self::Panic => c"panic",
            Self::Other => c"other",
        }
    }
}

/// Stages of a reconstruction in the order in which they run. Numbers never change.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum pcmvs_stage {
    /// Undistortion and silhouettes, view by view.
    Views = 0,
    /// Visual hull.
    Hull = 1,
    /// Points that the silhouettes alone give.
    Contours = 2,
    /// Detection and meshing at half the resolution, which guide the stages after it.
    Coarse = 3,
    /// Stereo, view by view.
    Detect = 4,
    /// All points to one cloud.
    Merge = 5,
    /// The cloud to a closed mesh.
    Mesh = 6,
    /// Colours of the mesh.
    Colour = 7,
}

/// Number of stages.
pub const PCMVS_STAGE_COUNT: u32 = 8;

impl From<Stage> for pcmvs_stage {
    fn from(stage: Stage) -> Self {
        match stage {
            Stage::Views => Self::Views,
            Stage::Hull => Self::Hull,
            Stage::Contours => Self::Contours,
            Stage::Coarse => Self::Coarse,
            Stage::Detect => Self::Detect,
            Stage::Merge => Self::Merge,
            Stage::Mesh => Self::Mesh,
            Stage::Colour => Self::Colour,
            _ => unreachable!("every stage of this version has a number"),
        }
    }
}

/// Name of a status for logs, in English, "unknown" for numbers of other versions. Static; never freed.
#[unsafe(no_mangle)]
pub extern "C" fn pcmvs_status_name(status: u32) -> *const c_char {
    pcmvs_status::ALL.get(status as usize).map_or(c"unknown", |s| s.name()).as_ptr()
}

/// Name of a stage as in reports ("views", "hull", ...), "unknown" for numbers of other versions. Static; never freed.
#[unsafe(no_mangle)]
pub extern "C" fn pcmvs_stage_name(stage: u32) -> *const c_char {
    const NAMES: [&CStr; PCMVS_STAGE_COUNT as usize] =
        [c"views", c"hull", c"contours", c"coarse", c"detect", c"merge", c"mesh", c"colour"];
    NAMES.get(stage as usize).unwrap_or(&c"unknown").as_ptr()
}

#[cfg(test)]
mod tests {
    use super::*;
    use pcmvs_core::frame::ORDER;

    #[test]
    fn numbers_are_places_and_names_are_the_cores() {
        for (i, status) in pcmvs_status::ALL.into_iter().enumerate() {
            assert_eq!(status as usize, i);
        }
        for stage in ORDER {
            assert_eq!(pcmvs_stage::from(stage) as u32, stage as u32);
            // SAFETY: a static string.
            let name = unsafe { CStr::from_ptr(pcmvs_stage_name(stage as u32)) };
            assert_eq!(name.to_str().unwrap(), stage.name());
        }
        assert_eq!(ORDER.len(), PCMVS_STAGE_COUNT as usize);
    }
}

//! Results of calls.

use std::ffi::{CStr, c_char};

/// Result of a call. Numbers never change, and new ones are added at the end only. Treat a number that you do not know
/// as a failure.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum pcmvs_status {
    /// Success.
    Ok = 0,
    /// A pointer that must not be NULL is NULL.
    NullPointer = 1,
    /// The handle is of another kind, has been freed, or never was a handle.
    InvalidHandle = 2,
    /// The `struct_size` or `size` of a struct is smaller than in every version, or a member that this library does not
    /// know is not zero, which means that the caller asks for something only a newer library can do.
    InvalidStruct = 3,
    /// An argument is out of range.
    InvalidArgument = 4,
    /// The frame or calibration is in use by a call that excludes this one. That call runs on another thread, or this call
    /// was made from one of its callbacks.
    Busy = 5,
    /// The call needs a stage or a calibration that has not run yet, or it comes too late.
    WrongOrder = 6,
    /// The progress callback asked to stop.
    Cancelled = 7,
    /// A camera's calibration cannot be used, or the cameras as a whole cannot: their axes or poses contradict each other.
    Camera = 8,
    /// A picture does not fit its camera or its own description.
    Image = 9,
    /// A silhouette cannot be used, or all masks are inverted.
    Silhouette = 10,
    /// Two cameras have the same position and direction. No longer returned: cameras at the same place are a warning.
    DuplicateCamera = 11,
    /// There are fewer cameras, or fewer silhouettes, than the method needs.
    TooFewViews = 12,
    /// The silhouettes have no common volume.
    EmptyHull = 13,
    /// The points do not bound a surface.
    NoSurface = 14,
    /// The frame needs more memory than `pcmvs_options.max_memory` allows, or an allocator of the caller returned NULL.
    OutOfMemory = 15,
    /// The buffer is too small. Ask for the size first.
    BufferTooSmall = 16,
    /// The write callback returned an error.
    WriteFailed = 17,
    /// A bug in the library. From now on the handle accepts only `pcmvs_..._error` and `pcmvs_..._free`; other handles
    /// are not affected.
    Panic = 18,
    /// A failure that this version of the ABI has no number for. The message describes it.
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

/// Returns the English name of a status for logs, or "unknown" for a number of another version. The string is static.
#[unsafe(no_mangle)]
pub extern "C" fn pcmvs_status_name(status: u32) -> *const c_char {
    pcmvs_status::ALL.get(status as usize).map_or(c"unknown", |s| s.name()).as_ptr()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_status_is_at_the_place_of_its_number() {
        for (i, status) in pcmvs_status::ALL.into_iter().enumerate() {
            assert_eq!(status as usize, i);
        }
    }
}

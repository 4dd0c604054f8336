//! What can be wrong with an input, said so that a host can name the camera and the remedy.

use alloc::string::String;

/// Why a reconstruction could not be made. `camera` is an index into the cameras given to [`crate::Rig::new`].
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A camera's calibration cannot be used.
    #[error("camera {camera}: {problem}")]
    Camera {
        /// Index of the camera.
        camera: u32,
        /// What is wrong and what to do.
        problem: String,
    },
    /// A picture does not fit its camera, or its buffer is too small for what it claims.
    #[error("camera {camera}: {problem}")]
    Image {
        /// Index of the camera.
        camera: u32,
        /// What is wrong and what to do.
        problem: String,
    },
    /// A silhouette cannot be used.
    #[error("camera {camera}: {problem}")]
    Silhouette {
        /// Index of the camera.
        camera: u32,
        /// What is wrong and what to do.
        problem: String,
    },
    /// Two cameras stand at the same place and look the same way.
    #[error("cameras {first} and {second} are the same camera: remove one of them")]
    DuplicateCamera {
        /// Index of the earlier camera.
        first: u32,
        /// Index of the later camera.
        second: u32,
    },
    /// Fewer views than the method needs.
    #[error("{given} views given, at least {needed} are needed")]
    TooFewViews {
        /// Views given.
        given: u32,
        /// Views needed.
        needed: u32,
    },
    /// The number of pictures is not the number of cameras.
    #[error("{given} pictures given for {cameras} cameras: give one a camera, in the same order")]
    ViewCount {
        /// Pictures given.
        given: u32,
        /// Cameras in the rig.
        cameras: u32,
    },
    /// The number of gains is not the number of cameras.
    #[error("{given} gains given for {cameras} cameras: give one a camera, in the same order")]
    GainCount {
        /// Gains given.
        given: u32,
        /// Cameras in the rig.
        cameras: u32,
    },
    /// No point of space projects into all silhouettes that see it.
    #[error(
        "the visual hull is empty: the silhouettes do not meet in space. \
         Check that masks, images and cameras belong together and that masks are white on the object"
    )]
    EmptyHull,
    /// The points bound no surface.
    #[error(
        "the points bound no surface: too few were found, or all have weight zero. \
         Check that the cameras overlap and that masks, images and cameras belong together"
    )]
    NoSurface,
    /// The option `max_memory` is below what the frame needs.
    #[error("{needed} bytes of memory are needed, max_memory allows {limit}")]
    OutOfMemory {
        /// Bytes needed.
        needed: u64,
        /// Bytes allowed.
        limit: u64,
    },
    /// The progress sink asked to stop.
    #[error("cancelled")]
    Cancelled,
}

/// Result of a stage.
pub type Result<T> = core::result::Result<T, Error>;

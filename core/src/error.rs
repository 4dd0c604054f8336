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
    /// There is no camera of this number.
    #[error("there is no camera {camera}: the rig has {cameras}")]
    NoSuchCamera {
        /// Number that was given.
        camera: u32,
        /// Cameras in the rig.
        cameras: u32,
    },
    /// A stage was asked for before what it needs was there, or too late. Only a host that runs a [`crate::Frame`] stage by
    /// stage meets it.
    #[error("{problem}")]
    WrongOrder {
        /// Index of the camera that is missing, if it is one.
        camera: Option<u32>,
        /// What is missing and what to do.
        problem: String,
    },
    /// The host asked to stop.
    #[error("cancelled")]
    Cancelled,
}

/// Kind of an [`Error`], for hosts that map errors to codes of their own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ErrorCode {
    /// [`Error::Camera`].
    Camera,
    /// [`Error::Image`].
    Image,
    /// [`Error::Silhouette`].
    Silhouette,
    /// [`Error::DuplicateCamera`].
    DuplicateCamera,
    /// [`Error::TooFewViews`].
    TooFewViews,
    /// Lists of different lengths, or a camera that does not exist.
    InvalidArgument,
    /// [`Error::EmptyHull`].
    EmptyHull,
    /// [`Error::NoSurface`].
    NoSurface,
    /// [`Error::OutOfMemory`].
    OutOfMemory,
    /// [`Error::WrongOrder`].
    WrongOrder,
    /// [`Error::Cancelled`].
    Cancelled,
}

impl ErrorCode {
    /// Stable name in kebab-case.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Camera => "camera",
            Self::Image => "image",
            Self::Silhouette => "silhouette",
            Self::DuplicateCamera => "duplicate-camera",
            Self::TooFewViews => "too-few-views",
            Self::InvalidArgument => "invalid-argument",
            Self::EmptyHull => "empty-hull",
            Self::NoSurface => "no-surface",
            Self::OutOfMemory => "out-of-memory",
            Self::WrongOrder => "wrong-order",
            Self::Cancelled => "cancelled",
        }
    }
}

impl Error {
    /// What kind of error it is.
    pub const fn code(&self) -> ErrorCode {
        match self {
            Self::Camera { .. } => ErrorCode::Camera,
            Self::Image { .. } => ErrorCode::Image,
            Self::Silhouette { .. } => ErrorCode::Silhouette,
            Self::DuplicateCamera { .. } => ErrorCode::DuplicateCamera,
            Self::TooFewViews { .. } => ErrorCode::TooFewViews,
            Self::ViewCount { .. } | Self::GainCount { .. } | Self::NoSuchCamera { .. } => ErrorCode::InvalidArgument,
            Self::EmptyHull => ErrorCode::EmptyHull,
            Self::NoSurface => ErrorCode::NoSurface,
            Self::OutOfMemory { .. } => ErrorCode::OutOfMemory,
            Self::WrongOrder { .. } => ErrorCode::WrongOrder,
            Self::Cancelled => ErrorCode::Cancelled,
        }
    }

    /// Index of the camera to blame, if it is one; of two it is the later one.
    pub const fn camera(&self) -> Option<u32> {
        match self {
            Self::Camera { camera, .. }
            | Self::Image { camera, .. }
            | Self::Silhouette { camera, .. }
            | Self::NoSuchCamera { camera, .. } => Some(*camera),
            Self::DuplicateCamera { second, .. } => Some(*second),
            Self::WrongOrder { camera, .. } => *camera,
            _ => None,
        }
    }
}

/// Result of a stage.
pub type Result<T> = core::result::Result<T, Error>;

//! Errors. Each message states the problem and the remedy; [`Error::camera`] gives the camera concerned.

use alloc::string::String;

/// Why a reconstruction failed. Every `camera` is an index into the cameras passed to [`crate::Rig::new`].
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
    /// A picture does not match its camera, or its buffer is smaller than its size, stride and format require.
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
    /// The cameras as a whole cannot be used: their axes or poses contradict each other or the silhouettes, mostly because
    /// they are given in another convention than that of [`crate::Camera`].
    #[error("{problem}")]
    Cameras {
        /// What is wrong and what to do.
        problem: String,
    },
    /// Most silhouettes touch the whole border of their pictures.
    #[error(
        "{inverted} of {given} silhouettes touch the whole border of their pictures: the masks are white on the background: \
         inverted? Give masks that are white on the object"
    )]
    MasksInverted {
        /// Silhouettes that touch the whole border.
        inverted: u32,
        /// Silhouettes given.
        given: u32,
    },
    /// There are fewer views than the method needs.
    #[error("{given} usable views given: at least {needed} are needed")]
    TooFewViews {
        /// Views with a silhouette that take part, or cameras of a rig.
        given: u32,
        /// Views needed.
        needed: u32,
    },
    /// A form of the mesh cannot be made as it was asked for.
    #[error("{problem}")]
    Form {
        /// What is wrong and what to do.
        problem: String,
    },
    /// The number of pictures differs from the number of cameras.
    #[error("{given} pictures given for {cameras} cameras: give one per camera, in the same order")]
    ViewCount {
        /// Pictures given.
        given: u32,
        /// Cameras in the rig.
        cameras: u32,
    },
    /// The number of gains differs from the number of cameras.
    #[error("{given} gains given for {cameras} cameras: give one per camera, in the same order")]
    GainCount {
        /// Gains given.
        given: u32,
        /// Cameras in the rig.
        cameras: u32,
    },
    /// No point in space lies inside all silhouettes that see it.
    #[error(
        "the visual hull is empty: no point in space lies inside the silhouettes of all views. \
         Check that masks, images and cameras belong together and that masks are white on the object"
    )]
    EmptyHull,
    /// The points do not bound a surface.
    #[error(
        "the points do not bound a surface: too few were found, or all have weight zero. \
         Check that the cameras overlap and that masks, images and cameras belong together"
    )]
    NoSurface,
    /// The frame needs more memory than the option `max_memory` allows.
    #[error("{needed} bytes of memory are needed but max_memory allows {limit}")]
    OutOfMemory {
        /// Bytes needed.
        needed: u64,
        /// Bytes allowed.
        limit: u64,
    },
    /// The rig has no camera with this index.
    #[error("there is no camera {camera}: the rig has {cameras}")]
    NoSuchCamera {
        /// Index that was given.
        camera: u32,
        /// Cameras in the rig.
        cameras: u32,
    },
    /// A stage was requested too early or too late. Occurs only in hosts that run a [`crate::Frame`] stage by stage.
    #[error("{problem}")]
    WrongOrder {
        /// Index of the camera concerned, if there is one.
        camera: Option<u32>,
        /// What is wrong and what to do.
        problem: String,
    },
    /// The host cancelled through [`crate::Progress::step`].
    #[error("cancelled")]
    Cancelled,
}

/// The kind of an [`Error`], for hosts that map errors to their own codes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ErrorCode {
    /// [`Error::Camera`] and [`Error::Cameras`].
    Camera,
    /// [`Error::Image`].
    Image,
    /// [`Error::Silhouette`] and [`Error::MasksInverted`].
    Silhouette,
    /// [`Error::TooFewViews`].
    TooFewViews,
    /// [`Error::Form`], lists of different lengths, or a camera that does not exist.
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
    /// The kind of error.
    pub const fn code(&self) -> ErrorCode {
        match self {
            Self::Camera { .. } | Self::Cameras { .. } => ErrorCode::Camera,
            Self::Image { .. } => ErrorCode::Image,
            Self::Silhouette { .. } | Self::MasksInverted { .. } => ErrorCode::Silhouette,
            Self::TooFewViews { .. } => ErrorCode::TooFewViews,
            Self::Form { .. } | Self::ViewCount { .. } | Self::GainCount { .. } | Self::NoSuchCamera { .. } => {
                ErrorCode::InvalidArgument
            }
            Self::EmptyHull => ErrorCode::EmptyHull,
            Self::NoSurface => ErrorCode::NoSurface,
            Self::OutOfMemory { .. } => ErrorCode::OutOfMemory,
            Self::WrongOrder { .. } => ErrorCode::WrongOrder,
            Self::Cancelled => ErrorCode::Cancelled,
        }
    }

    /// Index of the camera concerned, if there is one.
    pub const fn camera(&self) -> Option<u32> {
        match self {
            Self::Camera { camera, .. }
            | Self::Image { camera, .. }
            | Self::Silhouette { camera, .. }
            | Self::NoSuchCamera { camera, .. } => Some(*camera),
            Self::WrongOrder { camera, .. } => *camera,
            _ => None,
        }
    }
}

/// Result of a stage.
pub type Result<T> = core::result::Result<T, Error>;

//! The formats that can be imported.

/// Programs whose calibrations can be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// A folder with `*_par.txt`, or that file.
    Middlebury,
    /// A folder with a model: cameras and images, as text or binary.
    Colmap,
    /// A YAML, JSON or XML file of OpenCV's FileStorage, or a folder with one such file per camera, or with those of a stereo
    /// pair.
    Opencv,
    /// transforms.json or its folder.
    Transforms,
    /// A folder with intri.yml and extri.yml.
    Easymocap,
    /// bundle.out with list.txt, or a folder with them.
    #[cfg(feature = "formats")]
    Bundler,
    /// An XML file with cameras of Agisoft Metashape.
    #[cfg(feature = "formats")]
    Metashape,
    /// cameras_sphere.npz, or a folder with it.
    #[cfg(feature = "formats")]
    Neus,
    /// A TOML file of anipose, FreeMoCap or Caliscope.
    #[cfg(feature = "formats")]
    Anipose,
    /// A JSON file of CMU Panoptic.
    #[cfg(feature = "formats")]
    Panoptic,
    /// A folder with files *_cam.txt, or with such a folder `cams`.
    #[cfg(feature = "formats")]
    Mvsnet,
    /// Kalibr's camchain.yaml.
    #[cfg(feature = "formats")]
    Kalibr,
    /// RealityCapture or RealityScan: a CSV file of camera parameters, or a folder with pictures and XMP files.
    #[cfg(feature = "formats")]
    Realitycapture,
    /// A calibration of Qualisys Track Manager, .qca.txt, .xml or .txt.
    #[cfg(feature = "formats")]
    Qualisys,
    /// ZJU-MoCap's annots.npy, or a folder with it.
    #[cfg(feature = "formats")]
    Zju,
}

impl Source {
    /// Its name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Middlebury => "middlebury",
            Self::Colmap => "colmap",
            Self::Opencv => "opencv",
            Self::Transforms => "transforms",
            Self::Easymocap => "easymocap",
            #[cfg(feature = "formats")]
            Self::Bundler => "bundler",
            #[cfg(feature = "formats")]
            Self::Metashape => "metashape",
            #[cfg(feature = "formats")]
            Self::Neus => "neus",
            #[cfg(feature = "formats")]
            Self::Anipose => "anipose",
            #[cfg(feature = "formats")]
            Self::Panoptic => "panoptic",
            #[cfg(feature = "formats")]
            Self::Mvsnet => "mvsnet",
            #[cfg(feature = "formats")]
            Self::Kalibr => "kalibr",
            #[cfg(feature = "formats")]
            Self::Realitycapture => "realitycapture",
            #[cfg(feature = "formats")]
            Self::Qualisys => "qualisys",
            #[cfg(feature = "formats")]
            Self::Zju => "zju",
        }
    }
}

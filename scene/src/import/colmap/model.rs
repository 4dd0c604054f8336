//! The cameras and images of a COLMAP model, from text or binary files.

use crate::import::lens::REMEDY;
use pcmvs_core::Lens as Distortion;

/// Models that are read.
const MODELS: [&str; 10] = [
    "SIMPLE_PINHOLE",
    "PINHOLE",
    "SIMPLE_RADIAL",
    "RADIAL",
    "OPENCV",
    "FULL_OPENCV",
    "SIMPLE_RADIAL_FISHEYE",
    "RADIAL_FISHEYE",
    "OPENCV_FISHEYE",
    "THIN_PRISM_FISHEYE",
];

/// A camera model, which several images may share.
#[derive(Debug, Clone)]
pub struct Lens {
    /// Name of the model, such as OPENCV.
    pub model: String,
    pub size: [u32; 2],
    pub params: Vec<f64>,
}

/// An image with its pose.
#[derive(Debug, Clone)]
pub struct Image {
    /// Path of the picture.
    pub name: String,
    /// World to camera, w x y z.
    pub quaternion: [f64; 4],
    /// World to camera.
    pub translation: [f64; 3],
    /// Number of its camera model.
    pub camera: u32,
}

impl Lens {
    /// K and distortion of a scene. COLMAP's models are special cases of OpenCV's two.
    pub fn intrinsics(&self) -> Result<([[f64; 3]; 3], Distortion), String> {
        let model = self.model.as_str();
        let radial = |k1, k2| Distortion::brown([k1, k2, 0.0, 0.0, 0.0]);
        let (focal, centre, lens) = match (model, self.params.as_slice()) {
            ("SIMPLE_PINHOLE", &[f, cx, cy]) => ([f, f], [cx, cy], Distortion::NONE),
            ("PINHOLE", &[fx, fy, cx, cy]) => ([fx, fy], [cx, cy], Distortion::NONE),
            ("SIMPLE_RADIAL", &[f, cx, cy, k1]) => ([f, f], [cx, cy], radial(k1, 0.0)),
            ("RADIAL", &[f, cx, cy, k1, k2]) => ([f, f], [cx, cy], radial(k1, k2)),
            ("OPENCV", &[fx, fy, cx, cy, k1, k2, p1, p2]) => {
                ([fx, fy], [cx, cy], Distortion::brown([k1, k2, p1, p2, 0.0]))
            }
            ("FULL_OPENCV", &[fx, fy, cx, cy, k1, k2, p1, p2, k3, k4, k5, k6]) => {
                let rational = [k1, k2, p1, p2, k3, k4, k5, k6, 0.0, 0.0, 0.0, 0.0];
                ([fx, fy], [cx, cy], Distortion::OpenCv(rational))
            }
            ("SIMPLE_RADIAL_FISHEYE", &[f, cx, cy, k1]) => ([f, f], [cx, cy], Distortion::Fisheye([k1, 0.0, 0.0, 0.0])),
            ("RADIAL_FISHEYE", &[f, cx, cy, k1, k2]) => ([f, f], [cx, cy], Distortion::Fisheye([k1, k2, 0.0, 0.0])),
            ("OPENCV_FISHEYE", &[fx, fy, cx, cy, k1, k2, k3, k4]) => {
                ([fx, fy], [cx, cy], Distortion::Fisheye([k1, k2, k3, k4]))
            }
            ("THIN_PRISM_FISHEYE", &[fx, fy, cx, cy, k1, k2, p1, p2, k3, k4, sx1, sy1]) => {
                if [p1, p2, sx1, sy1] != [0.0; 4] {
                    return Err(format!(
                        "THIN_PRISM_FISHEYE with p1, p2, sx1 or sy1 is not supported: calibrate with OPENCV_FISHEYE, or \
                         {REMEDY} (`colmap image_undistorter` does that)"
                    ));
                }
                ([fx, fy], [cx, cy], Distortion::Fisheye([k1, k2, k3, k4]))
            }
            _ if MODELS.contains(&model) => {
                return Err(format!(
                    "{} parameters do not fit the model {model}: export the model again",
                    self.params.len()
                ));
            }
            _ => {
                return Err(format!(
                    "the model {model} is not supported: {REMEDY} (`colmap image_undistorter` does that)"
                ));
            }
        };
        let k = [[focal[0], 0.0, centre[0] - 0.5], [0.0, focal[1], centre[1] - 0.5], [0.0, 0.0, 1.0]];
        Ok((k, lens))
    }
}

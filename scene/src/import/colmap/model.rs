//! The cameras and images of a COLMAP model, from text or binary files.

use crate::import::lens::REMEDY;

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
    /// K and distortion of a scene.
    pub fn intrinsics(&self) -> Result<([[f64; 3]; 3], [f64; 5]), String> {
        let model = self.model.as_str();
        let (focal, centre, [k1, k2, p1, p2, k3]) = match (model, self.params.as_slice()) {
            ("SIMPLE_PINHOLE", &[f, cx, cy]) => ([f, f], [cx, cy], [0.0; 5]),
            ("PINHOLE", &[fx, fy, cx, cy]) => ([fx, fy], [cx, cy], [0.0; 5]),
            ("SIMPLE_RADIAL", &[f, cx, cy, k1]) => ([f, f], [cx, cy], [k1, 0.0, 0.0, 0.0, 0.0]),
            ("RADIAL", &[f, cx, cy, k1, k2]) => ([f, f], [cx, cy], [k1, k2, 0.0, 0.0, 0.0]),
            ("OPENCV", &[fx, fy, cx, cy, k1, k2, p1, p2]) => ([fx, fy], [cx, cy], [k1, k2, p1, p2, 0.0]),
            ("FULL_OPENCV", &[fx, fy, cx, cy, k1, k2, p1, p2, k3, k4, k5, k6]) => {
                if [k4, k5, k6] != [0.0; 3] {
                    return Err(format!(
                        "FULL_OPENCV with k4, k5 or k6 is not supported: calibrate with OPENCV, or {REMEDY} (`colmap \
                         image_undistorter` does that)"
                    ));
                }
                ([fx, fy], [cx, cy], [k1, k2, p1, p2, k3])
            }
            ("SIMPLE_PINHOLE" | "PINHOLE" | "SIMPLE_RADIAL" | "RADIAL" | "OPENCV" | "FULL_OPENCV", params) => {
                return Err(format!(
                    "{} parameters do not fit the model {model}: export the model again",
                    params.len()
                ));
            }
            _ => {
                return Err(format!(
                    "the model {model} is not supported: {REMEDY} (`colmap image_undistorter` does that)"
                ));
            }
        };
        let k = [[focal[0], 0.0, centre[0] - 0.5], [0.0, focal[1], centre[1] - 0.5], [0.0, 0.0, 1.0]];
        Ok((k, [k1, k2, p1, p2, k3]))
    }
}

//! Cameras.

use crate::{arrays::rows, error::Problem};
use numpy::{PyArray1, PyArray2};
use pcmvs_core::glam::DVec3;
use pcmvs_scene::{LensModel, SceneCamera};
use pyo3::prelude::*;

/// A calibrated camera.
///
/// A world point X projects to the pixel ``K @ distort(R @ X + t)``, as in OpenCV: R and t map world to camera, x points
/// right, y down and z forward. The *centre* of the first pixel is (0, 0). If your calibration puts (0.5, 0.5) there, as
/// COLMAP does, subtract 0.5 from cx and cy. Lengths are in any unit. Meshes come in the same one.
///
/// ``k`` is the intrinsic matrix, ``[[fx, skew, cx], [0, fy, cy], [0, 0, 1]]``. ``size`` is (width, height) in pixels.
/// ``distortion`` has up to 12 of OpenCV's coefficients in its order (k1, k2, p1, p2, k3, ...), or with
/// ``lens="fisheye"`` the 4 of its fisheye.
#[pyclass(frozen, module = "pcmvs")]
pub struct Camera {
    pub camera: pcmvs_core::Camera,
}

/// The name of a lens model.
const fn name(lens: LensModel) -> &'static str {
    match lens {
        LensModel::OpenCv => "opencv",
        LensModel::Fisheye => "fisheye",
    }
}

/// A 3 x 3 matrix of any kind of sequence.
fn matrix(value: &Bound<PyAny>, name: &str) -> Result<[[f64; 3]; 3], Problem> {
    value.extract().map_err(|e: PyErr| Problem::argument(format!("{name}: {e}: give 3 x 3 numbers")))
}

impl Camera {
    fn described(&self) -> SceneCamera {
        SceneCamera::new(String::new(), &self.camera)
    }
}

#[pymethods]
impl Camera {
    #[new]
    #[pyo3(signature = (k, r, t, size, *, distortion = Vec::new(), lens = "opencv"))]
    fn new(
        k: &Bound<PyAny>,
        r: &Bound<PyAny>,
        t: &Bound<PyAny>,
        size: (u32, u32),
        distortion: Vec<f64>,
        lens: &str,
    ) -> PyResult<Self> {
        let (k, r) = (matrix(k, "k")?, matrix(r, "r")?);
        let refused = |e| Problem::argument(format!("t: {e}: give 3 numbers"));
        let t = t.extract().map_err(refused)?;
        let models = [LensModel::OpenCv, LensModel::Fisheye];
        let Some(lens) = models.into_iter().find(|&model| name(model) == lens) else {
            let problem = format!("lens is {lens:?}: it is one of {:?}", models.map(name));
            return Err(Problem::argument(problem).into());
        };
        let (width, height) = size;
        let described = SceneCamera { name: String::new(), width, height, k, lens, distortion, r, t, offset: 0 };
        let camera = described.camera().map_err(Problem::argument)?;
        camera.check().map_err(Problem::argument)?;
        Ok(Self { camera })
    }

    /// The intrinsic matrix.
    #[getter]
    fn k<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        rows(py, self.camera.k)
    }

    /// The rotation, world to camera.
    #[getter]
    fn r<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        rows(py, self.camera.r)
    }

    /// The translation, world to camera.
    #[getter]
    fn t<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.camera.t)
    }

    /// Width and height in pixels.
    #[getter]
    fn size(&self) -> (u32, u32) {
        (self.camera.width, self.camera.height)
    }

    /// The coefficients of the lens.
    #[getter]
    fn distortion<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, self.described().distortion)
    }

    /// The model of the lens, "opencv" or "fisheye".
    #[getter]
    fn lens(&self) -> &'static str {
        name(self.described().lens)
    }

    /// Centre of projection in the world.
    #[getter]
    fn centre<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.camera.centre().to_array())
    }

    /// Projects world points, n x 3, to pixels and depths, n x 3: x, y, depth. Not-a-number behind the camera.
    fn project<'py>(&self, py: Python<'py>, points: Vec<[f64; 3]>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let project = |point: [f64; 3]| match self.camera.project(DVec3::from_array(point)) {
            Some((pixel, depth)) => [pixel.x, pixel.y, depth],
            None => [f64::NAN; 3],
        };
        rows(py, points.into_iter().map(project))
    }

    fn __repr__(&self) -> String {
        let pcmvs_core::Camera { width, height, k, .. } = self.camera;
        format!("Camera({width} x {height}, focal length {:.1} px)", k[0][0])
    }
}

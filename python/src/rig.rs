//! Rigs.

use crate::{camera::Camera, error::Problem, report::CaptureWarning};
use numpy::PyArray1;
use pyo3::prelude::*;
use std::sync::Arc;

/// The calibrated cameras of a capture. Make it once for all frames.
///
/// ``gains``, n x 3, fixes the factors by which the red, green and blue of each camera are multiplied when a mesh is
/// coloured. Without them they are found in every frame (``Frame.gains``).
#[pyclass(frozen, module = "pcmvs")]
pub struct Rig {
    pub rig: Arc<pcmvs_core::Rig>,
}

impl Rig {
    pub fn of(cameras: &[pcmvs_core::Camera]) -> Result<Self, Problem> {
        Ok(Self { rig: Arc::new(pcmvs_core::Rig::new(cameras)?) })
    }
}

#[pymethods]
impl Rig {
    #[new]
    #[pyo3(signature = (cameras, *, gains = None))]
    fn new(cameras: Vec<PyRef<Camera>>, gains: Option<Vec<[f32; 3]>>) -> PyResult<Self> {
        let cameras: Vec<_> = cameras.iter().map(|camera| camera.camera).collect();
        let rig = pcmvs_core::Rig::new(&cameras).map_err(Problem::from)?;
        let rig = match gains {
            Some(gains) => rig.with_gains(&gains).map_err(Problem::from)?,
            None => rig,
        };
        Ok(Self { rig: Arc::new(rig) })
    }

    /// The cameras, in the order in which they were given.
    #[getter]
    fn cameras(&self) -> Vec<Camera> {
        self.rig.cameras().iter().map(|&camera| Camera { camera }).collect()
    }

    /// The point nearest to all optical axes, near which the object is expected.
    #[getter]
    fn origin<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.rig.origin().to_array())
    }

    /// What may be wrong with the cameras as such.
    #[getter]
    fn warnings(&self) -> Vec<CaptureWarning> {
        let pairs = self.rig.same_place().iter();
        pairs.map(|&(first, second)| CaptureWarning::from(&pcmvs_core::Warning::SamePlace { first, second })).collect()
    }

    fn __len__(&self) -> usize {
        self.rig.cameras().len()
    }

    fn __repr__(&self) -> String {
        format!("Rig({} cameras)", self.__len__())
    }
}

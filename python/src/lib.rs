//! pcmvs for Python: the extension module `pcmvs._pcmvs`. Its docstrings and `pcmvs/_pcmvs.pyi` are the reference.
//!
//! A file holds one class, or the way of arguments into the core. `work` runs the core on threads of its own, so that
//! Python's lock is free meanwhile.

mod arrays;
mod calibration;
mod camera;
mod error;
mod frame;
mod mesh;
mod params;
mod pictures;
mod report;
mod rig;
mod scene;
mod work;

/// The extension module.
#[pyo3::pymodule]
mod _pcmvs {
    #[pymodule_export]
    use crate::{
        calibration::{Calibration, CameraReport, Finding, calibrate},
        camera::Camera,
        frame::{Frame, reconstruct},
        mesh::{Mesh, Points},
        params::preset,
        report::{CaptureWarning, ViewDiagnostics},
        rig::Rig,
        scene::Scene,
    };
    /// The version of the library.
    #[pymodule_export]
    #[expect(non_upper_case_globals)]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}

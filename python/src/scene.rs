//! Scenes on disk.

use crate::{camera::Camera, error::Problem, pictures::to_dict, rig::Rig};
use pcmvs_scene::{
    Disk, FrameFiles, MissingFile, NoVideos, Pictures, SceneFrame, SilhouetteFiles, Silhouettes, Threads, thread_count,
};
use pyo3::{exceptions::PyUserWarning, prelude::*, types::PyDict};
use std::{
    ffi::CString,
    mem::take,
    num::NonZeroUsize,
    path::{Path, PathBuf},
};

/// A capture on disk: a folder with scene.json, or the calibration of another program (COLMAP, OpenCV, EasyMocap,
/// transforms.json, ...) with its pictures.
#[pyclass(frozen, module = "pcmvs")]
pub struct Scene {
    scene: pcmvs_scene::Scene,
    silhouettes: Silhouettes,
    cameras: Vec<pcmvs_core::Camera>,
}

impl Scene {
    fn load(path: &Path, files: SilhouetteFiles) -> Result<Self, Problem> {
        let open = |path: &Path| match path.is_dir() {
            true => pcmvs_scene::open(&Disk, path),
            false => pcmvs_scene::Scene::load(&Disk, path),
        };
        let mut scene = open(path)?;
        let silhouettes = Silhouettes::new(files, &mut scene)?;
        let cameras = scene.cameras()?;
        Ok(Self { scene, silhouettes, cameras })
    }

    fn decode(
        &self,
        frame: &SceneFrame,
        threads: Option<NonZeroUsize>,
    ) -> Result<(Pictures, Vec<MissingFile>), Problem> {
        let mut files = FrameFiles::read(&Disk, &NoVideos, &self.scene, frame, self.silhouettes)?;
        let missing = take(&mut files.missing);
        Ok((files.decode(&Threads::new(thread_count(threads))?)?, missing))
    }
}

#[pymethods]
impl Scene {
    /// Opens a capture. ``silhouettes`` says what they are made of: "masks", "chroma" or "plates".
    #[staticmethod]
    #[pyo3(signature = (path, *, silhouettes = "masks"))]
    fn open(path: PathBuf, silhouettes: &str) -> PyResult<Self> {
        let files = match silhouettes {
            "masks" => SilhouetteFiles::Masks,
            "chroma" => SilhouetteFiles::None,
            "plates" => SilhouetteFiles::Plates,
            other => {
                let problem = format!("silhouettes is {other:?}: it is \"masks\", \"chroma\" or \"plates\"");
                return Err(Problem::argument(problem).into());
            }
        };
        Ok(Self::load(&path, files)?)
    }

    /// Path of its scene.json, or of the calibration.
    #[getter]
    fn path(&self) -> PathBuf {
        self.scene.path.clone()
    }

    /// The cameras.
    #[getter]
    fn cameras(&self) -> Vec<Camera> {
        self.cameras.iter().map(|&camera| Camera { camera }).collect()
    }

    /// Names of the cameras.
    #[getter]
    fn names(&self) -> Vec<&str> {
        self.scene.cameras.iter().map(|camera| camera.name.as_str()).collect()
    }

    /// Indices of the frames, in increasing order.
    #[getter]
    fn frames(&self) -> Vec<u32> {
        let mut indices: Vec<u32> = self.scene.frames.iter().map(|frame| frame.index).collect();
        indices.sort_unstable();
        indices
    }

    /// The upward direction. None if it is unknown.
    #[getter]
    fn up(&self) -> Option<[f64; 3]> {
        self.scene.up
    }

    /// The unit of length. None if it is unknown.
    #[getter]
    fn units(&self) -> Option<&str> {
        self.scene.units.as_deref()
    }

    /// Frames per second. None if it is unknown.
    #[getter]
    fn fps(&self) -> Option<f64> {
        self.scene.fps
    }

    /// The rig of the cameras.
    fn rig(&self) -> PyResult<Rig> {
        let rig = pcmvs_core::Rig::new(&self.cameras).map_err(|error| self.scene.explain(&error, None));
        Ok(Rig { rig: rig.map_err(Problem::from)?.into() })
    }

    /// Decodes the pictures of a frame. Returns a dictionary of arguments for ``Frame`` and ``reconstruct``: "images" and
    /// "masks" with one array or None per camera, or instead of the masks "chroma" or "plates". A file that does not exist
    /// gives None and a UserWarning.
    #[pyo3(signature = (index, *, threads = None))]
    fn pictures<'py>(
        &self,
        py: Python<'py>,
        index: u32,
        threads: Option<NonZeroUsize>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let Some(frame) = self.scene.frames.iter().find(|frame| frame.index == index) else {
            let problem = format!("{}: there is no frame {index}: see `frames`", self.scene.path.display());
            return Err(Problem::argument(problem).into());
        };
        let (pictures, missing) = py.detach(|| self.decode(frame, threads))?;
        for file in missing {
            let message = CString::new(file.message)?;
            PyErr::warn(py, &py.get_type::<PyUserWarning>(), &message, 1)?;
        }
        to_dict(py, &pictures, self.silhouettes)
    }

    fn __repr__(&self) -> String {
        let (cameras, frames) = (self.cameras.len(), self.scene.frames.len());
        format!("Scene({:?}, {cameras} cameras, {frames} frames)", self.scene.path)
    }
}

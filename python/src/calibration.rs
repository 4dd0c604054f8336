//! Checks and refines calibrations.

use crate::{camera::Camera, error::Problem, pictures::Given, rig::Rig, work::run};
use pcmvs_core::{
    Error, Executor, Progress, Stage, View,
    calibration::{self, CalibrationParams, Finding as CoreFinding, Verdict},
};
use pcmvs_scene::Pictures;
use pyo3::{prelude::*, types::PyDict};
use std::{
    num::NonZeroUsize,
    sync::atomic::{AtomicU32, Ordering},
};

/// Something that the pictures contradict.
#[pyclass(frozen, get_all, module = "pcmvs")]
pub struct Finding {
    /// Stable name of its kind, such as "camera-bumped".
    code: &'static str,
    /// Indices of the cameras concerned: none, one or two.
    cameras: Vec<u32>,
    /// What is wrong, and what to do.
    message: String,
}

#[pymethods]
impl Finding {
    fn __repr__(&self) -> String {
        format!("Finding({}, cameras {:?}: {})", self.code, self.cameras, self.message)
    }
}

impl From<&CoreFinding> for Finding {
    fn from(finding: &CoreFinding) -> Self {
        let cameras = finding.cameras().into_iter().flatten().collect();
        Self { code: finding.code(), cameras, message: finding.to_string() }
    }
}

/// What was found about one camera. Pairs are for the given and the refined calibration. None where there is too little to
/// measure.
#[pyclass(frozen, get_all, module = "pcmvs")]
pub struct CameraReport {
    /// Median distance in pixels by which the tangents from other silhouettes miss its silhouette.
    contour_px: (Option<f64>, Option<f64>),
    /// Median distance in pixels of matches from their epipolar lines.
    epipolar_px: (Option<f64>, Option<f64>),
    /// Number of matches with other cameras.
    matches: (u32, u32),
    /// How far the refinement moves the object in its picture, in pixels.
    moved_px: f64,
    /// Standard deviation of where the refined camera sees the object, in pixels.
    sigma_px: Option<f64>,
    /// Intersection over union of its silhouette and the hull, with the given calibration.
    silhouette_overlap: Option<f64>,
    /// Brightness of its pictures over the mean of all cameras.
    gain: Option<f64>,
}

impl From<&calibration::CameraReport> for CameraReport {
    fn from(report: &calibration::CameraReport) -> Self {
        let calibration::CameraReport { given, refined, moved_px, uncertainty, silhouette_overlap, gain } = *report;
        Self {
            contour_px: (given.contour_px, refined.contour_px),
            epipolar_px: (given.epipolar_px, refined.epipolar_px),
            matches: (given.matches, refined.matches),
            moved_px,
            sigma_px: uncertainty.map(|of| of.object_px),
            silhouette_overlap,
            gain,
        }
    }
}

/// A checked and refined calibration.
#[pyclass(frozen, module = "pcmvs")]
pub struct Calibration {
    found: calibration::Calibration,
}

#[pymethods]
impl Calibration {
    /// "improved" if the refined cameras agree better with what was held out, "kept" if not, "undecided" if there is too
    /// little to judge by.
    #[getter]
    fn verdict(&self) -> &'static str {
        match self.found.verdict {
            Verdict::Improved => "improved",
            Verdict::Kept => "kept",
            Verdict::Undecided => "undecided",
        }
    }

    /// The refined cameras if they are better, else the given ones.
    #[getter]
    fn cameras(&self) -> Vec<Camera> {
        self.found.cameras.iter().map(|&camera| Camera { camera }).collect()
    }

    /// What was found about each camera.
    #[getter]
    fn reports(&self) -> Vec<CameraReport> {
        self.found.reports.iter().map(CameraReport::from).collect()
    }

    /// What is wrong with the given calibration.
    #[getter]
    fn findings(&self) -> Vec<Finding> {
        self.found.findings.iter().map(Finding::from).collect()
    }

    /// Mean of the median distances of matches from their epipolar lines over all pairs of neighbouring cameras, in pixels,
    /// for the given and the refined cameras. None without matches.
    #[getter]
    fn epipolar_bias_px(&self) -> Option<(f64, f64)> {
        self.found.epipolar_bias_px.map(Into::into)
    }

    /// Number of points that were matched in two or more views.
    #[getter]
    fn points(&self) -> u32 {
        self.found.points
    }

    fn __repr__(&self) -> String {
        format!("Calibration({}, {} findings)", self.verdict(), self.found.findings.len())
    }
}

/// Checks the cameras of a rig by the pictures of some frames of a take, and refines them. ``frames`` has a dictionary per
/// frame, as ``Scene.pictures`` gives it: "images", and "masks", "chroma" or "plates". A few frames in which the person stands
/// differently say more than one. ``intrinsics`` also refines focal lengths and principal points. ``threads`` and
/// ``progress`` are as in ``Frame.run``.
#[pyfunction]
#[pyo3(signature = (rig, frames, *, intrinsics = false, threads = None, progress = None))]
pub fn calibrate(
    py: Python,
    rig: PyRef<Rig>,
    frames: Vec<Bound<PyDict>>,
    intrinsics: bool,
    threads: Option<NonZeroUsize>,
    progress: Option<&Bound<PyAny>>,
) -> PyResult<Calibration> {
    if frames.is_empty() {
        return Err(Problem::argument("frames is empty: give at least one").into());
    }
    let rig = rig.rig.clone();
    let read = |frame: &Bound<PyDict>| Given::from_dict(frame)?.read(rig.cameras().len());
    let pictures = frames.iter().map(read).collect::<PyResult<Vec<_>>>()?;
    let params = CalibrationParams { intrinsics, ..CalibrationParams::default() };
    let work = |executor: &dyn Executor, progress: &dyn Progress| {
        let views = views(&rig, &pictures, executor, progress)?;
        let views: Vec<&[View]> = views.iter().map(Vec::as_slice).collect();
        Ok(calibration::calibrate(&rig, &views, &params, executor, progress)?)
    };
    Ok(Calibration { found: run(py, threads, progress, work)? })
}

/// The views of all frames, in the rig's order.
fn views(
    rig: &pcmvs_core::Rig,
    frames: &[Pictures],
    executor: &dyn Executor,
    progress: &dyn Progress,
) -> Result<Vec<Vec<View>>, Error> {
    let (done, cameras) = (AtomicU32::new(0), rig.cameras().len());
    let total = (frames.len() * cameras) as u32;
    let of_frame = |pictures: &Pictures| {
        let inputs = pictures.inputs();
        let read = executor.map(cameras, |camera| {
            if !progress.step(Stage::Views, done.fetch_add(1, Ordering::Relaxed), total) {
                return Err(Error::Cancelled);
            }
            calibration::view(rig, camera, inputs[camera].as_ref())
        });
        let mut views = read.into_iter().collect::<Result<Vec<_>, _>>()?;
        views.sort_by_key(|view| view.index);
        Ok(views)
    };
    frames.iter().map(of_frame).collect()
}

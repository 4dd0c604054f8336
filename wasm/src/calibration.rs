//! Check and refinement of a calibration.

use crate::{
    diagnostics::Warning,
    error::Failed,
    frame::Frame,
    progress::Callback,
    rig::Rig,
    types::{Calibration, ProgressFunction},
};
use pcmvs_core::{
    Camera, Serial, View,
    calibration::{self, CalibrationParams, CameraReport, Finding, Residuals, Verdict, calibrate},
};
use pcmvs_scene::SceneCamera;
use serde::Serialize;
use serde_wasm_bindgen::Serializer;
use std::rc::Rc;
use wasm_bindgen::prelude::*;

/// Checks the calibration of a rig by one or more frames of a take, and looks for cameras that fit them better. Call
/// `free()` when it is no longer needed.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Calibrator {
    rig: Rig,
    /// The views of each frame, in the rig's order, without their colours.
    frames: Vec<Vec<View>>,
}

#[wasm_bindgen]
impl Calibrator {
    /// Without any frame.
    #[wasm_bindgen(constructor)]
    pub fn new(rig: &Rig) -> Calibrator {
        Self { rig: rig.clone(), frames: Vec::new() }
    }

    /// Adds what a frame shows. The frame may be freed afterwards. Throws `PcmvsError`.
    pub fn add(&mut self, frame: &Frame) -> Result<(), Failed> {
        if !Rc::ptr_eq(&self.rig.rig, frame.rig()) {
            return Err(Failed::input("the frame is of another rig: make it with the rig of the calibrator"));
        }
        self.frames.push(frame.views()?);
        Ok(())
    }

    /// Checks and refines. `progress("detect", done, total)` is called on the way; when it returns false, an error of code
    /// `cancelled` is thrown. Throws `PcmvsError`.
    pub fn run(&self, progress: Option<ProgressFunction>) -> Result<Calibration, Failed> {
        if self.frames.is_empty() {
            return Err(Failed::input("there is no frame to check the calibration by: add one"));
        }
        let callback = Callback::new(progress);
        let frames: Vec<&[View]> = self.frames.iter().map(Vec::as_slice).collect();
        let found = calibrate(&self.rig.rig, &frames, &CalibrationParams::default(), &Serial, &callback);
        let found = found.map_err(|error| callback.failed(&error))?;
        let object = Found::new(&found, &self.rig.names).serialize(&Serializer::json_compatible())?;
        Ok(object.unchecked_into())
    }
}

/// `Calibration`.
#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Found {
    verdict: &'static str,
    cameras: Vec<SceneCamera>,
    reports: Vec<Report>,
    points: u32,
    epipolar_bias_px: Option<[f64; 2]>,
    held_out_loss: Option<[f64; 2]>,
    warnings: Vec<Warning>,
}

impl Found {
    fn new(found: &calibration::Calibration, names: &[String]) -> Self {
        let camera = |(camera, name): (&Camera, &String)| SceneCamera::new(name.clone(), camera);
        Self {
            verdict: match found.verdict {
                Verdict::Improved => "improved",
                Verdict::Kept => "kept",
                Verdict::Undecided => "undecided",
            },
            cameras: found.cameras.iter().zip(names).map(camera).collect(),
            reports: found.reports.iter().map(Report::from).collect(),
            points: found.points,
            epipolar_bias_px: found.epipolar_bias_px,
            held_out_loss: found.held_out,
            warnings: found.findings.iter().flat_map(warnings).collect(),
        }
    }
}

/// `CalibrationReport`.
#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Report {
    given: Fit,
    refined: Fit,
    moved_px: f64,
    sigma_px: Option<f64>,
    silhouette_overlap: Option<f64>,
    gain: Option<f64>,
}

impl From<&CameraReport> for Report {
    fn from(report: &CameraReport) -> Self {
        let CameraReport { given, refined, moved_px, uncertainty, silhouette_overlap, gain } = *report;
        let sigma_px = uncertainty.map(|of| of.object_px);
        Self { given: given.into(), refined: refined.into(), moved_px, sigma_px, silhouette_overlap, gain }
    }
}

/// `CalibrationFit`.
#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Fit {
    contour_px: Option<f64>,
    epipolar_px: Option<f64>,
    noise_px: Option<f64>,
    matches: u32,
}

impl From<Residuals> for Fit {
    fn from(Residuals { contour_px, epipolar_px, noise_px, matches }: Residuals) -> Self {
        Self { contour_px, epipolar_px, noise_px, matches }
    }
}

/// A finding as one warning per camera concerned, or as one about no camera.
fn warnings(finding: &Finding) -> Vec<Warning> {
    let about = |camera, message| Warning { code: finding.code(), camera, message };
    match finding.cameras() {
        [Some(a), Some(b)] => {
            let with = |other: u32| format!("together with camera {other}: {finding}");
            vec![about(Some(a), with(b)), about(Some(b), with(a))]
        }
        [camera, _] => vec![about(camera, finding.to_string())],
    }
}

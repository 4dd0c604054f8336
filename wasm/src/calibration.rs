//! Check and refinement of a calibration.

use crate::{error::Failed, frame::Frame, progress::Callback, rig::Rig, types::ProgressFunction, warning::Warning};
use pcmvs_core::{
    Camera, Serial, View,
    calibration::{self, CalibrationParams, CameraReport, Finding, Residuals, Verdict, calibrate},
};
use pcmvs_scene::SceneCamera;
use serde::Serialize;
use serde_wasm_bindgen::Serializer;
use std::rc::Rc;
use wasm_bindgen::prelude::*;

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r#"
/** How well a camera fits the others. What could not be measured is null. */
export interface CalibrationFit {
    /** Median distance in pixels by which the tangents from other silhouettes miss this camera's silhouette. */
    contourPx: number | null;
    /** Median distance in pixels of this camera's matches with others from their epipolar lines. */
    epipolarPx: number | null;
    /** Standard deviation in pixels of single matches, whatever the calibration is. */
    noisePx: number | null;
    /** Number of matches with other cameras. */
    matches: number;
}

/** What a check of the calibration measured of a camera. What could not be measured is null. */
export interface CalibrationReport {
    given: CalibrationFit;
    /** With the refined cameras, whether they are kept or not. */
    refined: CalibrationFit;
    /** How far the refinement moves the object in this camera's picture, in pixels. */
    movedPx: number;
    /** Standard deviation in pixels of where the refined camera sees the object. */
    sigmaPx: number | null;
    /** Intersection over union of the silhouette and the visual hull's picture with the given cameras, 0..1. */
    silhouetteOverlap: number | null;
    /** Brightness of its pictures over the mean of all cameras. */
    gain: number | null;
}

/** What a check of the calibration found out. */
export interface Calibration {
    /** Whether the refined cameras fit better; with "undecided" there was too little to judge by. */
    verdict: "improved" | "kept" | "undecided";
    /** The refined cameras if they fit better, else the given ones. */
    cameras: Camera[];
    /** One per camera. */
    reports: CalibrationReport[];
    /** Number of points that were matched in two or more views. */
    points: number;
    /** By how many pixels epipolar lines miss, as the mean over all pairs of cameras: given, refined. */
    epipolarBiasPx: [number, number] | null;
    /** Mean loss over the evidence that was held out; smaller is better: given, refined. */
    heldOutLoss: [number, number] | null;
    /** What is wrong with the given calibration. */
    warnings: Warning[];
}
"#;

#[wasm_bindgen]
extern "C" {
    /// `Calibration`.
    #[wasm_bindgen(typescript_type = "Calibration")]
    pub type Calibration;
}

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
        self.frames.push(views(frame)?);
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

/// The views of all cameras in the rig's order.
fn views(frame: &Frame) -> Result<Vec<View>, Failed> {
    let view = |&camera: &u32| {
        let view = calibration::view(frame.rig(), camera as usize, frame.input(camera as usize)?.as_ref());
        view.map_err(|error| Failed::core(&error, None))
    };
    frame.rig().order().iter().map(view).collect()
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

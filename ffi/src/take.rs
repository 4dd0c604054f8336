//! What the lock of a calibration's handle protects, in safe Rust.

use crate::{
    failure::{Failure, Result},
    image::{Calibrated, calibrated},
    status::pcmvs_status::WrongOrder,
};
use pcmvs_core::{
    Error, Executor, Progress, Rig, Stage, View, ViewInput,
    calibration::{self, Calibration, CalibrationParams, CameraReport, calibrate},
};
use std::sync::{
    Arc,
    atomic::{AtomicU32, Ordering},
};

/// Some frames of a take, and what they say about its cameras.
pub(crate) struct Take {
    rig: Arc<Rig>,
    /// The views of each frame in the rig's order, without their colours, which nothing reads.
    frames: Vec<Vec<View>>,
    found: Option<Calibration>,
}

impl Take {
    pub fn new(rig: Arc<Rig>) -> Self {
        Self { rig, frames: Vec::new(), found: None }
    }

    pub fn cameras(&self) -> usize {
        self.rig.cameras().len()
    }

    /// The calibrated sizes of the cameras.
    pub fn calibrated(&self) -> Vec<Calibrated> {
        calibrated(self.rig.cameras())
    }

    /// Number of frames that have been added.
    pub fn frames(&self) -> u32 {
        self.frames.len() as u32
    }

    /// Reads the views of one frame, one per camera, and discards what was found without it. A camera without picture has
    /// none. On failure nothing changes.
    pub fn add(&mut self, inputs: &[Option<ViewInput>], threads: &dyn Executor, progress: &dyn Progress) -> Result<()> {
        let (done, total) = (AtomicU32::new(0), inputs.len() as u32);
        let report = || {
            let go_on = progress.step(Stage::Views, done.load(Ordering::Relaxed), total);
            if go_on { Ok(()) } else { Err(Error::Cancelled) }
        };
        let read = |camera: usize| {
            report()?;
            let view = calibration::view(&self.rig, camera, inputs[camera].as_ref())?;
            done.fetch_add(1, Ordering::Relaxed);
            Ok(view)
        };
        let views = threads.map(inputs.len(), read).into_iter().collect::<std::result::Result<Vec<_>, Error>>();
        let views = views.and_then(|views| report().map(|()| views));
        let mut views = views.map_err(|error| Failure::from(error).at(Stage::Views))?;
        views.sort_by_key(|view| view.index);
        self.frames.push(views);
        self.found = None;
        Ok(())
    }

    /// Checks and refines the cameras. On failure there is no result.
    pub fn run(&mut self, params: &CalibrationParams, threads: &dyn Executor, progress: &dyn Progress) -> Result<()> {
        self.found = None;
        if self.frames.is_empty() {
            let problem = "the calibration has no frames yet: call pcmvs_calibration_add_frame";
            return Err(Failure::new(WrongOrder, problem));
        }
        let frames: Vec<&[View]> = self.frames.iter().map(Vec::as_slice).collect();
        self.found = Some(calibrate(&self.rig, &frames, params, threads, progress)?);
        Ok(())
    }

    /// What was found.
    pub fn found(&self) -> Result<&Calibration> {
        let problem = "the calibration has no results yet: call pcmvs_calibration_run";
        self.found.as_ref().ok_or_else(|| Failure::new(WrongOrder, problem))
    }

    /// What was found about one camera.
    pub fn found_of(&self, camera: u32) -> Result<(&Calibration, &CameraReport)> {
        let found = self.found()?;
        let missing = Error::NoSuchCamera { camera, cameras: self.cameras() as u32 };
        let report = found.reports.get(camera as usize).ok_or(missing)?;
        Ok((found, report))
    }
}

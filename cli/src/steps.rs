//! Which cameras of a take are out of step.

use crate::{arguments::List, run::Run, warning::WarningReport};
use pcmvs_core::{Camera, Progress, Rig, View, calibration::out_of_step};
use pcmvs_scene::{Disk, Failure, FrameFiles, Scene, SceneCamera, SceneFrame};
use serde_json::{Map, Value};

/// Successive frames that are used if none are asked for.
const FRAMES: usize = 8;

/// What was found, and in which frames.
pub struct Steps {
    frames: Vec<u32>,
    /// For every camera the frames by which its pictures are late besides its offset, if that is known.
    pub late: Vec<Option<i32>>,
}

impl Run<'_> {
    /// Compares the cameras in successive frames: those asked for, or those in the middle of the take. A single frame tells
    /// nothing.
    pub fn steps(&self, cameras: &[Camera], asked: Option<&List>) -> Result<Option<Steps>, Failure> {
        let frames = successive(self.scene, asked)?;
        if frames.len() < 2 {
            return Ok(None);
        }
        let rig = Rig::new(cameras).map_err(|error| self.scene.explain(&error, None))?;
        let views = frames.iter().map(|frame| Ok((frame.index, self.silhouettes(&rig, frame)?)));
        let views: Vec<(u32, Vec<View>)> = views.collect::<Result<_, Failure>>()?;
        let progress = self.console.frame(frames[0].index);
        progress.begin("compare");
        let late = out_of_step(&rig, &views, self.threads, &progress as &dyn Progress);
        progress.end("compare");
        let late = late.map_err(|error| self.scene.explain(&error, None))?;
        Ok(Some(Steps { frames: frames.iter().map(|frame| frame.index).collect(), late }))
    }

    /// The silhouettes of a frame, in the rig's order, as they were given.
    fn silhouettes(&self, rig: &Rig, frame: &SceneFrame) -> Result<Vec<View>, Failure> {
        let files = FrameFiles::read(&Disk, self.videos, self.scene, frame, self.silhouettes)?;
        let pictures = files.decode(self.threads)?;
        let (order, inputs) = (rig.order(), pictures.inputs());
        let made = self.threads.map(order.len(), |place| {
            if self.console.is_cancelled() {
                return Err(Failure::Cancelled);
            }
            let camera = order[place] as usize;
            let view = match &inputs[camera] {
                Some(input) => View::new(rig, camera, input, None),
                None => View::absent(rig, camera),
            };
            let view = view.map_err(|error| self.scene.explain(&error, Some(frame)))?;
            Ok(View::of_silhouette(view.index, view.camera, view.silhouette))
        });
        made.into_iter().collect()
    }
}

/// The frames asked for, or some in the middle of the take, sorted by index.
fn successive(scene: &Scene, asked: Option<&List>) -> Result<Vec<SceneFrame>, Failure> {
    let mut frames: Vec<&SceneFrame> = match asked {
        Some(List(asked)) => asked.iter().map(|&index| scene.frame(index)).collect::<Result<_, _>>()?,
        None => scene.frames.iter().collect(),
    };
    frames.sort_by_key(|frame| frame.index);
    let count = if asked.is_some() { frames.len() } else { frames.len().min(FRAMES) };
    let first = (frames.len() - count) / 2;
    Ok(frames[first..][..count].iter().map(|&frame| frame.clone()).collect())
}

impl Steps {
    /// Whether a camera is known to be out of step.
    pub fn is_any_out(&self) -> bool {
        self.late.iter().flatten().any(|&late| late != 0)
    }

    /// The cameras that are out of step, each with the remedy.
    pub fn warnings(&self, scene: &Scene) -> Vec<WarningReport> {
        let out =
            scene.cameras.iter().zip(&self.late).filter_map(|(camera, late)| Some((camera, late.filter(|&l| l != 0)?)));
        let warning = |(camera, late): (&SceneCamera, i32)| WarningReport {
            code: String::from("out-of-step"),
            frame: None,
            camera: Some(camera.name.clone()),
            message: format!(
                "{}: camera `{}`: its silhouettes are {} {} {} those of the others: write {} into scene.json, and check again",
                scene.path.display(),
                camera.name,
                late.abs(),
                if late.abs() == 1 { "frame" } else { "frames" },
                if late > 0 { "behind" } else { "ahead of" },
                self.line(scene),
            ),
        };
        out.map(warning).collect()
    }

    /// The line of scene.json that brings all cameras into step.
    fn line(&self, scene: &Scene) -> String {
        let offset = |(camera, late): (&SceneCamera, &Option<i32>)| {
            let offset = camera.offset + late.unwrap_or(0);
            (offset != 0).then(|| (camera.name.clone(), Value::from(offset)))
        };
        let offsets: Map<String, Value> = scene.cameras.iter().zip(&self.late).filter_map(offset).collect();
        format!("\"offsets\": {}", Value::Object(offsets))
    }

    /// What the frames do not tell, for the terminal.
    pub fn unknown(&self) -> Option<String> {
        let unknown = self.late.iter().filter(|late| late.is_none()).count();
        (unknown > 0).then(|| {
            format!(
                "frames {} to {} do not tell of {unknown} of {} cameras whether they are in step: name successive frames with \
                 motion by --frames, at least eight",
                self.frames[0],
                self.frames[self.frames.len() - 1],
                self.late.len()
            )
        })
    }
}

//! Makes one frame: reads its files, reconstructs it, averages it with its neighbours and writes its mesh.

use crate::{
    fingerprint::{Fingerprint, sha256},
    json,
    mesh_file::{Made, MeshFile},
    output,
    progress::{Console, FrameProgress},
    report::{CameraReport, Earlier, FrameReport, peak_memory},
    video::Videos,
    warning::WarningReport,
};
use pcmvs_core::{
    Error, Frame, Memory, Mesh, Params, PointCloud, Reconstruction, Rig, Stage, export::ply, steady::SteadyParams,
};
use pcmvs_scene::{DecodedView, Disk, Failure, FrameFiles, Scene, SceneFrame, Silhouettes, Threads};
use std::{
    fs,
    mem::take,
    path::{Path, PathBuf},
};

/// Why a frame cannot be made.
enum Problem {
    File(Failure),
    Core(Error),
}

impl From<Failure> for Problem {
    fn from(failure: Failure) -> Self {
        Self::File(failure)
    }
}

impl From<Error> for Problem {
    fn from(error: Error) -> Self {
        Self::Core(error)
    }
}

/// What all frames of a run share.
pub struct Job<'a> {
    pub scene: &'a Scene,
    /// Indices of the frames to write. The scene has those that they are averaged with besides.
    pub asked: &'a [u32],
    /// Whether frames are not averaged with their neighbours.
    pub alone: bool,
    pub rig: &'a Rig,
    pub params: &'a Params,
    /// Memory limit per frame, in bytes.
    pub max_memory: Option<u64>,
    pub silhouettes: Silhouettes,
    pub videos: &'a Videos,
    /// Whether warnings are errors.
    pub strict: bool,
    pub mesh_file: MeshFile,
    pub stages: bool,
    pub folder: &'a Path,
    pub threads: &'a Threads,
    pub console: &'a Console<'a>,
    /// Fingerprint of the program, the parameters and the cameras.
    pub settings: &'a Fingerprint,
    /// What an earlier run finished.
    pub earlier: &'a Earlier,
}

/// A frame that has been reconstructed by itself.
pub struct Own<'a> {
    frame: &'a SceneFrame,
    made: Frame<&'a Rig>,
    progress: FrameProgress<'a>,
}

impl Own<'_> {
    /// The mesh of the frame alone.
    pub fn mesh(&self) -> &Mesh {
        self.made.own_mesh()
    }
}

impl Job<'_> {
    /// Whether a frame's mesh is to be written.
    pub fn is_asked(&self, index: u32) -> bool {
        self.asked.binary_search(&index).is_ok()
    }

    /// Reads the pictures of a frame.
    pub fn read<'s>(&'s self, frame: &'s SceneFrame) -> Result<FrameFiles<'s>, Failure> {
        if self.console.is_cancelled() {
            return Err(Failure::Cancelled);
        }
        FrameFiles::read(&Disk, self.videos, self.scene, frame, self.silhouettes)
    }

    /// SHA-256 of a frame's pictures and masks.
    pub fn digest(files: &FrameFiles) -> String {
        let mut digest = Fingerprint::default();
        for file in files.contents() {
            digest.add_optional(file);
        }
        digest.finish()
    }

    /// What the result of a frame depends on: the settings, its own pictures, and those of its neighbours. A neighbour that
    /// has no result has no digest.
    pub fn fingerprint(&self, own: &str, neighbours: impl IntoIterator<Item = Option<String>>) -> String {
        let mut fingerprint = self.settings.clone();
        fingerprint.add(own.as_bytes());
        for neighbour in neighbours {
            fingerprint.add_optional(neighbour.as_deref().map(str::as_bytes));
        }
        fingerprint.finish()
    }

    /// The result of an earlier run for a frame, if it is still there and nothing has changed.
    pub fn kept(&self, frame: &SceneFrame, fingerprint: &str) -> Option<&FrameReport> {
        let earlier = self.earlier.frames.iter().find(|e| e.index == frame.index && e.fingerprint == fingerprint);
        earlier.filter(|earlier| self.is_still_there(earlier))
    }

    /// Keeps the result of an earlier run. Its warnings are written to the terminal and added to `warnings`.
    pub fn keep(
        &self,
        frame: &SceneFrame,
        earlier: &FrameReport,
        warnings: &mut Vec<WarningReport>,
    ) -> Result<FrameReport, Failure> {
        self.warn(warnings, self.earlier.warnings_of(frame.index).cloned().collect());
        self.accept(frame, warnings)?;
        self.console.line(&format!("frame {} has not changed: its mesh is kept", frame.index));
        Ok(earlier.clone())
    }

    /// Averages a frame with its neighbours, if there are any, and writes its mesh.
    pub fn finish(
        &self,
        own: Own,
        neighbours: &[&Mesh],
        fingerprint: String,
        warnings: &mut Vec<WarningReport>,
    ) -> Result<FrameReport, Failure> {
        let Own { frame, mut made, progress } = own;
        self.accept(frame, warnings)?;
        let explain = |error| self.scene.explain(&error, Some(frame));
        if !neighbours.is_empty() {
            made.steady(neighbours, &SteadyParams::DEFAULT, self.threads, &progress).map_err(explain)?;
        }
        let file = self.mesh_file.make(&made, frame.index, self.threads, &progress);
        let Made { bytes, bounds, warning } = file.map_err(explain)?;
        self.warn(warnings, warning.into_iter().collect());
        self.accept(frame, warnings)?;

        let result = made.into_reconstruction();
        progress.begin("write");
        let bounds = bounds.ok_or_else(|| Failure::Other(format!("frame {}: the mesh is empty", frame.index)))?;
        if self.stages {
            self.write_stages(frame.index, &result)?;
        }
        let file = output::frame_name(frame.index, self.mesh_file.extension());
        output::write(&self.folder.join(&file), &bytes)?;
        progress.end("write");

        let hash = |&(stage, hash): &(Stage, u64)| (stage.name().to_owned(), format!("{hash:016x}").into());
        let names = self.scene.cameras.iter().map(|camera| &camera.name);
        Ok(FrameReport {
            index: frame.index,
            file,
            bytes: bytes.len() as u64,
            sha256: sha256(&bytes),
            fingerprint,
            bounds,
            seconds: progress.seconds().into_iter().map(|(step, s)| (step.to_owned(), s.into())).collect(),
            counts: json::to_value(&result.counts),
            cameras: names.zip(&result.diagnostics).map(|(name, found)| CameraReport::new(name, found)).collect(),
            hashes: result.hashes.iter().map(hash).collect(),
            peak_memory: peak_memory(),
        })
    }

    /// Writes warnings to the terminal and keeps them.
    fn warn(&self, kept: &mut Vec<WarningReport>, warnings: Vec<WarningReport>) {
        for warning in &warnings {
            self.console.warn(warning);
        }
        kept.extend(warnings);
    }

    /// Refuses a frame that has warnings, if they are errors.
    fn accept(&self, frame: &SceneFrame, warnings: &[WarningReport]) -> Result<(), Failure> {
        if !self.strict || warnings.is_empty() {
            return Ok(());
        }
        Err(Failure::Input(format!(
            "frame {}: its warnings are errors with --strict, see the {} above: correct what they name, or run without \
             --strict",
            frame.index,
            warnings.len()
        )))
    }

    fn is_still_there(&self, earlier: &FrameReport) -> bool {
        let same = fs::read(self.folder.join(&earlier.file)).is_ok_and(|bytes| sha256(&bytes) == earlier.sha256);
        same && (!self.stages || self.stages_folder(earlier.index).is_dir())
    }

    /// Reconstructs a frame by itself. Warnings are written to the terminal and added to `warnings`, also if the frame fails.
    pub fn reconstruct<'s>(
        &'s self,
        frame: &'s SceneFrame,
        mut files: FrameFiles,
        warnings: &mut Vec<WarningReport>,
    ) -> Result<Own<'s>, Failure> {
        let progress = self.console.frame(frame.index);
        let missing = take(&mut files.missing);
        let missing = missing.into_iter().map(|file| WarningReport::of_missing(file, self.scene, frame));
        self.warn(warnings, missing.collect());
        let memory = self.max_memory.map_or_else(Memory::default, Memory::limited);
        let mut made = Frame::new(self.rig, *self.params, memory);
        made.keep_intermediates(self.stages);
        made.keep_views(false);
        // Pictures are decoded one after the other, as their views are read, because all of them together take two thirds of
        // the memory of their views.
        let files = files.into_views(self.threads);
        let read = made.read_views(self.threads, &progress, |camera, give| {
            let decoded = files.decode(camera)?;
            let input = decoded.as_ref().map(DecodedView::input);
            give(input.as_ref()).map_err(Problem::Core)
        });
        let result = read.and_then(|()| made.run_stages(self.threads, &progress).map_err(Problem::Core));
        self.warn(warnings, self.warnings_of(&made, frame, warnings));
        result.map_err(|problem| match problem {
            Problem::File(failure) => failure,
            Problem::Core(error) => self.scene.explain(&error, Some(frame)),
        })?;
        Ok(Own { frame, made, progress })
    }

    /// The core's warnings about a frame. That a camera has no picture or mask goes without saying where `known` says that
    /// its file is missing.
    fn warnings_of(&self, made: &Frame<&Rig>, frame: &SceneFrame, known: &[WarningReport]) -> Vec<WarningReport> {
        let found = made.warnings().into_iter().filter(|warning| !warning.is_about_rig());
        let found = found.map(|warning| WarningReport::of_core(&warning, self.scene, Some(frame)));
        let is_known = |warning: &WarningReport| {
            let explains = |code: &str| match code {
                "missing-picture" => "no-picture",
                "missing-mask" | "missing-plate" => "no-silhouette",
                _ => "",
            };
            known.iter().any(|known| known.camera == warning.camera && explains(&known.code) == warning.code)
        };
        found.filter(|warning| !is_known(warning)).collect()
    }

    fn stages_folder(&self, index: u32) -> PathBuf {
        self.folder.join("stages").join(format!("frame_{index:04}"))
    }

    /// Writes the intermediate results. The folder appears under its final name when it is complete.
    fn write_stages(&self, index: u32, result: &Reconstruction) -> Result<(), Failure> {
        let (origin, stages) = (self.rig.origin(), &result.intermediates);
        let folder = self.stages_folder(index);
        let temporary = output::temporary(&folder);
        let unwritable = |e| Failure::unwritable(&folder, &e);
        for old in [&temporary, &folder] {
            if old.exists() {
                fs::remove_dir_all(old).map_err(unwritable)?;
            }
        }
        let mesh = |name: &str, mesh: &Mesh| output::write(&temporary.join(name), &ply::write_mesh(mesh, origin));
        let cloud =
            |name: &str, cloud: &PointCloud| output::write(&temporary.join(name), &ply::write_cloud(cloud, origin));
        mesh("hull.ply", &stages.hull)?;
        for (view, points) in stages.detected.iter().enumerate() {
            cloud(&format!("detect_{view:02}.ply"), points)?;
        }
        mesh("coarse.ply", &stages.coarse)?;
        cloud("frontier.ply", &stages.frontier)?;
        cloud("implicit.ply", &stages.implicit)?;
        cloud("merge.ply", &stages.merged)?;
        mesh("mesh.ply", &Mesh { colours: Vec::new(), ..result.mesh.clone() })?;
        mesh("colour.ply", &result.mesh)?;
        fs::rename(&temporary, &folder).map_err(unwritable)
    }
}

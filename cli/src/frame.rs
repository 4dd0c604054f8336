//! Makes one frame: reads its files, reconstructs it, averages it with its neighbours and writes its mesh.

use crate::{
    fingerprint::{Fingerprint, sha256},
    json,
    kept::Kept,
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
    /// A copy of what its neighbours need of it.
    pub fn kept(&self) -> Kept {
        Kept { mesh: self.made.own_mesh().clone(), overruled: self.made.overruled() }
    }

    /// Whether the frames two before and two after it may tell what it has lost.
    pub fn look_beyond(&self, job: &Job, neighbours: [&Kept; 2]) -> Result<[bool; 2], Failure> {
        let look_beyond = self.made.look_beyond(neighbours.map(Kept::beside), job.threads);
        look_beyond.map_err(|error| job.scene.explain(&error, Some(self.frame)))
    }
}

/// A frame before and one after another one.
pub struct Pair<'a, 'k> {
    pub frames: [&'a SceneFrame; 2],
    pub kept: [&'k Kept; 2],
}

/// Whether a warning of this code is about files that do not exist.
fn is_about_files(code: &str) -> bool {
    code.starts_with("missing-")
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

    /// What the result of a frame depends on: the settings, its own pictures, and those of other frames, which are its neighbours
    /// and, if they were looked at, the frames beyond them. A frame that has no result has no digest.
    pub fn fingerprint(&self, own: &str, others: impl IntoIterator<Item = Option<String>>) -> String {
        let mut fingerprint = self.settings.clone();
        fingerprint.add(own.as_bytes());
        for other in others {
            fingerprint.add_optional(other.as_deref().map(str::as_bytes));
        }
        fingerprint.finish()
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

    /// Averages a frame with its neighbours, if there are any, and writes its mesh. `beyond` are the other frames that it has
    /// looked at.
    pub fn finish(
        &self,
        own: Own,
        neighbours: &[&Mesh],
        fingerprint: String,
        beyond: Vec<u32>,
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
            beyond,
            bounds,
            seconds: progress.seconds().into_iter().map(|(step, s)| (step.to_owned(), s.into())).collect(),
            counts: json::to_value(&result.counts),
            cameras: names.zip(&result.diagnostics).map(|(name, found)| CameraReport::new(name, found)).collect(),
            hashes: result.hashes.iter().map(hash).collect(),
            peak_memory: peak_memory(),
        })
    }

    /// Writes warnings to the terminal.
    pub fn say(&self, warnings: &[WarningReport]) {
        for warning in warnings {
            self.console.warn(warning);
        }
    }

    /// Writes warnings to the terminal and keeps them.
    fn warn(&self, kept: &mut Vec<WarningReport>, warnings: Vec<WarningReport>) {
        self.say(&warnings);
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

    /// Whether the files of an earlier result are as they were written.
    pub fn is_still_there(&self, earlier: &FrameReport) -> bool {
        let same = fs::read(self.folder.join(&earlier.file)).is_ok_and(|bytes| sha256(&bytes) == earlier.sha256);
        same && (!self.stages || self.stages_folder(earlier.index).is_dir())
    }

    /// Reconstructs a frame by itself. Warnings are added to `warnings`, also if the frame fails, and are not yet written to the
    /// terminal ([`Self::say`]), because the frame may be made again ([`Self::restored`]).
    pub fn reconstruct<'s>(
        &'s self,
        frame: &'s SceneFrame,
        mut files: FrameFiles,
        warnings: &mut Vec<WarningReport>,
    ) -> Result<Own<'s>, Failure> {
        let progress = self.console.frame(frame.index);
        let missing = take(&mut files.missing);
        let missing = missing.into_iter().map(|file| WarningReport::of_missing(file, self.scene, frame));
        warnings.extend(missing);
        let mut made = self.empty_frame();
        // Pictures are decoded one after the other, as their views are read, because all of them together take two thirds of
        // the memory of their views.
        let files = files.into_views(self.threads);
        let read = made.read_views(self.threads, &progress, |camera, give| {
            let decoded = files.decode(camera)?;
            let input = decoded.as_ref().map(DecodedView::input);
            give(input.as_ref()).map_err(Problem::Core)
        });
        let result = read.and_then(|()| made.run_stages(self.threads, &progress).map_err(Problem::Core));
        warnings.extend(self.warnings_of(&made, frame, warnings));
        result.map_err(|problem| match problem {
            Problem::File(failure) => failure,
            Problem::Core(error) => self.scene.explain(&error, Some(frame)),
        })?;
        Ok(Own { frame, made, progress })
    }

    /// Makes a frame again if it lacks a part that the two frames of a pair have, and its pictures show that part. Of the pairs,
    /// that counts which gives back a part of the most silhouettes; of equal ones, the first. `read` reads the files of a frame.
    /// If no picture shows such a part, the frame stays as it is. Otherwise `warnings` are replaced by those of the new frame.
    pub fn restored<'s>(
        &'s self,
        own: Own<'s>,
        pairs: &[Pair<'s, '_>],
        read: impl Fn([&'s SceneFrame; 3]) -> Result<[FrameFiles<'s>; 3], Failure>,
        warnings: &mut Vec<WarningReport>,
    ) -> Result<Own<'s>, Failure> {
        let frame = own.frame;
        let mut best = None;
        for pair in pairs {
            let may_have = own.made.may_have_lost_part(pair.kept.map(Kept::beside), self.threads);
            if !may_have.map_err(|error| self.scene.explain(&error, Some(frame)))? {
                continue;
            }
            let [before, after] = pair.frames;
            let (made, silhouettes) = self.views_between(frame, read([frame, before, after])?, &own.progress)?;
            if silhouettes > best.as_ref().map_or(0, |&(_, most, _)| most) {
                best = Some((made, silhouettes, pair.frames));
            }
        }
        let Some((mut made, silhouettes, [before, after])) = best else { return Ok(own) };
        // Its memory is needed.
        let Own { progress, .. } = own;
        self.console.line(&format!(
            "frame {} is made again: frames {} and {} have a part that {silhouettes} of its silhouettes lack and its pictures show",
            frame.index, before.index, after.index
        ));
        made.run_stages(self.threads, &progress).map_err(|error| self.scene.explain(&error, Some(frame)))?;
        // What is missing on the disk is missing still.
        warnings.retain(|warning| is_about_files(&warning.code));
        warnings.extend(self.warnings_of(&made, frame, warnings));
        Ok(Own { frame, made, progress })
    }

    /// The views of a frame, with what its silhouettes lack and those of two other frames have, and the number of silhouettes
    /// that got something.
    fn views_between<'s>(
        &'s self,
        frame: &SceneFrame,
        files: [FrameFiles; 3],
        progress: &FrameProgress,
    ) -> Result<(Frame<&'s Rig>, u32), Failure> {
        let made = self.empty_frame();
        let files = files.map(|files| files.into_views(self.threads));
        let restored = made.read_views_between(self.threads, progress, |camera, give| {
            let [own, before, after] = [0, 1, 2].map(|file: usize| files[file].decode(camera));
            let [own, before, after] = [own?, before?, after?];
            let [own, before, after] = [&own, &before, &after].map(|view| view.as_ref().map(DecodedView::input));
            give(own.as_ref(), [before.as_ref(), after.as_ref()]).map_err(Problem::Core)
        });
        let restored = restored.map_err(|problem| match problem {
            Problem::File(failure) => failure,
            Problem::Core(error) => self.scene.explain(&error, Some(frame)),
        })?;
        Ok((made, restored))
    }

    /// A frame without views.
    fn empty_frame(&self) -> Frame<&Rig> {
        let memory = self.max_memory.map_or_else(Memory::default, Memory::limited);
        let mut made = Frame::new(self.rig, *self.params, memory);
        made.keep_intermediates(self.stages);
        made.keep_views(false);
        made
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

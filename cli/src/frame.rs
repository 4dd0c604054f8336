//! Reconstructs one frame: reads its files and writes its mesh.

use crate::{
    arguments::Format,
    fingerprint::{Fingerprint, sha256},
    json, output,
    progress::{Console, FrameProgress},
    report::{FrameReport, peak_memory},
    threads::Threads,
};
use pcmvs_core::{
    ChromaKey, Executor, Frame, Mask, Memory, Mesh, Params, PointCloud, Progress, Reconstruction, Rig, Stage,
    ViewInput,
    export::{bounds, glb, ply},
};
use pcmvs_scene::{Failure, Picture, Scene, SceneFrame};
use std::{
    fs,
    path::{Path, PathBuf},
};

/// What all frames of a run share.
pub struct Job<'a> {
    pub scene: &'a Scene,
    pub rig: &'a Rig,
    pub params: &'a Params,
    /// Memory limit per frame, in bytes.
    pub max_memory: Option<u64>,
    /// Silhouettes from the backdrop's colour instead of mask files.
    pub key: Option<ChromaKey>,
    pub format: Format,
    pub stages: bool,
    pub folder: &'a Path,
    pub threads: &'a Threads,
    pub console: &'a Console<'a>,
    /// Fingerprint of the program, the parameters and the cameras.
    pub settings: &'a Fingerprint,
    /// Frames that an earlier run finished.
    pub earlier: &'a [FrameReport],
}

/// The files of one camera and one frame, not yet decoded.
struct Files {
    image: Vec<u8>,
    mask: Option<Vec<u8>>,
}

impl Job<'_> {
    /// Reconstructs a frame, or keeps the result of an earlier run if nothing has changed.
    pub fn run(&self, frame: &SceneFrame) -> Result<FrameReport, Failure> {
        if self.console.is_cancelled() {
            return Err(Failure::Cancelled);
        }
        let files = self.read(frame)?;
        let fingerprint = self.fingerprint(&files);
        if let Some(earlier) = self.earlier.iter().find(|e| e.index == frame.index && e.fingerprint == fingerprint)
            && self.is_still_there(earlier)
        {
            self.console.line(&format!("frame {} has not changed: its mesh is kept", frame.index));
            return Ok(earlier.clone());
        }
        let progress = self.console.frame(frame.index);
        let result = self.reconstruct(frame, files, &progress)?;

        progress.begin("write");
        let origin = self.rig.origin();
        let bounds = bounds(&result.mesh, origin)
            .ok_or_else(|| Failure::Other(format!("frame {}: the mesh is empty", frame.index)))?;
        if self.stages {
            self.write_stages(frame.index, &result)?;
        }
        let bytes = match self.format {
            Format::Glb => glb::write(&result.mesh, origin, &glb::Options { up: self.scene.up, ..Default::default() }),
            Format::Ply => ply::write_mesh(&result.mesh, origin),
        };
        let file = output::frame_name(frame.index, self.format.extension());
        output::write(&self.folder.join(&file), &bytes)?;
        progress.end("write");

        let hash = |&(stage, hash): &(Stage, u64)| (stage.name().to_owned(), format!("{hash:016x}").into());
        Ok(FrameReport {
            index: frame.index,
            file,
            bytes: bytes.len() as u64,
            sha256: sha256(&bytes),
            fingerprint,
            bounds,
            seconds: progress.seconds().into_iter().map(|(step, s)| (step.to_owned(), s.into())).collect(),
            counts: json::to_value(&result.counts),
            hashes: result.hashes.iter().map(hash).collect(),
            peak_memory: peak_memory(),
        })
    }

    /// Frame, camera and file of a picture, for error messages.
    fn place(&self, frame: &SceneFrame, camera: usize, path: &Path) -> String {
        let name = &self.scene.cameras[camera].name;
        format!("frame {}: camera `{name}`: {}", frame.index, self.scene.resolve(path).display())
    }

    fn read(&self, frame: &SceneFrame) -> Result<Vec<Files>, Failure> {
        let read = |camera: usize, path: &Path| {
            fs::read(self.scene.resolve(path)).map_err(|e| {
                let place = self.place(frame, camera, path);
                Failure::Input(format!("{place}: cannot be read ({e}): check the path in scene.json"))
            })
        };
        let files = |camera: usize| {
            let path = frame.mask(camera).filter(|_| self.key.is_none());
            let mask = path.map(|path| read(camera, path)).transpose()?;
            Ok(Files { image: read(camera, &frame.images[camera])?, mask })
        };
        (0..self.scene.cameras.len()).map(files).collect()
    }

    fn fingerprint(&self, files: &[Files]) -> String {
        let mut fingerprint = self.settings.clone();
        for file in files {
            fingerprint.add(&file.image);
            fingerprint.add(&[u8::from(file.mask.is_some())]);
            fingerprint.add(file.mask.as_deref().unwrap_or_default());
        }
        fingerprint.finish()
    }

    fn is_still_there(&self, earlier: &FrameReport) -> bool {
        let same = fs::read(self.folder.join(&earlier.file)).is_ok_and(|bytes| sha256(&bytes) == earlier.sha256);
        same && (!self.stages || self.stages_folder(earlier.index).is_dir())
    }

    fn reconstruct(
        &self,
        frame: &SceneFrame,
        files: Vec<Files>,
        progress: &FrameProgress,
    ) -> Result<Reconstruction, Failure> {
        progress.begin("decode");
        let decode = |camera: usize, path: &Path, file: &[u8]| {
            Picture::decode(file)
                .map_err(|problem| Failure::Input(format!("{}: {problem}", self.place(frame, camera, path))))
        };
        let pictures = self.threads.map(files.len(), |camera| {
            let image = decode(camera, &frame.images[camera], &files[camera].image)?;
            let mask = match (&files[camera].mask, frame.mask(camera)) {
                (Some(file), Some(path)) => Some(decode(camera, path, file)?),
                _ => None,
            };
            Ok((image, mask))
        });
        let pictures: Vec<(Picture, Option<Picture>)> = pictures.into_iter().collect::<Result<_, Failure>>()?;
        drop(files);
        progress.end("decode");
        let inputs: Vec<ViewInput> = pictures.iter().map(|pictures| view_input(pictures, self.key)).collect();
        let progress: &dyn Progress = progress;
        let memory = self.max_memory.map_or_else(Memory::default, Memory::limited);
        let mut made = Frame::new(self.rig, *self.params, memory);
        made.run_all(&inputs, self.threads, progress).map_err(|error| self.scene.explain(&error, Some(frame)))?;
        Ok(made.into_reconstruction())
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

fn view_input((image, mask): &(Picture, Option<Picture>), key: Option<ChromaKey>) -> ViewInput<'_> {
    let mask = match (key, mask) {
        (Some(key), _) => Mask::ChromaKey(key),
        (None, Some(mask)) => Mask::Given(mask.view()),
        (None, None) => Mask::Unknown,
    };
    ViewInput { image: image.view(), mask }
}

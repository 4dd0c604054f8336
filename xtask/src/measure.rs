//! Reconstructs captured scenes with the command line and scores the results.

use crate::{
    Result,
    process::{cargo, program, run, target},
};
use serde_json::Value;
use std::{
    env, fs,
    path::{Path, PathBuf},
    process::Command,
};

/// The captured scenes and the tool that scores their meshes. They are not part of the project.
pub struct Captured {
    data: PathBuf,
    tool: PathBuf,
    pcmvs: PathBuf,
}

/// What to reconstruct.
#[derive(Debug, Clone, Copy)]
pub struct Job<'a> {
    pub scene: &'a str,
    pub preset: &'a str,
    /// Frames in the syntax of the command line; `None` for all.
    pub frames: Option<&'a str>,
    /// Cameras in the syntax of the command line; `None` for all.
    pub cameras: Option<&'a str>,
    /// Overrides of the preset's parameters.
    pub set: &'a [String],
}

impl<'a> Job<'a> {
    /// All frames and cameras of a scene with a preset.
    pub fn new(scene: &'a str, preset: &'a str) -> Self {
        Self { scene, preset, frames: None, cameras: None, set: &[] }
    }

    /// Name of the result folder: what distinguishes the job, in characters that every file system accepts.
    fn folder(&self) -> String {
        let mut name = format!("{}-{}", self.scene, self.preset);
        for part in self.frames.iter().chain(&self.cameras).copied().chain(self.set.iter().map(String::as_str)) {
            name.push('-');
            name.extend(part.chars().map(|c| if c.is_ascii_alphanumeric() || c == '.' { c } else { '_' }));
        }
        name
    }
}

/// Results: one score and one report per frame.
#[derive(Debug, Clone)]
pub struct Measured {
    pub scores: Vec<Value>,
    pub frames: Vec<Value>,
}

impl Measured {
    /// Mean of a figure over the frames; `None` if the scene has no such figure.
    pub fn mean(&self, key: &str) -> Option<f64> {
        let values: Option<Vec<f64>> = self.scores.iter().map(|s| s[key].as_f64()).collect();
        values.filter(|v| !v.is_empty()).map(|v| v.iter().sum::<f64>() / v.len() as f64)
    }

    /// Mean seconds per frame of each step, in the order in which they ran.
    pub fn seconds(&self) -> Vec<(String, f64)> {
        let mut steps: Vec<(String, f64)> = Vec::new();
        for (step, seconds) in self.frames.iter().filter_map(|f| f["seconds"].as_object()).flatten() {
            let share = seconds.as_f64().unwrap_or(f64::NAN) / self.frames.len() as f64;
            match steps.iter_mut().find(|(name, _)| name == step) {
                Some((_, sum)) => *sum += share,
                None => steps.push((step.clone(), share)),
            }
        }
        steps
    }

    /// Mean seconds per frame of all steps.
    pub fn total_seconds(&self) -> f64 {
        self.seconds().iter().map(|(_, s)| s).sum()
    }

    /// Peak memory over all frames, in MiB.
    pub fn peak_mebibytes(&self) -> f64 {
        let bytes = self.frames.iter().filter_map(|f| f["peak_memory"].as_f64());
        bytes.fold(f64::NAN, f64::max) / f64::from(1 << 20)
    }
}

impl Captured {
    /// Finds the data and the tool, and builds the command. The inner error names what is missing.
    pub fn find() -> Result<std::result::Result<Self, String>> {
        let place = |variable: &str| {
            let path = PathBuf::from(env::var_os(variable).ok_or_else(|| format!("{variable} is not set"))?);
            path.canonicalize().map_err(|_| format!("{} does not exist: set {variable}", path.display()))
        };
        let found = place("PCMVS_DATA").and_then(|data| Ok((data, place("PCMVS_SCORE")?)));
        let (data, tool) = match found {
            Ok(found) => found,
            Err(missing) => return Ok(Err(missing)),
        };
        build()?;
        install_packages()?;
        Ok(Ok(Self { data, tool, pcmvs: target().join("release/pcmvs") }))
    }

    /// Another tool in the folder of the one that scores.
    pub fn tool(&self, name: &str) -> PathBuf {
        self.tool.with_file_name(name)
    }

    /// The folder of a scene.
    pub fn scene(&self, name: &str) -> PathBuf {
        self.data.join(name)
    }

    /// The command `pcmvs`.
    pub fn pcmvs(&self) -> &Path {
        &self.pcmvs
    }

    /// Reconstructs every frame by itself on one thread, and scores it. Results of an earlier run are kept. The meshes are PLY files,
    /// because the reader of the scoring tool drops vertex colours of a GLB that has a material.
    pub fn measure(&self, job: &Job) -> Result<Measured> {
        let (scene, out) = (self.scene(job.scene), target().join("captured").join(job.folder()));
        let mut command =
            program(&self.pcmvs, &format!("reconstruct --threads 1 --format ply --alone --preset {}", job.preset));
        command.args(job.frames.into_iter().flat_map(|list| ["--frames", list]));
        command.args(job.cameras.into_iter().flat_map(|list| ["--cameras", list]));
        command.args(job.set.iter().flat_map(|assignment| ["--set", assignment]));
        run(command.arg(&scene).arg("-o").arg(&out))?;
        let frames = reported_frames(&out)?;
        // A rough scene is the clean one with noise, bad mattes and calibration errors: the clean one has the truth.
        let truth = self.scene(job.scene.strip_suffix("-rough").unwrap_or(job.scene));
        let scores = frames.iter().map(|frame| self.score(&truth, &out, frame)).collect::<Result<_>>()?;
        Ok(Measured { scores, frames })
    }

    fn score(&self, scene: &Path, out: &Path, frame: &Value) -> Result<Value> {
        let (Some(file), Some(hash), Some(index)) =
            (frame["file"].as_str(), frame["sha256"].as_str(), frame["index"].as_u64())
        else {
            return Err(format!("{}: report.json lacks file, sha256 or index", out.display()));
        };
        let json = out.join(format!("{file}.{}.score.json", &hash[..16]));
        if !json.exists() {
            let mut command = python();
            command.arg(&self.tool).arg(scene).arg(out.join(file));
            command.arg("--json").arg(&json).args(["--frame", &index.to_string()]);
            command.args(masked_cameras(scene, index)?.iter().flat_map(|list| ["--cameras", list]));
            run(&mut command)?;
        }
        read_json(&json)
    }
}

/// Builds the command with the same features as the demo, so that neither rebuilds it.
pub fn build() -> Result<()> {
    run(&mut cargo("build --quiet --release --package pcmvs-cli --package studio --bins")).map(drop)
}

/// The frames of the command's report.
pub fn reported_frames(folder: &Path) -> Result<Vec<Value>> {
    Ok(read_json(&folder.join("report.json"))?["frames"].as_array().cloned().unwrap_or_default())
}

fn read_json(path: &Path) -> Result<Value> {
    let bytes = fs::read(path).map_err(|e| format!("{}: {e}", path.display()))?;
    serde_json::from_slice(&bytes).map_err(|e| format!("{}: {e}", path.display()))
}

/// The cameras with masks, if some have none. Silhouettes can be compared only there.
fn masked_cameras(scene: &Path, index: u64) -> Result<Option<String>> {
    let file = read_json(&scene.join("scene.json"))?;
    let frame = file["frames"].as_array().into_iter().flatten().find(|f| f["index"] == index);
    let masks = frame.and_then(|f| f["masks"].as_array()).cloned().unwrap_or_default();
    let masked: Vec<String> = (0..masks.len()).filter(|&i| !masks[i].is_null()).map(|i| i.to_string()).collect();
    Ok((masked.len() < masks.len()).then(|| masked.join(",")))
}

/// Folder for Python packages.
fn packages() -> PathBuf {
    target().join("python")
}

/// Python with the packages of [`install_packages`].
pub fn python() -> Command {
    let mut command = program("python3", "");
    command.env("PYTHONPATH", packages());
    command
}

/// Packages that the scoring tool imports.
pub fn install_packages() -> Result<()> {
    if run(python().args(["-c", "import open3d, trimesh, PIL, scipy"])).is_ok() {
        return Ok(());
    }
    let mut install = program("python3", "-m pip install --quiet open3d trimesh pillow scipy --target");
    run(install.arg(packages())).map(|_| ())
}

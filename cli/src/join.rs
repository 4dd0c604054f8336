//! `pcmvs join`: joins the parts of a clip that were made by several runs, such as those of several machines.

use crate::{
    arguments::{Join, List},
    fingerprint::sha256,
    manifest::{self, Manifest, ManifestFrame, gaps},
    output,
    progress::Console,
    report::{self, FrameReport, Report},
};
use pcmvs_scene::Failure;
use std::{fs, path::Path, sync::atomic::AtomicBool};

/// The result folder of one run.
struct Part<'a> {
    folder: &'a Path,
    manifest: Manifest,
    report: Report,
}

/// A frame of a part.
#[derive(Clone, Copy)]
struct Frame<'a> {
    part: &'a Part<'a>,
    report: &'a FrameReport,
    manifest: &'a ManifestFrame,
}

/// Runs the command.
pub fn run(options: &Join, cancelled: &AtomicBool) -> Result<(), Failure> {
    let console = Console::new(cancelled);
    let parts: Vec<Part> = options.parts.iter().map(|folder| Part::read(folder)).collect::<Result<_, _>>()?;
    let [first, others @ ..] = parts.as_slice() else { return Err(Failure::Input(String::from("there are no parts"))) };
    others.iter().try_for_each(|part| part.check_belongs_to(first))?;
    check_output(&options.output, &parts)?;
    let frames = chosen(&parts, options.frames.as_ref())?;

    let bar = console.bar("join", frames.len() as u64);
    for frame in &frames {
        if console.is_cancelled() {
            return Err(Failure::Cancelled);
        }
        frame.copy_to(&options.output)?;
        bar.inc(1);
    }
    drop(bar);
    let report = joined_report(&parts, &frames);
    output::write_json(&options.output.join(report::FILE_NAME), &report)?;
    let manifest = Manifest {
        frame_count: frames.len(),
        bounds: manifest::bounds(&report.frames, first.manifest.rotation),
        frames: frames.iter().map(|frame| frame.manifest.clone()).collect(),
        ..first.manifest.clone()
    };
    // Last, because it says that the clip is complete.
    manifest.write(&options.output)?;
    println!("{} frames of {} parts in {}", frames.len(), parts.len(), options.output.display());
    Ok(())
}

impl<'a> Part<'a> {
    fn read(folder: &'a Path) -> Result<Self, Failure> {
        Ok(Self { folder, manifest: Manifest::read(folder)?, report: Report::read(folder)? })
    }

    /// Refuses a part of another clip, or one that another program or other settings made.
    fn check_belongs_to(&self, first: &Self) -> Result<(), Failure> {
        let (ours, theirs) = (&self.report, &first.report);
        let what = if ours.version != theirs.version {
            format!("was made by version {} instead of {}", ours.version, theirs.version)
        } else if ours.cameras != theirs.cameras || self.manifest.fps != first.manifest.fps {
            String::from("is of another scene")
        } else if ours.settings != theirs.settings || !self.manifest.is_alike(&first.manifest) {
            String::from("was made by another build of pcmvs, with other options, or with another calibration")
        } else {
            return Ok(());
        };
        Err(Failure::Input(format!(
            "{}: {what} than {}: make all parts with the same program, scene and options",
            self.folder.display(),
            first.folder.display()
        )))
    }

    fn frames(&self) -> impl Iterator<Item = Frame<'_>> {
        let listed = |report: &FrameReport| self.manifest.frames.iter().find(|frame| frame.index == report.index);
        self.report
            .frames
            .iter()
            .filter_map(move |report| listed(report).map(|manifest| Frame { part: self, report, manifest }))
    }
}

impl Frame<'_> {
    /// Copies the mesh, unless it is there already. Its content must be that which the part's run has written.
    fn copy_to(&self, output: &Path) -> Result<(), Failure> {
        let (from, to) = (self.part.folder.join(&self.report.file), output.join(&self.report.file));
        if fs::read(&to).is_ok_and(|bytes| sha256(&bytes) == self.report.sha256) {
            return Ok(());
        }
        let bytes = fs::read(&from).map_err(|e| Failure::unreadable(&from, &e))?;
        if sha256(&bytes) != self.report.sha256 {
            return Err(Failure::Input(format!(
                "{}: has changed since it was written: run `pcmvs reconstruct` again for this part",
                from.display()
            )));
        }
        output::write(&to, &bytes)
    }
}

/// Refuses to write into one of the parts, or into a folder with another clip.
fn check_output(output: &Path, parts: &[Part]) -> Result<(), Failure> {
    let refused = |what: &str| Err(Failure::Input(format!("{}: {what}: name a new folder", output.display())));
    if !output.exists() {
        return Ok(());
    }
    if !output.is_dir() {
        return refused("is a file");
    }
    let same = |part: &Part| output.canonicalize().ok() == part.folder.canonicalize().ok();
    if parts.iter().any(same) {
        return refused("is one of the parts");
    }
    if Report::read(output).is_ok_and(|earlier| earlier.settings != parts[0].report.settings) {
        return refused("holds another clip");
    }
    Ok(())
}

/// The frames of a list, or all frames, by index. None may be missing, and none may differ from part to part.
fn chosen<'a>(parts: &'a [Part<'a>], list: Option<&List>) -> Result<Vec<Frame<'a>>, Failure> {
    let mut frames: Vec<Frame> = parts.iter().flat_map(Part::frames).collect();
    frames.sort_by_key(|frame| frame.report.index);
    for pair in frames.windows(2) {
        let [a, b] = [pair[0], pair[1]].map(|frame| (frame.report.index, frame.report.sha256.as_str()));
        if a.0 == b.0 && a.1 != b.1 {
            return Err(Failure::Input(format!(
                "frame {} is in {} and in {}, and they differ: its pictures have changed in between, so make it again",
                a.0,
                pair[0].part.folder.display(),
                pair[1].part.folder.display()
            )));
        }
    }
    frames.dedup_by_key(|frame| frame.report.index);
    let has = |index: u32| frames.binary_search_by_key(&index, |frame| frame.report.index).is_ok();
    let missing = match list {
        Some(List(list)) => {
            let missing: Vec<String> = list.iter().filter(|&&index| !has(index)).map(u32::to_string).collect();
            (!missing.is_empty()).then(|| missing.join(","))
        }
        None => gaps(&frames.iter().map(|frame| frame.report.index).collect::<Vec<_>>()),
    };
    let asked = |index: u32| list.is_none_or(|List(list)| list.contains(&index));
    let failures = parts.iter().flat_map(|part| part.report.failures.iter().map(move |failure| (part, failure)));
    if let Some((part, failure)) = failures.into_iter().find(|(_, failure)| asked(failure.index) && !has(failure.index))
    {
        return Err(Failure::Input(format!(
            "{}: frame {} failed there ({}): mend what it names and make it again, or leave it out of --frames",
            part.folder.display(),
            failure.index,
            failure.error
        )));
    }
    if let Some(missing) = missing {
        return Err(Failure::Input(format!(
            "no part has frames {missing}: run `pcmvs reconstruct` for them, or name the frames of the clip with --frames"
        )));
    }
    frames.retain(|frame| asked(frame.report.index));
    if frames.is_empty() { Err(Failure::Input(String::from("the parts have no frames"))) } else { Ok(frames) }
}

/// The report of one run that made all frames. Seconds and memory are those of the runs that made them.
fn joined_report(parts: &[Part], frames: &[Frame]) -> Report {
    let first = &parts[0].report;
    let mut warnings: Vec<_> = first.warnings.iter().filter(|warning| warning.frame.is_none()).cloned().collect();
    for Frame { part, report, .. } in frames {
        let of_frame = part.report.warnings.iter().filter(|warning| warning.frame == Some(report.index));
        warnings.extend(of_frame.cloned());
    }
    Report {
        peak_memory: parts.iter().filter_map(|part| part.report.peak_memory).max(),
        warnings,
        frames: frames.iter().map(|frame| frame.report.clone()).collect(),
        failures: Vec::new(),
        ..first.clone()
    }
}

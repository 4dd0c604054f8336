//! `pcmvs reconstruct`: reconstructs all frames of a scene.

use crate::{
    arguments::Reconstruct,
    calibration,
    fingerprint::Fingerprint,
    frame::Job,
    json,
    manifest::Manifest,
    mesh_file::MeshFile,
    output, overrides,
    progress::Console,
    report::{self, Earlier, FrameFailure, Report, peak_memory},
    run::Run,
    video::Videos,
    warning::WarningReport,
};
use pcmvs_core::{Camera, Params, Rig, Warning, calibration::CalibrationParams};
use pcmvs_scene::{Disk, Failure, Scene, Silhouettes, Threads, thread_count};
use std::{
    panic::{AssertUnwindSafe, catch_unwind},
    path::Path,
    sync::{Mutex, PoisonError, atomic::AtomicBool},
};

/// Largest number of frames in memory at a time, because each takes hundreds of MiB. Further threads work on the views of
/// these frames.
const MAX_FRAMES: usize = 8;

/// Runs the command.
pub fn run(options: &Reconstruct, cancelled: &AtomicBool) -> Result<(), Failure> {
    let mut scene = Scene::load(&Disk, &options.scene)?;
    let first_index = scene.frames.iter().map(|f| f.index).min().unwrap_or(0);
    if let Some(list) = &options.cameras {
        scene.select_cameras(&list.0)?;
    }
    // Chosen from the whole clip, so that runs over parts of it get the same cameras.
    let evidence = calibration::evidence(&scene, None)?;
    let silhouettes = Silhouettes::new(options.common.masks.files(), &mut scene)?;
    let videos = Videos::open(&scene)?;
    scene.select_frames(options.frames.as_ref().map(|list| list.0.as_slice()))?;
    if options.output.exists() && !options.output.is_dir() {
        return Err(Failure::Input(format!("{}: is a file: name a folder", options.output.display())));
    }
    let mut cameras = scene.cameras()?;
    let mut params = Params::preset(options.preset.preset());
    for assignment in &options.overrides {
        params = overrides::set(&params, assignment).map_err(Failure::Input)?;
    }
    let mesh_file = MeshFile::new(options, &scene)?;
    let threads = thread_count(options.common.threads);
    let pool = Threads::new(threads)?;
    let console = Console::new(cancelled);
    let (mut calibration, mut is_doubtful) = (None, false);
    if options.refine {
        let run = Run { scene: &scene, silhouettes, videos: &videos, threads: &pool, console: &console };
        let found = run.calibrate(&cameras, &evidence, &CalibrationParams::default())?;
        found.print(&scene, &console);
        cameras = found.cameras().to_vec();
        is_doubtful = found.is_doubtful();
        calibration = Some(found.to_json(&scene));
    }
    let rig = Rig::new(&cameras).map_err(|error| scene.explain(&error, None))?;
    let settings = settings(&mesh_file, &params, &cameras, silhouettes)?;
    let settings_text = settings.clone().finish();
    let earlier = Earlier::read(&options.output, &settings_text);
    let about_rig = warnings_about(&rig, &scene);
    about_rig.iter().for_each(|warning| console.warn(warning));
    if options.strict && (is_doubtful || !about_rig.is_empty()) {
        return Err(Failure::Input(format!(
            "{}: the warnings above are errors with --strict: correct what they name, or run without --strict",
            scene.path.display()
        )));
    }
    let job = Job {
        scene: &scene,
        rig: &rig,
        params: &params,
        max_memory: options.max_memory.map(|mib| mib.saturating_mul(1 << 20)),
        silhouettes,
        videos: &videos,
        strict: options.strict,
        mesh_file: mesh_file.clone(),
        stages: options.stages,
        folder: &options.output,
        threads: &pool,
        console: &console,
        settings: &settings,
        earlier: &earlier,
    };
    let report = Report {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        preset: options.preset.name().to_owned(),
        masks: options.common.masks.name().to_owned(),
        cameras: scene.cameras.iter().map(|c| c.name.clone()).collect(),
        threads: threads.get(),
        params: json::to_value(&params),
        settings: settings_text,
        calibration,
        peak_memory: peak_memory(),
        warnings: about_rig,
        frames: Vec::new(),
        failures: Vec::new(),
    };
    let report = with_not_asked(report, &earlier, &scene, &options.output);
    let (report, worst) = make_frames(&job, report);
    if report.frames.is_empty() {
        return Err(worst.unwrap_or(Failure::Cancelled));
    }
    // Written once more, because frames may have failed after the last good one.
    output::write_json(&options.output.join(report::FILE_NAME), &report)?;
    Manifest::new(&scene, first_index, &mesh_file, &report).write(&options.output)?;
    match worst {
        Some(failure) => Err(failure),
        None => {
            println!("{} frames in {}", scene.frames.len(), options.output.display());
            Ok(())
        }
    }
}

/// Warnings that hold for all frames.
fn warnings_about(rig: &Rig, scene: &Scene) -> Vec<WarningReport> {
    let pairs = rig.same_place().iter().map(|&(first, second)| Warning::SamePlace { first, second });
    pairs.map(|warning| WarningReport::of_core(&warning, scene, None)).collect()
}

/// Everything that the frames depend on besides their own pictures.
fn settings(
    mesh_file: &MeshFile,
    params: &Params,
    cameras: &[Camera],
    silhouettes: Silhouettes,
) -> Result<Fingerprint, Failure> {
    let mut fingerprint = Fingerprint::of_program()?;
    fingerprint.add(format!("{params:?} {cameras:?} {silhouettes:?} {mesh_file:?}").as_bytes());
    Ok(fingerprint)
}

/// Adds the frames of an earlier run that belong to the same clip but are not part of this run.
fn with_not_asked(mut report: Report, earlier: &Earlier, scene: &Scene, folder: &Path) -> Report {
    let asked = |index: u32| scene.frames.iter().any(|f| f.index == index);
    for frame in earlier.frames.iter().filter(|e| !asked(e.index) && folder.join(&e.file).is_file()) {
        report.warnings.extend(earlier.warnings_of(frame.index).cloned());
        report.frames.push(frame.clone());
    }
    report
}

/// Reconstructs all frames, even if some of them fail. The report is written after each good frame, so that a killed run
/// can be continued.
fn make_frames(job: &Job, report: Report) -> (Report, Option<Failure>) {
    let report = Mutex::new(report);
    let frames = &job.scene.frames;
    // Frames are read one after another, in their order, because that is how videos are read. No other work of the pool is
    // done meanwhile, which could wait for the same lock.
    let turn = Mutex::new(0);
    let outcomes = job.threads.map_at_most(MAX_FRAMES, frames.len(), |_| {
        let mut next = turn.lock().unwrap_or_else(PoisonError::into_inner);
        let frame = &frames[*next];
        *next += 1;
        let index = frame.index;
        let files = guarded(index, || job.read(frame));
        drop(next);
        let mut warnings = Vec::new();
        let outcome = files.and_then(|files| guarded(index, || job.run(frame, files, &mut warnings)));
        let mut report = report.lock().unwrap_or_else(PoisonError::into_inner);
        report.warnings.extend(warnings);
        report.warnings.sort_by_key(|warning| warning.frame);
        let outcome = outcome.and_then(|done| {
            report.frames.push(done);
            report.frames.sort_by_key(|f| f.index);
            report.peak_memory = peak_memory();
            output::write_json(&job.folder.join(report::FILE_NAME), &*report)
        });
        if let Err(failure) = &outcome
            && *failure != Failure::Cancelled
        {
            job.console.line(&format!("error: {failure}"));
            report.failures.push(FrameFailure { index, error: failure.to_string() });
            report.failures.sort_by_key(|f| f.index);
        }
        outcome
    });
    let report = report.into_inner().unwrap_or_else(PoisonError::into_inner);
    let failures: Vec<Failure> = outcomes.into_iter().filter_map(Result::err).collect();
    (report, summary(&failures, frames.len()))
}

/// Work on a frame. A panic is a failure of the frame alone.
fn guarded<T>(index: u32, work: impl FnOnce() -> Result<T, Failure>) -> Result<T, Failure> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|_| {
        Err(Failure::Other(format!("frame {index}: internal error, see the message above: please report it")))
    })
}

/// The failure that decides the exit status: cancellation first, then other errors, then wrong input.
fn summary(failures: &[Failure], frames: usize) -> Option<Failure> {
    let text = format!("{} of {frames} frames failed, see the messages above", failures.len());
    if failures.is_empty() {
        None
    } else if failures.contains(&Failure::Cancelled) {
        Some(Failure::Cancelled)
    } else if failures.iter().any(|f| matches!(f, Failure::Other(_))) {
        Some(Failure::Other(text))
    } else {
        Some(Failure::Input(text))
    }
}

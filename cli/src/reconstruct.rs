//! `pcmvs reconstruct`: reconstructs all frames of a scene.

use crate::{
    arguments::Reconstruct,
    at_once::AtOnce,
    calibration,
    fingerprint::Fingerprint,
    frame::{Job, Own},
    json,
    kept::Kept,
    lost_part::{Beyond, Search, lock},
    manifest::Manifest,
    mesh_file::MeshFile,
    neighbours::{self, Found, Planned, Ready, Waiting},
    output, overrides,
    progress::Console,
    report::{self, Earlier, FrameFailure, FrameReport, Report, peak_memory},
    run::Run,
    unchanged,
    video::Videos,
    warning::WarningReport,
};
use pcmvs_core::{Camera, Mesh, Params, Rig, Warning, calibration::CalibrationParams};
use pcmvs_scene::{Disk, Failure, Scene, Silhouettes, Threads, thread_count};
use std::{
    panic::{AssertUnwindSafe, catch_unwind},
    sync::{Mutex, PoisonError, atomic::AtomicBool},
};

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
    let all = scene.frames.clone();
    scene.select_frames(options.frames.as_ref().map(|list| list.0.as_slice()))?;
    let asked: Vec<u32> = scene.frames.iter().map(|frame| frame.index).collect();
    let alone = options.alone || !options.preset.averages();
    if !alone {
        scene.frames = neighbours::with_neighbours(all, &asked);
    }
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
    let settings = settings(&mesh_file, &params, &cameras, silhouettes, alone)?;
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
        asked: &asked,
        alone,
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
    let report = with_not_asked(report, &job);
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
            println!("{} frames in {}", asked.len(), options.output.display());
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
    alone: bool,
) -> Result<Fingerprint, Failure> {
    let mut fingerprint = Fingerprint::of_program()?;
    fingerprint.add(format!("{params:?} {cameras:?} {silhouettes:?} {mesh_file:?} {alone}").as_bytes());
    Ok(fingerprint)
}

/// Adds the frames of an earlier run that belong to the same clip but are not part of this run.
fn with_not_asked(mut report: Report, job: &Job) -> Report {
    for frame in job.earlier.frames.iter().filter(|e| !job.is_asked(e.index) && job.folder.join(&e.file).is_file()) {
        report.warnings.extend(job.earlier.warnings_of(frame.index).cloned());
        report.frames.push(frame.clone());
    }
    report
}

/// The report of a run while frames are made, and the failures so far.
struct Outcome<'a> {
    job: &'a Job<'a>,
    report: Report,
    failures: Vec<Failure>,
}

impl Outcome<'_> {
    /// Adds a frame that has been written, or its failure. The report is written after each good frame, so that a killed run
    /// can be continued.
    fn add(&mut self, index: u32, outcome: Result<FrameReport, Failure>, warnings: Vec<WarningReport>) {
        let Self { job, report, failures } = self;
        report.warnings.extend(warnings);
        report.warnings.sort_by_key(|warning| warning.frame);
        let outcome = outcome.and_then(|done| {
            report.frames.push(done);
            report.frames.sort_by_key(|f| f.index);
            report.peak_memory = peak_memory();
            output::write_json(&job.folder.join(report::FILE_NAME), report)
        });
        let Err(failure) = outcome else { return };
        if failure != Failure::Cancelled {
            job.console.line(&format!("error: {failure}"));
            report.failures.push(FrameFailure { index, error: failure.to_string() });
            report.failures.sort_by_key(|f| f.index);
        }
        failures.push(failure);
    }
}

/// Makes all frames, even if some of them fail.
fn make_frames(job: &Job, report: Report) -> (Report, Option<Failure>) {
    let mut outcome = Outcome { job, report, failures: Vec::new() };
    match keep_earlier(job, &mut outcome) {
        Ok(kept) => outcome = make_missing(job, &kept, outcome),
        Err(failure) => outcome.failures.push(failure),
    }
    let Outcome { report, failures, .. } = outcome;
    (report, summary(&failures, job.asked.len()))
}

/// Keeps the results of an earlier run for which nothing has changed, and returns their frames.
fn keep_earlier(job: &Job, outcome: &mut Outcome) -> Result<Vec<u32>, Failure> {
    let mut kept = Vec::new();
    if job.earlier.frames.is_empty() {
        return Ok(kept);
    }
    let plan = neighbours::plan(&job.scene.frames, |index| job.is_asked(index), job.alone);
    for (planned, earlier) in plan.iter().zip(unchanged::kept(job, &plan)?) {
        let Some(earlier) = earlier else { continue };
        let mut warnings = Vec::new();
        let done = job.keep(planned.frame, earlier, &mut warnings);
        outcome.add(earlier.index, done, warnings);
        kept.push(earlier.index);
    }
    Ok(kept)
}

/// Makes the frames that are asked for and not `kept`, and those that they are averaged with.
fn make_missing<'a>(job: &'a Job<'a>, kept: &[u32], outcome: Outcome<'a>) -> Outcome<'a> {
    let is_missing = |index: u32| job.is_asked(index) && !kept.contains(&index);
    let plan = neighbours::plan(&job.scene.frames, is_missing, job.alone);
    let (outcome, waiting) = (Mutex::new(outcome), Mutex::new(Waiting::new(&plan)));
    // Frames are read one after another, in their order, because that is how videos are read. No other work of the pool is
    // done meanwhile, which could wait for the same lock.
    let turn = Mutex::new(0);
    let search = Search { job, plan: &plan, waiting: &waiting, turn: &turn };
    let at_once = AtOnce::new(job.rig, job.params, if job.alone { 0 } else { job.threads.count() });
    if let Some(text) = at_once.explanation(job.threads.count(), plan.len()) {
        job.console.line(&text);
    }
    job.threads.map_at_most(at_once.frames(), plan.len(), |_| {
        let mut next = lock(&turn);
        let place = *next;
        *next += 1;
        let Planned { frame, is_asked, ref neighbours, .. } = plan[place];
        let index = frame.index;
        let files = guarded(index, || job.read(frame));
        drop(next);
        let mut warnings = Vec::new();
        let own = files.and_then(|files| {
            let digest = Job::digest(&files);
            Ok((guarded(index, || job.reconstruct(frame, files, &mut warnings))?, digest))
        });
        let ready = match own {
            Ok((own, digest)) => {
                // The frame's own mesh goes with it when it is finished.
                let kept = if neighbours.is_empty() { Kept::default() } else { own.kept() };
                if !is_asked {
                    job.say(&warnings);
                }
                lock(&waiting).made(place, own, kept, digest, warnings)
            }
            Err(failure) => {
                job.say(&warnings);
                if is_asked {
                    lock(&outcome).add(index, Err(failure), warnings);
                } else if failure != Failure::Cancelled {
                    job.console.line(&format!("{failure}: the frames beside it are averaged without it"));
                }
                lock(&waiting).failed(place)
            }
        };
        for ready in ready {
            let index = plan[ready.place].frame.index;
            let place = ready.place;
            match guarded(index, || search.ask(ready)) {
                Ok(Some(ready)) => finish(&search, ready, &outcome),
                // It comes back when the frames that it has asked for are made.
                Ok(None) => {}
                Err(failure) => {
                    lock(&waiting).done(place);
                    lock(&outcome).add(index, Err(failure), Vec::new());
                }
            }
        }
    });
    outcome.into_inner().unwrap_or_else(PoisonError::into_inner)
}

/// Finishes a frame whose neighbours are settled, and so are the frames that it has asked for.
fn finish<'a>(search: &Search<'_, 'a>, mut ready: Ready<Own<'a>>, outcome: &Mutex<Outcome<'a>>) {
    let Search { job, plan, waiting, .. } = search;
    let index = plan[ready.place].frame.index;
    let beyond =
        guarded(index, || if job.console.is_cancelled() { Err(Failure::Cancelled) } else { search.beyond(&mut ready) });
    let Ready { place, own, digest, neighbours, mut warnings, .. } = ready;
    lock(waiting).done(place);
    let digest_of = |found: &Option<Found>| found.as_ref().map(|(digest, _)| digest.clone());
    let restored = beyond.and_then(|beyond| {
        let own = guarded(index, || search.restored(place, own, &neighbours, &beyond, &mut warnings))?;
        let looked_at: Vec<&Beyond> = beyond.iter().flatten().collect();
        let digests = neighbours.iter().chain(looked_at.iter().map(|other| &other.found)).map(digest_of);
        let fingerprint = job.fingerprint(&digest, digests);
        Ok((own, fingerprint, looked_at.iter().map(|other| other.frame.index).collect()))
    });
    job.say(&warnings);
    let done = restored.and_then(|(own, fingerprint, looked_at)| {
        let meshes: Vec<&Mesh> = neighbours.iter().flatten().map(|(_, kept)| &kept.mesh).collect();
        guarded(index, || job.finish(own, &meshes, fingerprint, looked_at, &mut warnings))
    });
    lock(outcome).add(index, done, warnings);
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

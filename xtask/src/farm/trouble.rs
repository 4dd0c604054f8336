//! A take whose runs are killed, whose disk is full and whose pictures vanish. What has been written is whole at any time,
//! and a last run finishes the clip with the bytes of a run without trouble.

use super::clip::{FRAMES, PATIENCE, built, compare, folder, is_root, scene, single};
use crate::{
    Result,
    process::{program, run},
};
use std::{
    fs,
    path::Path,
    process::{Child, Command, Stdio},
    thread,
    time::{Duration, Instant},
};

const KILLS: u64 = 10;

/// Makes the clip three times.
pub fn check() -> Result<String> {
    let killed = killed()?;
    let full =
        if is_root()? { disk_full()? } else { String::from("full disk not tried: mounting needs the rights of root") };
    Ok(format!("{killed}; {full}; {}", no_input()?))
}

fn reconstruct(clip: &Path) -> Command {
    let mut command = program(built("pcmvs"), "reconstruct --threads 2");
    command.arg(scene()).arg("-o").arg(clip);
    command
}

/// Compares the meshes that are there with those of the run without trouble. Answers how many there are.
fn whole(clip: &Path) -> Result<usize> {
    let names = fs::read_dir(clip).into_iter().flatten().flatten().map(|entry| entry.file_name());
    let names: Vec<_> = names.filter(|name| name.to_string_lossy().starts_with("frame_")).collect();
    for name in &names {
        let read = |folder: &Path| fs::read(folder.join(name)).map_err(|e| format!("{}: {e}", folder.display()));
        if read(clip)? != read(&single())? {
            return Err(format!("{} is not whole", clip.join(name).display()));
        }
    }
    Ok(names.len())
}

/// Kills runs at moments that look random and lie within the time of a whole run.
fn killed() -> Result<String> {
    let clip = folder().join("killed");
    let mut found = Vec::new();
    let mut state = 1_u64;
    for _ in 0..KILLS {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let mut child = spawn(&mut reconstruct(&clip))?;
        thread::sleep(Duration::from_millis((state >> 33) % 4000));
        child.kill().and_then(|()| child.wait()).map_err(|e| format!("pcmvs: {e}"))?;
        found.push(whole(&clip)?);
    }
    if found.last() == Some(&0) {
        return Err(format!("{KILLS} runs were killed before one of them had finished a frame"));
    }
    finish(&clip)?;
    Ok(format!("killed {KILLS} times, with {found:?} frames finished"))
}

/// Writes to a disk that has room for some of the frames.
fn disk_full() -> Result<String> {
    let disk = folder().join("disk");
    fs::create_dir_all(&disk).map_err(|e| format!("{}: {e}", disk.display()))?;
    let mesh = single().join("frame_0000.glb");
    let size = fs::metadata(&mesh).map_err(|e| format!("{}: {e}", mesh.display()))?.len();
    run(program("mount", "-t tmpfs -o").arg(format!("size={}", size * u64::from(FRAMES) / 3)).arg("pcmvs").arg(&disk))?;
    let tried = on_full_disk(&disk);
    run(program("umount", "").arg(&disk))?;
    tried
}

fn on_full_disk(disk: &Path) -> Result<String> {
    let clip = disk.join("clip");
    let output = reconstruct(&clip).output().map_err(|e| format!("pcmvs: {e}"))?;
    let message = String::from_utf8_lossy(&output.stderr);
    if output.status.code() != Some(1) || !message.contains("No space left on device") {
        return Err(format!("a full disk ended in {}: {message}", output.status));
    }
    let done = whole(&clip)?;
    run(program("mount", "-o remount,size=1g").arg(disk))?;
    finish(&clip)?;
    Ok(format!("disk full after {done} frames"))
}

/// Takes the pictures away while a run goes on.
fn no_input() -> Result<String> {
    let clip = folder().join("no-input");
    let (pictures, away) = (scene().join("images"), scene().join("images-away"));
    let mut child = spawn(&mut reconstruct(&clip))?;
    let start = Instant::now();
    while whole(&clip)? < 2 {
        if start.elapsed() > PATIENCE {
            return Err(String::from("no frame was finished in time"));
        }
        thread::sleep(Duration::from_millis(20));
    }
    let rename = |from: &Path, to: &Path| fs::rename(from, to).map_err(|e| format!("{}: {e}", from.display()));
    rename(&pictures, &away)?;
    let status = child.wait().map_err(|e| format!("pcmvs: {e}"))?;
    rename(&away, &pictures)?;
    // A frame beside one that fails is averaged without it, so only the next run makes the bytes of the whole clip.
    finish(&clip)?;
    if status.success() {
        return Err(String::from("a run whose pictures vanished ended as if nothing had happened"));
    }
    Ok(format!("pictures gone in the middle: {status}"))
}

fn spawn(command: &mut Command) -> Result<Child> {
    command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().map_err(|e| format!("pcmvs: {e}"))
}

/// The run that finishes the clip.
fn finish(clip: &Path) -> Result<()> {
    run(&mut reconstruct(clip))?;
    compare(&single(), clip)
}

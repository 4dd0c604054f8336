//! Takes whose pictures are videos. The tests need ffmpeg, and are skipped without it.

use crate::common::{self, Capture, names, pcmvs, stderr};
use serde_json::{Value, json};
use std::{
    env, fs,
    io::Write,
    process::{Command, Output, Stdio},
    thread,
};

/// Frames of the captures. They are more than one group of the video.
const FRAMES: u32 = 7;

fn has_ffmpeg() -> bool {
    let version = Command::new("ffmpeg").arg("-version").stdout(Stdio::null()).stderr(Stdio::null()).status();
    let found = version.is_ok_and(|status| status.success());
    if !found {
        assert!(env::var_os("PCMVS_ALL_TOOLS").is_none(), "ffmpeg is not installed");
        // `println!` would be shown only if the test fails.
        let test = thread::current().name().unwrap_or("a test").to_owned();
        std::io::stdout().write_all(format!("SKIPPED: {test}: ffmpeg is not installed\n").as_bytes()).unwrap();
    }
    found
}

/// Makes a video of a camera's pictures or masks. `codec` are the arguments for the output.
fn encode(capture: &Capture, kind: &str, camera: usize, codec: &[&str], file: &str) {
    let pictures = capture.path(&format!("{kind}/cam{camera:02}_%d.png"));
    let mut command = Command::new("ffmpeg");
    command.args(["-v", "error", "-y", "-framerate", "25", "-i"]).arg(pictures).args(codec).arg(capture.path(file));
    let output = command.output().unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
}

/// Without loss, with pictures that refer to later ones, in groups of three.
const PICTURES: [&str; 8] = ["-c:v", "libx264rgb", "-qp", "0", "-g", "3", "-bf", "2"];
const MASKS: [&str; 4] = ["-c:v", "ffv1", "-level", "3"];

/// A capture of which only videos are left, and the meshes of its pictures.
fn with_videos(cameras: usize) -> (Capture, Vec<Vec<u8>>) {
    let mut capture = Capture::new(cameras, FRAMES);
    let expected = meshes(&capture, &[], FRAMES);
    for camera in 0..cameras {
        encode(&capture, "images", camera, &PICTURES, &format!("cam{camera:02}.mp4"));
        encode(&capture, "masks", camera, &MASKS, &format!("cam{camera:02}_mask.mkv"));
    }
    for folder in ["images", "masks", "out"] {
        fs::remove_dir_all(capture.path(folder)).unwrap();
    }
    capture.scene["frames"] = json!({ "first": 0, "last": FRAMES - 1 });
    capture.scene["videos"] = json!("{camera}.mp4");
    capture.scene["mask_videos"] = json!("{camera}_mask.mkv");
    (capture, expected)
}

/// The first meshes of a run that must succeed.
#[track_caller]
fn meshes(capture: &Capture, arguments: &[&str], count: u32) -> Vec<Vec<u8>> {
    let output = capture.run(arguments);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    (0..count).map(|index| fs::read(capture.path(&format!("out/frame_{index:04}.glb"))).unwrap()).collect()
}

#[track_caller]
fn assert_refused(capture: &Capture, output: &Output, words: &[&str]) {
    common::assert_refused(output, words);
    assert!(!capture.path("out").join("sequence.json").exists());
}

#[test]
fn videos_give_the_meshes_of_their_pictures() {
    if !has_ffmpeg() {
        return;
    }
    let (capture, expected) = with_videos(6);
    assert_eq!(meshes(&capture, &["--threads", "1"], FRAMES), expected);
    fs::remove_dir_all(capture.path("out")).unwrap();
    assert_eq!(meshes(&capture, &["--threads", "5"], FRAMES), expected);
    let output = capture.run(&[]);
    assert_eq!(stderr(&output).matches("has not changed").count(), FRAMES as usize, "{}", stderr(&output));
    // No file besides the videos and the results.
    let names: Vec<String> = names(&capture.path(""));
    assert!(names.iter().all(|name| name.starts_with("cam") || ["out", "scene.json"].contains(&&**name)), "{names:?}");
}

#[test]
fn any_frames_of_videos_can_be_chosen() {
    if !has_ffmpeg() {
        return;
    }
    let (mut capture, expected) = with_videos(6);
    for index in [5, 2, 6, 1] {
        let output = capture.run(&["--frames", &index.to_string()]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let mesh = fs::read(capture.path(&format!("out/frame_{index:04}.glb"))).unwrap();
        assert_eq!(mesh, expected[index], "frame {index}");
    }
    // All cameras are two frames late: the pictures of frame 3 are those with the number 5.
    let names = (0..6).map(|camera| (format!("cam{camera:02}"), json!(2)));
    capture.scene["offsets"] = Value::Object(names.collect());
    let output = capture.run(&["--frames", "3"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(fs::read(capture.path("out/frame_0003.glb")).unwrap(), expected[5]);
}

#[test]
fn a_video_that_is_too_short_lacks_pictures_in_its_last_frames() {
    if !has_ffmpeg() {
        return;
    }
    let (mut capture, _) = with_videos(6);
    capture.scene["offsets"] = json!({ "cam04": 1 });
    meshes(&capture, &[], FRAMES);
    let report: Value = serde_json::from_slice(&fs::read(capture.path("out/report.json")).unwrap()).unwrap();
    let warnings = report["warnings"].as_array().unwrap();
    assert_eq!(warnings.len(), 1, "{warnings:?}");
    assert_eq!((&warnings[0]["code"], &warnings[0]["frame"]), (&json!("missing-picture"), &json!(6)));
    let message = warnings[0]["message"].as_str().unwrap();
    assert!(message.contains("cam04.mp4") && message.contains("7 pictures and none with the number 7"), "{message}");
}

#[test]
fn a_damaged_video_fails_the_frames_that_it_cannot_show() {
    if !has_ffmpeg() {
        return;
    }
    let (capture, expected) = with_videos(6);
    let file = capture.path("cam02_mask.mkv");
    let mut bytes = fs::read(&file).unwrap();
    let end = bytes.len();
    // In the last pictures, before the index of the file.
    bytes[end * 3 / 4..][..40].fill(0x55);
    fs::write(&file, bytes).unwrap();
    let output = capture.run(&[]);
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("camera `cam02`") && message.contains("cam02_mask.mkv: picture"), "{message}");
    assert_eq!(fs::read(capture.path("out/frame_0000.glb")).unwrap(), expected[0]);
    let failed = (0..FRAMES).filter(|index| !capture.path(&format!("out/frame_{index:04}.glb")).exists()).count();
    assert!((1..=5).contains(&failed), "{failed} failed: {message}");
}

#[test]
fn videos_that_do_not_fit_are_refused() {
    if !has_ffmpeg() {
        return;
    }
    let (mut capture, _) = with_videos(4);
    let original = fs::read(capture.path("cam01.mp4")).unwrap();
    let changed = |arguments: &[&str]| {
        let mut command = Command::new("ffmpeg");
        command.args(["-v", "error", "-y", "-i"]).arg(capture.path("cam02.mp4")).args(arguments);
        assert!(command.arg(capture.path("cam01.mp4")).status().unwrap().success());
    };
    changed(&["-vf", "scale=32:24"]);
    assert_refused(&capture, &capture.run(&[]), &["cam01", "cam01.mp4", "32 x 24", "64 x 48"]);
    changed(&["-vf", "select='not(eq(n,2))'", "-fps_mode", "passthrough", "-enc_time_base", "-1"]);
    assert_refused(&capture, &capture.run(&[]), &["cam01", "cam01.mp4", "not constant"]);
    changed(&["-vf", "setpts=2*PTS", "-r", "12.5"]);
    assert_refused(&capture, &capture.run(&[]), &["cam01", "cam01.mp4", "12.5", "cam00", "25.0"]);
    fs::write(capture.path("cam01.mp4"), &original[..100]).unwrap();
    assert_refused(&capture, &capture.run(&[]), &["cam01", "cam01.mp4", "no video that ffmpeg reads"]);
    fs::remove_file(capture.path("cam01.mp4")).unwrap();
    assert_refused(&capture, &capture.run(&[]), &["cam01", "cam01.mp4", "does not exist"]);
    fs::write(capture.path("cam01.mp4"), original).unwrap();
    capture.scene["videos"] = json!(["cam00.mp4", "cam01.mp4", "cam01.mp4", null]);
    assert_refused(&capture, &capture.run(&[]), &["cam02", "cam01.mp4", "same video"]);
}

#[test]
fn without_ffmpeg_videos_are_refused_with_what_to_install() {
    let mut capture = Capture::new(4, 1);
    capture.scene["frames"] = json!({ "first": 0, "last": 0 });
    capture.scene["videos"] = json!("{camera}.mp4");
    fs::write(capture.path("scene.json"), capture.scene.to_string()).unwrap();
    let mut command = pcmvs();
    command.arg("reconstruct").arg(capture.path("")).arg("-o").arg(capture.path("out"));
    let output = command.env("PCMVS_FFMPEG", capture.path("ffmpeg")).output().unwrap();
    assert_refused(&capture, &output, &["scene.json", "install ffmpeg", "PCMVS_FFMPEG"]);
}

/// A rig of anipose with the cameras of a capture.
fn rig(capture: &Capture, head: &str) -> String {
    let mut text = String::from(head);
    for camera in capture.scene["cameras"].as_array().unwrap() {
        text += &format!(
            "[{}]\nname = {0}\nsize = [{}, {}]\nmatrix = {}\ndistortions = {}\nrotation = {}\ntranslation = {}\n",
            camera["name"],
            camera["width"],
            camera["height"],
            camera["K"],
            camera["distortion"],
            camera["R"],
            camera["t"]
        );
    }
    text
}

fn import(capture: &Capture) -> Output {
    pcmvs()
        .args(["import", "--from", "anipose"])
        .arg(capture.path("rig.toml"))
        .arg("-o")
        .arg(capture.path("in"))
        .output()
        .unwrap()
}

#[test]
fn videos_beside_a_rig_become_those_of_the_scene() {
    if !has_ffmpeg() {
        return;
    }
    let (mut capture, _) = with_videos(4);
    // A rig does not tell them.
    for key in ["up", "units"] {
        capture.scene.as_object_mut().unwrap().remove(key);
    }
    let expected = meshes(&capture, &[], FRAMES);
    fs::create_dir(capture.path("masks")).unwrap();
    fs::create_dir(capture.path("videos")).unwrap();
    for camera in 0..4 {
        let name = format!("cam{camera:02}");
        fs::rename(capture.path(&format!("{name}.mp4")), capture.path(&format!("videos/{name}.mp4"))).unwrap();
        fs::rename(capture.path(&format!("{name}_mask.mkv")), capture.path(&format!("masks/{name}.mkv"))).unwrap();
    }
    let few = "videos = [\"cam03.mp4\", \"cam02.mp4\", \"cam01.mp4\"]\n";
    fs::write(capture.path("rig.toml"), rig(&capture, few)).unwrap();
    common::assert_refused(&import(&capture), &["rig.toml", "list one video for each of the 4 cameras"]);
    let listed = "videos = [\"cam00.mp4\", \"cam01.mp4\", \"cam02.mp4\", \"cam03.mp4\"]\n";
    for head in ["", listed] {
        fs::write(capture.path("rig.toml"), rig(&capture, head)).unwrap();
        let output = import(&capture);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        assert!(stderr(&output).contains("7 frames, 25 per second"), "{}", stderr(&output));
        let scene: Value = serde_json::from_slice(&fs::read(capture.path("in/scene.json")).unwrap()).unwrap();
        assert_eq!((&scene["frames"], &scene["fps"]), (&json!({ "first": 0, "last": 6 }), &json!(25.0)));
        assert_eq!(scene["videos"][1], "videos/cam01.mp4");
        assert_eq!(scene["mask_videos"][3], "masks/cam03.mkv");
        let mut command = pcmvs();
        command.arg("reconstruct").arg(capture.path("in")).arg("-o").arg(capture.path("out"));
        let output = command.args(["--preset", "hull"]).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        assert!(fs::read(capture.path("out/frame_0006.glb")).unwrap() == expected[6], "the meshes differ");
        fs::remove_dir_all(capture.path("in")).unwrap();
    }

    // Names that contain those of the cameras.
    fs::write(capture.path("rig.toml"), rig(&capture, "")).unwrap();
    let name = |camera: usize| format!("videos/calib-cam{camera:02}.mp4");
    let own = |camera: usize| format!("videos/cam{camera:02}.mp4");
    for camera in 0..4 {
        fs::rename(capture.path(&own(camera)), capture.path(&name(camera))).unwrap();
    }
    let output = import(&capture);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stderr(&output).contains("calib-cam02.mp4 is taken, because only its name contains `cam02`"));
    let scene: Value = serde_json::from_slice(&fs::read(capture.path("in/scene.json")).unwrap()).unwrap();
    assert_eq!(scene["videos"][2], "videos/cam02.mp4");
    assert!(fs::read(capture.path(&name(2))).unwrap() == fs::read(capture.path("in/videos/cam02.mp4")).unwrap());
    fs::remove_dir_all(capture.path("in")).unwrap();
    fs::copy(capture.path(&name(1)), capture.path("videos/take_cam01.mp4")).unwrap();
    let words = ["cam01", "calib-cam01.mp4", "take_cam01.mp4", "give the right one the name", "as `videos = ["];
    common::assert_refused(&import(&capture), &words);
    fs::remove_file(capture.path("videos/take_cam01.mp4")).unwrap();
    for camera in 0..4 {
        fs::rename(capture.path(&name(camera)), capture.path(&own(camera))).unwrap();
    }

    // A video of another size, and cameras with pictures beside those with videos.
    let text = rig(&capture, "");
    fs::write(capture.path("rig.toml"), text.replacen("size = [64, 48]", "size = [80, 60]", 1)).unwrap();
    common::assert_refused(&import(&capture), &["cam00", "cam00.mp4", "64 x 48", "80 x 60"]);
    fs::write(capture.path("rig.toml"), text).unwrap();
    image::RgbImage::new(64, 48).save(capture.path("cam02.png")).unwrap();
    common::assert_refused(&import(&capture), &["cam00", "is a video, but camera `cam02` has pictures"]);
}

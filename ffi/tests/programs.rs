//! Programs in C and C++, built and run as a user would.

mod common;

use common::{C99, CPP17, Link, Sample, build, has, libraries, meshoptimizer, missing, output, root, run, thorough};
use std::{ffi::OsString, fs, process::Command, sync::atomic::AtomicBool};

#[test]
fn misuse_fails_as_the_header_says() {
    let source = fs::read_to_string(root().join("tests/c/misuse.c")).unwrap();
    let header = fs::read_to_string(root().join("include/pcmvs.h")).unwrap();
    let functions = header.lines().filter(|line| line.starts_with("pcmvs_status pcmvs_"));
    for function in functions.filter_map(|line| line.split([' ', '(']).nth(1)) {
        let null = [format!("NULL_POINTER({function}("), format!("OK({function}(NULL))")];
        assert!(null.iter().any(|call| source.contains(call)), "{function} is not called with NULL");
    }
    let sample = Sample::new();
    let program = build(sample.path(), C99, "tests/c/misuse.c", Link::Shared);
    output(&program, [sample.plain()]);
}

#[test]
fn random_calls_neither_crash_nor_panic() {
    let sample = Sample::sized(4, 40, 32);
    let program = build(sample.path(), C99, "tests/c/hostile.c", Link::Shared);
    let seeds: &[&str] = if thorough() { &["1", "2", "3", "4"] } else { &["1"] };
    for seed in seeds {
        let arguments = [sample.plain().into_os_string(), seed.into(), "2000".into()];
        println!("{}", output(&program, arguments));
    }
}

#[test]
fn a_parallel_callback_may_return_early() {
    let sample = Sample::sized(4, 40, 32);
    let program = build(sample.path(), &[C99, &["-pthread"]].concat(), "tests/c/early.c", Link::Shared);
    output(&program, [sample.plain()]);
}

#[test]
fn results_are_the_same_in_every_way_to_make_them() {
    let sample = Sample::new();
    let fewer: &[&str] = if thorough() { &[] } else { &["-DFEW_CALLS"] };
    let program = build(sample.path(), &[C99, fewer].concat(), "tests/c/results.c", Link::Shared);
    output(&program, [sample.plain()]);
}

#[test]
fn warnings_name_the_camera_and_the_problem() {
    let sample = Sample::new();
    let program = build(sample.path(), C99, "tests/c/warnings.c", Link::Shared);
    output(&program, [sample.plain()]);
}

#[test]
fn calibrations_name_the_turned_camera_and_correct_it() {
    let sample = Sample::turned();
    let program = build(sample.path(), C99, "tests/c/calibration.c", Link::Shared);
    println!("{}", output(&program, [sample.plain()]));
}

#[test]
fn silhouettes_come_from_masks_keys_and_plates() {
    let folder = tempfile::tempdir().unwrap();
    let program = build(folder.path(), C99, "tests/c/silhouettes.c", Link::Static);
    println!("{}", output(&program, [""; 0]));
}

/// The command line's file of a sample whose upward direction is not known: the examples do not set it.
fn command_lines_glb(sample: &Sample, options: &[&str]) -> Vec<u8> {
    let file = sample.path().join("scene/scene.json");
    let text = fs::read_to_string(&file).unwrap();
    fs::write(&file, text.replace("\"up\"", "\"was_up\"")).unwrap();
    upright_glb(sample, options)
}

/// The command line's file of a sample.
fn upright_glb(sample: &Sample, options: &[&str]) -> Vec<u8> {
    let (out, scene) = (sample.path().join("out"), sample.path().join("scene"));
    let arguments = ["pcmvs", "reconstruct"].map(OsString::from).into_iter();
    let arguments = arguments.chain([scene.into(), "-o".into(), out.clone().into(), "--threads".into(), "1".into()]);
    let arguments = arguments.chain(options.iter().map(OsString::from));
    assert_eq!(pcmvs_cli::run(arguments, &AtomicBool::new(false)), 0);
    fs::read(out.join("frame_0000.glb")).unwrap()
}

#[test]
fn refined_cameras_give_the_command_lines_glb() {
    let sample = Sample::turned();
    let expected = command_lines_glb(&sample, &["--refine"]);
    let program = build(sample.path(), CPP17, "examples/cpp/refine.cpp", Link::Shared);
    let result = sample.path().join("refined.glb");
    let printed = output(&program, [sample.plain(), result.clone()]);
    // The pictures are too small to tell a movement from a wrong lens.
    assert!(printed.contains("camera-bumped: camera 4: the camera is off by 5."), "{printed}");
    assert!(fs::read(&result).unwrap() == expected, "the bytes differ from the command line's");
}

#[test]
fn glb_is_the_command_lines() {
    let sample = Sample::new();
    let expected = command_lines_glb(&sample, &[]);
    for link in [Link::Shared, Link::Static] {
        let program = build(sample.path(), C99, "examples/c/reconstruct.c", link);
        let result = sample.path().join("c.glb");
        output(&program, [sample.plain(), result.clone()]);
        assert!(fs::read(result).unwrap() == expected, "the bytes differ from the command line's");
    }
}

#[test]
fn forms_are_the_command_lines() {
    let sample = Sample::new();
    let program = build(sample.path(), C99, "tests/c/forms.c", Link::Shared);
    let result = sample.path().join("form.glb");
    output(&program, [sample.plain(), result.clone()]);
    let expected = upright_glb(&sample, &["--faces", "2000", "--texture=256", "--upright"]);
    assert!(fs::read(result).unwrap() == expected, "the bytes differ from the command line's");
}

#[test]
fn compressed_files_are_the_command_lines() {
    let sample = Sample::new();
    let meshoptimizer = meshoptimizer(sample.path());
    let meshoptimizer: Vec<&str> = meshoptimizer.iter().map(String::as_str).collect();
    let full = upright_glb(&sample, &["--compress"]);
    let in_c = build(sample.path(), &[C99, &meshoptimizer].concat(), "tests/c/compress.c", Link::Shared);
    output(&in_c, [sample.plain(), sample.path().to_owned()]);
    let web: &[&str] = &["--faces", "20000", "--texture=1024", "--compress", "--upright"];
    let mobile: &[&str] = &["--faces", "5000", "--texture=512", "--compress", "--upright"];
    for (name, expected) in
        [("full", full.clone()), ("web", upright_glb(&sample, web)), ("mobile", upright_glb(&sample, mobile))]
    {
        let written = fs::read(sample.path().join(name).with_extension("glb")).unwrap();
        assert!(written == expected, "{name}: the bytes differ from the command line's");
    }
    let in_cpp = build(sample.path(), &[CPP17, &meshoptimizer].concat(), "tests/cpp/compress.cpp", Link::Shared);
    let result = sample.path().join("cpp.glb");
    output(&in_cpp, [sample.plain(), result.clone()]);
    assert!(fs::read(result).unwrap() == full, "the bytes differ from the command line's");
}

#[test]
fn averaged_frames_are_the_command_lines() {
    let sample = Sample::take(3);
    let program = build(sample.path(), C99, "tests/c/steady.c", Link::Shared);
    let result = sample.path().join("steady.glb");
    let folders = ["plain", "plain1", "plain2"].map(|folder| sample.path().join(folder));
    output(&program, folders.into_iter().chain([result.clone()]));
    command_lines_glb(&sample, &[]);
    let expected = fs::read(sample.path().join("out/frame_0001.glb")).unwrap();
    assert!(fs::read(result).unwrap() == expected, "the bytes differ from the command line's");
}

#[test]
fn frames_that_get_a_lost_part_back_are_the_command_lines() {
    let sample = Sample::lacking();
    let program = build(sample.path(), C99, "tests/c/lost_part.c", Link::Shared);
    let result = sample.path().join("whole.glb");
    let folders = ["plain", "plain1", "plain2"].map(|folder| sample.path().join(folder));
    output(&program, folders.into_iter().chain([result.clone()]));
    command_lines_glb(&sample, &[]);
    let expected = fs::read(sample.path().join("out/frame_0001.glb")).unwrap();
    assert!(fs::read(result).unwrap() == expected, "the bytes differ from the command line's");
    let report = fs::read_to_string(sample.path().join("out/report.json")).unwrap();
    assert!(report.contains("silhouette-restored"), "the command line has not made the frame again");
}

#[test]
fn wrapper_keeps_its_promises() {
    let sample = Sample::new();
    let program = build(sample.path(), CPP17, "tests/cpp/wrapper.cpp", Link::Shared);
    output(&program, [sample.plain()]);
    // It compiles without exceptions, too.
    let mut command = Command::new("c++");
    command.args(["-std=c++17", "-fno-exceptions", "-fsyntax-only", "-Wall", "-Wextra", "-Werror", "-x", "c++"]);
    run(command.arg(root().join("include/pcmvs.hpp")).arg("-Wno-pragma-once-outside-header"));
}

#[test]
fn threads_of_the_host_give_the_same_bytes() {
    let sample = Sample::new();
    let glb = |name: &str| sample.path().join(name);
    let whole = build(sample.path(), C99, "examples/c/reconstruct.c", Link::Shared);
    output(&whole, [sample.plain(), glb("whole.glb")]);
    let live = build(sample.path(), CPP17, "examples/cpp/live.cpp", Link::Shared);
    for threads in ["1", "3"] {
        let arguments = [sample.plain().into(), "2".into(), threads.into(), glb("live.glb").into_os_string()];
        output(&live, arguments);
        assert!(fs::read(glb("live.glb")).unwrap() == fs::read(glb("whole.glb")).unwrap(), "{threads} threads");
    }
}

#[test]
fn readme_program_runs() {
    let sample = Sample::new();
    let readme = fs::read_to_string(root().join("README.md")).unwrap();
    let program = readme.split("```cpp\n").nth(1).and_then(|rest| rest.split("```").next()).unwrap();
    assert_eq!(program.lines().count(), 20);
    fs::write(sample.path().join("readme.inc"), program).unwrap();
    let glb = |name: &str| sample.path().join(name);
    let whole = build(sample.path(), C99, "examples/c/reconstruct.c", Link::Shared);
    output(&whole, [sample.plain(), glb("whole.glb")]);
    let readme = build(sample.path(), CPP17, "tests/cpp/readme.cpp", Link::Shared);
    output(&readme, [sample.plain(), glb("readme.glb")]);
    assert!(fs::read(glb("readme.glb")).unwrap() == fs::read(glb("whole.glb")).unwrap());
}

#[test]
fn frames_of_one_rig_are_made_at_once() {
    let sample = Sample::sized(4, 40, 32);
    let program = build(sample.path(), CPP17, "tests/cpp/threads.cpp", Link::Shared);
    output(&program, [sample.plain()]);
}

#[test]
fn opencv_and_python_make_the_same_bytes() {
    let sample = Sample::new();
    let whole = build(sample.path(), C99, "examples/c/reconstruct.c", Link::Shared);
    let expected = sample.path().join("whole.glb");
    output(&whole, [sample.plain(), expected.clone()]);
    let expected = fs::read(expected).unwrap();
    let result = sample.path().join("other.glb");

    if has("python3") {
        let mut python = Command::new("python3");
        python.arg(root().join("examples/python/smoke.py")).arg(libraries().join("libpcmvs.so"));
        let printed = run(python.arg(sample.plain()).arg(&result)).stdout;
        assert_eq!(String::from_utf8(printed).unwrap().trim(), env!("CARGO_PKG_VERSION"));
        assert!(fs::read(&result).unwrap() == expected, "Python's bytes differ");
    }

    let opencv = Command::new("pkg-config").args(["--cflags", "opencv4"]).output();
    let Some(opencv) = opencv.ok().filter(|o| o.status.success()) else {
        missing("OpenCV");
        return;
    };
    let flags = String::from_utf8(opencv.stdout).unwrap();
    // OpenCV's headers cause warnings.
    let flags = flags.trim().replace("-I", "-isystem");
    let compiler = [CPP17, &["-Wl,--no-as-needed", flags.as_str(), "-lopencv_imgcodecs", "-lopencv_core"]].concat();
    let program = build(sample.path(), &compiler, "examples/cpp/opencv.cpp", Link::Shared);
    output(&program, [sample.plain().join("calibration.yml"), sample.plain(), result.clone()]);
    assert!(fs::read(&result).unwrap() == expected, "OpenCV's bytes differ");
}

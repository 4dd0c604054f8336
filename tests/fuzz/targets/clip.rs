//! Any bytes as the result folder of a run: its manifest, its report and its frames, for `pcmvs pack` and `pcmvs join`.
#![no_main]

use gltf::Glb;
use libfuzzer_sys::fuzz_target;
use pcmvs_fuzz::{Folder, files_between};
use sha2::{Digest, Sha256};
use std::{fs, path::Path, sync::atomic::AtomicBool};

/// Stands for the SHA-256 of the first frame's file, which the fuzzer cannot find.
const HASH: &[u8] = b"@0";
/// Names of the files, in the order of the bytes.
const NAMES: [&str; 4] = ["frame_0000.glb", "sequence.json", "report.json", "frame_0001.glb"];

/// Runs a command and returns whether it succeeded. It must not fail for another reason than its input.
fn run(arguments: &[&Path]) -> bool {
    let arguments = ["pcmvs".into()].into_iter().chain(arguments.iter().map(|argument| argument.into()));
    let status = pcmvs_cli::run(arguments, &AtomicBool::new(false));
    assert!(matches!(status, 0 | 2), "the exit status is {status}");
    status == 0
}

fuzz_target!(|bytes: &[u8]| {
    let folder = Folder::new();
    let part = folder.path("part");
    fs::create_dir(&part).expect("the folder is empty");
    let files = files_between(bytes, NAMES.len());
    let hash: String = Sha256::digest(&files[0]).iter().map(|byte| format!("{byte:02x}")).collect();
    for (name, file) in NAMES.iter().zip(&files) {
        let file = if name.ends_with(".json") { replaced(file, HASH, hash.as_bytes()) } else { file.clone() };
        fs::write(part.join(name), file).expect("the folder is there");
    }

    let clip = folder.path("clip.glb");
    if run(&[Path::new("pack"), &part, Path::new("-o"), &clip]) {
        let bytes = fs::read(&clip).expect("the clip is there");
        let read = Glb::from_slice(&bytes).expect("a packed clip is a GLB file");
        assert_eq!(read.header.length as usize, bytes.len());
        serde_json::from_slice::<serde_json::Value>(&read.json).expect("its first chunk is JSON");
    }
    let published = folder.path("published");
    if run(&[Path::new("pack"), &part, Path::new("--manifest"), Path::new("-o"), &published]) {
        assert!(published.join("sequence.json").is_file());
    }
    let joined = folder.path("joined");
    if run(&[Path::new("join"), &part, Path::new("-o"), &joined]) {
        assert!(joined.join("sequence.json").is_file());
    }
    folder.assert_contains_only(&["part", "clip.glb", "published", "joined"]);
});

/// The bytes with every mark replaced.
fn replaced(bytes: &[u8], mark: &[u8], by: &[u8]) -> Vec<u8> {
    let mut out = Vec::with_capacity(bytes.len());
    let mut rest = bytes;
    while let Some(at) = rest.windows(mark.len()).position(|window| window == mark) {
        out.extend_from_slice(&rest[..at]);
        out.extend_from_slice(by);
        rest = &rest[at + mark.len()..];
    }
    out.extend_from_slice(rest);
    out
}

//! Programs that were built with an older header of this ABI version run with this library. `abi/` holds the exported symbols,
//! a dump of the types, and one folder per older header. `PCMVS_WRITE_ABI=1 cargo test -p pcmvs-ffi --test abi` renews symbols
//! and dump.
//!
//! The references are those of ABI 0.2. Version 0.2.0 broke the ABI once, so that stages, attributes, reports and warnings can
//! be added without breaking it again (CHANGELOG.md). Headers of 0.1 are not kept: their programs ask for `libpcmvs.so.0.1`,
//! which this library does not claim to be.

mod common;

use common::{Link, Sample, has, libraries, output, root, run};
use std::{
    env, fs,
    path::{Path, PathBuf},
    process::Command,
};

fn abi() -> PathBuf {
    root().join("ffi/abi")
}

#[test]
fn exported_symbols_are_the_listed_ones() {
    let mut nm = Command::new("nm");
    let printed = run(nm.args(["-D", "--defined-only"]).arg(libraries().join("libpcmvs.so"))).stdout;
    let printed = String::from_utf8(printed).unwrap();
    let mut symbols: Vec<&str> = printed.lines().filter_map(|line| line.split(' ').next_back()).collect();
    symbols.sort_unstable();
    let symbols = symbols.join("\n") + "\n";
    let file = abi().join("symbols.txt");
    if env::var_os("PCMVS_WRITE_ABI").is_some() {
        fs::write(&file, &symbols).unwrap();
    }
    assert_eq!(symbols, fs::read_to_string(file).unwrap());
    let header = fs::read_to_string(root().join("include/pcmvs.h")).unwrap();
    for symbol in symbols.lines() {
        assert!(header.contains(&format!("{symbol}(")), "{symbol} is not in the header");
    }
}

/// A shared object with the functions and types of the header as C has them. Rust's own types are not part of the ABI.
fn stubs(folder: &Path) -> PathBuf {
    let header = fs::read_to_string(root().join("include/pcmvs.h")).unwrap();
    let mut code = String::from("#include <pcmvs.h>\n");
    let starts = ["pcmvs_status pcmvs_", "const char *pcmvs_", "uint32_t pcmvs_"];
    for (at, _) in header.match_indices('\n') {
        let rest = &header[at + 1..];
        if starts.iter().any(|start| rest.starts_with(start)) {
            code += &rest[..rest.find(';').unwrap()];
            code += " { __builtin_trap(); }\n";
        }
    }
    let object = folder.join("libpcmvs.so");
    fs::write(folder.join("stubs.c"), code).unwrap();
    // With a relative name, so that the dump contains no folder of this machine.
    let mut cc = Command::new("gcc");
    cc.current_dir(folder).args(["-std=c11", "-g", "-shared", "-fPIC", "-w", "-I"]);
    cc.arg(root().join("include")).arg("stubs.c");
    run(cc.arg(format!("-Wl,-soname,{}", common::soname())).arg("-o").arg(&object));
    object
}

#[test]
fn types_are_compatible_with_the_dump() {
    if !has("abidiff") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let (object, dump) = (stubs(folder.path()), abi().join("types.abi"));
    if env::var_os("PCMVS_WRITE_ABI").is_some() {
        let mut abidw = Command::new("abidw");
        abidw.args(["--no-corpus-path", "--no-comp-dir-path", "--no-show-locs", "--out-file"]);
        run(abidw.arg(&dump).arg(&object));
    }
    let output = Command::new("abidiff").arg(dump).arg(object).output().unwrap();
    // Bits of its status: 1 error, 2 wrong usage, 4 a change, 8 an incompatible change.
    let status = output.status.code().unwrap();
    assert!(status & (1 | 2 | 8) == 0, "{}", String::from_utf8_lossy(&output.stdout));
}

#[test]
fn programs_of_older_headers_run() {
    let sample = Sample::new();
    let entries = fs::read_dir(abi()).unwrap().map(|entry| entry.unwrap().path());
    let versions: Vec<_> = entries.filter(|path| path.is_dir()).collect();
    assert!(!versions.is_empty(), "there is no older header");
    for version in versions {
        let folder = tempfile::tempdir().unwrap();
        fs::copy(version.join("pcmvs.h"), folder.path().join("pcmvs.h")).unwrap();
        let old = format!("-I{}", folder.path().display());
        let program = common::build(folder.path(), &["cc", "-std=c99", &old], "examples/c/reconstruct.c", Link::Shared);
        output(&program, [sample.plain(), folder.path().join("out.glb")]);
    }
}

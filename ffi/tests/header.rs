//! The committed header is the one that the sources generate. `PCMVS_WRITE_HEADER=1 cargo test -p pcmvs-ffi --test header`
//! writes it.

use std::{env, fs, path::Path};

#[test]
fn header_is_up_to_date() {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    let config = cbindgen::Config::from_file(package.join("cbindgen.toml")).unwrap();
    let bindings = cbindgen::Builder::new().with_crate(package).with_config(config).generate().unwrap();
    let mut generated = Vec::new();
    bindings.write(&mut generated);
    let path = package.join("../include/pcmvs.h");
    if env::var_os("PCMVS_WRITE_HEADER").is_some() {
        fs::write(&path, &generated).unwrap();
    }
    let committed = fs::read_to_string(&path).unwrap();
    assert!(committed.as_bytes() == generated, "include/pcmvs.h is not up to date: run `cargo xtask header`");
}

mod common;

#[test]
fn header_stands_alone_in_every_standard() {
    let c = [("c99", "c"), ("c11", "c"), ("c17", "c"), ("c++11", "c++"), ("c++17", "c++"), ("c++20", "c++")];
    let cpp = [("c++17", "c++"), ("c++20", "c++")];
    for compiler in ["gcc", "clang"] {
        if !common::has(compiler) {
            continue;
        }
        for (header, standards) in [("pcmvs.h", &c[..]), ("pcmvs.hpp", &cpp[..])] {
            for (standard, language) in standards {
                let folder = tempfile::tempdir().unwrap();
                let source = folder.path().join("twice.txt");
                fs::write(&source, format!("#include \"{header}\"\n#include \"{header}\"\n")).unwrap();
                let mut command = std::process::Command::new(compiler);
                command.args(["-x", language, &format!("-std={standard}"), "-fsyntax-only"]);
                command.args(["-Wall", "-Wextra", "-Wpedantic", "-Werror"]);
                command.arg("-I").arg(common::root().join("include")).arg(source);
                common::run(&mut command);
            }
        }
    }
}

//! Renders a small capture as plain files for the examples in C. Usage: plain_capture FOLDER [VIEWS WIDTH HEIGHT]

use std::{env, io, path::Path};

#[path = "../tests/common/plain.rs"]
mod plain;

fn main() -> io::Result<()> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let numbers: Option<Vec<u32>> = arguments.iter().skip(1).map(|a| a.parse().ok()).collect();
    let capture = match numbers.as_deref() {
        Some([]) => plain::capture(10, 160, 120),
        Some(&[views, width, height]) => plain::capture(views, width, height),
        _ => return Err(io::Error::other("usage: plain_capture FOLDER [VIEWS WIDTH HEIGHT]")),
    };
    let folder = arguments.first().ok_or_else(|| io::Error::other("name a folder"))?;
    plain::write(&capture, 0, Path::new(folder))
}

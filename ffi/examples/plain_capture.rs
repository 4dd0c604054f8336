//! Renders a small capture as the plain files that the examples in C read: plain_capture FOLDER

use std::{env, io, path::Path};

#[path = "../tests/common/plain.rs"]
mod plain;

fn main() -> io::Result<()> {
    let folder = env::args_os().nth(1).ok_or_else(|| io::Error::other("usage: plain_capture FOLDER"))?;
    plain::write(&plain::capture(10, 160, 120), Path::new(&folder))
}

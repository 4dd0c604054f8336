//! What the fuzz targets share: decisions from the fuzzer's bytes, files in memory and on disk, and a closed mesh as the oracle.

mod abi;
mod bytes;
mod files;
mod folder;
mod ring;
mod sound;
mod split;

pub use abi::{camera, init};
pub use bytes::Bytes;
pub use files::{PICTURE, Tree};
pub use folder::Folder;
pub use ring::ring;
pub use sound::assert_closed;
pub use split::files_between;

//! What the fuzz targets share: decisions from the fuzzer's bytes, files in memory, and a closed mesh as the oracle.

mod abi;
mod bytes;
mod files;
mod ring;
mod sound;

pub use abi::{camera, init};
pub use bytes::Bytes;
pub use files::{PICTURE, Tree};
pub use ring::ring;
pub use sound::assert_closed;

//! Version of the library, and of the header by macros.

use std::ffi::c_char;

/// Major version of this header.
pub const PCMVS_VERSION_MAJOR: u32 = 0;
/// Minor version of this header.
pub const PCMVS_VERSION_MINOR: u32 = 1;
/// Patch version of this header.
pub const PCMVS_VERSION_PATCH: u32 = 1;
/// Version of this header as one number that grows: major * 1000000 + minor * 1000 + patch.
pub const PCMVS_VERSION: u32 = 1001;

const _: () = {
    assert!(PCMVS_VERSION == PCMVS_VERSION_MAJOR * 1_000_000 + PCMVS_VERSION_MINOR * 1_000 + PCMVS_VERSION_PATCH);
};

/// Version of the library that is running, composed like `PCMVS_VERSION`. May be newer than the header's.
#[unsafe(no_mangle)]
pub extern "C" fn pcmvs_version() -> u32 {
    PCMVS_VERSION
}

/// Version of the library that is running, as "0.1.1". Static; never freed.
#[unsafe(no_mangle)]
pub extern "C" fn pcmvs_version_string() -> *const c_char {
    concat!(env!("CARGO_PKG_VERSION"), "\0").as_ptr().cast()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_those_of_the_package() {
        let composed = format!("{PCMVS_VERSION_MAJOR}.{PCMVS_VERSION_MINOR}.{PCMVS_VERSION_PATCH}");
        assert_eq!(composed, env!("CARGO_PKG_VERSION"));
    }
}

//! The version of the library, and of the header as macros.

use std::ffi::c_char;

/// Major version of this header.
pub const PCMVS_VERSION_MAJOR: u32 = 0;
/// Minor version of this header.
pub const PCMVS_VERSION_MINOR: u32 = 2;
/// Patch version of this header.
pub const PCMVS_VERSION_PATCH: u32 = 0;
/// Version of this header as one number: major * 1000000 + minor * 1000 + patch.
pub const PCMVS_VERSION: u32 = 2000;

const _: () = {
    assert!(PCMVS_VERSION == PCMVS_VERSION_MAJOR * 1_000_000 + PCMVS_VERSION_MINOR * 1_000 + PCMVS_VERSION_PATCH);
};

/// Returns the version of the running library in the form of `PCMVS_VERSION`. It may be newer than the header.
#[unsafe(no_mangle)]
pub extern "C" fn pcmvs_version() -> u32 {
    PCMVS_VERSION
}

/// Returns the version of the running library as text, such as "0.2.0". The string is static.
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

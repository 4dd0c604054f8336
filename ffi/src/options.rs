//! How a frame is made.

use crate::{
    boundary::{Growing, Result, Versioned, init},
    error::Failure,
    executor::{HostThreads, pcmvs_parallel_fn},
    progress::pcmvs_progress_fn,
    status::pcmvs_status::{self, InvalidArgument},
};
use pcmvs_core::{Memory, Params, Preset};
use std::{ffi::c_void, mem::size_of, ptr::null_mut};

/// Sets of parameters. Numbers never change.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum pcmvs_preset {
    /// What measures best.
    Default = 0,
    /// The method as published.
    Paper = 1,
    /// The visual hull alone.
    Hull = 2,
    /// The fastest.
    Preview = 3,
}

/// How a frame is made. All zero but `struct_size` is the default.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct pcmvs_options {
    /// Set by `pcmvs_options_init`.
    pub struct_size: u32,
    /// A `pcmvs_preset`.
    pub preset: u32,
    /// Number of the frame, for error messages only.
    pub frame: u32,
    /// Distance of the final mesh's grid nodes in pixels of footprint; 0 is the preset's.
    pub voxel_pixels: f32,
    /// Called as the work advances, or NULL.
    pub progress: pcmvs_progress_fn,
    /// Handed to `progress`.
    pub progress_user: *mut c_void,
    /// Runs pieces of work on the caller's threads, or NULL: everything runs on the calling thread.
    pub parallel: pcmvs_parallel_fn,
    /// Handed to `parallel`.
    pub parallel_user: *mut c_void,
    /// Most bytes that a frame may need on one thread beside the pictures given to it, or 0 for no limit. A frame that
    /// needs more fails with `PCMVS_STATUS_OUT_OF_MEMORY` as soon as its hull is known, and tells how much it needs.
    /// Without a limit a frame keeps working memory for the next one, and takes up to twice as much.
    pub max_memory: u64,
}

impl Growing for pcmvs_options {
    const FIRST_SIZE: usize = 16 + 4 * size_of::<usize>();
}

// SAFETY: numbers, raw pointers and nullable function pointers, the size first, no padding.
unsafe impl Versioned for pcmvs_options {
    fn defaults() -> Self {
        Self {
            struct_size: size_of::<Self>() as u32,
            preset: pcmvs_preset::Default as u32,
            frame: 0,
            voxel_pixels: 0.0,
            progress: None,
            progress_user: null_mut(),
            parallel: None,
            parallel_user: null_mut(),
            max_memory: 0,
        }
    }
}

/// Sets options to their defaults. `size` is `sizeof *options`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_options_init(options: *mut pcmvs_options, size: usize) -> pcmvs_status {
    // SAFETY: the caller's promise.
    unsafe { init(options, size, "options") }
}

impl pcmvs_options {
    pub(crate) fn params(&self) -> Result<Params> {
        const PRESETS: [Preset; 4] = [Preset::Default, Preset::Paper, Preset::Hull, Preset::Preview];
        let Some(&preset) = PRESETS.get(self.preset as usize) else {
            return Err(Failure::new(InvalidArgument, format!("preset {} is not known", self.preset)));
        };
        let mut params = Params::preset(preset);
        if self.voxel_pixels != 0.0 {
            if !(0.25..=100.0).contains(&self.voxel_pixels) {
                let problem = format!("voxel_pixels is {}: allowed are 0 and 0.25 to 100", self.voxel_pixels);
                return Err(Failure::new(InvalidArgument, problem));
            }
            params.meshing.voxel_pixels = self.voxel_pixels;
        }
        Ok(params)
    }

    /// Working memory as the options ask for it.
    pub(crate) fn memory(&self) -> Memory {
        if self.max_memory == 0 { Memory::kept() } else { Memory::limited(self.max_memory) }
    }

    pub(crate) fn threads(&self) -> HostThreads {
        HostThreads { parallel: self.parallel, user: self.parallel_user }
    }
}

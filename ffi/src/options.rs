//! How a frame is made.

use crate::{
    clock::Clock,
    executor::{HostThreads, pcmvs_parallel_fn},
    failure::{Failure, Result},
    progress::{HostProgress, pcmvs_progress_fn},
    sized::{Growing, Versioned, init},
    status::pcmvs_status::{self, InvalidArgument},
};
use pcmvs_core::{Memory, Params, Preset};
use std::{ffi::c_void, mem::size_of, ptr::null_mut};

/// Sets of parameters. Numbers never change.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum pcmvs_preset {
    /// The parameters with the best measured results.
    Default = 0,
    /// The method as published.
    Paper = 1,
    /// The visual hull without stereo.
    Hull = 2,
    /// The fastest preset.
    Preview = 3,
}

/// Options for a frame. If every member but `struct_size` is zero, these are the defaults.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct pcmvs_options {
    /// Set by `pcmvs_options_init`.
    pub struct_size: u32,
    /// A `pcmvs_preset`.
    pub preset: u32,
    /// Number of the frame. It appears in errors and has no other effect.
    pub frame: u32,
    /// Spacing of the grid on which the final mesh is computed, in pixels of footprint: 0.25 to 100, or 0 for the
    /// preset's own. A footprint is the size of a pixel at the object.
    pub voxel_pixels: f32,
    /// Called as the work advances. May be NULL.
    pub progress: pcmvs_progress_fn,
    /// Passed to `progress`.
    pub progress_user: *mut c_void,
    /// Runs jobs on the caller's threads. If it is NULL, all work runs on the calling thread.
    pub parallel: pcmvs_parallel_fn,
    /// Passed to `parallel`.
    pub parallel_user: *mut c_void,
    /// Largest amount of memory that the frame may need on one thread, in bytes, not counting the caller's pictures. Copies
    /// of them count: of pictures that are stored from the bottom up or have 16 bits.
    /// 0 means no limit. A frame that needs more fails with `PCMVS_STATUS_OUT_OF_MEMORY` before it allocates the memory,
    /// and the message says how much it needs. With a limit, working memory is freed after each stage. Without one it is
    /// kept for the next frame, which is faster but can take up to twice as much.
    pub max_memory: u64,
}

impl Growing for pcmvs_options {
    const FIRST_SIZE: usize = 24 + 4 * size_of::<usize>();
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

/// Initialises options with their defaults. `size` is `sizeof *options`.
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
                let problem = format!("voxel_pixels is {}: it must be 0 or from 0.25 to 100", self.voxel_pixels);
                return Err(Failure::new(InvalidArgument, problem));
            }
            params.meshing.voxel_pixels = self.voxel_pixels;
        }
        Ok(params)
    }

    /// Whether a frame keeps its working memory for the next one.
    pub(crate) fn keeps_memory(&self) -> bool {
        self.max_memory == 0
    }

    /// New working memory, beside `held` bytes that are held otherwise.
    pub(crate) fn memory(&self, held: u64) -> Memory {
        if self.keeps_memory() { Memory::kept() } else { Memory::limited(self.max_memory.saturating_sub(held)) }
    }

    pub(crate) fn threads(&self) -> HostThreads {
        HostThreads { parallel: self.parallel, user: self.parallel_user }
    }

    /// Progress of one call on the current thread.
    pub(crate) fn progress<'a>(&self, clock: &'a Clock) -> HostProgress<'a> {
        HostProgress::new(clock, self.progress, self.progress_user, self.parallel.is_some())
    }
}

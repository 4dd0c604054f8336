//! Adds what samples contribute to the nodes around them. Jobs sum up the contributions of neighbouring samples, and their
//! sums are added in the order of the samples, whatever the number of threads.

use alloc::vec::Vec;
use core::iter::repeat_with;

use super::spline::ABSENT;
use crate::error::Result;
use crate::executor::Executor;
use crate::grid::{BLOCK_NODES, SparseGrid};

/// Samples of one job. Samples are in the order of their Morton codes, so that those of a job reach few blocks.
const SAMPLES_PER_JOB: usize = 1 << 12;
/// Samples that are processed between two progress reports: at most 25 ms of work.
pub(super) const SAMPLES_PER_STEP: usize = 32 * SAMPLES_PER_JOB;

/// The sums of one job at the nodes of the blocks that its samples reach.
pub(super) struct Patch<const N: usize> {
    /// For each block of the grid, its place in `slots`, or [`ABSENT`].
    places: Vec<u32>,
    slots: Vec<u32>,
    /// Block after block.
    sums: Vec<[f32; N]>,
}

impl<const N: usize> Patch<N> {
    fn new(blocks: usize) -> Self {
        Self { places: alloc::vec![ABSENT; blocks], slots: Vec::new(), sums: Vec::new() }
    }

    /// Place of a block of the grid among those of the patch, which gets the block if it does not have it.
    pub(super) fn place(&mut self, slot: u32) -> u32 {
        let place = &mut self.places[slot as usize];
        if *place == ABSENT {
            *place = self.slots.len() as u32;
            self.slots.push(slot);
            self.sums.resize(self.slots.len() * BLOCK_NODES, [0.0; N]);
        }
        *place
    }

    /// The sums at the nodes of the patch's blocks.
    #[inline]
    pub(super) fn sums(&mut self) -> &mut [[f32; N]] {
        &mut self.sums
    }

    /// Passes the sums of each block, with the index of its first node in the grid, to `add`, and forgets them.
    fn empty_into(&mut self, add: &mut impl FnMut(usize, &[[f32; N]])) {
        for (&slot, sums) in self.slots.iter().zip(self.sums.chunks_exact(BLOCK_NODES)) {
            add(slot as usize * BLOCK_NODES, sums);
            self.places[slot as usize] = ABSENT;
        }
        self.slots.clear();
        self.sums.clear();
    }
}

/// Calls `contribute` for each sample with the patch that it adds to, and `add` with the sums of whole blocks and the index
/// of each block's first node. `step` is called before every [`SAMPLES_PER_STEP`] samples.
pub(super) fn accumulate<S: Sync, const N: usize>(
    samples: &[S],
    grid: &SparseGrid,
    contribute: impl Fn(&S, &mut Patch<N>) + Sync,
    mut add: impl FnMut(usize, &[[f32; N]]),
    executor: &dyn Executor,
    mut step: impl FnMut() -> Result<()>,
) -> Result<()> {
    let jobs = samples.len().min(SAMPLES_PER_STEP).div_ceil(SAMPLES_PER_JOB);
    let mut patches: Vec<Patch<N>> = repeat_with(|| Patch::new(grid.blocks.len())).take(jobs).collect();
    for batch in samples.chunks(SAMPLES_PER_STEP) {
        step()?;
        executor.map_parts(patches.iter_mut().zip(batch.chunks(SAMPLES_PER_JOB)), |_, (patch, samples)| {
            samples.iter().for_each(|sample| contribute(sample, patch));
        });
        patches.iter_mut().for_each(|patch| patch.empty_into(&mut add));
    }
    Ok(())
}

//! How many frames are made at the same time.

use pcmvs_core::{Params, Rig, memory};
use sysinfo::{MemoryRefreshKind, RefreshKind, System};

/// Largest number of frames in memory at a time. Further threads work on the views of these frames.
const MAX: usize = 8;
/// Share of the free memory that frames may take. The rest is for what other programs will need, for the files of a frame,
/// and for meshes that wait for their neighbours.
const SHARE: f64 = 0.75;
/// Bytes per pixel of the decoded pictures and masks of the frames before and after.
const DECODED: u64 = 2 * (3 + 1);

/// Number of frames of a rig that are made at the same time, so that all of them fit in the memory that is free now. At least
/// one frame is always made, because what a frame needs is reckoned from above.
pub struct AtOnce {
    /// Bytes that a frame is expected to need.
    expected: u64,
    /// Bytes for the views of the frames before and after that are read together with those of frames that are made again.
    between: u64,
    /// Bytes that are free, if the system tells.
    free: Option<u64>,
}

impl AtOnce {
    /// Asks the system how much memory is free. `reading` is the number of threads that may read views together with those of
    /// the frames before and after, 0 if every frame is made by itself.
    pub fn new(rig: &Rig, params: &Params, reading: usize) -> Self {
        let largest = rig.cameras().iter().map(|c| u64::from(c.width) * u64::from(c.height)).max().unwrap_or(0);
        let between = reading as u64 * (memory::between(rig, params) + DECODED * largest);
        Self { expected: memory::expected(rig, params), between, free: free_memory() }
    }

    /// The number of frames at a time.
    pub fn frames(&self) -> usize {
        let Some(free) = self.free else { return MAX };
        let fits = ((SHARE * free as f64 - self.between as f64) / self.expected.max(1) as f64) as usize;
        fits.clamp(1, MAX)
    }

    /// What to say if memory allows fewer frames at a time than there are `threads` and frames in `count`.
    pub fn explanation(&self, threads: usize, count: usize) -> Option<String> {
        let (frames, mib) = (self.frames(), |bytes: u64| bytes >> 20);
        (frames < threads.min(count).min(MAX)).then(|| {
            format!(
                "{frames} of {count} frames at a time, because each may need {} MiB, and {} MiB of memory are free",
                mib(self.expected),
                mib(self.free.unwrap_or(0)),
            )
        })
    }
}

/// Bytes of memory that are free on this machine, and in this container if that has a limit.
fn free_memory() -> Option<u64> {
    let system =
        System::new_with_specifics(RefreshKind::nothing().with_memory(MemoryRefreshKind::nothing().with_ram()));
    let of_machine = Some(system.available_memory()).filter(|&bytes| bytes > 0)?;
    // The files that the system keeps in memory do not count, because it lets them go when memory is needed.
    let of_group = system.cgroup_limits().map(|limits| limits.total_memory.saturating_sub(limits.rss));
    Some(of_group.map_or(of_machine, |bytes| bytes.min(of_machine)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_at_a_time_fit_in_three_quarters_of_the_free_memory() {
        let frames = |expected, free| AtOnce { expected, between: 0, free }.frames();
        assert_eq!(frames(1 << 30, Some(4 << 30)), 3);
        assert_eq!(frames(1 << 30, Some((4 << 30) - 1)), 2);
        assert_eq!(frames(1 << 30, Some(1 << 40)), MAX);
        assert_eq!(frames(1 << 30, Some(0)), 1);
        assert_eq!(frames(0, Some(1 << 30)), MAX);
        assert_eq!(frames(1 << 30, None), MAX);
        let averaged = AtOnce { expected: 1 << 30, between: 1 << 30, free: Some(4 << 30) };
        assert_eq!(averaged.frames(), 2, "views of frames before and after take memory, too");
    }

    #[test]
    fn fewer_frames_than_threads_are_explained_with_both_figures() {
        let little = AtOnce { expected: 3 << 30, between: 0, free: Some(9 << 30) };
        let text = little.explanation(4, 100).expect("only two frames fit");
        assert!(
            text.starts_with("2 of 100 frames at a time") && text.contains("3072 MiB") && text.contains("9216 MiB"),
            "{text}"
        );
        assert_eq!(little.explanation(2, 100), None);
        assert_eq!(little.explanation(4, 2), None);
    }

    #[test]
    fn this_machine_has_free_memory() {
        assert!(free_memory().is_some_and(|bytes| bytes > 1 << 20));
    }
}

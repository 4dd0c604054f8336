//! Sets of views that exclude the same place.

/// Largest number of views that may wrongly exclude the same place.
pub(super) const TOLERATED: u32 = 3;

/// A small set of views that exclude the same place, in ascending order; unused entries are `u16::MAX`.
pub(super) type Excluders = [u16; TOLERATED as usize];

/// The empty set.
pub(super) const NOBODY: Excluders = [u16::MAX; TOLERATED as usize];

/// Number of views in a set.
pub(super) fn size(set: &Excluders) -> usize {
    set.iter().filter(|&&view| view != u16::MAX).count()
}

/// Distinct sets of views that exclude places of one ray. Of a place that few views exclude, but more than another, the
/// set is kept as well: once one of its views is out, it may become the most plausible one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sets {
    sets: [Excluders; Self::MOST],
    count: usize,
}

impl Sets {
    /// Largest number of sets that are kept per ray.
    pub(super) const MOST: usize = 6;

    /// No set.
    pub(super) const fn new() -> Self {
        Self { sets: [NOBODY; Self::MOST], count: 0 }
    }

    /// The sets, in the order in which they were added.
    pub(super) fn iter(&self) -> core::slice::Iter<'_, Excluders> {
        self.sets[..self.count].iter()
    }

    /// Adds a set, in the place of a larger one if there is no room.
    pub(super) fn add(&mut self, set: Excluders) {
        if self.sets[..self.count].contains(&set) {
            return;
        }
        if self.count < Self::MOST {
            self.sets[self.count] = set;
            self.count += 1;
        } else if let Some(larger) = (0..Self::MOST).max_by_key(|&i| (size(&self.sets[i]), i))
            && size(&self.sets[larger]) > size(&set)
        {
            self.sets[larger] = set;
        }
    }
}

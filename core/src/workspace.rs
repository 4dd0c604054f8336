//! Memory that is reused by later steps and frames.

use alloc::{boxed::Box, vec::Vec};
use core::any::{Any, TypeId};

/// Vectors that steps return for reuse by later steps and frames. Memory is then allocated once, but the peak is
/// higher.
///
/// The default workspace keeps nothing: each step allocates its memory and frees it at once. The content of kept
/// vectors never affects a result.
#[derive(Debug, Default)]
pub struct Workspace {
    keeps: bool,
    kept: Vec<Kept>,
}

/// An empty vector that is kept for its capacity.
#[derive(Debug)]
struct Kept {
    /// Type of its items, and its capacity.
    items: TypeId,
    room: usize,
    vector: Box<dyn Any + Send + Sync>,
}

impl Workspace {
    /// A workspace that keeps the vectors it receives.
    pub fn keeping() -> Self {
        Self { keeps: true, ..Self::default() }
    }

    /// The smallest kept vector with a capacity of at least `len` items. If there is none, the largest vector is freed,
    /// because the caller allocates a larger one that will replace it.
    fn roomy(&mut self, items: TypeId, len: usize) -> Option<Kept> {
        let fits = |kept: &Kept| kept.items == items && kept.room >= len;
        let roomy = (0..self.kept.len()).filter(|&i| fits(&self.kept[i])).min_by_key(|&i| self.kept[i].room);
        if roomy.is_none() {
            self.largest(items);
        }
        roomy.map(|i| self.kept.swap_remove(i))
    }

    fn largest(&mut self, items: TypeId) -> Option<Kept> {
        let of_type = (0..self.kept.len()).filter(|&i| self.kept[i].items == items);
        let largest = of_type.max_by_key(|&i| self.kept[i].room);
        largest.map(|i| self.kept.swap_remove(i))
    }

    /// An empty vector with a capacity of at least `len` items.
    pub(crate) fn empty<T: Send + Sync + 'static>(&mut self, len: usize) -> Vec<T> {
        let kept = self.roomy(TypeId::of::<T>(), len);
        kept.map_or_else(|| Vec::with_capacity(len), Kept::vector)
    }

    /// An empty vector for a number of items that is not known in advance: the largest one that is kept.
    pub(crate) fn take<T: Send + Sync + 'static>(&mut self) -> Vec<T> {
        self.largest(TypeId::of::<T>()).map_or_else(Vec::new, Kept::vector)
    }

    /// A vector of `len` copies of `value`.
    pub(crate) fn filled<T: Clone + Send + Sync + 'static>(&mut self, value: T, len: usize) -> Vec<T> {
        let mut filled = self.empty(len);
        filled.resize(len, value);
        filled
    }

    /// Takes back a vector for reuse.
    pub fn recycle<T: Send + Sync + 'static>(&mut self, mut used: Vec<T>) {
        if self.keeps && used.capacity() > 0 {
            used.clear();
            self.kept.push(Kept { items: TypeId::of::<T>(), room: used.capacity(), vector: Box::new(used) });
        }
    }
}

impl Kept {
    fn vector<T: 'static>(self) -> Vec<T> {
        *self.vector.downcast().expect("a vector is kept with the type of its items")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_comes_back() {
        let mut workspace = Workspace::keeping();
        let (small, large) = (workspace.filled(1u32, 10), workspace.filled(2u32, 1000));
        let places = (small.as_ptr(), large.as_ptr());
        workspace.recycle(large);
        workspace.recycle(small);
        let (small, large) = (workspace.filled(3u32, 9), workspace.empty::<u32>(900));
        assert_eq!((small.as_ptr(), large.as_ptr()), places);
        assert_eq!((&small[..], large.len()), (&[3; 9][..], 0));
        workspace.recycle(large);
        workspace.recycle(small);
        let largest = workspace.take::<u32>();
        assert_eq!(largest.as_ptr(), places.1);
        // A vector that is too small is freed when a larger one is requested. Each item type has its own vectors.
        assert_eq!(workspace.take::<f32>().capacity(), 0);
        drop(workspace.empty::<u32>(5000));
        assert!(workspace.kept.is_empty());
    }

    #[test]
    fn the_default_keeps_nothing() {
        let mut workspace = Workspace::default();
        workspace.recycle(Vec::<u32>::with_capacity(10));
        assert_eq!(workspace.take::<u32>().capacity(), 0);
    }
}

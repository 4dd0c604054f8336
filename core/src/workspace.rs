//! Memory that outlives the step that needed it.

use alloc::{boxed::Box, vec::Vec};
use core::any::{Any, TypeId};

/// Vectors that a step hands back for the next one to use, and a frame for the next: memory is asked for once, but more is
/// taken at a time. The default keeps nothing: steps then take new memory and free it at once. What is kept does not
/// matter to any result.
#[derive(Debug, Default)]
pub struct Workspace {
    keeps: bool,
    kept: Vec<Kept>,
}

/// A vector without items.
#[derive(Debug)]
struct Kept {
    /// Type and number of the items for which it has room.
    items: TypeId,
    room: usize,
    vector: Box<dyn Any + Send + Sync>,
}

impl Workspace {
    /// One that keeps what it is given.
    pub fn keeping() -> Self {
        Self { keeps: true, ..Self::default() }
    }

    /// The smallest kept vector with room for `len` items. If none has it, the largest goes: a new one takes its place.
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

    /// An empty vector with room for `len` items.
    pub(crate) fn empty<T: Send + Sync + 'static>(&mut self, len: usize) -> Vec<T> {
        let kept = self.roomy(TypeId::of::<T>(), len);
        kept.map_or_else(|| Vec::with_capacity(len), Kept::vector)
    }

    /// An empty vector that will grow by as much as cannot be foretold: the largest kept one.
    pub(crate) fn take<T: Send + Sync + 'static>(&mut self) -> Vec<T> {
        self.largest(TypeId::of::<T>()).map_or_else(Vec::new, Kept::vector)
    }

    /// A vector of `len` times `value`.
    pub(crate) fn filled<T: Clone + Send + Sync + 'static>(&mut self, value: T, len: usize) -> Vec<T> {
        let mut filled = self.empty(len);
        filled.resize(len, value);
        filled
    }

    /// Takes a vector's memory back.
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
        // What is too small makes room for what is not; other types have vectors of their own.
        assert_eq!(workspace.take::<f32>().capacity(), 0);
        drop(workspace.empty::<u32>(5000));
        assert!(workspace.kept.is_empty());
    }

    #[test]
    fn one_that_keeps_nothing_is_empty() {
        let mut workspace = Workspace::default();
        workspace.recycle(Vec::<u32>::with_capacity(10));
        assert_eq!(workspace.take::<u32>().capacity(), 0);
    }
}

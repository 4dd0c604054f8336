//! Memory that outlives the step that needed it.

use alloc::{boxed::Box, collections::BTreeMap, vec, vec::Vec};
use core::any::{Any, TypeId};

/// Vectors that a step hands back for the next one to use, and a frame for the next: memory is asked for once, but more is
/// taken at a time. The default keeps nothing: steps then take new memory and free it at once. What is kept does not
/// matter to any result.
#[derive(Debug, Default)]
pub struct Workspace {
    keeps: bool,
    /// A list of vectors for each type of item.
    kept: BTreeMap<TypeId, Box<dyn Any + Send + Sync>>,
}

impl Workspace {
    /// One that keeps what it is given.
    pub fn keeping() -> Self {
        Self { keeps: true, ..Self::default() }
    }

    fn kept<T: Send + Sync + 'static>(&mut self) -> &mut Vec<Vec<T>> {
        let kept = self.kept.entry(TypeId::of::<T>()).or_insert_with(|| Box::new(Vec::<Vec<T>>::new()));
        kept.downcast_mut().expect("what is kept under a type is of that type")
    }

    /// The smallest kept vector with room for `len` items. If none has it, the largest goes: a new one takes its place.
    fn roomy<T: Send + Sync + 'static>(&mut self, len: usize) -> Option<Vec<T>> {
        let kept = self.kept::<T>();
        let roomy = (0..kept.len()).filter(|&i| kept[i].capacity() >= len).min_by_key(|&i| kept[i].capacity());
        if roomy.is_none() {
            self.growing::<T>();
        }
        roomy.map(|i| self.kept().swap_remove(i))
    }

    /// An empty vector with room for `len` items.
    pub(crate) fn empty<T: Send + Sync + 'static>(&mut self, len: usize) -> Vec<T> {
        self.roomy(len).unwrap_or_else(|| Vec::with_capacity(len))
    }

    /// An empty vector that will grow by as much as cannot be foretold: the largest kept one.
    pub(crate) fn growing<T: Send + Sync + 'static>(&mut self) -> Vec<T> {
        let kept = self.kept::<T>();
        let largest = (0..kept.len()).max_by_key(|&i| kept[i].capacity());
        largest.map_or_else(Vec::new, |i| kept.swap_remove(i))
    }

    /// A vector of `len` times `value`.
    pub(crate) fn filled<T: Clone + Send + Sync + 'static>(&mut self, value: T, len: usize) -> Vec<T> {
        match self.roomy(len) {
            Some(mut filled) => {
                filled.resize(len, value);
                filled
            }
            None => vec![value; len],
        }
    }

    /// Takes a vector's memory back.
    pub fn keep<T: Send + Sync + 'static>(&mut self, mut used: Vec<T>) {
        used.clear();
        if self.keeps && used.capacity() > 0 {
            self.kept().push(used);
        }
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
        workspace.keep(large);
        workspace.keep(small);
        let (small, large) = (workspace.filled(3u32, 9), workspace.empty::<u32>(900));
        assert_eq!((small.as_ptr(), large.as_ptr()), places);
        assert_eq!((&small[..], large.len()), (&[3; 9][..], 0));
        workspace.keep(large);
        workspace.keep(small);
        let largest = workspace.growing::<u32>();
        assert_eq!(largest.as_ptr(), places.1);
        // What is too small makes room for what is not.
        drop(workspace.empty::<u32>(5000));
        assert!(workspace.kept::<u32>().is_empty());
        assert_eq!(workspace.growing::<f32>().capacity(), 0);
    }
}

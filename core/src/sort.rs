//! Sorting in little code. The sorts of the standard library are fast for long lists, but each type that they are used for
//! and each order is several kilobytes of code, which the npm package has no room for. Short lists, such as those with an
//! entry per camera, do without them.

use alloc::collections::BinaryHeap;
use core::cmp::Ordering;

/// Longer lists are not short.
const SHORT: usize = 64;

/// Sorts numbers. It is a function of its own, so that it is compiled once.
#[inline(never)]
pub fn numbers(list: &mut [u64]) {
    list.sort_unstable();
}

/// Sorts pairs of a key and an index by their keys, and pairs with the same key by their indices. It is a function of its own, so
/// that it is compiled once.
#[inline(never)]
pub fn indexed(list: &mut [(u64, u32)]) {
    list.sort_unstable();
}

/// Sorts a list that is nearly always short. Equal entries must not be distinguishable.
pub fn mostly_short<T: Copy + Ord>(list: &mut [T]) {
    if list.len() <= SHORT {
        return short(list);
    }
    let sorted = list.iter().copied().collect::<BinaryHeap<T>>().into_sorted_vec();
    list.copy_from_slice(&sorted);
}

/// Sorts a short list by binary insertion. Equal entries stay in their order.
pub fn short_by<T: Copy>(list: &mut [T], order: impl Fn(&T, &T) -> Ordering) {
    for i in 1..list.len() {
        let entry = list[i];
        let place = list[..i].partition_point(|other| order(other, &entry).is_le());
        list.copy_within(place..i, place + 1);
        list[place] = entry;
    }
}

/// Sorts a short list of numbers, or of what is compared like them.
pub fn short<T: Copy + Ord>(list: &mut [T]) {
    short_by(list, T::cmp);
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn short_lists_are_sorted_as_by_the_standard_library(keys in proptest::collection::vec(0_u8..8, 0..40)) {
            let mut list: Vec<(u8, usize)> = keys.into_iter().enumerate().map(|(i, key)| (key, i)).collect();
            let mut expected = list.clone();
            expected.sort_by_key(|&(key, _)| key);
            short_by(&mut list, |a, b| a.0.cmp(&b.0));
            prop_assert_eq!(list, expected);
        }

        #[test]
        fn lists_of_any_length_are_sorted_as_by_the_standard_library(keys in proptest::collection::vec(0_u8..100, 0..300)) {
            let (mut list, mut expected) = (keys.clone(), keys);
            expected.sort();
            mostly_short(&mut list);
            prop_assert_eq!(list, expected);
        }
    }
}

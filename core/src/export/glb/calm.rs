//! Bytes that compress well among those that are near enough.
//!
//! The vertices' format of EXT_meshopt_compression (version 0) stores each byte of a vertex as its difference to that of the
//! vertex before, in groups of 16 differences with 0, 2, 4 or 8 bits each. Differences that do not fit the bits of their group
//! take a byte more. The cheapest choice of all is found by dynamic programming over the vertices.

use alloc::{vec, vec::Vec};

/// Bytes that are near enough, from the first to the last.
pub(super) type Near = [u8; 2];

/// Most bytes of a vertex that are compared. Those at the end of a longer interval are left out.
const MOST: usize = 16;
/// Differences in a group.
const GROUP: usize = 16;
/// The ways to store a group: its bytes, and the differences, with their sign as the lowest bit, that take no byte more.
const WAYS: [(u32, u8); 4] = [(0, 0), (4, 2), (8, 14), (16, 255)];
/// A way that stores no other difference, because it has no bits.
const ZERO: usize = 0;
/// More than the bytes of any file.
const IMPOSSIBLE: u32 = u32::MAX / 2;

/// The bytes stored to get to each byte of an interval.
type Costs = [u32; MOST];

/// One byte per vertex, within its interval, so that they take the fewest bytes.
pub(super) fn cheapest(near: &[Near]) -> Vec<u8> {
    let Some(&first) = near.first() else { return Vec::new() };
    // Where each way came from, per vertex, and the best way per last byte of a group.
    let mut from = vec![[[0u8; MOST]; WAYS.len()]; near.len()];
    let mut ways = Vec::with_capacity(near.len().div_ceil(GROUP));
    // The first vertex is stored as it is.
    let (mut last, mut costs) = (first, [0; MOST]);
    for (group, from) in near.chunks(GROUP).zip(from.chunks_mut(GROUP)) {
        let mut best = [IMPOSSIBLE; MOST];
        let mut best_way = [ZERO; MOST];
        for (way, (bytes, _)) in WAYS.iter().enumerate() {
            let (mut before, mut reached) = (last, costs);
            for (&near, from) in group.iter().zip(from.iter_mut()) {
                reached = step(way, before, &reached, near, &mut from[way]);
                before = near;
            }
            for (at, cost) in reached.iter().enumerate() {
                if cost + bytes < best[at] {
                    (best[at], best_way[at]) = (cost + bytes, way);
                }
            }
        }
        last = group[group.len() - 1];
        costs = best;
        ways.push(best_way);
    }
    let mut at = (0..=width(last)).min_by_key(|&at| costs[at]).unwrap_or(0);
    let mut out = vec![0; near.len()];
    for (group, way) in ways.iter().enumerate().rev() {
        let way = way[at];
        for i in (group * GROUP..near.len().min((group + 1) * GROUP)).rev() {
            out[i] = near[i][0] + at as u8;
            at = usize::from(from[i][way][at]);
        }
    }
    out
}

/// The last place in an interval.
fn width([low, high]: Near) -> usize {
    usize::from(high.saturating_sub(low)).min(MOST - 1)
}

/// The costs of a vertex's bytes, from those of the vertex before. `from` gets the places that they come from.
fn step(way: usize, before: Near, costs: &Costs, near: Near, from: &mut [u8; MOST]) -> Costs {
    let (_, largest) = WAYS[way];
    let mut reached = [IMPOSSIBLE; MOST];
    for (at, reached) in reached.iter_mut().enumerate().take(width(near) + 1) {
        for (place, cost) in costs.iter().enumerate().take(width(before) + 1) {
            let difference = (near[0] + at as u8).wrapping_sub(before[0] + place as u8).cast_signed();
            let stored = ((difference << 1) ^ (difference >> 7)).cast_unsigned();
            let more = if stored <= largest {
                0
            } else if way == ZERO {
                IMPOSSIBLE
            } else {
                1
            };
            // Both are at most half of the largest number.
            let cost = cost + more;
            if cost < *reached {
                (*reached, from[at]) = (cost, place as u8);
            }
        }
    }
    reached
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bytes that the format takes for a series, without its headers.
    fn stored(series: &[u8]) -> usize {
        let mut last = series[0];
        let mut total = 0;
        for group in series.chunks(GROUP) {
            let differences: Vec<u8> = group
                .iter()
                .map(|&value| {
                    let difference = value.wrapping_sub(core::mem::replace(&mut last, value)).cast_signed();
                    ((difference << 1) ^ (difference >> 7)).cast_unsigned()
                })
                .collect();
            let beyond = |largest| differences.iter().filter(|&&d| d > largest).count();
            let zero = if beyond(0) == 0 { 0 } else { usize::MAX };
            total += zero.min(4 + beyond(2)).min(8 + beyond(14)).min(16);
        }
        total
    }

    #[test]
    fn no_other_choice_takes_fewer_bytes() {
        // All choices of a short series, which begins with a group of vertices that have none.
        let mut near: Vec<Near> = vec![[100, 100]; GROUP];
        near.extend([[99, 101], [103, 104], [90, 91], [105, 107], [104, 105], [120, 121], [119, 122], [0, 1]]);
        let made = cheapest(&near);
        assert!(made.iter().zip(&near).all(|(value, [low, high])| (low..=high).contains(&value)));
        let mut choices: Vec<Vec<u8>> = vec![Vec::new()];
        for &[low, high] in &near {
            let longer = choices.iter().flat_map(|c| (low..=high).map(move |v| [c.as_slice(), &[v]].concat()));
            choices = longer.collect();
        }
        assert_eq!(Some(stored(&made)), choices.iter().map(|choice| stored(choice)).min());
    }

    #[test]
    fn a_value_that_may_stay_stays() {
        let near: Vec<Near> = (0..100).map(|i| [40 - i % 3, 42 + i % 5]).collect();
        assert_eq!(stored(&cheapest(&near)), 0);
        assert!(cheapest(&[]).is_empty());
    }
}

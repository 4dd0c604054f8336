//! The most probable offsets along a closed loop.

use super::profile::{Costs, OFFSET_STEP, OFFSETS, offset};
use crate::silhouette::refill::refill;
use alloc::vec::Vec;

/// Cost of a change of offset from one point to the next, per step of the offset.
const CHANGE: f32 = 0.3;
/// Points by which a loop's ends overlap, so that it closes.
const OVERLAP: usize = 40;

/// Where the contour passes a point, in pixels along the outward normal, and how precisely that is known.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Offset {
    pub value: f32,
    /// 1/σ² in 1/pixel².
    pub precision: f32,
}

/// For each point of a loop, and those by which its ends overlap, the best state before each state.
pub(super) type Ways = Vec<[u8; OFFSETS]>;

/// Offsets of smallest total cost of a loop of `n` points, refined between states by a parabola. `ways` is a buffer, `out`
/// is overwritten.
pub(super) fn offsets(n: usize, costs: impl Fn(usize) -> Costs, ways: &mut Ways, out: &mut Vec<Offset>) {
    let overlap = OVERLAP.min(n);
    let total = n + 2 * overlap;
    refill(ways, total, [0; OFFSETS]);
    let mut sums = [0.0f32; OFFSETS];
    for k in 0..total {
        // Best way from the last point: itself, or through the neighbouring states.
        let mut way: [u8; OFFSETS] = core::array::from_fn(|s| s as u8);
        for s in 1..OFFSETS {
            if sums[s - 1] + CHANGE < sums[s] {
                (sums[s], way[s]) = (sums[s - 1] + CHANGE, way[s - 1]);
            }
        }
        for s in (0..OFFSETS - 1).rev() {
            if sums[s + 1] + CHANGE < sums[s] {
                (sums[s], way[s]) = (sums[s + 1] + CHANGE, way[s + 1]);
            }
        }
        let point = costs((k + n - overlap) % n);
        let least = sums.iter().copied().fold(f32::INFINITY, f32::min);
        (0..OFFSETS).for_each(|s| sums[s] += point[s] - least);
        ways[k] = way;
    }
    let mut state = (0..OFFSETS).min_by(|&a, &b| sums[a].total_cmp(&sums[b])).unwrap_or(OFFSETS / 2);
    refill(out, n, Offset::default());
    for k in (0..total).rev() {
        if (overlap..n + overlap).contains(&k) {
            out[k - overlap] = between(&costs(k - overlap), state);
        }
        state = ways[k][state] as usize;
    }
}

/// Curvature of costs at an offset: 1/σ² in 1/pixel².
pub(super) fn precision(costs: &Costs, value: f32) -> f32 {
    let state = value / OFFSET_STEP + (OFFSETS / 2) as f32 + 0.5;
    between(costs, (state.max(0.0) as usize).min(OFFSETS - 1)).precision
}

/// Minimum and curvature of the parabola through a state and its neighbours.
fn between(costs: &Costs, state: usize) -> Offset {
    let middle = state.clamp(1, OFFSETS - 2);
    let (a, b, c) = (costs[middle - 1], costs[middle], costs[middle + 1]);
    let bend = a - 2.0 * b + c;
    let shift = if bend > 0.0 { (0.5 * (a - c) / bend).clamp(-1.0, 1.0) } else { 0.0 };
    Offset { value: offset(middle) + shift * OFFSET_STEP, precision: (bend / (OFFSET_STEP * OFFSET_STEP)).max(0.0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn offsets_follow_the_costs_across_gaps_and_outliers() {
        let truth = |i: usize| 2.0 * libm::sinf(i as f32 * core::f32::consts::TAU / 200.0);
        let costs: Vec<Costs> = (0..200)
            .map(|i| {
                let wrong = i % 40 == 7;
                let blind = (60..70).contains(&i);
                core::array::from_fn(|s| {
                    let error = offset(s) - if wrong { truth(i) - 3.0 } else { truth(i) };
                    if blind { 0.0 } else { (8.0 * error * error).min(4.0) }
                })
            })
            .collect();
        let mut found = Vec::new();
        offsets(costs.len(), |i| costs[i], &mut Vec::new(), &mut found);
        for (i, found) in found.iter().enumerate() {
            let allowed = if (58..72).contains(&i) || i % 40 == 7 { 0.6 } else { 0.05 };
            assert!((found.value - truth(i)).abs() < allowed, "{i}: {} instead of {}", found.value, truth(i));
            let precise = (found.precision - 16.0).abs() < 0.5;
            assert!(precise != (60..70).contains(&i) || i % 40 == 7, "{i}: {}", found.precision);
        }
    }
}

//! Connected parts of the object, and of what surrounds it.

use super::refill::refill;
use alloc::{collections::VecDeque, vec::Vec};

/// Which pixels next to each other are connected.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Connected {
    /// Those that share a side.
    Sides,
    /// Those that share a side or a corner.
    Corners,
}

/// A connected part of one side of the contour.
#[derive(Debug)]
pub(crate) struct Part {
    /// Whether it belongs to the object.
    pub inside: bool,
    /// Number of its pixels.
    pub pixels: u32,
    /// Whether it reaches the edge.
    pub at_edge: bool,
}

/// Connected parts, in the order of their first pixels.
#[derive(Debug, Default)]
pub(crate) struct Parts {
    /// Each pixel's part.
    of: Vec<u32>,
    /// The parts.
    pub list: Vec<Part>,
}

impl Parts {
    const NONE: u32 = u32::MAX;

    /// The parts of one side alone.
    pub fn of_side(w: usize, h: usize, object: &[bool], inside: bool, connected: Connected) -> Self {
        let mut parts = Self::default();
        let side = |i: usize| (object[i] == inside).then_some(inside);
        parts.find(w, h, connected, side, &mut VecDeque::new());
        parts
    }

    /// Finds the parts. `side` tells whether a pixel belongs to the object; pixels for which it is `None` are of no part.
    /// `open` is a buffer: taken first in, first out, it stays short.
    pub fn find(
        &mut self,
        w: usize,
        h: usize,
        connected: Connected,
        side: impl Fn(usize) -> Option<bool>,
        open: &mut VecDeque<u32>,
    ) {
        let Self { of, list } = self;
        refill(of, w * h, Self::NONE);
        list.clear();
        let neighbours = if connected == Connected::Sides { 4 } else { 8 };
        for start in 0..w * h {
            let Some(inside) = side(start).filter(|_| of[start] == Self::NONE) else { continue };
            let number = list.len() as u32;
            let mut part = Part { inside, pixels: 0, at_edge: false };
            of[start] = number;
            open.push_back(start as u32);
            while let Some(i) = open.pop_front() {
                let i = i as usize;
                part.pixels += 1;
                let (x, y) = (i % w, i / w);
                let (left, right, above, below) = (x > 0, x + 1 < w, y > 0, y + 1 < h);
                part.at_edge |= !(left && right && above && below);
                let near = [
                    (left, i.wrapping_sub(1)),
                    (right, i + 1),
                    (above, i.wrapping_sub(w)),
                    (below, i + w),
                    (above && left, i.wrapping_sub(w + 1)),
                    (above && right, i.wrapping_sub(w).wrapping_add(1)),
                    (below && left, (i + w).wrapping_sub(1)),
                    (below && right, i + w + 1),
                ];
                for &(within, j) in &near[..neighbours] {
                    if within && of[j] == Self::NONE && side(j) == Some(inside) {
                        of[j] = number;
                        open.push_back(j as u32);
                    }
                }
            }
            list.push(part);
        }
    }

    /// A pixel's part.
    pub fn of(&self, i: usize) -> Option<usize> {
        (self.of[i] != Self::NONE).then_some(self.of[i] as usize)
    }

    /// Number of pixels of a pixel's part.
    pub fn size(&self, i: usize) -> Option<u32> {
        self.of(i).map(|part| self.list[part].pixels)
    }
}

/// Removes the parts of an object with fewer pixels than a share of those of the largest one.
pub(super) fn keep_large(w: usize, h: usize, object: &mut [bool], share: f32) {
    let parts = Parts::of_side(w, h, object, true, Connected::Sides);
    let largest = parts.list.iter().map(|part| part.pixels).max().unwrap_or(0);
    for (i, object) in object.iter_mut().enumerate() {
        *object = parts.size(i).is_some_and(|pixels| pixels as f32 >= share * largest as f32);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_connected_by_sides_or_by_corners() {
        let rows = ["#..##", "##...", "..#..", "...#."];
        let object: Vec<bool> = rows.iter().flat_map(|row| row.bytes().map(|b| b == b'#')).collect();
        let found = |inside: bool, connected: Connected| -> Vec<(u32, bool)> {
            let parts = Parts::of_side(5, 4, &object, inside, connected);
            parts.list.iter().map(|part| (part.pixels, part.at_edge)).collect()
        };
        assert_eq!(found(true, Connected::Sides), [(3, true), (2, true), (1, false), (1, true)]);
        assert_eq!(found(true, Connected::Corners), [(5, true), (2, true)]);
        assert_eq!(found(false, Connected::Sides), [(8, true), (5, true)]);
        assert_eq!(found(false, Connected::Corners), [(13, true)]);
        let parts = Parts::of_side(5, 4, &object, true, Connected::Sides);
        assert_eq!([0, 6, 3, 1].map(|i| parts.of(i)), [Some(0), Some(0), Some(1), None]);
        let mut large = object.clone();
        keep_large(5, 4, &mut large, 0.5);
        assert_eq!(large.iter().filter(|&&o| o).count(), 5);
    }
}

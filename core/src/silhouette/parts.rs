//! Connected parts of the object, and of what surrounds it.

use super::refill::refill;
use alloc::vec::Vec;
use core::ops::Range;

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

/// A label of pixels.
#[derive(Debug, Clone, Copy)]
struct Label {
    /// A smaller label of the same part, or itself. At last the number of the part.
    same: u32,
    /// Whether its pixels belong to the object.
    inside: bool,
}

/// Connected parts, in the order of their first pixels.
#[derive(Debug, Default)]
pub(crate) struct Parts {
    /// Each pixel's part.
    of: Vec<u32>,
    /// The parts.
    pub list: Vec<Part>,
    /// The labels of pixels while parts are found.
    labels: Vec<Label>,
}

impl Parts {
    const NONE: u32 = u32::MAX;

    /// The parts of one side alone.
    pub fn of_side(w: usize, h: usize, object: &[bool], inside: bool, connected: Connected) -> Self {
        let mut parts = Self::default();
        let side = |i: usize| (object[i] == inside).then_some(inside);
        parts.find(w, h, connected, side);
        parts
    }

    /// Finds the parts. `side` tells whether a pixel belongs to the object; pixels for which it is `None` are of no part.
    ///
    /// Row by row, neighbouring pixels of the same side get the label of such pixels above them, or a new one. Labels that turn
    /// out to be of the same part are joined, and a second pass replaces them by the numbers of the parts (Rosenfeld & Pfaltz,
    /// Sequential Operations in Digital Picture Processing, 1966).
    pub fn find(&mut self, w: usize, h: usize, connected: Connected, side: impl Fn(usize) -> Option<bool>) {
        refill(&mut self.of, w * h, Self::NONE);
        self.labels.clear();
        for y in 0..h {
            let mut x = 0;
            while x < w {
                let (start, first) = (x, side(y * w + x));
                while x < w && side(y * w + x) == first {
                    x += 1;
                }
                if let Some(inside) = first {
                    self.label(w, y, start..x, inside, connected);
                }
            }
        }
        self.number(w, h);
    }

    /// Labels pixels of the same side in the columns of a row, the rows above which have labels.
    fn label(&mut self, w: usize, y: usize, columns: Range<usize>, inside: bool, connected: Connected) {
        let Self { of, labels, .. } = self;
        let reach = usize::from(connected == Connected::Corners);
        let near = columns.start.saturating_sub(reach)..(columns.end + reach).min(w);
        let (above, row) = of[y.saturating_sub(1) * w..(y + 1) * w].split_at_mut(if y > 0 { w } else { 0 });
        let (mut label, mut last) = (Self::NONE, Self::NONE);
        for &other in above.get(near).unwrap_or_default() {
            if other != last {
                last = other;
                if other != Self::NONE && labels[other as usize].inside == inside {
                    label = joined(labels, label, other);
                }
            }
        }
        if label == Self::NONE {
            label = labels.len() as u32;
            labels.push(Label { same: label, inside });
        }
        row[columns].fill(label);
    }

    /// Replaces the labels by the numbers of their parts, which it lists.
    fn number(&mut self, w: usize, h: usize) {
        let Self { of, list, labels } = self;
        list.clear();
        // A part's smallest label is that of its first pixel.
        for label in 0..labels.len() {
            let Label { same, inside } = labels[label];
            labels[label].same = if same as usize == label {
                list.push(Part { inside, pixels: 0, at_edge: false });
                list.len() as u32 - 1
            } else {
                labels[same as usize].same
            };
        }
        for y in 0..h {
            let mut start = 0;
            for pixels in of[y * w..][..w].chunk_by_mut(|a, b| a == b) {
                let end = start + pixels.len();
                if pixels[0] != Self::NONE {
                    let number = labels[pixels[0] as usize].same;
                    let part = &mut list[number as usize];
                    part.pixels += pixels.len() as u32;
                    part.at_edge |= y == 0 || y + 1 == h || start == 0 || end == w;
                    pixels.fill(number);
                }
                start = end;
            }
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

/// Joins the parts of two labels, of which the first may be [`Parts::NONE`]. Returns the smallest label of both.
fn joined(labels: &mut [Label], a: u32, b: u32) -> u32 {
    let smallest = |mut label: u32| {
        while labels[label as usize].same != label {
            label = labels[label as usize].same;
        }
        label
    };
    let b = smallest(b);
    let a = if a == Parts::NONE { b } else { smallest(a) };
    labels[a.max(b) as usize].same = a.min(b);
    a.min(b)
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
    use alloc::vec;
    use proptest::prelude::*;

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

    /// Sides of the contour, number of pixels, and whether the edge is reached, of one part after the other.
    type List = Vec<(bool, u32, bool)>;

    /// Each pixel's part and the parts, by filling one part after the other.
    fn filled(w: usize, h: usize, sides: &[Option<bool>], connected: Connected) -> (Vec<Option<usize>>, List) {
        let (mut of, mut list) = (vec![None; w * h], Vec::new());
        for start in 0..w * h {
            let Some(inside) = sides[start].filter(|_| of[start].is_none()) else { continue };
            let (number, mut pixels, mut at_edge) = (list.len(), 0, false);
            of[start] = Some(number);
            let mut open = vec![start];
            while let Some(i) = open.pop() {
                pixels += 1;
                let (x, y) = ((i % w) as i32, (i / w) as i32);
                for (dx, dy) in (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dx, dy))) {
                    let (x, y) = (x + dx, y + dy);
                    if x < 0 || y < 0 || x == w as i32 || y == h as i32 {
                        at_edge = true;
                        continue;
                    }
                    let j = y as usize * w + x as usize;
                    let is_beside = connected == Connected::Corners || dx == 0 || dy == 0;
                    if is_beside && of[j].is_none() && sides[j] == Some(inside) {
                        of[j] = Some(number);
                        open.push(j);
                    }
                }
            }
            list.push((inside, pixels, at_edge));
        }
        (of, list)
    }

    proptest! {
        #[test]
        fn labels_give_the_parts_that_filling_gives(
            w in 1_usize..14,
            sides in proptest::collection::vec(0_u8..7, 1..160),
            corners: bool,
        ) {
            let h = sides.len().div_ceil(w);
            let side = |i: usize| sides.get(i).filter(|&&side| side > 0).map(|&side| side > 3);
            let all: Vec<Option<bool>> = (0..w * h).map(side).collect();
            let connected = if corners { Connected::Corners } else { Connected::Sides };
            let mut parts = Parts::default();
            parts.find(w, h, connected, side);
            let found: Vec<_> = parts.list.iter().map(|part| (part.inside, part.pixels, part.at_edge)).collect();
            let (of, expected) = filled(w, h, &all, connected);
            prop_assert_eq!(found, expected);
            prop_assert_eq!((0..w * h).map(|i| parts.of(i)).collect::<Vec<_>>(), of);
        }
    }
}

//! The pixels of a part that one camera's silhouette lacks and those of the frames before and after it have.

use crate::{
    colour_counts::{ColourCounts, bin},
    silhouette::Silhouette,
};
use alloc::{vec, vec::Vec};

/// A pixel of a neighbouring frame shows the part if it is this far inside that frame's silhouette and this far outside the
/// frame's own, in pixels.
const INSIDE: f32 = 2.0;
const OUTSIDE: f32 = -4.0;
/// Pixels this far outside all three silhouettes are counted as background.
const BACKGROUND: f32 = -12.0;
/// A neighbouring frame shows the background at a pixel if that is this far outside its silhouette.
const SHOWS_BACKGROUND: f32 = -3.0;
/// Share of the pixels that is added to every colour.
const PRIOR: f32 = 0.002;

/// How clearly a pixel must be one of the part: how many times more frequent its colour is there than in the background, and by
/// how many levels one of its channels differs from the background at the same pixel.
struct Evidence {
    colour: f32,
    change: u8,
}

/// Of the pixels that a part begins with, and of those that join them.
const CERTAIN: Evidence = Evidence { colour: 8.0, change: 30 };
const LIKELY: Evidence = Evidence { colour: 2.0, change: 20 };

/// A part has at least this many certain pixels, and at least this share of the pixels that the neighbours show more. One pixel
/// is at least as far outside the silhouette as [`OUTSIDE`].
const MIN_PIXELS: usize = 64;
const MIN_SHARE: f32 = 0.1;

/// A camera's picture in one frame, packed sRGB, and its silhouette.
#[derive(Clone, Copy)]
pub(crate) struct Shown<'a> {
    pub rgb: &'a [u8],
    pub silhouette: &'a Silhouette,
}

/// Marks the pixels of parts that a camera's silhouette lacks, although its picture shows them and the same camera's
/// silhouettes in two neighbouring frames have them. All pictures have the same size. `None` if it lacks nothing.
pub(crate) fn lost_pixels(own: Shown, neighbours: [Shown; 2]) -> Option<Vec<bool>> {
    let distances = own.silhouette.distances();
    let units = |pixels: f32| (pixels * Silhouette::UNITS) as i16;
    let [inside, outside, background, shows_background] = [INSIDE, OUTSIDE, BACKGROUND, SHOWS_BACKGROUND].map(units);
    let of_neighbours = neighbours.map(|neighbour| neighbour.silhouette.distances());
    let is_known = |d: i16| d != Silhouette::UNKNOWN;

    let (mut part, mut around) = (ColourCounts::new(), ColourCounts::new());
    let mut areas = [0usize; 2];
    for (i, &d) in distances.iter().enumerate() {
        for ((neighbour, d_there), area) in neighbours.iter().zip(of_neighbours).zip(&mut areas) {
            if d < outside && is_known(d_there[i]) && d_there[i] > inside {
                part.add(&neighbour.rgb[3 * i..]);
                *area += 1;
            }
        }
        if d < background && of_neighbours.iter().all(|there| there[i] < background) {
            around.add(&own.rgb[3 * i..]);
        }
    }
    let least = areas[0].min(areas[1]);
    if least < MIN_PIXELS || around.total() == 0 {
        return None;
    }
    let ratios = part.against(&around, PRIOR);
    let shows = |i: usize, evidence: &Evidence| {
        let pixel = &own.rgb[3 * i..][..3];
        let differs = |(neighbour, there): (&Shown, &[i16])| {
            let change = || pixel.iter().zip(&neighbour.rgb[3 * i..][..3]).map(|(a, b)| a.abs_diff(*b)).max();
            there[i] >= shows_background || change() > Some(evidence.change)
        };
        distances[i] <= 0 && ratios[bin(pixel)] >= evidence.colour && neighbours.iter().zip(of_neighbours).all(differs)
    };

    let width = own.silhouette.width as usize;
    let height = distances.len() / width;
    let mut visited = vec![false; distances.len()];
    let mut lost: Option<Vec<bool>> = None;
    let mut joined: Vec<u32> = Vec::new();
    for start in 0..distances.len() {
        if visited[start] || distances[start] > outside || !shows(start, &CERTAIN) {
            continue;
        }
        visited[start] = true;
        joined.clear();
        joined.push(start as u32);
        let (mut next, mut certain) = (0, 0);
        while next < joined.len() {
            let i = joined[next] as usize;
            next += 1;
            certain += usize::from(shows(i, &CERTAIN));
            let (x, y) = (i % width, i / width);
            let near = [
                (x > 0, i.wrapping_sub(1)),
                (x + 1 < width, i + 1),
                (y > 0, i.wrapping_sub(width)),
                (y + 1 < height, i + width),
            ];
            for (is_there, j) in near {
                if is_there && !visited[j] && shows(j, &LIKELY) {
                    visited[j] = true;
                    joined.push(j as u32);
                }
            }
        }
        if certain >= MIN_PIXELS && certain as f32 >= MIN_SHARE * least as f32 {
            let lost = lost.get_or_insert_with(|| vec![false; distances.len()]);
            joined.iter().for_each(|&i| lost[i as usize] = true);
        }
    }
    lost
}

#[cfg(test)]
mod tests {
    use super::*;

    const W: u32 = 96;
    const H: u32 = 72;
    type Rectangle = [u32; 4];
    const BODY: Rectangle = [30, 10, 50, 60];

    fn arm(y: u32) -> Rectangle {
        [50, y, 85, y + 8]
    }

    fn contains([left, top, right, bottom]: Rectangle, x: u32, y: u32) -> bool {
        (left..right).contains(&x) && (top..bottom).contains(&y)
    }

    /// A person before a patterned wall. The colours of body and arm are those of no part of the wall.
    fn picture(arm: Option<Rectangle>, arm_colour: [u8; 3]) -> Vec<u8> {
        let colour = |i: u32| {
            let (x, y) = (i % W, i / W);
            if contains(BODY, x, y) {
                [40, 60, 160]
            } else if arm.is_some_and(|arm| contains(arm, x, y)) {
                arm_colour
            } else {
                [90 + (x % 5) as u8 * 10, 100 + (y % 7) as u8 * 8, 90]
            }
        };
        (0..W * H).flat_map(colour).collect()
    }

    fn silhouette(arm: Option<Rectangle>) -> Silhouette {
        let inside = |i: u32| contains(BODY, i % W, i / W) || arm.is_some_and(|arm| contains(arm, i % W, i / W));
        let coverage: Vec<u8> = (0..W * H).map(|i| if inside(i) { 255 } else { 0 }).collect();
        Silhouette::from_coverage(W, H, &coverage, |_| true).unwrap()
    }

    const SKIN: [u8; 3] = [220, 170, 140];

    /// The pixels that are found of a frame whose picture and mask have an arm at these places, between two complete frames.
    fn found(
        picture_has: Option<(Rectangle, [u8; 3])>,
        mask_has: Option<Rectangle>,
        beside: [Option<Rectangle>; 2],
    ) -> Option<Vec<bool>> {
        let (of, colour) = picture_has.unzip();
        let (own, mask) = (picture(of, colour.unwrap_or(SKIN)), silhouette(mask_has));
        let pictures = beside.map(|arm| picture(arm, SKIN));
        let masks = beside.map(silhouette);
        let neighbour = |k: usize| Shown { rgb: &pictures[k], silhouette: &masks[k] };
        lost_pixels(Shown { rgb: &own, silhouette: &mask }, [neighbour(0), neighbour(1)])
    }

    #[test]
    fn an_arm_that_only_the_mask_lacks_is_found_where_the_picture_has_it() {
        // It rests, moves by less than its width, and by more.
        for (before, own, after) in [(20, 20, 20), (18, 23, 28), (15, 30, 45)] {
            let lost = found(Some((arm(own), SKIN)), None, [Some(arm(before)), Some(arm(after))]);
            let lost = lost.unwrap_or_else(|| panic!("nothing is found at {before}, {own}, {after}"));
            let expected = |i: usize| contains(arm(own), i as u32 % W, i as u32 / W);
            assert!((0..lost.len()).all(|i| !lost[i] || expected(i)), "a pixel beside the arm");
            let count = lost.iter().filter(|&&is_lost| is_lost).count();
            assert!(count as u32 >= 35 * 8 * 9 / 10, "{count} of {} pixels", 35 * 8);
        }
    }

    #[test]
    fn nothing_is_found_that_the_picture_does_not_show() {
        let beside = [Some(arm(20)), Some(arm(30))];
        assert!(found(None, None, beside).is_none(), "the arm is bent away");
        assert!(
            found(Some((arm(25), [60, 64, 50])), None, beside).is_none(),
            "something of other colours, as a shadow"
        );
        assert!(found(Some((arm(25), SKIN)), Some(arm(25)), beside).is_none(), "the mask lacks nothing");
        assert!(found(Some((arm(25), SKIN)), None, [beside[0], None]).is_none(), "only one neighbour has an arm");
        assert!(found(Some(([60, 62, 66, 66], SKIN)), None, beside).is_none(), "something that is too small");
    }
}

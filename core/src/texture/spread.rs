//! Spreads the colours of charts over the rest of a texture, so that interpolation at their borders, mipmaps and JPEG
//! find no foreign colour there. Integer arithmetic only.

use alloc::{vec, vec::Vec};

/// Rings of texels around charts that get the mean of their neighbours. Further away the mean of larger surroundings is
/// enough.
const RINGS: usize = 4;

/// Fills the texels without a colour. The picture is square, with `size` texels along a side. Without any colour it
/// becomes black.
pub(super) fn spread(texels: &[Option<[u8; 3]>], size: u32) -> Vec<u8> {
    let mut finest = Level { size: size as usize, texels: texels.iter().map(|c| c.map_or(NONE, known)).collect() };
    for _ in 0..RINGS {
        finest.grow();
    }
    finest.fill();
    finest.texels.iter().flat_map(|&[r, g, b, _]| [r as u8, g as u8, b as u8]).collect()
}

/// Red, green and blue, and the number of texels that they are the sum of: at most nine.
type Sum = [u16; 4];

const NONE: Sum = [0; 4];

fn known([r, g, b]: [u8; 3]) -> Sum {
    [r.into(), g.into(), b.into(), 1]
}

fn is_known(sum: Sum) -> bool {
    sum[3] != 0
}

/// The rounded mean of some texels that are known, as a known texel, or [`NONE`].
fn mean(texels: impl Iterator<Item = Sum>) -> Sum {
    let [r, g, b, n] = texels.fold(NONE, |a, b| core::array::from_fn(|k| a[k] + b[k]));
    let rounded = |sum: u16| (sum + n / 2).checked_div(n);
    match [r, g, b].map(rounded) {
        [Some(r), Some(g), Some(b)] => [r, g, b, 1],
        _ => NONE,
    }
}

/// A square picture of which some texels are known.
struct Level {
    size: usize,
    texels: Vec<Sum>,
}

impl Level {
    fn at(&self, x: usize, y: usize) -> Sum {
        if x < self.size && y < self.size { self.texels[y * self.size + x] } else { NONE }
    }

    /// Gives unknown texels next to known ones the mean of those.
    fn grow(&mut self) {
        let mut grown = Vec::new();
        for y in 0..self.size {
            for x in 0..self.size {
                if is_known(self.at(x, y)) {
                    continue;
                }
                let rows = y.saturating_sub(1)..=y + 1;
                let around = rows.flat_map(|y| (x.saturating_sub(1)..=x + 1).map(move |x| (x, y)));
                let found = mean(around.map(|(x, y)| self.at(x, y)));
                if is_known(found) {
                    grown.push((y * self.size + x, found));
                }
            }
        }
        for (i, found) in grown {
            self.texels[i] = found;
        }
    }

    /// Gives unknown texels the colour of the picture at half the size, which is filled first in the same way.
    fn fill(&mut self) {
        if self.size == 1 || self.texels.iter().all(|&texel| is_known(texel)) {
            return;
        }
        let half = self.size.div_ceil(2);
        let mut coarser = Level { size: half, texels: vec![NONE; half * half] };
        for y in 0..half {
            for x in 0..half {
                let block = [(0, 0), (1, 0), (0, 1), (1, 1)].into_iter().map(|(i, j)| self.at(2 * x + i, 2 * y + j));
                coarser.texels[y * half + x] = mean(block);
            }
        }
        coarser.fill();
        for (i, texel) in self.texels.iter_mut().enumerate() {
            if !is_known(*texel) {
                *texel = coarser.at(i % self.size / 2, i / self.size / 2);
            }
        }
    }
}

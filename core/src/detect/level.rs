//! A view at one level of the image pyramid, as the plane sweep (§4.1) reads it.

use crate::{
    camera::Pinhole,
    silhouette::{Silhouette, stored},
    view::View,
};
use alloc::{borrow::Cow, vec, vec::Vec};

/// Luma and silhouette of a view at one resolution: borrowed from the view at full resolution, and computed otherwise.
#[derive(Debug, Clone)]
pub struct PyramidLevel<'a> {
    /// The camera at this resolution.
    pub camera: Pinhole,
    /// Luma, row after row.
    pub luma: Cow<'a, [u8]>,
    /// Signed distance to the contour in this level's pixels, positive inside, in the form of [`Silhouette::distances`].
    /// Without a silhouette all pixels are inside.
    pub inside: Cow<'a, [i16]>,
}

impl<'a> PyramidLevel<'a> {
    /// The view at its full resolution, borrowed.
    pub fn full(view: &'a View) -> Self {
        let inside = match view.shown() {
            Some(s) => Cow::Borrowed(s.distances()),
            None => Cow::Owned(vec![i16::MAX; view.luma.len()]),
        };
        Self { camera: view.camera, luma: Cow::Borrowed(&view.luma), inside }
    }

    /// The view at an octave, by `octave` times averaging 2 x 2 pixels. `None` if that is the view itself.
    pub fn made(view: &View, octave: u32) -> Option<PyramidLevel<'static>> {
        let full = PyramidLevel::full(view);
        if octave == 0 {
            let Cow::Owned(inside) = full.inside else { return None };
            return Some(PyramidLevel { camera: full.camera, luma: view.luma.clone().into(), inside: inside.into() });
        }
        Some((1..octave).fold(full.halved(), |level, _| level.halved()))
    }

    /// The view at an octave: the result of [`Self::made`], or the view itself if that was `None`.
    pub fn new(view: &'a View, made: Option<&'a PyramidLevel<'static>>) -> Self {
        made.map_or_else(|| Self::full(view), |made| made.borrowed())
    }

    /// The same, borrowed.
    pub fn borrowed(&self) -> PyramidLevel<'_> {
        let (luma, inside) = (Cow::Borrowed(&*self.luma), Cow::Borrowed(&*self.inside));
        PyramidLevel { camera: self.camera, luma, inside }
    }

    /// Overwrites `pairs` with the luma of each pixel in the lower byte and that of the pixel below it in the upper one, for all
    /// rows but the last. Two of them side by side are the four pixels around a position.
    pub(super) fn write_pairs(&self, pairs: &mut Vec<u16>) {
        let below = self.luma.get(self.camera.width as usize..).unwrap_or_default();
        pairs.clear();
        pairs.extend(self.luma.iter().zip(below).map(|(&upper, &lower)| u16::from(upper) | u16::from(lower) << 8));
    }

    /// The next level at half the resolution, by averaging 2 x 2 pixels.
    fn halved(&self) -> PyramidLevel<'static> {
        let camera = self.camera.halved();
        let (w, h, full) = (camera.width as usize, camera.height as usize, self.camera.width as usize);
        let (mut luma, mut inside) = (Vec::with_capacity(w * h), Vec::with_capacity(w * h));
        for y in 0..h {
            for x in 0..w {
                let i = 2 * y * full + 2 * x;
                let square = [i, i + 1, i + full, i + full + 1];
                let sum: u32 = square.iter().map(|&k| u32::from(self.luma[k])).sum();
                luma.push(((sum + 2) / 4) as u8);
                let sum: i32 = square.iter().map(|&k| Silhouette::units(self.inside[k])).sum();
                // The mean of four distances, in units of pixels that are twice as large.
                inside.push(stored::stored_whole(sum / 8));
            }
        }
        PyramidLevel { camera, luma: luma.into(), inside: inside.into() }
    }
}

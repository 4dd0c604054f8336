//! A view at one resolution of the image pyramid: what the sweep reads.

use crate::{camera::Pinhole, view::View};
use alloc::{borrow::Cow, vec, vec::Vec};

/// Luma and silhouette of a view: its own at full resolution, made at half of it.
#[derive(Debug, Clone)]
pub struct Level<'a> {
    /// The camera at this resolution.
    pub camera: Pinhole,
    /// Luma, row after row.
    pub luma: Cow<'a, [u8]>,
    /// Signed distance to the contour in 1/64 of this level's pixels; positive inside. All inside without a mask.
    pub inside: Cow<'a, [i16]>,
}

impl<'a> Level<'a> {
    /// The view at the resolution that a pass asks for.
    pub fn new(view: &'a View, halved: bool) -> Self {
        let inside = match &view.silhouette {
            Some(s) => Cow::Borrowed(s.distances()),
            None => Cow::Owned(vec![i16::MAX; view.luma.len()]),
        };
        let full = Self { camera: view.camera, luma: Cow::Borrowed(&view.luma), inside };
        if halved { full.halved() } else { full }
    }

    /// Half the resolution, means of 2 x 2 pixels.
    fn halved(&self) -> Self {
        let camera = self.camera.halved();
        let (w, h, full) = (camera.width as usize, camera.height as usize, self.camera.width as usize);
        let (mut luma, mut inside) = (Vec::with_capacity(w * h), Vec::with_capacity(w * h));
        for y in 0..h {
            for x in 0..w {
                let i = 2 * y * full + 2 * x;
                let square = [i, i + 1, i + full, i + full + 1];
                let sum: u32 = square.iter().map(|&k| u32::from(self.luma[k])).sum();
                luma.push(((sum + 2) / 4) as u8);
                let sum: i32 = square.iter().map(|&k| i32::from(self.inside[k])).sum();
                // A mean of four distances, in pixels twice as large.
                inside.push((sum / 8) as i16);
            }
        }
        Self { camera, luma: luma.into(), inside: inside.into() }
    }
}

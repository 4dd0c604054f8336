//! The contour of a silhouette, point by point.

use super::Silhouette;
use glam::Vec2;

/// Cells in a row that are looked at together: most of them have no contour.
const CELLS: usize = 16;

impl Silhouette {
    /// Calls `f` with a point on the contour and the outward unit normal in the image, once per pixel cell that the contour
    /// passes.
    pub(crate) fn contour(&self, mut f: impl FnMut(Vec2, Vec2)) {
        let (w, h) = (self.width as usize, self.height as usize);
        let d = self.distances();
        for y in 0..h - 1 {
            let (upper, lower) = (&d[y * w..][..w], &d[(y + 1) * w..][..w]);
            let with_contour = (0..w - 1).step_by(CELLS).map(|first| first..(first + CELLS).min(w - 1));
            let with_contour = with_contour.filter(|cells| {
                let inside = |row: &[i16]| row[cells.start..=cells.end].iter().map(|&v| u16::from(v > 0)).sum::<u16>();
                let count = usize::from(inside(upper) + inside(lower));
                count > 0 && count < 2 * (cells.len() + 1)
            });
            for x in with_contour.flatten() {
                let corners = [upper[x], upper[x + 1], lower[x], lower[x + 1]];
                let inside = corners.iter().filter(|&&v| v > 0).count();
                if inside == 0 || inside == 4 || corners.contains(&Self::UNKNOWN) {
                    continue;
                }
                let [a, b, c, e] = corners.map(f32::from);
                // The plane fitted to the four corners: its value at the cell's centre and its gradient.
                let middle = 0.25 * (a + b + c + e);
                let gradient = Vec2::new(0.5 * (b + e - a - c), 0.5 * (c + e - a - b));
                let length = gradient.length_squared();
                if length > 0.0 {
                    let offset = gradient * (-middle / length);
                    if offset.x.abs() <= 0.5 && offset.y.abs() <= 0.5 {
                        let pixel = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) + offset;
                        f(pixel, -gradient.normalize_or_zero());
                    }
                }
            }
        }
    }
}

//! Chroma keying (§0): silhouettes in front of a backdrop of one colour. The backdrop may be unevenly lit, and its
//! exact colour need not be known.

use super::{colour::vector, matte};
use crate::image::ImageRef;
use alloc::{format, string::String, vec, vec::Vec};
use glam::Vec3;

/// Edge length in pixels of the tiles in which the backdrop's colour is estimated.
const TILE: usize = 32;
/// Number of backdrop pixels from which a tile relies on its own estimate alone.
const TILE_PIXELS: f32 = 64.0;
/// Number of iterations that spread the colour to tiles with too little backdrop.
const SPREAD: usize = 64;

/// How to separate the object from a backdrop of one colour.
///
/// Light and shadow change the length of a colour vector in RGB but hardly its direction. Colours are therefore
/// compared by the angle between their vectors. The backdrop's colour is estimated in every part of the picture; `rgb`
/// is only the initial value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChromaKey {
    /// Approximate colour of the backdrop, sRGB.
    pub rgb: [u8; 3],
    /// A pixel is backdrop if the angle between its colour and the local backdrop's is less than this fraction of the
    /// angle between the backdrop's colour and grey. In 0..1.
    pub tolerance: f32,
    /// Shadows on the backdrop are recognised down to this fraction of its local brightness. Darker pixels belong to
    /// the object, because black cloth has no reliable colour.
    pub darkest_shadow: f32,
    /// Parts of the object that cover less than this fraction of the picture are removed as specks.
    pub smallest_part: f32,
    /// Holes in the object that cover less than this fraction of the picture are filled.
    pub smallest_hole: f32,
}

impl Default for ChromaKey {
    fn default() -> Self {
        Self { rgb: [40, 165, 75], tolerance: 0.5, darkest_shadow: 0.2, smallest_part: 3e-4, smallest_hole: 5e-5 }
    }
}

/// Coverage of the object in a real (distorted) picture, given as packed RGB. A pixel of 255 lies fully on the object.
pub(crate) fn coverage(picture: &ImageRef, rgb: &[u8], key: &ChromaKey) -> Result<Vec<u8>, String> {
    let (w, h) = (picture.width as usize, picture.height as usize);
    let hint = vector(key.rgb.as_slice());
    let gray = Vec3::ONE;
    let saturation = angle(hint, gray);
    if saturation < 0.1 {
        return Err(format!(
            "the chroma key {:?} is nearly gray, so that no object can be separated from it: \
             give masks or a clean plate",
            key.rgb
        ));
    }
    // The mean colour of the pixels that are closer to the hint than to grey is a better estimate than the hint.
    let global = mean(rgb, hint, saturation * 0.6)
        .ok_or_else(|| format!("no pixel is close to the backdrop's colour {:?}: check the chroma key", key.rgb))?;
    let limit = angle(global, gray) * key.tolerance.clamp(0.05, 0.95);
    let backdrop = Backdrop::estimate(w, h, rgb, global, limit);
    let cosine = libm::cosf(limit);
    let mut object = vec![false; w * h];
    for y in 0..h {
        for x in 0..w {
            let i = y * w + x;
            let (colour, local) = (vector(&rgb[3 * i..]), backdrop.at(x, y));
            let (along, length) = (colour.dot(local), colour.length_squared());
            let brightness = local.length_squared();
            let dark = along < key.darkest_shadow * brightness;
            object[i] = dark || along * along < cosine * cosine * length * brightness;
        }
    }
    let pixels = |share: f32| (share * (w * h) as f32) as usize;
    matte::remove_small(w, h, &mut object, true, pixels(key.smallest_part));
    matte::remove_small(w, h, &mut object, false, pixels(key.smallest_hole));
    Ok(matte::soften(w, h, rgb, &object))
}

/// Angle between two colour vectors in radians.
fn angle(a: Vec3, b: Vec3) -> f32 {
    let lengths = libm::sqrtf(a.length_squared() * b.length_squared());
    if lengths > 0.0 { libm::acosf((a.dot(b) / lengths).clamp(-1.0, 1.0)) } else { 0.0 }
}

fn within(colour: Vec3, centre: Vec3, cosine: f32) -> bool {
    let along = colour.dot(centre);
    along > 0.0 && along * along >= cosine * cosine * colour.length_squared() * centre.length_squared()
}

/// Mean of the colours whose angle to a centre is less than `limit` radians.
fn mean(rgb: &[u8], centre: Vec3, limit: f32) -> Option<Vec3> {
    let cosine = libm::cosf(limit);
    let (mut sums, mut count) = ([0u64; 3], 0u64);
    for pixel in rgb.chunks_exact(3).filter(|p| within(vector(p), centre, cosine)) {
        (0..3).for_each(|c| sums[c] += u64::from(pixel[c]));
        count += 1;
    }
    (count > 0).then(|| Vec3::from_array(sums.map(|s| s as f32 / count as f32)))
}

/// The backdrop's colour over the picture: one estimate per tile, interpolated bilinearly between the tiles' centres.
struct Backdrop {
    columns: usize,
    rows: usize,
    tiles: Vec<Vec3>,
}

impl Backdrop {
    fn estimate(width: usize, height: usize, rgb: &[u8], global: Vec3, limit: f32) -> Self {
        let (columns, rows) = (width.div_ceil(TILE), height.div_ceil(TILE));
        let cosine = libm::cosf(limit);
        let mut sums = vec![(Vec3::ZERO, 0.0f32); columns * rows];
        for (i, pixel) in rgb.chunks_exact(3).enumerate() {
            let colour = vector(pixel);
            if within(colour, global, cosine) {
                let tile = &mut sums[i / width / TILE * columns + i % width / TILE];
                *tile = (tile.0 + colour, tile.1 + 1.0);
            }
        }
        // Tiles with few backdrop pixels take their colour partly or fully from the neighbouring tiles.
        let own = |&(sum, count): &(Vec3, f32)| if count > 0.0 { sum / count } else { global };
        let mut tiles: Vec<Vec3> = sums.iter().map(own).collect();
        for _ in 0..SPREAD {
            for y in 0..rows {
                for x in 0..columns {
                    let i = y * columns + x;
                    let trust = (sums[i].1 / TILE_PIXELS).min(1.0);
                    let around = [
                        tiles[i - usize::from(x > 0)],
                        tiles[i + usize::from(x + 1 < columns)],
                        tiles[i - columns * usize::from(y > 0)],
                        tiles[i + columns * usize::from(y + 1 < rows)],
                    ];
                    let neighbours = (around[0] + around[1] + around[2] + around[3]) * 0.25;
                    tiles[i] = own(&sums[i]) * trust + neighbours * (1.0 - trust);
                }
            }
        }
        Self { columns, rows, tiles }
    }

    fn at(&self, x: usize, y: usize) -> Vec3 {
        let place = |v: usize, n: usize| {
            let t = ((v as f32 + 0.5) / TILE as f32 - 0.5).clamp(0.0, (n - 1) as f32);
            let i = (t as usize).min(n.saturating_sub(2));
            (i, (i + 1).min(n - 1), t - i as f32)
        };
        let ((x0, x1, fx), (y0, y1, fy)) = (place(x, self.columns), place(y, self.rows));
        let row = |y: usize| self.tiles[y * self.columns + x0].lerp(self.tiles[y * self.columns + x1], fx);
        row(y0).lerp(row(y1), fy)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        image::PixelFormat,
        silhouette::{Silhouette, clean_plate, matte},
    };

    const W: u32 = 320;
    const H: u32 = 240;
    const RADIUS: f32 = 60.0;

    fn truth(x: f32, y: f32) -> f32 {
        RADIUS - libm::hypotf(x - 150.3, y - 118.6)
    }

    /// An unevenly lit backdrop with a shadow across it, in shades of `base`.
    fn empty(x: f32, y: f32, base: Vec3) -> Vec3 {
        let light = 0.55 + 0.35 * x / W as f32 + 0.1 * libm::sinf(y / 23.0);
        let shadow = 1.0 - 0.4 / (1.0 + libm::expf((libm::fabsf(x + y - 290.0) - 25.0) / 4.0));
        base * (light * shadow)
    }

    /// A disc of one colour in front of the backdrop, blended by exact coverage, with sensor noise.
    fn picture(object: Option<Vec3>, base: Vec3) -> Vec<u8> {
        let mut state = 1u32;
        let mut noise = move || {
            let mut sum = -1020.0;
            for _ in 0..8 {
                state = state.wrapping_mul(1664525).wrapping_add(1013904223);
                sum += (state >> 24) as f32;
            }
            sum / 70.0
        };
        let mut out = Vec::new();
        for i in 0..W * H {
            let (x, y) = ((i % W) as f32, (i / W) as f32);
            // The disc is so large that its edge is nearly straight within a pixel.
            let alpha = if object.is_some() { (truth(x, y) + 0.5).clamp(0.0, 1.0) } else { 0.0 };
            let colour = empty(x, y, base) * (1.0 - alpha) + object.unwrap_or(Vec3::ZERO) * alpha;
            out.extend(colour.to_array().map(|v| libm::roundf(v + noise()).clamp(0.0, 255.0) as u8));
        }
        out
    }

    fn contour_error(coverage: &[u8]) -> f32 {
        let silhouette = Silhouette::from_coverage(W, H, coverage, |_| true).unwrap();
        let mut worst = 0.0f32;
        for (i, &d) in silhouette.distances().iter().enumerate() {
            let t = truth((i as u32 % W) as f32, (i as u32 / W) as f32);
            let d = f32::from(d) / Silhouette::UNITS;
            assert!(t.abs() < 1.0 || (d > 0.0) == (t > 0.0), "pixel {i}: {d} instead of {t}");
            if t.abs() < 1.5 {
                worst = worst.max((d - t).abs());
            }
        }
        worst
    }

    const GREEN: Vec3 = Vec3::new(46.0, 190.0, 90.0);
    /// Skin, white, black, jeans.
    const OBJECTS: [Vec3; 4] = [
        Vec3::new(200.0, 150.0, 120.0),
        Vec3::new(240.0, 240.0, 235.0),
        Vec3::new(14.0, 13.0, 16.0),
        Vec3::new(70.0, 85.0, 130.0),
    ];

    #[test]
    fn chroma_key_finds_the_contour_over_an_unevenly_lit_backdrop() {
        for object in OBJECTS {
            let rgb = picture(Some(object), GREEN);
            let image = ImageRef::packed(&rgb, W, H, PixelFormat::Rgb8);
            // The hint differs from the true colour by more than the lighting does.
            let key = ChromaKey { rgb: [60, 160, 60], ..ChromaKey::default() };
            let error = contour_error(&coverage(&image, &rgb, &key).unwrap());
            assert!(error < 0.3, "{object}: {error}");
        }
    }

    #[test]
    fn clean_plate_finds_the_contour_before_any_background() {
        for base in [GREEN, Vec3::new(90.0, 80.0, 70.0), Vec3::new(200.0, 200.0, 210.0)] {
            for object in [Vec3::new(230.0, 40.0, 60.0), Vec3::new(20.0, 60.0, 200.0)] {
                let (rgb, plate) = (picture(Some(object), base), picture(None, base));
                let image = ImageRef::packed(&rgb, W, H, PixelFormat::Rgb8);
                let plate = ImageRef::packed(&plate, W, H, PixelFormat::Rgb8);
                let error = contour_error(&clean_plate::coverage(&image, &rgb, &plate).unwrap());
                assert!(error < 0.3, "{base} {object}: {error}");
            }
        }
    }

    #[test]
    fn unusable_keys_and_plates_are_errors() {
        let rgb = picture(None, GREEN);
        let image = ImageRef::packed(&rgb, W, H, PixelFormat::Rgb8);
        let gray = ChromaKey { rgb: [120, 122, 119], ..ChromaKey::default() };
        assert!(coverage(&image, &rgb, &gray).unwrap_err().contains("gray"));
        let blue = ChromaKey { rgb: [20, 30, 200], ..ChromaKey::default() };
        assert!(coverage(&image, &rgb, &blue).unwrap_err().contains("no pixel"));
        let small = ImageRef::packed(&rgb, W / 2, H, PixelFormat::Rgb8);
        assert!(clean_plate::coverage(&image, &rgb, &small).is_err());
    }

    #[test]
    fn specks_and_pinholes_go_and_larger_parts_stay() {
        const N: usize = 40;
        let mut object = vec![false; N * N];
        let mut paint = |xs: core::ops::Range<usize>, ys: core::ops::Range<usize>, label| {
            ys.for_each(|y| xs.clone().for_each(|x| object[y * N + x] = label));
        };
        paint(5..25, 5..25, true);
        paint(10..12, 10..12, false);
        paint(15..19, 15..19, false);
        paint(30..32, 30..32, true);
        matte::remove_small(N, N, &mut object, true, 5);
        matte::remove_small(N, N, &mut object, false, 5);
        assert!(!object[31 * N + 31], "speck of 4 pixels");
        assert!(object[11 * N + 11], "hole of 4 pixels");
        assert!(!object[16 * N + 16], "hole of 16 pixels");
        assert_eq!(object.iter().filter(|&&o| o).count(), 400 - 16);
    }
}

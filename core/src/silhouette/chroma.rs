//! Chroma keying (§0): silhouettes in front of a painted backdrop, which may be unevenly lit and of several colours. Its
//! exact colours need not be known. Besides it the stage may have a wall of other colours.

use super::{
    colour::{from_gray, vector},
    keying::{Likeness, Paint, is_border, object},
    matte,
};
use crate::image::ImageRef;
use alloc::{format, string::String, vec::Vec};
use core::iter;
use glam::Vec3;

/// Number of further colours of a backdrop.
pub const MORE_COLOURS: usize = 3;
/// Colours at a smaller angle to grey, in radians, cannot be keyed.
const LEAST_SATURATION: f32 = 0.1;
/// An object covers at most these shares of the picture and of its border.
const MOST: f32 = 0.7;
const MOST_BORDER: f32 = 0.6;

/// How to separate the object from a painted backdrop of one or several colours.
///
/// Light and shadow change the length of a colour vector in RGB but hardly its direction. Colours are therefore
/// compared by the angle between their vectors. The backdrop's colours are estimated in every part of the picture; `rgb`
/// and `more` are only the initial values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChromaKey {
    /// Approximate colour of the backdrop, sRGB.
    pub rgb: [u8; 3],
    /// Further colours of it, such as of another cloth or paint. Colours near grey, as of a dark wall, need not be given:
    /// where they span a side of the picture they are learned from it.
    pub more: [Option<[u8; 3]>; MORE_COLOURS],
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
        Self {
            rgb: [40, 165, 75],
            more: [None; MORE_COLOURS],
            tolerance: 0.5,
            darkest_shadow: 0.2,
            smallest_part: 3e-4,
            smallest_hole: 5e-5,
        }
    }
}

impl ChromaKey {
    /// The key of a backdrop with the given colours, sRGB. `None` if there are none, or more than a key holds.
    pub fn with_colours(colours: &[[u8; 3]]) -> Option<Self> {
        let (&rgb, rest) = colours.split_first()?;
        let mut more = [None; MORE_COLOURS];
        if rest.len() > more.len() {
            return None;
        }
        more.iter_mut().zip(rest).for_each(|(place, &colour)| *place = Some(colour));
        Some(Self { rgb, more, ..Self::default() })
    }
}

/// Coverage of the object in a real (distorted) picture, given as packed RGB. A pixel of 255 lies fully on the object.
pub(crate) fn coverage(picture: &ImageRef, rgb: &[u8], key: &ChromaKey) -> Result<Vec<u8>, String> {
    let (w, h) = (picture.width as usize, picture.height as usize);
    let colours: Vec<[u8; 3]> = iter::once(key.rgb).chain(key.more.into_iter().flatten()).collect();
    let hints = colours.iter().map(|colour| vector(colour));
    let hints: Vec<Vec3> = hints.filter(|&hint| from_gray(hint) >= LEAST_SATURATION).collect();
    if hints.is_empty() {
        return Err(format!(
            "the chroma key {colours:?} is nearly gray, so that no object can be separated from it: give masks or a clean \
             plate"
        ));
    }
    let tolerance = key.tolerance.clamp(0.05, 0.95);
    let find = |hint: Vec3| Paint::find(w, h, rgb, hint, tolerance, key.darkest_shadow);
    let paints: Vec<Paint> = hints.into_iter().filter_map(find).collect();
    if paints.is_empty() {
        return Err(format!("no pixel is close to the backdrop's colour {colours:?}: check the chroma key"));
    }
    // Of several paints, the most similar one counts.
    let likeness = |i: usize| paints.iter().map(|paint| paint.likeness(w, rgb, i)).min().unwrap_or(Likeness::Other);
    let likeness: Vec<Likeness> = (0..w * h).map(likeness).collect();
    let mut object = object(w, h, rgb, &likeness);
    let pixels = |share: f32| (share * (w * h) as f32) as usize;
    matte::remove_small(w, h, &mut object, true, pixels(key.smallest_part));
    matte::remove_small(w, h, &mut object, false, pixels(key.smallest_hole));
    plausible(w, h, &object)?;
    Ok(matte::soften(w, h, rgb, &object))
}

/// Refuses what can only be a wall: an object that covers most of the picture or of its border.
fn plausible(w: usize, h: usize, object: &[bool]) -> Result<(), String> {
    let whole = share(object, 0..w * h);
    let border = share(object, (0..w * h).filter(|&i| is_border(w, h, i)));
    if whole <= MOST && border <= MOST_BORDER {
        return Ok(());
    }
    Err(format!(
        "what the chroma key leaves covers {:.0} % of the picture and {:.0} % of its border, which is no object: list all \
         colours of the backdrop, or give masks or clean plates",
        100.0 * whole,
        100.0 * border
    ))
}

/// Share of the object among pixels.
fn share(object: &[bool], pixels: impl Iterator<Item = usize>) -> f32 {
    let (mut found, mut all) = (0u32, 0u32);
    pixels.for_each(|i| (found, all) = (found + u32::from(object[i]), all + 1));
    found as f32 / all.max(1) as f32
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        image::PixelFormat,
        silhouette::{Silhouette, clean_plate, matte},
    };
    use alloc::vec;

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

    /// A stage with a green floor below and a dark wall with bright spots above, and a figure before both: a bright body with
    /// greenish light on its lower half, and hair that differs from the wall by a few levels. Returns the picture and the
    /// figure.
    fn stage(shadow: bool) -> (Vec<u8>, Vec<bool>) {
        let mut state = 7u32;
        let mut noise = move || {
            state = state.wrapping_mul(1664525).wrapping_add(1013904223);
            (state >> 24) as f32 / 64.0 - 2.0
        };
        let (mut rgb, mut figure) = (Vec::new(), Vec::new());
        for i in 0..W * H {
            let (x, y) = ((i % W) as f32, (i / W) as f32);
            let body = libm::fabsf(x - 160.0) < 24.0 && (80.0..200.0).contains(&y);
            let hair = libm::hypotf(x - 160.0, y - 66.0) < 20.0 && !body;
            let dark = if shadow && libm::hypotf((x - 200.0) / 2.0, y - 195.0) < 22.0 { 0.5 } else { 1.0 };
            let light = 0.7 + 0.3 * x / W as f32;
            let spot = i % W % 23 < 2 && i / W % 19 < 2;
            let colour = if body {
                if y > 150.0 { Vec3::new(100.0, 112.0, 60.0) } else { Vec3::new(200.0, 180.0, 150.0) }
            } else if hair {
                Vec3::new(27.0, 21.0, 16.0)
            } else if y > 120.0 {
                Vec3::new(76.0, 147.0, 55.0) * (light * dark)
            } else if spot {
                Vec3::splat(170.0)
            } else {
                Vec3::splat(13.0) * light
            };
            rgb.extend(colour.to_array().map(|v| (v + noise()).clamp(0.0, 255.0) as u8));
            figure.push(body || hair);
        }
        (rgb, figure)
    }

    #[test]
    fn a_figure_before_a_painted_floor_and_a_dark_wall_is_found_with_its_hair_and_without_its_shadow() {
        for shadow in [false, true] {
            let (rgb, figure) = stage(shadow);
            let image = ImageRef::packed(&rgb, W, H, PixelFormat::Rgb8);
            let key = ChromaKey { rgb: [40, 120, 60], ..ChromaKey::default() };
            let found = coverage(&image, &rgb, &key).unwrap();
            let area = figure.iter().filter(|&&f| f).count() as f32;
            let both = (0..figure.len()).filter(|&i| figure[i] && found[i] > 127).count() as f32;
            let either = (0..figure.len()).filter(|&i| figure[i] || found[i] > 127).count() as f32;
            assert!(both > 0.98 * area, "shadow {shadow}: {both} of {area} pixels");
            assert!(both > 0.9 * either, "shadow {shadow}: {either} pixels instead of {area}");
        }
    }

    #[test]
    fn a_second_colour_of_the_backdrop_is_backdrop() {
        let blue = Vec3::new(40.0, 70.0, 190.0);
        let mut rgb = picture(Some(OBJECTS[0]), GREEN);
        let other = picture(Some(OBJECTS[0]), blue);
        let half = rgb.len() / 2;
        rgb[half..].copy_from_slice(&other[half..]);
        let image = ImageRef::packed(&rgb, W, H, PixelFormat::Rgb8);
        let key = ChromaKey::with_colours(&[[60, 160, 60], [40, 70, 180]]).unwrap();
        let error = contour_error(&coverage(&image, &rgb, &key).unwrap());
        assert!(error < 0.3, "{error}");
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
        let grays = ChromaKey::with_colours(&[[120, 122, 119], [30, 31, 30]]).unwrap();
        assert!(coverage(&image, &rgb, &grays).unwrap_err().contains("[[120, 122, 119], [30, 31, 30]]"));
        let blue = ChromaKey { rgb: [20, 30, 200], ..ChromaKey::default() };
        assert!(coverage(&image, &rgb, &blue).unwrap_err().contains("no pixel"));
        let small = ImageRef::packed(&rgb, W / 2, H, PixelFormat::Rgb8);
        assert!(clean_plate::coverage(&image, &rgb, &small).is_err());
        assert_eq!(ChromaKey::with_colours(&[]), None);
        assert!(ChromaKey::with_colours(&[[40, 165, 75]; 1 + MORE_COLOURS]).is_some());
        assert_eq!(ChromaKey::with_colours(&[[40, 165, 75]; 2 + MORE_COLOURS]), None);
    }

    #[test]
    fn what_covers_most_of_the_picture_is_no_object() {
        // The backdrop shows in the corners alone.
        let corner = |i: u32, n: u32| i < 40 || i + 40 >= n;
        let colour = |i: u32| if corner(i % W, W) && corner(i / W, H) { GREEN } else { OBJECTS[0] };
        let rgb: Vec<u8> = (0..W * H).flat_map(|i| colour(i).to_array().map(|v| v as u8)).collect();
        let image = ImageRef::packed(&rgb, W, H, PixelFormat::Rgb8);
        let error = coverage(&image, &rgb, &ChromaKey::default()).unwrap_err();
        assert!(error.contains("% of the picture") && error.contains("list all colours"), "{error}");
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

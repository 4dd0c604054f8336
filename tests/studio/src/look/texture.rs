//! The texture of a mesh, read as graphics cards read it: bilinear, between smaller and smaller copies.

use glam::{DVec2, DVec3};
use image::RgbImage;
use std::error::Error;

/// A square texture with copies of it that have half the size of the one before.
#[derive(Debug, Clone)]
pub struct Texture {
    levels: Vec<Level>,
}

#[derive(Debug, Clone)]
struct Level {
    size: usize,
    /// Linear light, by rows.
    texels: Vec<DVec3>,
}

impl Texture {
    /// The texture of a primitive whose material has one. `blob` is the binary chunk of its file.
    ///
    /// # Errors
    /// The texture is not in the file, or cannot be decoded.
    pub fn of(primitive: &gltf::Primitive<'_>, blob: &[u8]) -> Result<Option<Self>, Box<dyn Error>> {
        let Some(info) = primitive.material().pbr_metallic_roughness().base_color_texture() else { return Ok(None) };
        let gltf::image::Source::View { view, .. } = info.texture().source().source() else {
            return Err("the texture is not in the file".into());
        };
        let place = view.offset()..view.offset() + view.length();
        let bytes = blob.get(place).ok_or("the texture is outside of the file")?;
        Ok(Some(Self::new(&image::load_from_memory(bytes)?.into_rgb8())?))
    }

    /// Makes the copies of a square picture whose side is a power of two.
    ///
    /// # Errors
    /// The picture has another shape.
    pub fn new(picture: &RgbImage) -> Result<Self, String> {
        let (width, height) = picture.dimensions();
        if width != height || !width.is_power_of_two() {
            return Err(format!("the texture has {width} x {height} texels"));
        }
        let texels = picture.pixels().map(|p| DVec3::from(p.0.map(|code| linear(f64::from(code) / 255.0))));
        let mut levels = vec![Level { size: width as usize, texels: texels.collect() }];
        while let Some(last) = levels.last().filter(|level| level.size > 1) {
            levels.push(last.halved());
        }
        Ok(Self { levels })
    }

    /// Linear light at a place in 0..1 from the upper left corner on. `steps` are how far the place moves from one pixel to
    /// the next, to the right and down.
    pub fn sample(&self, uv: DVec2, steps: [DVec2; 2]) -> DVec3 {
        let size = self.levels[0].size as f64;
        let texels = steps.map(|step| step.length() * size).into_iter().fold(1.0, f64::max);
        let level = libm::log2(texels).min((self.levels.len() - 1) as f64);
        let at = |i: usize| self.levels[i.min(self.levels.len() - 1)].sample(uv);
        let floor = level as usize;
        at(floor).lerp(at(floor + 1), level - floor as f64)
    }
}

impl Level {
    fn halved(&self) -> Self {
        let size = self.size / 2;
        let mean = |i: usize| {
            let first = i / size * 2 * self.size + i % size * 2;
            [0, 1, self.size, self.size + 1].map(|step| self.texels[first + step]).iter().sum::<DVec3>() / 4.0
        };
        Self { size, texels: (0..size * size).map(mean).collect() }
    }

    fn sample(&self, uv: DVec2) -> DVec3 {
        let place = uv * self.size as f64 - 0.5;
        let corner = place.floor();
        let share = place - corner;
        let texel = |x: f64, y: f64| {
            let [x, y] = [x, y].map(|v| v.clamp(0.0, (self.size - 1) as f64) as usize);
            self.texels[y * self.size + x]
        };
        let row = |y: f64| texel(corner.x, y).lerp(texel(corner.x + 1.0, y), share.x);
        row(corner.y).lerp(row(corner.y + 1.0), share.y)
    }
}

/// IEC 61966-2-1: sRGB to linear light, both in 0..1.
fn linear(v: f64) -> f64 {
    if v <= 0.040_45 { v / 12.92 } else { libm::pow((v + 0.055) / 1.055, 2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::Rgb;

    #[test]
    fn texels_are_bilinear_and_far_textures_are_their_mean() {
        // Black and white columns.
        let picture = RgbImage::from_fn(4, 4, |x, _| Rgb([255 * (x % 2) as u8; 3]));
        let texture = Texture::new(&picture).unwrap();
        let near = [DVec2::new(0.01, 0.0), DVec2::new(0.0, 0.01)];
        let at = |x: f64, steps| texture.sample(DVec2::new(x, 0.5), steps).x;
        for (x, expected) in [(0.125, 0.0), (0.375, 1.0), (0.25, 0.5), (0.3125, 0.75), (0.0, 0.0), (1.0, 1.0)] {
            assert!((at(x, near) - expected).abs() < 1e-12, "{x}: {}", at(x, near));
        }
        let half = [DVec2::new(0.5, 0.0), DVec2::new(0.0, 0.1)];
        assert_eq!(at(0.375, half), 0.5);
        // Half-way between the first level and the second.
        let between = [DVec2::new(0.25 * std::f64::consts::SQRT_2, 0.0), DVec2::ZERO];
        assert!((at(0.375, between) - 0.75).abs() < 1e-12);
    }
}

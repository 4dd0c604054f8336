//! Sphere tracing: the picture of an ideal camera, and the share of each pixel that the subject covers.

use crate::{
    backdrop,
    solid::{OCCLUSION, Parts, Solid},
};
use glam::{DMat3, DVec2, DVec3};
use pcmvs_core::Camera;

/// Side of the square tiles whose pixels share the start of their rays and the choice of parts.
const TILE: u32 = 8;
/// Samples of a pixel on an edge, so many that along every direction they are less than 0.2 pixels apart.
const EDGE: u32 = 25;
/// Samples of a pixel's colour.
const INNER: u32 = 4;

/// A picture before the sensor reads it.
#[derive(Debug, Clone, PartialEq)]
pub struct Render {
    /// Display values in 0..1 of the subject over the backdrop, by rows.
    pub rgb: Vec<[f64; 3]>,
    /// Share of each pixel that the subject covers.
    pub coverage: Vec<f64>,
}

/// The rays of a camera in the world.
pub struct Lens<'a> {
    camera: &'a Camera,
    to_world: DMat3,
    centre: DVec3,
}

impl<'a> Lens<'a> {
    /// The rays of a camera, including lens distortion.
    pub fn new(camera: &'a Camera) -> Self {
        // The rows of R are the columns of its inverse.
        Self { camera, to_world: DMat3::from_cols_array_2d(&camera.r), centre: camera.centre() }
    }

    /// Origin of all rays.
    pub fn centre(&self) -> DVec3 {
        self.centre
    }

    /// Unit direction of the ray through a position in the distorted picture.
    pub fn ray(&self, x: f64, y: f64) -> DVec3 {
        let k = &self.camera.k;
        let v = (y - k[1][2]) / k[1][1];
        let u = (x - k[0][2] - k[0][1] * v) / k[0][0];
        (self.to_world * self.undistort(DVec2::new(u, v)).extend(1.0)).normalize()
    }

    /// Inverts the lens distortion by fixed-point iteration, which converges for every lens that does not fold the picture.
    fn undistort(&self, distorted: DVec2) -> DVec2 {
        let mut p = distorted;
        if self.camera.lens.is_distorted() {
            for _ in 0..40 {
                let miss = distorted - self.camera.lens.distort(p);
                p += miss;
                if miss.length_squared() < 1e-24 {
                    break;
                }
            }
        }
        p
    }
}

/// What the centre of a pixel sees.
#[derive(Clone, Copy)]
struct Centre {
    /// No surface is nearer than this on any ray of the pixel.
    from: f64,
    /// Distance of the surface, if the ray hits it.
    hit: Option<f64>,
    /// Whether the subject may cover a part of the pixel.
    near: bool,
}

struct Renderer<'a> {
    solid: &'a Solid,
    lens: Lens<'a>,
    width: u32,
    height: u32,
    far: f64,
    tiles: Vec<Option<Tile>>,
}

/// A square of pixels that the subject may cover.
#[derive(Clone, Copy)]
struct Tile {
    /// The parts that its rays can hit.
    parts: Parts,
    /// The parts that can occlude ambient light where its rays hit.
    around: Parts,
    /// No surface is nearer than this.
    from: f64,
    /// Largest distance, at unit length, of the rays of a pixel from its central one.
    pixel: f64,
}

/// Renders a solid as a camera sees it.
pub fn render(solid: &Solid, camera: &Camera) -> Render {
    let lens = Lens::new(camera);
    let (middle, radius) = solid.ball();
    let far = (middle - lens.centre).length() + radius;
    let mut renderer = Renderer { solid, lens, width: camera.width, height: camera.height, far, tiles: Vec::new() };
    for y in (0..camera.height).step_by(TILE as usize) {
        for x in (0..camera.width).step_by(TILE as usize) {
            let tile = renderer.tile(x, y);
            renderer.tiles.push(tile);
        }
    }
    let pixels = (0..camera.height).flat_map(|y| (0..camera.width).map(move |x| (x, y)));
    let centres: Vec<Centre> = pixels.clone().map(|(x, y)| renderer.centre(x, y)).collect();
    let mut out = Render { rgb: Vec::with_capacity(centres.len()), coverage: Vec::with_capacity(centres.len()) };
    for (x, y) in pixels {
        let (rgb, coverage) = renderer.pixel(x, y, &centres);
        out.rgb.push(rgb);
        out.coverage.push(coverage);
    }
    out
}

impl Renderer<'_> {
    /// The largest distance, at unit length, of a rectangle's rays from a ray inside it.
    fn spread(&self, direction: DVec3, (x0, y0): (f64, f64), (x1, y1): (f64, f64)) -> f64 {
        let corners = [(x0, y0), (x1, y0), (x0, y1), (x1, y1)];
        // Lens distortion can move the middle of an edge slightly beyond its corners.
        1.05 * corners.into_iter().map(|(x, y)| (self.lens.ray(x, y) - direction).length()).fold(0.0, f64::max)
    }

    /// Distance that all rays within `spread` of a ray can go without hitting the surface.
    fn clear(&self, direction: DVec3, spread: f64, from: f64, parts: Parts) -> f64 {
        let mut t = from;
        while t < self.far {
            let d = self.solid.bound(self.lens.centre + direction * t, parts);
            let step = d - t * spread;
            if step < 0.5 * t * spread {
                break;
            }
            t += step;
        }
        t
    }

    /// The parts that the rays of a tile can hit and the distance at which these rays can start; `None` if they hit nothing.
    fn tile(&self, x: u32, y: u32) -> Option<Tile> {
        let (x0, y0) = (f64::from(x) - 0.5, f64::from(y) - 0.5);
        let size = f64::from(TILE);
        let direction = self.lens.ray(x0 + 0.5 * size, y0 + 0.5 * size);
        let spread = self.spread(direction, (x0, y0), (x0 + size, y0 + size));
        let (middle, radius) = self.solid.ball();
        let to = middle - self.lens.centre;
        let off = (to - direction * to.dot(direction)).length();
        if off > radius + OCCLUSION + (to.length() + radius) * spread {
            return None;
        }
        let parts = self.solid.near(self.lens.centre, direction, spread, 0.0);
        let around = self.solid.near(self.lens.centre, direction, spread, 2.0 * OCCLUSION);
        let from = self.clear(direction, spread, (to.length() - radius).max(0.0), parts);
        (parts != 0 && from < self.far).then_some(Tile { parts, around, from, pixel: 1.05 * spread / size })
    }

    fn tile_of(&self, x: u32, y: u32) -> Option<Tile> {
        self.tiles[(y / TILE * self.width.div_ceil(TILE) + x / TILE) as usize]
    }

    fn centre(&self, x: u32, y: u32) -> Centre {
        let Some(Tile { parts, from, pixel, .. }) = self.tile_of(x, y) else {
            return Centre { from: self.far, hit: None, near: false };
        };
        let direction = self.lens.ray(f64::from(x), f64::from(y));
        let from = self.clear(direction, pixel, from, parts);
        if from >= self.far {
            return Centre { from, hit: None, near: false };
        }
        let hit = self.solid.trace(self.lens.centre, direction, from, self.far, parts);
        Centre { from, hit, near: true }
    }

    /// Whether a neighbour sees the backdrop, or a surface across a step in depth.
    fn is_edge(&self, x: u32, y: u32, centres: &[Centre]) -> bool {
        let at = |x: u32, y: u32| &centres[(y * self.width + x) as usize];
        let Some(depth) = at(x, y).hit else {
            return at(x, y).near;
        };
        let (w, h) = (self.width - 1, self.height - 1);
        (y.saturating_sub(1)..=(y + 1).min(h)).any(|j| {
            (x.saturating_sub(1)..=(x + 1).min(w)).any(|i| at(i, j).hit.is_none_or(|d| libm::fabs(d - depth) > 0.02))
        })
    }

    fn pixel(&self, x: u32, y: u32, centres: &[Centre]) -> ([f64; 3], f64) {
        let centre = centres[(y * self.width + x) as usize];
        let behind = || backdrop::colour(self.lens.centre, self.lens.ray(f64::from(x), f64::from(y)));
        let (true, Some(tile)) = (centre.near, self.tile_of(x, y)) else {
            return (behind(), 0.0);
        };
        if let Some(depth) = centre.hit
            && !self.is_edge(x, y, centres)
            && let Some(rgb) = self.inner(x, y, depth, tile)
        {
            return (rgb, 1.0);
        }
        let (mut sum, mut shaded, mut hits) = ([0.0; 3], 0_u32, 0_u32);
        for i in 0..EDGE {
            let direction = self.sample(x, y, i, EDGE);
            let Some(t) = self.solid.trace(self.lens.centre, direction, centre.from, self.far, tile.parts) else {
                continue;
            };
            hits += 1;
            if shaded == 0 || i % (EDGE / INNER) == 0 {
                let p = self.lens.centre + direction * t;
                let (light, _) = self.light(p, tile.around);
                shaded += 1;
                add(&mut sum, self.solid.colour_of(p, tile.parts), light);
            }
        }
        if hits == 0 {
            return (behind(), 0.0);
        }
        let coverage = f64::from(hits) / f64::from(EDGE);
        let mut rgb = sum.map(|v| v / f64::from(shaded));
        if hits < EDGE {
            let b = behind();
            (0..3).for_each(|channel| rgb[channel] = rgb[channel] * coverage + b[channel] * (1.0 - coverage));
        }
        (rgb, coverage)
    }

    /// Direction of the `i`th of `count` samples of a pixel.
    fn sample(&self, x: u32, y: u32, i: u32, count: u32) -> DVec3 {
        // A square grid, sheared in both directions.
        let side = if count == EDGE { 5 } else { 2 };
        let j = side * (i % side) + i / side;
        let offset = |n: u32| (f64::from(n) + 0.5) / f64::from(count) - 0.5;
        self.lens.ray(f64::from(x) + offset(i), f64::from(y) + offset(j))
    }

    /// Colour of a pixel that the surface covers without an edge, approximated by the tangent plane. `None` where the view is
    /// too oblique for that.
    fn inner(&self, x: u32, y: u32, depth: f64, tile: Tile) -> Option<[f64; 3]> {
        let middle = self.lens.ray(f64::from(x), f64::from(y)) * depth;
        let (light, normal) = self.light(self.lens.centre + middle, tile.around);
        let off = middle.dot(normal);
        if off > -0.3 * depth {
            return None;
        }
        let mut sum = [0.0; 3];
        for i in 0..INNER {
            let direction = self.sample(x, y, i, INNER);
            let p = self.lens.centre + direction * (off / direction.dot(normal));
            add(&mut sum, self.solid.colour_of(p, tile.parts), light);
        }
        Some(sum.map(|v| v / f64::from(INNER)))
    }

    /// Lambertian light from a wide source above and in front, ambient light from above, and ambient occlusion. It does not
    /// depend on the camera. Also returns the normal.
    fn light(&self, p: DVec3, parts: Parts) -> (f64, DVec3) {
        let normal = self.solid.gradient(p, parts).normalize_or_zero();
        let source = DVec3::new(0.48, 0.36, 0.80);
        let direct = (0.5 + 0.5 * normal.dot(source)).max(0.0);
        let sky = 0.5 + 0.5 * normal.z;
        ((0.30 + 0.22 * sky + 0.62 * direct) * self.solid.openness(p, normal, parts), normal)
    }
}

fn add(sum: &mut [f64; 3], colour: [f64; 3], light: f64) {
    (0..3).for_each(|channel| sum[channel] += (colour[channel] * light).clamp(0.0, 1.0));
}

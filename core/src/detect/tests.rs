//! Compares the sweep with the definition of ZNCC, and AVX2 code with baseline code.

mod clean;
mod search;
mod substitute;
mod vote;

use super::{
    clean::{CleanParams, FitAt, Fits, Points},
    depth::DepthMap,
    level::PyramidLevel,
    sweep::{MAX_RADIUS, NOISE_VARIANCE, TILE, TILE_PIXELS, Tile},
    vote::{Curves, Support, VoteParams},
};
use crate::{
    camera::{Camera, Pinhole},
    eigen::{LANES, Lanes, principal},
    lens::Lens,
    simd::{Simd, Work},
};
use alloc::vec::Vec;
use glam::{DVec3, Vec3};

const WIDTH: u32 = 48;
const HEIGHT: u32 = 40;

/// A generator of pseudo-random numbers.
struct Random(u32);

impl Random {
    fn next(&mut self) -> u32 {
        self.0 = self.0.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        (self.0 >> 9) ^ self.0.rotate_left(13)
    }

    fn unit(&mut self) -> f32 {
        (self.next() >> 8) as f32 / (1 << 24) as f32
    }
}

/// A view from x along z, with a picture of `luma`. About one pixel in seven is background.
fn level(x: f64, random: &mut Random, mut luma: impl FnMut(&mut Random) -> u8) -> PyramidLevel<'static> {
    let k = [[60.0, 0.0, 23.5], [0.0, 60.0, 19.5], [0.0, 0.0, 1.0]];
    let r = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let camera = Camera { width: WIDTH, height: HEIGHT, k, lens: Lens::NONE, r, t: [-x, 0.0, 0.0] };
    let pixels = 0..WIDTH * HEIGHT;
    PyramidLevel {
        camera: Pinhole::new(&camera, DVec3::ZERO),
        luma: pixels.clone().map(|_| luma(random)).collect(),
        inside: pixels.map(|_| if random.next().is_multiple_of(7) { -64 } else { 64 }).collect(),
    }
}

/// Luma at a position between pixels.
fn bilinear(level: &PyramidLevel, u: f64, v: f64) -> f64 {
    let at = |x: usize, y: usize| f64::from(level.luma[y * WIDTH as usize + x]);
    let (x, y) = (u as usize, v as usize);
    let (fx, fy) = (u - x as f64, v - y as f64);
    let row = |y| at(x, y) * (1.0 - fx) + at(x + 1, y) * fx;
    row(y) * (1.0 - fy) + row(y + 1) * fy
}

#[test]
fn scores_are_zncc() {
    const RADIUS: usize = 2;
    let mut random = Random(5);
    let target = level(0.0, &mut random, |r| (r.next() & 255) as u8);
    let neighbour = level(0.1, &mut random, |r| (r.next() & 255) as u8);
    let guide: Vec<f32> = target.inside.iter().map(|&d| if d > 0 { 2.0 + 0.3 * random.unit() } else { 0.0 }).collect();
    let (x0, y0, shift) = (15, 11, 0.02);
    let mut tile = Tile::default();
    tile.load(&target, &guide, x0, y0, RADIUS);
    tile.face(&target, &neighbour, x0, y0);
    let mut scores = [0.0; TILE_PIXELS];
    let mut pairs = Vec::new();
    neighbour.write_pairs(&mut pairs);
    tile.score(&neighbour, &pairs, shift, &mut scores);
    for (i, &score) in scores.iter().enumerate() {
        let (cx, cy) = (x0 + i % TILE, y0 + i / TILE);
        let mut pairs: Vec<(f64, f64)> = Vec::new();
        for y in cy - RADIUS..=cy + RADIUS {
            for x in cx - RADIUS..=cx + RADIUS {
                let k = y * WIDTH as usize + x;
                if guide[k] > 0.0 {
                    let depth = 1.0 / (1.0 / guide[k] - shift);
                    let seen = neighbour.camera.project(target.camera.unproject(x as f32, y as f32, depth));
                    pairs.push((f64::from(target.luma[k]), bilinear(&neighbour, seen.x.into(), seen.y.into())));
                }
            }
        }
        let n = pairs.len() as f64;
        let mean = pairs.iter().fold((0.0, 0.0), |s, p| (s.0 + p.0 / n, s.1 + p.1 / n));
        let sum = |f: fn(f64, f64) -> f64| pairs.iter().map(|p| f(p.0 - mean.0, p.1 - mean.1)).sum::<f64>();
        let noise = f64::from(NOISE_VARIANCE) * n;
        let expected = sum(|a, b| a * b) / libm::sqrt((sum(|a, _| a * a) + noise) * (sum(|_, b| b * b) + noise));
        assert!((f64::from(score) - expected).abs() < 2e-4, "pixel {i}: {score}, not {expected}");
    }
}

/// Sweeps some tiles. The output is the bits of all scores, positions and supports.
struct Sweep<'a> {
    target: &'a PyramidLevel<'a>,
    neighbour: &'a PyramidLevel<'a>,
    guide: &'a [f32],
    radius: usize,
}

impl Work for Sweep<'_> {
    type Output = Vec<u32>;

    #[inline(always)]
    fn run(self) -> Vec<u32> {
        let params = VoteParams { smoothing: Some(0.8), support: Support::SpreadPeaks(1.0), agreement_radius: Some(2) };
        let mut tile = Tile::default();
        let mut curves = Curves::default();
        let mut pairs = Vec::new();
        self.neighbour.write_pairs(&mut pairs);
        curves.tune(&params);
        let mut bits = Vec::new();
        for (x0, y0) in [(0, 0), (20, 13), (40, 30)] {
            tile.load(self.target, self.guide, x0, y0, self.radius);
            tile.face(self.target, self.neighbour, x0, y0);
            curves.reset(9);
            for (i, scores) in curves.scores_mut().iter_mut().enumerate() {
                tile.score(self.neighbour, &pairs, 0.01 * (i as f32 - 4.0), scores);
                bits.extend(scores.iter().map(|&s| canonical(s)));
            }
            curves.vote(&params);
            curves.agree(2, &[true; TILE_PIXELS]);
            for pixel in 0..TILE_PIXELS {
                let (position, support) = curves.best(pixel, 1, 7, true);
                bits.extend([canonical(position), canonical(support)]);
            }
        }
        bits
    }
}

/// The bits of a number. All NaNs are treated alike, because it is not specified which one an operation gives.
fn canonical(v: f32) -> u32 {
    if v.is_nan() { f32::NAN.to_bits() } else { v.to_bits() }
}

#[test]
fn sweeps_are_the_same_with_vector_code() {
    let pictures: [fn(&mut Random) -> u8; 4] =
        [|r| (r.next() & 255) as u8, |_| 0, |_| 200, |r| if r.next() & 1 == 0 { 0 } else { 255 }];
    let depths = [2.0, 1.9, 1e-3, 1e30, f32::MIN_POSITIVE / 8.0, -0.0, -1.0, f32::NAN, f32::INFINITY];
    let mut random = Random(11);
    for picture in pictures {
        let (target, neighbour) = (level(0.0, &mut random, picture), level(0.1, &mut random, picture));
        for odd in depths {
            let pixels = 0..WIDTH * HEIGHT;
            let guide: Vec<f32> =
                pixels.map(|_| if random.next().is_multiple_of(5) { odd } else { 1.8 + 0.4 * random.unit() }).collect();
            for radius in 1..=MAX_RADIUS {
                let sweep = || Sweep { target: &target, neighbour: &neighbour, guide: &guide, radius };
                assert_eq!(Simd::Baseline.run(sweep()), Simd::detect().run(sweep()), "depth {odd}, radius {radius}");
            }
        }
    }
}

#[test]
fn neighbourhoods_are_the_same_with_vector_code() {
    let odd = [1e-3, 1e30, f32::MIN_POSITIVE / 8.0, 0.0, -0.0, -1.0, f32::NAN, f32::INFINITY];
    let mut random = Random(23);
    let level = level(0.1, &mut random, |_| 0);
    // A rough surface, and a flat one with equal depths.
    for roughness in [0.4, 0.0] {
        for odd in odd {
            let pixels = 0..WIDTH * HEIGHT;
            let depth = |_| if random.next().is_multiple_of(5) { odd } else { 1.8 + roughness * random.unit() };
            let map = DepthMap { depth: pixels.map(depth).collect(), ..DepthMap::default() };
            for radius_pixels in [1.0, 2.5, 4.0, 5.0] {
                let params = CleanParams { radius_pixels, density: None, flatness: None, facing: None };
                let mut planes = <[Vec<f32>; 4]>::default();
                let points = Points::new(&level, &map, &params, &mut planes);
                for (x, y) in [(0, 0), (7, 3), (WIDTH as usize - 1, HEIGHT as usize - 1)] {
                    let fit = |simd: Simd| {
                        let Fits { count, values, normal } = simd.run(FitAt { points: &points, x, y });
                        let all = values.iter().chain(&normal).chain([&count]).flatten();
                        all.map(|&v| canonical(v)).collect::<Vec<_>>()
                    };
                    assert_eq!(fit(Simd::Baseline), fit(Simd::detect()), "depth {odd}, radius {radius_pixels}");
                }
            }
        }
    }
}

/// The bits of eigenvalues and normals.
struct Principal([Lanes; 6]);

impl Work for Principal {
    type Output = Vec<u32>;

    #[inline(always)]
    fn run(self) -> Vec<u32> {
        let (values, normal) = principal(self.0);
        values.iter().chain(&normal).flatten().map(|&v| canonical(v)).collect()
    }
}

#[test]
fn eigenvectors_are_the_same_with_vector_code() {
    let odd = [0.0, -0.0, 1.0, f32::MIN_POSITIVE / 4.0, 1e-30, 1e30, f32::NAN, f32::INFINITY];
    let mut random = Random(3);
    for _ in 0..2000 {
        let mut entry =
            || if random.next().is_multiple_of(3) { odd[random.next() as usize % odd.len()] } else { random.unit() };
        let matrices: [Lanes; 6] = core::array::from_fn(|_| [0.0; LANES].map(|_| entry()));
        assert_eq!(Simd::Baseline.run(Principal(matrices)), Simd::detect().run(Principal(matrices)));
    }
    let normal = Vec3::new(0.6, 0.0, 0.8);
    let projection = |i: usize, j: usize| f32::from(u8::from(i == j)) - normal[i] * normal[j];
    let plane = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].map(|(i, j)| [projection(i, j); LANES]);
    let (_, normals) = principal(plane);
    assert!((normals[0][0] * 0.6 + normals[2][0] * 0.8).abs() > 0.999_99);
}

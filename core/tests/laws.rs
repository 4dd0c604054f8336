//! Laws that hold for all inputs, tested on inputs that are drawn at random and the same every time.
#![allow(clippy::disallowed_methods, clippy::disallowed_types, reason = "no result depends on the tests' own numbers")]

use glam::{DMat3, DQuat, DVec3, Vec3};
use pcmvs_core::{
    Camera, ImageRef, Lens, Mask, Params, Pinhole, PixelFormat, Preset, Rig, Silent, View, ViewInput, hull::VisualHull,
    silhouette::Silhouette,
};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngSeed};
use std::sync::Arc;

fn law(cases: u32) -> Config {
    Config { cases, rng_seed: RngSeed::Fixed(7), failure_persistence: None, ..Config::default() }
}

const WIDTH: u32 = 128;
const HEIGHT: u32 = 96;

/// A camera anywhere in a ball of radius 10 that looks anywhere, with skew.
fn any_camera() -> impl Strategy<Value = Camera> {
    let place = prop::array::uniform3(-5.0..5.0f64);
    let turn = prop::array::uniform4(-1.0..1.0f64);
    (place, turn, 80.0..400.0f64, 0.9..1.1f64, -3.0..3.0f64, -8.0..8.0f64).prop_filter_map(
        "a rotation",
        |(place, turn, focal, aspect, skew, shift)| {
            let turn = DQuat::from_array(turn);
            let r = (turn.length() > 0.1).then(|| DMat3::from_quat(turn.normalize()))?;
            Some(Camera {
                width: WIDTH,
                height: HEIGHT,
                k: [[focal, skew, 63.5 + shift], [0.0, focal * aspect, 47.5 - shift], [0.0, 0.0, 1.0]],
                lens: Lens::NONE,
                r: r.transpose().to_cols_array_2d(),
                t: (-(r * DVec3::from_array(place))).to_array(),
            })
        },
    )
}

/// OpenCV's coefficients as lenses have them.
fn any_lens() -> impl Strategy<Value = [f64; 5]> {
    (-0.25..0.2f64, -0.05..0.05f64, -2e-3..2e-3f64, -2e-3..2e-3f64).prop_map(|(k1, k2, p1, p2)| [k1, k2, p1, p2, 0.0])
}

/// Distance to the nearest pixel of the other side, by trying all.
fn to_other_side(silhouette: &Silhouette, pixel: usize) -> f32 {
    let w = silhouette.width as usize;
    let d = silhouette.distances();
    let squared = |i: usize| (i % w).abs_diff(pixel % w).pow(2) + (i / w).abs_diff(pixel / w).pow(2);
    let others = (0..d.len()).filter(|&i| (d[i] > 0) != (d[pixel] > 0));
    others.map(squared).min().map_or(f32::INFINITY, |s| (s as f32).sqrt())
}

proptest! {
    #![proptest_config(law(256))]

    /// A pixel's ray at a depth projects to the pixel and the depth, also in pictures of half the size.
    #[test]
    fn what_is_unprojected_projects_back(
        camera in any_camera(), u in -20.0..150.0f32, v in -20.0..120.0f32, depth in 0.2..20.0f32,
    ) {
        let full = Pinhole::new(&camera, DVec3::ZERO);
        for camera in [full, full.halved()] {
            let back = camera.project(camera.unproject(u, v, depth));
            // Single precision, at up to 10 units from the origin.
            let precision = 2e-5 * (10.0 + depth) / depth;
            prop_assert!((back.z / depth - 1.0).abs() < precision, "{back} at {depth}");
            prop_assert!((back.x - u).abs() < 400.0 * precision && (back.y - v).abs() < 400.0 * precision, "{back}");
            prop_assert!((camera.depth(camera.unproject(u, v, depth)) / depth - 1.0).abs() < precision);
        }
        // A pixel of half the size sees what 2 x 2 pixels around the same place see.
        let (half, point) = (full.halved(), full.unproject(u, v, depth));
        let q = half.project(point);
        let precision = 2e-5 * (10.0 + depth) / depth;
        prop_assert!((2.0 * q.x + 0.5 - u).abs() < 400.0 * precision, "{q}");
        prop_assert!((2.0 * q.y + 0.5 - v).abs() < 400.0 * precision, "{q}");
    }

    /// The pinhole's pixel, distorted, is the calibrated camera's pixel.
    #[test]
    fn the_camera_is_its_pinhole_and_its_lens(
        camera in any_camera(), lens in any_lens(), u in 0.0..127.0f32, v in 0.0..95.0f32, depth in 0.5..20.0f32,
    ) {
        let camera = Camera { lens: Lens::brown(lens), ..camera };
        let pinhole = Pinhole::new(&camera, DVec3::ZERO);
        let point = pinhole.unproject(u, v, depth).as_dvec3();
        let (pixel, z) = camera.project(point).expect("it is in front");
        let ideal = pinhole.project(point.as_vec3());
        let expected = camera.distort_pixel(ideal.truncate().as_dvec2());
        let precision = 2e-2 * (10.0 + f64::from(depth)) / f64::from(depth);
        prop_assert!((pixel - expected).length() < precision, "{pixel} and {expected}");
        prop_assert!((z / f64::from(ideal.z) - 1.0).abs() < precision);
    }
}

proptest! {
    #![proptest_config(law(40))]

    /// An undistorted picture shows at a pixel what the real one shows where the lens puts that pixel.
    #[test]
    fn undistorted_pictures_show_what_the_lens_saw(camera in any_camera(), lens in any_lens()) {
        let mut cameras = studio::Ring { count: 3, ..studio::Ring::default() }.sized(WIDTH, HEIGHT).cameras();
        cameras[1] = Camera { k: camera.k, lens: Lens::brown(lens), ..cameras[1] };
        let rig = Rig::new(&cameras).expect("the cameras are sound");
        // Red is the column and green the row, both times two.
        let pixels = (0..HEIGHT).flat_map(|y| (0..WIDTH).map(move |x| (x, y)));
        let rgb: Vec<u8> = pixels.clone().flat_map(|(x, y)| [2 * x as u8, 2 * y as u8, 0]).collect();
        let image = ImageRef::packed(&rgb, WIDTH, HEIGHT, PixelFormat::Rgb8);
        let view = View::new(&rig, 1, &ViewInput { image, mask: Mask::Unknown }, None).expect("the picture fits");
        let mut seen = 0;
        for (i, (x, y)) in pixels.enumerate() {
            let source = cameras[1].distort_pixel(glam::DVec2::new(f64::from(x), f64::from(y)));
            let inner = source.x > 2.0 && source.y > 2.0 && source.x < 125.0 && source.y < 93.0;
            // Beyond the fold the model is meaningless.
            let r2 = cameras[1].normalise(glam::DVec2::new(f64::from(x), f64::from(y))).length_squared();
            if inner && 1.0 + r2 * (3.0 * lens[0] + r2 * 5.0 * lens[1]) > 0.3 {
                let found = [f64::from(view.rgb[3 * i]) / 2.0, f64::from(view.rgb[3 * i + 1]) / 2.0];
                // Rounding of a ramp of two levels a pixel, and a few hundredths of the map.
                prop_assert!((found[0] - source.x).abs() < 0.35, "({x}, {y}): {found:?} for {source}");
                prop_assert!((found[1] - source.y).abs() < 0.35, "({x}, {y}): {found:?} for {source}");
                seen += 1;
            }
        }
        prop_assert!(seen > 4000, "{seen}");
    }

    /// The distance has the side's sign, is that to the nearest pixel of the other side but for the pixel that the contour
    /// runs through, and changes from pixel to pixel by no more than the pixels are apart.
    #[test]
    fn silhouettes_are_signed_distances(
        discs in prop::collection::vec((0.0..40.0f32, 0.0..30.0f32, 2.0..9.0f32), 1..6), soft in any::<bool>(),
    ) {
        const W: usize = 40;
        const H: usize = 30;
        let depth = |x: usize, y: usize| {
            discs.iter().map(|d| d.2 - (x as f32 - d.0).hypot(y as f32 - d.1)).fold(f32::NEG_INFINITY, f32::max)
        };
        let coverage: Vec<u8> = (0..W * H)
            .map(|i| {
                let d = depth(i % W, i / W);
                if soft { ((d + 0.5).clamp(0.0, 1.0) * 255.0) as u8 } else { u8::from(d > 0.0) * 255 }
            })
            .collect();
        let Ok(silhouette) = Silhouette::from_coverage(W as u32, H as u32, &coverage, |_| true) else { return Ok(()) };
        let d: Vec<f32> = silhouette.distances().iter().map(|&d| f32::from(d) / Silhouette::UNITS).collect();
        for i in 0..W * H {
            let (x, y) = (i % W, i / W);
            let around = (0..9).map(|k| (x + k % 3, y + k / 3)).filter(|&(x, y)| (1..=W).contains(&x) && (1..=H).contains(&y));
            let mut around = around.map(|(x, y)| coverage[(y - 1) * W + x - 1]);
            prop_assert!(d[i] > 0.0 || !around.clone().all(|c| c == 255), "({x}, {y}) lies amid the object: {}", d[i]);
            prop_assert!(d[i] <= 0.0 || !around.all(|c| c == 0), "({x}, {y}) lies amid background: {}", d[i]);
            let other = to_other_side(&silhouette, i);
            prop_assert!((other - 1.05..other + 0.05).contains(&d[i].abs()), "({x}, {y}): {} but {other}", d[i]);
            for (step, apart) in [(1, 1.0), (W, 1.0), (W + 1, 2f32.sqrt())] {
                if i + step < W * H && x + step % W < W {
                    let change = (d[i + step] - d[i]).abs();
                    prop_assert!(change < apart + 0.1, "({x}, {y}) to {step} on: {change}");
                }
            }
        }
    }

    /// The order in which cameras are numbered changes nothing: not the origin, not the order in which stages take them.
    #[test]
    fn a_rig_does_not_depend_on_the_numbering(
        (count, seed) in (3..9u32, any::<u64>()), order in Just((0..8usize).collect::<Vec<_>>()).prop_shuffle(),
    ) {
        let ring = studio::Ring { count, seed, ..studio::Ring::default() }.sized(WIDTH, HEIGHT);
        let cameras = ring.cameras();
        let order: Vec<usize> = order.into_iter().filter(|&i| i < cameras.len()).collect();
        let shuffled: Vec<Camera> = order.iter().map(|&i| cameras[i]).collect();
        let (a, b) = (Rig::new(&cameras).expect("sound"), Rig::new(&shuffled).expect("sound"));
        prop_assert_eq!(a.origin(), b.origin());
        let taken = |rig: &Rig| rig.order().iter().map(|&i| rig.pinholes()[i as usize]).collect::<Vec<_>>();
        prop_assert_eq!(taken(&a), taken(&b));
        for i in 0..shuffled.len() {
            prop_assert_eq!(b.order()[b.place(i).expect("it has it")], i as u32);
        }
    }
}

/// A view that sees balls as its silhouette, pixels inside or outside.
fn view_of(balls: &[(Vec3, f32)], camera: &Camera, index: u16) -> Option<View> {
    let camera = Pinhole::new(camera, DVec3::ZERO);
    let covered = |i: u32| {
        let ray = camera.ray((i % camera.width) as f32, (i / camera.width) as f32).normalize();
        let meets = |&(centre, radius): &(Vec3, f32)| {
            let to: Vec3 = centre - camera.centre;
            (to - ray * to.dot(ray)).length() < radius
        };
        u8::from(balls.iter().any(meets)) * 255
    };
    let coverage: Vec<u8> = (0..camera.width * camera.height).map(covered).collect();
    let silhouette = Silhouette::from_coverage(camera.width, camera.height, &coverage, |_| true).ok()?;
    Some(View::of_silhouette(index, camera, Some(Arc::new(silhouette))))
}

proptest! {
    #![proptest_config(law(10))]

    /// What one silhouette excludes is outside, and what all see well inside is inside; the order of the views does not
    /// matter.
    #[test]
    fn the_hull_is_what_no_silhouette_excludes(
        balls in prop::collection::vec((prop::array::uniform3(-0.3..0.3f32), 0.1..0.3f32), 1..4),
        count in 4..8u32, points in prop::collection::vec(prop::array::uniform3(-0.8..0.8f32), 300),
    ) {
        let balls: Vec<(Vec3, f32)> = balls.into_iter().map(|(c, r)| (Vec3::from_array(c), r)).collect();
        let cameras: Vec<Camera> = (0..count).map(|i| {
            let turn = std::f64::consts::TAU * f64::from(i) / f64::from(count);
            let from = DVec3::new(2.5 * turn.cos(), 2.5 * turn.sin(), if i % 2 == 0 { 1.2 } else { 0.4 });
            let forward = -from.normalize();
            let right = forward.cross(DVec3::Z).normalize();
            let r = DMat3::from_cols(right, forward.cross(right), forward).transpose();
            let k = [[150.0, 0.0, 63.5], [0.0, 150.0, 63.5], [0.0, 0.0, 1.0]];
            let (r, t) = (r.transpose().to_cols_array_2d(), (-(r * from)).to_array());
            Camera { width: 128, height: 128, k, lens: Lens::NONE, r, t }
        }).collect();
        let views: Option<Vec<View>> = cameras.iter().enumerate().map(|(i, c)| view_of(&balls, c, i as u16)).collect();
        let Some(views) = views else { return Ok(()) };
        let carve = |views: &[View]| VisualHull::new(views, &Params::preset(Preset::Hull).hull, &Silent);
        let hull = carve(&views).expect("the balls are in it");
        let mut reversed = views.clone();
        reversed.reverse();
        let other = carve(&reversed).expect("the balls are in it");
        let near = balls.iter().flat_map(|b| points.iter().map(|p| b.0 + Vec3::from_array(*p) * b.1 * 1.4));
        for p in points.iter().map(|p| Vec3::from_array(*p)).chain(near) {
            let seen = views.iter().filter_map(|v| {
                let q = v.camera.project(p);
                v.silhouette.as_ref().and_then(|s| s.sample(q.x, q.y))
            });
            let (least, count) = seen.fold((f32::INFINITY, 0), |(least, count), d| (d.min(least), count + 1));
            let distance = hull.signed_distance(p);
            prop_assert!(least > 0.0 || distance <= 0.0, "{p} is {distance} inside but {least} pixels outside");
            prop_assert!(
                least < 0.01 || count < views.len() || distance > 0.0,
                "{p} is {distance} but {least} pixels inside for all"
            );
            prop_assert_eq!(distance, other.signed_distance(p));
        }
    }
}

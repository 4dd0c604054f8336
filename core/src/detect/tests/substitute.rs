//! §4.2: where stereo fails, the guide's point takes the place of the one that was found.

extern crate std;

use super::super::{
    DetectionParams, DetectionScratch, Guide, PyramidLevel, SubstitutionParams, depth::DepthMap, detect_view,
    substitute::substitute,
};
use crate::{
    context::Context,
    hull::VisualHull,
    params::{Params, Preset},
    point_cloud::{PointCloud, Rank},
    progress::Silent,
    report::Counts,
    rig::Rig,
    testing::{camera, ring, silhouette_of, sphere},
};
use alloc::{collections::BTreeMap, vec, vec::Vec};
use glam::{DVec3, Vec3};
use std::sync::LazyLock;

pub(super) const SIZE: u32 = 96;
/// Radius of the surface, and of the hull around it.
pub(super) const SURFACE: f32 = 0.9;
pub(super) const HULL: f32 = 1.0;
pub(super) const VIEW: usize = 0;

pub(super) struct Scene {
    pub(super) rig: Rig,
    views: Vec<crate::View>,
    pub(super) levels: Vec<PyramidLevel<'static>>,
}

/// A ball with texture on its upper half and none on its lower half, in a hull that is a larger ball.
pub(super) static SCENE: LazyLock<Scene> = LazyLock::new(|| {
    let cameras: Vec<_> = ring(12, 4.0, 0.5).map(|from| camera(from, Vec3::ZERO, SIZE, 170.0)).collect();
    let rig = Rig::new(&cameras).expect("the cameras are sound");
    assert!(rig.origin().length() < 0.6 && rig.origin() != DVec3::ZERO);
    let centre = -rig.origin().as_vec3();
    let pinholes: Vec<_> = rig.order().iter().map(|&i| rig.pinholes()[i as usize]).collect();
    let views: Vec<_> =
        pinholes.iter().enumerate().map(|(i, c)| silhouette_of(&[(centre, HULL)], c, i as u16)).collect();
    let levels = pinholes.iter().zip(&views).map(|(camera, view)| {
        let luma = |i: u32| {
            let ray = camera.ray((i % SIZE) as f32, (i / SIZE) as f32).normalize();
            let to = centre - camera.centre;
            let across = (to - ray * to.dot(ray)).length_squared();
            if across > SURFACE * SURFACE {
                return 20;
            }
            let p = ray * (to.dot(ray) - libm::sqrtf(SURFACE * SURFACE - across)) - to;
            let waves = [Vec3::new(9.0, 4.0, 13.0), Vec3::new(-14.0, 8.0, 5.0), Vec3::new(3.0, -16.0, 7.0)];
            let texture: f32 = waves.iter().map(|w| libm::sinf(1.7 * w.dot(p))).sum();
            if p.z > 0.0 { (128.0 + 40.0 * texture) as u8 } else { 128 }
        };
        let inside = view.silhouette.as_ref().expect("there is one").distances().to_vec();
        PyramidLevel { camera: *camera, luma: (0..SIZE * SIZE).map(luma).collect(), inside: inside.into() }
    });
    let levels = levels.collect();
    Scene { rig, views, levels }
});

/// All that cleaning could take away stays.
pub(super) fn params() -> DetectionParams {
    let mut params = Params::preset(Preset::Paper).detection;
    (params.clean.density, params.clean.flatness, params.clean.facing) = (None, None, None);
    params
}

fn found(params: &DetectionParams) -> (PointCloud, Counts) {
    let hull = VisualHull::new(&SCENE.views, &Params::preset(Preset::Paper).hull, &Silent).expect("there is a hull");
    let mesh = sphere(-SCENE.rig.origin().as_vec3(), HULL);
    let context = Context { rig: &SCENE.rig, views: &SCENE.views, hull: &hull, progress: &Silent };
    let level = |view: usize| SCENE.levels[view].clone();
    detect_view(context, VIEW, &level, Guide::Hull(&mesh), params, &mut DetectionScratch::default())
        .expect("nothing cancels")
}

fn below(below: f32) -> DetectionParams {
    DetectionParams { substitution: Some(SubstitutionParams { below }), ..params() }
}

/// Distance from the ball's centre.
fn height(p: Vec3) -> f32 {
    (p + SCENE.rig.origin().as_vec3()).length()
}

/// Points by pixel.
fn by_pixel(cloud: &PointCloud) -> BTreeMap<(i32, i32), crate::Point> {
    let camera = &SCENE.levels[VIEW].camera;
    let pixel = |p: Vec3| {
        let q = camera.project(p);
        (libm::roundf(q.x) as i32, libm::roundf(q.y) as i32)
    };
    let map: BTreeMap<_, _> = cloud.iter().map(|p| (pixel(p.position), *p)).collect();
    assert_eq!(map.len(), cloud.len(), "one point for each pixel");
    map
}

#[test]
fn below_a_quarter_of_the_views_the_first_hull_point_takes_the_place() {
    let views = params().search.neighbours as f32;
    // With a threshold of 0 every point that stereo finds is taken, with its fidelity.
    let all = by_pixel(&found(&below(0.0)).0);
    let (cloud, counts) = found(&params());
    let (mut substituted, mut detected) = (vec![], vec![]);
    for (pixel, p) in by_pixel(&cloud) {
        // What has hardly a neighbour has no normal, and is not there.
        let Some(q) = all.get(&pixel) else { continue };
        let weak = q.rank == Rank::Substituted || q.fidelity < 0.25 * views;
        assert_eq!(p.rank == Rank::Substituted, weak, "{pixel:?}: {p:?}");
        if weak {
            assert!((height(p.position) - HULL).abs() < 0.004, "{pixel:?}: {p:?}");
            let front = SCENE.levels[VIEW].camera.centre - p.position;
            assert!((p.position + SCENE.rig.origin().as_vec3()).dot(front) > -0.05, "not the first: {p:?}");
            assert_eq!(p.fidelity, 0.0);
            substituted.push(pixel);
        } else {
            assert_eq!((p.rank, p.position), (Rank::Detected, all[&pixel].position), "{pixel:?}");
            detected.push(pixel);
        }
    }
    assert_eq!(counts.substituted + counts.detected, cloud.len() as u32 + counts.cleaned_density);
    assert!(substituted.len() > 1000 && detected.len() > 1000, "{} {}", substituted.len(), detected.len());
}

#[test]
fn texture_is_found_on_the_surface_and_blankness_stays_on_the_hull() {
    let camera = &SCENE.levels[VIEW].camera;
    let centre = -SCENE.rig.origin().as_vec3();
    let (cloud, _) = found(&params());
    // Well within each half, seen from not too far aside.
    let facing = |p: Vec3| (p - centre).normalize().dot((camera.centre - centre).normalize()) > 0.6;
    let (mut on, mut off, mut blank) = (0, 0, 0);
    for p in cloud.iter().filter(|p| facing(p.position)) {
        let z = (p.position - centre).z;
        if z > 0.2 {
            let good = p.rank == Rank::Detected && (height(p.position) - SURFACE).abs() < 0.03;
            if good { on += 1 } else { off += 1 }
        } else if z < -0.2 {
            assert_eq!(p.rank, Rank::Substituted, "{p:?}");
            blank += 1;
        }
    }
    assert!(on > 4 * off && on > 300 && blank > 300, "{on} on the surface, {off} off it, {blank} blank");
}

#[test]
fn without_substitution_failed_pixels_have_no_point() {
    let (cloud, counts) = found(&DetectionParams { substitution: None, ..params() });
    assert!(counts.substituted == 0 && cloud.len() as u32 + counts.cleaned_density == counts.detected);
    assert!(!cloud.is_empty() && cloud.iter().all(|p| p.rank == Rank::Detected && p.fidelity > 0.0));
    // No fidelity is above the number of views: then all are substituted.
    let (cloud, counts) = found(&below(1.01));
    assert!(counts.detected == 0 && cloud.iter().all(|p| p.rank == Rank::Substituted));
}

/// The rule itself, pixel by pixel: of four views that were compared a fidelity of 1 is enough, and of two 0.5.
#[test]
fn the_threshold_is_a_quarter_of_the_views() {
    // Not searched, not found, below, at and above the threshold of four views, and above that of two.
    let (guide, depth) = ([0.0, 2.0, 2.0, 2.0, 2.0, 2.0], vec![0.0, 0.0, 2.5, 2.5, 2.5, 2.5]);
    let (fidelity, compared) = (vec![0.0, 0.0, 0.99, 1.0, 3.0, 0.6], vec![0, 4, 4, 4, 4, 2]);
    let mut map = DepthMap { depth, fidelity, sigma: vec![0.1; 6], compared };
    let (mut rank, mut counts) = (Vec::new(), Counts::default());
    substitute(&mut map, &guide, Some(&SubstitutionParams { below: 0.25 }), &mut rank, &mut counts);
    assert_eq!(map.depth, [0.0, 2.0, 2.0, 2.5, 2.5, 2.5]);
    assert_eq!(map.fidelity, [0.0, 0.0, 0.0, 1.0, 3.0, 0.6]);
    assert_eq!(rank[1..3], [Rank::Substituted; 2]);
    assert_eq!(rank[3..], [Rank::Detected; 3]);
    assert_eq!((counts.substituted, counts.detected), (2, 3));
    assert_eq!(Params::preset(Preset::Paper).detection.substitution, Some(SubstitutionParams { below: 0.25 }));
}

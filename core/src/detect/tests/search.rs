//! §4.1: a pixel is searched in its own interval only.

use super::{
    super::{
        PyramidLevel, SearchParams,
        depth::{DepthMap, SweepScratch, depth_map},
        range::SearchRange,
    },
    substitute::{SCENE, SIZE, SURFACE, VIEW, params},
};
use crate::raster::Raster;
use alloc::vec::Vec;

/// Half the length of an interval.
const BAND: f32 = 0.1;
/// By how much an interval misses the surface.
const MISS: f32 = 0.25;

/// Of three neighbouring pixels one has its interval around the surface, one before it and one behind it. All three are
/// in the same tile, so that their hypotheses are the same.
#[test]
fn depths_lie_in_the_intervals_of_their_pixels() {
    let target = &SCENE.levels[VIEW];
    let centre = -SCENE.rig.origin().as_vec3();
    // Depth of the surface's upper half, where there is texture.
    let surface = |i: u32| {
        let ray = target.camera.ray((i % SIZE) as f32, (i / SIZE) as f32).normalize();
        let to = centre - target.camera.centre;
        let half = SURFACE * SURFACE - (to - ray * to.dot(ray)).length_squared();
        let p = target.camera.centre + ray * (to.dot(ray) - libm::sqrtf(half.max(0.0)));
        (half > 0.1 && p.z > centre.z).then(|| target.camera.depth(p))
    };
    let interval = |i: u32| surface(i).map(|depth| depth + MISS * ((i % 3) as f32 - 1.0));
    let mut guide = Raster::default();
    guide.inverse = (0..SIZE * SIZE).map(|i| interval(i).map_or(0.0, |depth| 1.0 / depth)).collect();
    let mut range = SearchRange::default();
    range.set_around_surface(target, &guide, BAND);
    // Upright windows take nothing from the guide but the interval.
    let search: SearchParams = params().search;
    let neighbours = SCENE.rig.neighbours(VIEW).iter().take(search.neighbours as usize);
    let neighbours: Vec<&PyramidLevel> = neighbours.map(|&j| &SCENE.levels[j as usize]).collect();
    let mut map = DepthMap::default();
    depth_map(target, &neighbours, &range, &search, &mut SweepScratch::default(), &mut map, |_, _| Ok(()))
        .expect("nothing cancels");
    let (mut on, mut around) = (0, 0);
    for i in 0..SIZE * SIZE {
        let depth = map.depth[i as usize];
        let Some(middle) = interval(i) else {
            assert_eq!(depth, 0.0, "pixel {i} is not searched");
            continue;
        };
        assert!(depth == 0.0 || (depth - middle).abs() < BAND + 1e-4, "pixel {i}: {depth}, {middle}");
        if i % 3 == 1 {
            around += 1;
            on += u32::from((depth - middle).abs() < 0.03);
        }
    }
    // The surface is found where it can be: the intervals are not empty.
    assert!(around > 300 && on > around / 2, "{on} of {around}");
}

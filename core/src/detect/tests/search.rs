//! §4.1: a pixel is searched in its own interval only, and compared with views that show it.

use super::{
    super::{
        PyramidLevel, SearchParams,
        depth::{DepthMap, SweepScratch, depth_map},
        range::SearchRange,
    },
    substitute::{HULL, SCENE, SIZE, SURFACE, VIEW, params},
};
use crate::{
    raster::{Crossings, Interval, Raster},
    testing::{pinhole, sphere},
};
use alloc::vec::Vec;

/// Half the length of an interval.
const BAND: f32 = 0.1;
/// By how much an interval misses the surface.
const MISS: f32 = 0.25;

/// The views nearest to the target's, nearest first.
fn nearest() -> Vec<&'static PyramidLevel<'static>> {
    SCENE.rig.neighbours(VIEW).iter().map(|&j| &SCENE.levels[j as usize]).collect()
}

fn depths(neighbours: &[&PyramidLevel], range: &SearchRange, search: &SearchParams) -> DepthMap {
    let mut map = DepthMap::default();
    depth_map(&SCENE.levels[VIEW], neighbours, range, search, &mut SweepScratch::default(), &mut map, |_, _| Ok(()))
        .expect("nothing cancels");
    map
}

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
    range.set_around_surface(target, &guide, BAND, None);
    // Upright windows take nothing from the guide but the interval.
    let search: SearchParams = params().search;
    let map = depths(&nearest(), &range, &search);
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

/// The guide surface is seen in every second column only, as if thin parts of it had got lost.
#[test]
fn the_hull_is_searched_where_an_incomplete_surface_is_not_seen() {
    let target = &SCENE.levels[VIEW];
    let middle = -SCENE.rig.origin().as_vec3();
    let mut crossings = Crossings::default();
    crossings.find(&sphere(middle, HULL), &target.camera);
    let mut surface = Raster::default();
    surface.render(&sphere(middle, SURFACE), &target.camera);
    surface.inverse.iter_mut().step_by(2).for_each(|inverse| *inverse = 0.0);
    let (mut range, mut in_hull) = (SearchRange::default(), SearchRange::default());
    in_hull.set_in_hull(target, &mut crossings);
    range.set_around_surface(target, &surface, BAND, Some(&mut crossings));
    let (mut around, mut within) = (0, 0);
    for (pixel, &inverse) in surface.inverse.iter().enumerate() {
        if inverse == 0.0 || target.inside[pixel] <= 0 {
            assert_eq!(
                (range.of(pixel), range.guide[pixel]),
                (in_hull.of(pixel), in_hull.guide[pixel]),
                "pixel {pixel}"
            );
            within += usize::from(!range.of(pixel).is_empty());
        } else {
            let depth = 1.0 / inverse;
            assert_eq!(range.of(pixel), [Interval { near: depth - BAND, far: depth + BAND }], "pixel {pixel}");
            around += 1;
        }
    }
    assert!(around > 300 && within > 300, "{around}, {within}");
}

#[test]
fn pixels_are_compared_with_the_nearest_views_that_show_them() {
    let target = &SCENE.levels[VIEW];
    let mut guide = Raster::default();
    guide.render(&sphere(-SCENE.rig.origin().as_vec3(), SURFACE), &target.camera);
    let mut range = SearchRange::default();
    range.set_around_surface(target, &guide, BAND, None);
    let search = params().search;
    let expected = depths(&nearest(), &range, &search);
    let found = expected.depth.iter().filter(|&&depth| depth > 0.0).count();
    assert!(found > 2000, "{found}");
    let wanted = search.neighbours as u16;
    assert!(
        expected.compared.iter().zip(&expected.depth).all(|(&n, &depth)| n == if depth > 0.0 { wanted } else { 0 })
    );

    // The same pictures, taken by cameras at the same places that look away.
    let away: Vec<PyramidLevel> = nearest()
        .iter()
        .map(|level| {
            let centre = level.camera.centre;
            PyramidLevel { camera: pinhole(centre, centre * 2.0, SIZE, 170.0), ..(*level).clone() }
        })
        .collect();
    let mut neighbours: Vec<&PyramidLevel> = away.iter().collect();
    let map = depths(&neighbours, &range, &search);
    assert!(map.depth.iter().all(|&depth| depth == 0.0), "no view shows the surface");
    neighbours.extend(nearest());
    let map = depths(&neighbours, &range, &search);
    assert!(map.depth == expected.depth && map.fidelity == expected.fidelity && map.sigma == expected.sigma);
}

//! Solids are signed distances, with evenly distributed surface points.

use glam::DVec3;
use std::collections::BTreeMap;
use studio::{
    Solid, Subject,
    material::Material,
    noise::Random,
    part::{Part, Pose, Shape},
    polygonise::polygonise,
    score,
};

const ALL: [Subject; 6] =
    [Subject::Sphere, Subject::Box, Subject::Torus, Subject::TwoBodies, Subject::Plate, Subject::Figure];
const EXACT: [Subject; 5] = [Subject::Sphere, Subject::Box, Subject::Torus, Subject::TwoBodies, Subject::Plate];

/// A random point in a ball slightly larger than the bounding ball.
fn around(solid: &Solid, random: &mut Random) -> DVec3 {
    let (centre, radius) = solid.ball();
    centre + DVec3::new(random.signed(), random.signed(), random.signed()) * radius * 1.2
}

/// Sphere tracing is correct only for functions with slope at most 1.
#[test]
fn slope_is_at_most_one() {
    for subject in ALL {
        let solid = subject.at(0.3);
        let mut random = Random::new(1, 0);
        for i in 0..20_000 {
            // Half of the pairs are near the surface, where folds and blends are.
            let a = if i % 2 == 0 { around(&solid, &mut random) } else { near_surface(&solid, &mut random) };
            let step = [1e-4, 3e-3, 3e-2, 0.3][i / 2 % 4] * random.uniform();
            let b = a + random.direction() * step;
            let change = solid.bound(a, solid.all()) - solid.bound(b, solid.all());
            assert!(change.abs() <= step * (1.0 + 1e-9) + 1e-12, "{subject:?}: {change} over {step} at {a}");
        }
    }
}

fn near_surface(solid: &Solid, random: &mut Random) -> DVec3 {
    let mut p = around(solid, random);
    for _ in 0..8 {
        p -= solid.normal(p) * solid.bound(p, solid.all());
    }
    p + random.direction() * 0.01
}

/// The distance equals that to the nearest of many surface points, up to their spacing.
#[test]
fn distances_are_exact() {
    for subject in EXACT {
        let solid = subject.at(0.0);
        let surface = solid.surface_points(20_000, 3);
        let mut random = Random::new(2, 0);
        for _ in 0..200 {
            let p = around(&solid, &mut random);
            let nearest = surface.iter().map(|(s, _)| (*s - p).length()).fold(f64::MAX, f64::min);
            let distance = solid.distance(p).abs();
            assert!(distance <= nearest + 1e-9, "{subject:?}: {distance} beyond {nearest}");
            assert!(
                nearest <= libm::sqrt(distance * distance + 0.03 * 0.03) + 0.03,
                "{subject:?}: {distance}, {nearest}"
            );
        }
    }
    let sphere = Subject::Sphere.at(0.0);
    let p = DVec3::new(0.3, -0.9, 1.4);
    assert_eq!(sphere.distance(p), (p - DVec3::new(0.0, 0.0, 0.9)).length() - 0.45);
}

/// A millimetre along the normal changes the distance by a millimetre, even for the figure.
#[test]
fn distances_near_the_figure_are_right_to_first_order() {
    let solid = Subject::Figure.at(0.2);
    let mut misses: Vec<f64> = Vec::new();
    for (p, n) in solid.surface_points(2000, 1) {
        assert!(solid.distance(p).abs() < 1e-6);
        for h in [-1e-3, 1e-3] {
            misses.push((solid.distance(p + n * h) - h).abs());
        }
    }
    misses.sort_by(f64::total_cmp);
    assert!(misses[misses.len() * 95 / 100] < 0.05e-3, "{}", misses[misses.len() * 95 / 100]);
}

/// The inner half of a torus has π R - 2 r of 2 π R parts of its area.
#[test]
fn surface_points_are_even() {
    let torus = Shape::Torus { major: 0.4, minor: 0.2 };
    let solid = Solid::new(vec![Part::new(torus, Pose::at(DVec3::ZERO), Material::Stone)]);
    let points = solid.surface_points(40_000, 5);
    let inner = points.iter().filter(|(p, _)| p.x * p.x + p.y * p.y < 0.16).count() as f64 / 40_000.0;
    let expected = 0.5 - 0.2 / (core::f64::consts::PI * 0.4);
    assert!((inner - expected).abs() < 0.01, "{inner}, not {expected}");
    assert_eq!(points, solid.surface_points(40_000, 5));
}

/// Colours move with the body.
#[test]
fn texture_moves_with_its_part() {
    let frames = [0.1, 0.9].map(|time| Pose::at(DVec3::new(time, 2.0 * time, 0.5)));
    let [a, b] = frames.map(|frame| Part::new(Shape::Ball { radius: 0.2 }, frame, Material::Print));
    let mut different = 0;
    for i in 0..50 {
        let p = DVec3::new(0.004 * f64::from(i), 0.1, 0.05);
        let (u, v) = (a.colour(frames[0].to_world(p)), b.colour(frames[1].to_world(p)));
        (0..3).for_each(|c| assert!((u[c] - v[c]).abs() < 1e-9));
        different += usize::from(a.colour(p) != u);
    }
    assert!(different > 40);
}

/// The figure has the height of a person, stands on the floor at all times, moves, and is one closed body.
#[test]
fn the_figure_is_a_person() {
    let mut before: Option<Vec<(DVec3, DVec3)>> = None;
    for time in [0.0, 0.4, 1.1] {
        let solid = Subject::Figure.at(time);
        let points = solid.surface_points(3000, 0);
        let low = points.iter().map(|(p, _)| p.z).fold(f64::MAX, f64::min);
        let high = points.iter().map(|(p, _)| p.z).fold(f64::MIN, f64::max);
        assert!((-0.005..0.02).contains(&low), "{low}");
        assert!((1.6..1.8).contains(&high), "{high}");
        if let Some(before) = before.replace(points) {
            let moved = before.iter().filter(|(p, _)| solid.distance(*p).abs() > 0.02).count();
            assert!(moved > 300, "{moved}");
        }
    }
    let mesh = polygonise(&Subject::Figure.at(0.0), 0.008);
    assert_closed(&mesh.faces);
    let mut root: Vec<u32> = (0..mesh.vertices.len() as u32).collect();
    let find = |root: &[u32], mut v: u32| {
        while root[v as usize] != v {
            v = root[v as usize];
        }
        v
    };
    for [a, b, c] in &mesh.faces {
        for (v, w) in [(a, b), (a, c)] {
            let (v, w) = (find(&root, *v), find(&root, *w));
            root[v.max(w) as usize] = v.min(w);
        }
    }
    let bodies = (0..root.len()).filter(|&v| root[v] as usize == v).count();
    assert_eq!(bodies, 1);
}

fn assert_closed(faces: &[[u32; 3]]) {
    let mut edges: BTreeMap<(u32, u32), u32> = BTreeMap::new();
    for [a, b, c] in faces {
        for edge in [(*a, *b), (*b, *c), (*c, *a)] {
            *edges.entry(edge).or_default() += 1;
        }
    }
    assert!(edges.iter().all(|((a, b), n)| *n == 1 && edges.get(&(*b, *a)) == Some(&1)));
}

/// A fine mesh of the truth has no error, and one that is grown by 6 mm has an error of 6 mm.
#[test]
fn scores_are_right() {
    for subject in [Subject::Sphere, Subject::Torus, Subject::Figure] {
        let solid = subject.at(0.0);
        let mut mesh = polygonise(&solid, 0.012);
        assert_closed(&mesh.faces);
        let exact = score::accuracy(&solid, &mesh, 0.9, 4000);
        assert!(exact < 0.0012, "{subject:?}: {exact}");
        let cameras = studio::Ring::default().cameras();
        let seen = score::seen(&solid, &cameras, 2, 1500);
        assert!(seen.len() > 1000, "{subject:?}: {}", seen.len());
        assert!(score::completeness(&seen, &mesh, 0.003) > 0.99);

        for v in &mut mesh.vertices {
            *v += solid.normal(*v) * 0.006;
        }
        let grown = score::accuracy(&solid, &mesh, 0.5, 4000);
        assert!((grown - 0.006).abs() < 0.0005, "{subject:?}: {grown}");
        assert!(score::completeness(&seen, &mesh, 0.003) < 0.15);
    }
}

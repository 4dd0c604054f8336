use super::{
    adjacency::{NONE, adjacency},
    area, area_of, bake,
    cells::Cells,
    charts::{LEAST_FACING, charts},
    normals, pack, spread, unfold,
    unfold::Unfolded,
};
use crate::{
    point_cloud::Mesh,
    testing::{both, cuboid, law, sphere, torus},
};
use alloc::{vec, vec::Vec};
use glam::{Vec2, Vec3};
use proptest::prelude::*;

const SIZE: u32 = 256;

struct Atlas {
    charts: Vec<Unfolded>,
    packed: pack::Packed,
}

fn atlas(mesh: &Mesh) -> Atlas {
    let normals: Vec<Vec3> = normals(mesh).collect();
    let neighbours = adjacency(mesh);
    let texel = 1.0 / pack::expected_scale(area_of(&normals), SIZE);
    let charts = unfold::unfold(mesh, charts(&normals, &neighbours), &neighbours, texel);
    let packed = pack::pack(&charts, SIZE, || Ok(())).expect("nothing cancels it").expect("the charts fit");
    Atlas { charts, packed }
}

/// A bar that winds upwards around the z axis one and a half times: seen from above it covers itself.
fn helix() -> Mesh {
    let mut mesh = Mesh::default();
    let steps = 90u32;
    for i in 0..=steps {
        let turn = i as f32 / steps as f32 * 1.5 * core::f32::consts::TAU;
        let (sin, cos, low) = (libm::sinf(turn), libm::cosf(turn), 0.15 * turn);
        for (r, z) in [(0.9, low), (1.1, low), (1.1, low + 0.3), (0.9, low + 0.3)] {
            mesh.positions.push(Vec3::new(r * cos, r * sin, z));
        }
    }
    for i in 0..steps {
        for k in 0..4 {
            let (a, b) = (4 * i + k, 4 * i + (k + 1) % 4);
            mesh.triangles.extend([[a, b + 4, b], [a, a + 4, b + 4]]);
        }
    }
    let last = 4 * steps;
    mesh.triangles.extend([[0, 1, 2], [0, 2, 3]]);
    mesh.triangles.extend([[last, last + 2, last + 1], [last, last + 3, last + 2]]);
    mesh
}

fn bodies() -> Vec<(&'static str, Mesh)> {
    vec![
        ("sphere", sphere(Vec3::ZERO, 1.0)),
        ("torus", torus(1.0, 0.4)),
        ("box", cuboid(Vec3::ZERO, Vec3::new(1.0, 2.0, 0.05))),
        ("two spheres", both(sphere(Vec3::ZERO, 1.0), &sphere(Vec3::new(3.0, 0.0, 0.0), 0.3))),
        ("helix", helix()),
    ]
}

#[test]
fn every_triangle_has_one_place_and_covers_no_other() {
    for (name, mesh) in bodies() {
        let Atlas { charts, packed } = atlas(&mesh);
        let mut times = vec![0; mesh.triangles.len()];
        let mut owner: Vec<Option<usize>> = vec![None; (SIZE * SIZE) as usize];
        for (c, chart) in charts.iter().enumerate() {
            for (i, &t) in chart.triangles.iter().enumerate() {
                times[t as usize] += 1;
                let Some(cells) = Cells::new(bake::corners(chart, &packed, c, i)) else { continue };
                cells.for_each(|cell| {
                    let inside = |v: i32| (0..SIZE as i32).contains(&v);
                    assert!(inside(cell.x) && inside(cell.y), "{name}: outside of the texture");
                    let owner = &mut owner[(cell.y * SIZE as i32 + cell.x) as usize];
                    assert_eq!(*owner, None, "{name}: covered twice");
                    *owner = Some(c);
                });
            }
        }
        assert!(times.iter().all(|&n| n == 1), "{name}");
        // Interpolation at a chart's border reads the next texel, which belongs to no other chart.
        let size = SIZE as usize;
        for i in (0..size * size - size - 1).filter(|i| i % size + 1 < size) {
            for next in [i + 1, i + size, i + size + 1] {
                if let (Some(a), Some(b)) = (owner[i], owner[next]) {
                    assert_eq!(a, b, "{name}: charts touch");
                }
            }
        }
    }
}

#[test]
fn charts_stretch_little_and_keep_their_side() {
    for (name, mesh) in bodies() {
        let Atlas { charts, .. } = atlas(&mesh);
        for chart in &charts {
            for (i, &t) in chart.triangles.iter().enumerate() {
                let normal = area(mesh.triangles[t as usize].map(|v| mesh.positions[v as usize]));
                let [a, b, c] = chart.corners[i];
                // Counter-clockwise as seen from outside.
                let flat = (b - a).perp_dot(c - a) * 0.5;
                assert!(flat >= 0.99 * LEAST_FACING * normal.length(), "{name}: {flat} of {}", normal.length());
            }
        }
        assert!(charts.len() < mesh.triangles.len() / 6 + 7, "{name}: {} charts", charts.len());
    }
}

#[test]
fn a_steep_triangle_does_not_take_the_label_of_its_neighbours() {
    let chart_count = |x: f32| {
        let z = libm::sqrtf(1.0 - x * x);
        let normals = [Vec3::new(x, 0.0, z), Vec3::Z, Vec3::Z, Vec3::Z];
        let neighbours = [[1, 2, 3], [0, NONE, NONE], [0, NONE, NONE], [0, NONE, NONE]];
        charts(&normals, &neighbours).len()
    };
    // All neighbours face upwards. The triangle joins them if that stretches it by less than the bound.
    assert_eq!(chart_count(0.9), 1);
    // It leaves them, and then they touch no longer.
    assert_eq!(chart_count(0.95), 4);
}

#[test]
fn a_square_texture_is_filled_well() {
    let Atlas { charts, packed } = atlas(&sphere(Vec3::ZERO, 1.0));
    let covered: f32 = charts.iter().flat_map(|c| &c.corners).map(|[a, b, c]| (*b - *a).perp_dot(*c - *a) * 0.5).sum();
    let share = covered * packed.scale * packed.scale / (SIZE * SIZE) as f32;
    assert!(share > 0.5, "{share}");
}

#[test]
fn neighbours_share_an_edge() {
    let mesh = torus(1.0, 0.4);
    let neighbours = adjacency(&mesh);
    for (t, around) in neighbours.iter().enumerate() {
        for k in 0..3 {
            assert_ne!(around[k], NONE);
            let edge = [mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]];
            assert!(edge.iter().all(|v| mesh.triangles[around[k] as usize].contains(v)));
            assert!(neighbours[around[k] as usize].contains(&(t as u32)));
        }
    }
    let open = Mesh { triangles: mesh.triangles[..1].to_vec(), ..mesh };
    assert_eq!(adjacency(&open), [[NONE; 3]]);
}

#[test]
fn spreading_keeps_what_is_known_and_leaves_no_gap() {
    let mut texels = vec![None; 33 * 33];
    texels[5 * 33 + 7] = Some([10, 200, 30]);
    texels[30 * 33 + 1] = Some([90, 0, 30]);
    let filled = spread::spread(&texels, 33);
    for (i, known) in texels.iter().enumerate().filter_map(|(i, t)| t.map(|t| (i, t))) {
        assert_eq!(filled[i * 3..][..3], known);
    }
    // Every colour lies between the known ones, and those next to a known texel are its own.
    assert!(filled.chunks(3).all(|c| (10..=90).contains(&c[0]) && c[1] <= 200 && c[2] == 30));
    assert_eq!(filled[(5 * 33 + 8) * 3..][..3], [10, 200, 30]);
    assert!(spread::spread(&[None; 16], 4).iter().all(|&v| v == 0));
    // Two charts with a gap between them: each texel takes the colour of the chart that it is next to.
    let row = |i: usize| match i % 8 {
        0..=3 => Some([200, 0, 0]),
        6.. => Some([0, 0, 200]),
        _ => None,
    };
    let filled = spread::spread(&(0..64).map(row).collect::<Vec<_>>(), 8);
    assert_eq!((&filled[4 * 3..][..3], &filled[5 * 3..][..3]), (&[200, 0, 0][..], &[0, 0, 200][..]));
}

proptest! {
    #![proptest_config(law(200))]

    /// A texel whose centre lies in a quadrilateral belongs to exactly one of the two triangles that it is cut into, also
    /// if the centre lies on the cut.
    #[test]
    fn a_common_edge_belongs_to_one_triangle(
        // Whole numbers put many centres on edges.
        p in prop::array::uniform8(0i32..24),
    ) {
        let [a, b, c, d] = [0, 2, 4, 6].map(|i| Vec2::new(p[i] as f32 * 0.5, p[i + 1] as f32 * 0.5));
        // b and d on different sides of the cut from a to c.
        let (left, right) = ((c - a).perp_dot(b - a), (c - a).perp_dot(d - a));
        prop_assume!(left * right < 0.0);
        let mut times = vec![0; 16 * 16];
        for corners in [[a, b, c], [c, d, a]] {
            let cells = Cells::new(corners).expect("it has an area");
            cells.for_each(|cell| times[(cell.y * 16 + cell.x) as usize] += 1);
        }
        let inside = |p: Vec2, t: [Vec2; 3]| {
            let turns = [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])].map(|(q, r)| (r - q).perp_dot(p - q));
            turns.iter().all(|&v| v > 0.0) || turns.iter().all(|&v| v < 0.0)
        };
        for (i, &n) in times.iter().enumerate() {
            let centre = Vec2::new((i % 16) as f32, (i / 16) as f32);
            let on_cut = (c - a).perp_dot(centre - a) == 0.0
                && (centre - a).dot(c - a) > 0.0 && (centre - c).dot(a - c) > 0.0;
            if on_cut || inside(centre, [a, b, c]) || inside(centre, [c, d, a]) {
                prop_assert_eq!(n, 1, "{}", centre);
            }
            prop_assert!(n <= 1);
        }
    }
}

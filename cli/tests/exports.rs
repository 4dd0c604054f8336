//! Other libraries read the GLB and PLY files.

use glam::{DVec3, Vec3};
use pcmvs_core::{
    Mesh, Point, Rank,
    export::{bounds, glb, ply},
};

/// A tetrahedron, its vertices repeated until there are at least `vertices` of them.
fn mesh(vertices: usize) -> Mesh {
    let corners =
        [Vec3::new(1.0, 1.0, 1.0), Vec3::new(-1.0, -1.0, 1.0), Vec3::new(-1.0, 1.0, -1.0), Vec3::new(1.0, -1.0, -1.0)];
    let mut mesh = Mesh::default();
    while mesh.positions.len() < vertices {
        let i = mesh.positions.len() as u32;
        mesh.triangles.extend([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]].map(|t| t.map(|c: u32| i + c)));
        mesh.positions.extend(corners.map(|c| c * 0.1 + i as f32 * 1e-4));
        mesh.normals.extend(corners.map(Vec3::normalize));
        mesh.colours.extend([[255, 0, 0], [0, 128, 0], [10, 20, 30], [0, 0, 0]]);
    }
    mesh
}

const ORIGIN: DVec3 = DVec3::new(0.5, -2.25, 10.0);
/// Surveyors' coordinates in metres.
const FAR: DVec3 = DVec3::new(448_291.537, 5_411_932.18, 113.06);

#[test]
fn gltf_reads_back_what_was_written() {
    for vertices in [4, 65_532, 65_536] {
        let mesh = mesh(vertices);
        let bytes = glb::write(&mesh, ORIGIN, &glb::Options { up: Some([0.0, 0.0, 1.0]), ..Default::default() });
        let gltf::Gltf { document, blob } = gltf::Gltf::from_slice(&bytes).unwrap();
        let primitive = document.meshes().next().unwrap().primitives().next().unwrap();
        assert!(primitive.material().unlit());
        let reader = primitive.reader(|_| blob.as_deref());

        let positions: Vec<[f32; 3]> = reader.read_positions().unwrap().collect();
        assert_eq!(positions.len(), mesh.positions.len());
        for (read, &given) in positions.iter().zip(&mesh.positions) {
            assert_eq!(*read, (ORIGIN + given.as_dvec3()).as_vec3().to_array());
        }
        let [low, high] = bounds(&mesh, ORIGIN).unwrap();
        let single = |corner: [f64; 3]| corner.map(|v| v as f32);
        let (low, high) = (single(low), single(high));
        assert_eq!(primitive.bounding_box(), gltf::mesh::BoundingBox { min: low, max: high });
        assert!(document.nodes().all(|node| node.transform().decomposed().0 == [0.0; 3]));
        for axis in 0..3 {
            assert_eq!(low[axis], positions.iter().map(|p| p[axis]).fold(f32::INFINITY, f32::min));
            assert_eq!(high[axis], positions.iter().map(|p| p[axis]).fold(f32::NEG_INFINITY, f32::max));
        }
        assert_eq!(reader.read_normals().unwrap().count(), mesh.normals.len());

        let indices = primitive.indices().unwrap();
        let small = mesh.positions.len() < 65_536;
        let expected = if small { gltf::accessor::DataType::U16 } else { gltf::accessor::DataType::U32 };
        assert_eq!(indices.data_type(), expected);
        let read: Vec<u32> = reader.read_indices().unwrap().into_u32().collect();
        assert_eq!(read, mesh.triangles.concat());
    }
}

#[test]
fn colours_are_linear_and_come_back_as_the_same_srgb() {
    let mut all = mesh(256);
    for (code, colour) in all.colours.iter_mut().enumerate() {
        *colour = [code as u8; 3];
    }
    let bytes = glb::write(&all, DVec3::ZERO, &glb::Options::default());
    let gltf::Gltf { document, blob } = gltf::Gltf::from_slice(&bytes).unwrap();
    let primitive = document.meshes().next().unwrap().primitives().next().unwrap();
    let reader = primitive.reader(|_| blob.as_deref());
    let linear: Vec<[f32; 3]> = reader.read_colors(0).unwrap().into_rgb_f32().collect();
    assert_eq!((linear[0], linear[255]), ([0.0; 3], [1.0; 3]));
    for (code, &[value, ..]) in linear.iter().enumerate() {
        let srgb = if value <= 0.003_130_8 { 12.92 * value } else { 1.055 * value.powf(1.0 / 2.4) - 0.055 };
        assert!((srgb * 255.0 - code as f32).abs() < 0.01, "{code}");
    }
}

#[test]
fn a_mesh_without_colours_or_faces_is_a_valid_file_too() {
    let plain = Mesh { colours: Vec::new(), ..mesh(4) };
    let bytes = glb::write(&plain, DVec3::ZERO, &glb::Options { normals: false, ..Default::default() });
    let document = gltf::Gltf::from_slice(&bytes).unwrap().document;
    let primitive = document.meshes().next().unwrap().primitives().next().unwrap();
    assert_eq!(primitive.attributes().count(), 1);
    let empty = glb::write(&Mesh::default(), DVec3::ZERO, &glb::Options::default());
    assert_eq!(gltf::Gltf::from_slice(&empty).unwrap().meshes().count(), 0);
}

/// Splits a PLY file into the lines of its header and its body.
fn split(ply: &[u8]) -> (Vec<String>, &[u8]) {
    let end = ply.windows(11).position(|w| w == b"end_header\n").unwrap() + 11;
    let header = String::from_utf8(ply[..end].to_vec()).unwrap();
    (header.lines().map(str::to_owned).collect(), &ply[end..])
}

#[test]
fn ply_of_a_mesh_holds_vertices_and_faces_in_order() {
    let mesh = mesh(4);
    let bytes = ply::write_mesh(&mesh, ORIGIN);
    let (header, body) = split(&bytes);
    assert!(header.contains(&"element vertex 4".to_owned()) && header.contains(&"element face 4".to_owned()));
    assert_eq!(body.len(), 4 * (24 + 3) + 4 * 13);
    let x = f32::from_le_bytes(body[27..31].try_into().unwrap());
    assert_eq!(x, (ORIGIN + mesh.positions[1].as_dvec3()).x as f32);
    assert_eq!(body[24..27], mesh.colours[0]);
    let face = &body[4 * 27 + 13..4 * 27 + 26];
    assert_eq!(face[0], 3);
    let corners: Vec<u32> = face[1..].chunks(4).map(|c| u32::from_le_bytes(c.try_into().unwrap())).collect();
    assert_eq!(corners, mesh.triangles[1]);
}

#[test]
fn ply_of_a_cloud_holds_every_field() {
    let point = Point {
        position: Vec3::new(1.0, 2.0, 3.0),
        normal: Vec3::Z,
        fidelity: 2.5,
        sigma: 0.5,
        weight: 0.75,
        view: 7,
        rank: Rank::Frontier,
    };
    let bytes = ply::write_cloud(&vec![point, Point { view: Point::NO_VIEW, rank: Rank::Implicit, ..point }], ORIGIN);
    let (header, body) = split(&bytes);
    let properties = header.iter().filter_map(|line| line.strip_prefix("property ")).collect::<Vec<_>>();
    assert_eq!(properties[6..], ["float fidelity", "float sigma", "float weight", "ushort view", "uchar rank"]);
    assert_eq!(body.len(), 2 * 39);
    let number = |i: usize| f32::from_le_bytes(body[4 * i..4 * i + 4].try_into().unwrap());
    let numbers: Vec<f32> = (0..9).map(number).collect();
    assert_eq!(numbers, [1.5, -0.25, 13.0, 0.0, 0.0, 1.0, 2.5, 0.5, 0.75]);
    assert_eq!(body[36..39], [7, 0, 3]);
    assert_eq!(body[75..78], [255, 255, 0]);
}

/// Far from the scene's origin, the step between single-precision numbers is 0.5 m here.
#[test]
fn far_from_the_origin_positions_are_exact() {
    const TOLERANCE: f64 = 1e-7;
    let mesh = mesh(4);
    let exact = |i: usize| FAR + mesh.positions[i].as_dvec3();

    let bytes = glb::write(&mesh, FAR, &glb::Options::default());
    let gltf::Gltf { document, blob } = gltf::Gltf::from_slice(&bytes).unwrap();
    let (translation, ..) = document.nodes().next().unwrap().transform().decomposed();
    let translation = DVec3::from_array(translation.map(f64::from));
    assert!((translation - FAR).abs().max_element() < 0.5);
    let primitive = document.meshes().next().unwrap().primitives().next().unwrap();
    let reader = primitive.reader(|_| blob.as_deref());
    for (i, read) in reader.read_positions().unwrap().enumerate() {
        let found = translation + DVec3::from_array(read.map(f64::from));
        assert!((found - exact(i)).abs().max_element() < TOLERANCE, "{found} instead of {}", exact(i));
    }

    let bytes = ply::write_mesh(&mesh, FAR);
    let (header, body) = split(&bytes);
    assert!(header.contains(&"property double x".to_owned()) && header.contains(&"property float nx".to_owned()));
    assert_eq!(body.len(), 4 * (36 + 3) + 4 * 13);
    let [low, high] = bounds(&mesh, FAR).unwrap().map(DVec3::from_array);
    for i in 0..4 {
        let number = |axis: usize| f64::from_le_bytes(body[39 * i + 8 * axis..][..8].try_into().unwrap());
        let found = DVec3::from_array(std::array::from_fn(number));
        assert!((found - exact(i)).abs().max_element() < TOLERANCE, "{found} instead of {}", exact(i));
        assert!(found.cmpge(low).all() && found.cmple(high).all());
    }
    assert!((high - low - DVec3::splat(0.2)).abs().max_element() < 1e-6, "{low} to {high}");

    let cloud = vec![Point {
        position: mesh.positions[0],
        normal: Vec3::Z,
        fidelity: 1.0,
        sigma: 0.5,
        weight: 1.0,
        view: 0,
        rank: Rank::Detected,
    }];
    assert!(split(&ply::write_cloud(&cloud, FAR)).0.contains(&"property double z".to_owned()));
    assert!(split(&ply::write_cloud(&Vec::new(), FAR)).0.contains(&"property float z".to_owned()));
}

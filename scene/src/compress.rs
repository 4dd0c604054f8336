//! Compression of meshes by meshoptimizer (EXT_meshopt_compression), for the command line and Python.

use pcmvs_core::{Form, export::glb::Compress};

/// The algorithms of meshoptimizer.
#[derive(Debug, Clone, Copy)]
pub struct Meshopt;

/// Version of the format that EXT_meshopt_compression has.
const VERTEX_FORMAT: i32 = 0;
/// The format's version 0 has a single level.
const LEVEL: i32 = 2;

impl Compress for Meshopt {
    fn attributes(&self, bytes: &[u8], stride: usize) -> Vec<u8> {
        match stride {
            4 => encode::<4>(bytes),
            8 => encode::<8>(bytes),
            12 => encode::<12>(bytes),
            _ => unreachable!("the core writes attributes of 4, 8 or 12 bytes"),
        }
    }

    fn triangles(&self, triangles: &[[u32; 3]], vertices: usize) -> Vec<u8> {
        meshopt::encode_index_buffer(triangles.as_flattened(), vertices)
            .expect("the buffer has the size that it asked for")
    }
}

fn encode<const STRIDE: usize>(bytes: &[u8]) -> Vec<u8> {
    let (vertices, _) = bytes.as_chunks::<STRIDE>();
    meshopt::encode_vertex_buffer_level(vertices, LEVEL, Some(VERTEX_FORMAT))
        .expect("the buffer has the size that it asked for")
}

/// Sorts triangles so that neighbours follow each other, and vertices in the order in which they are used first. Compression
/// and drawing need that. Returns the sorted form.
pub fn sort(form: Form) -> Form {
    let corners = meshopt::optimize_vertex_cache_strip(form.mesh.triangles.as_flattened(), form.mesh.positions.len());
    let places = meshopt::optimize_vertex_fetch_remap(&corners, form.mesh.positions.len());
    let triangles = corners.as_chunks::<3>().0.iter().map(|t| t.map(|v| places[v as usize])).collect();
    form.reordered(&places, triangles)
}

//! Compression by the encoder of the npm package meshoptimizer, which the page or program passes in.

use crate::error::Failed;
use js_sys::{Array, Uint8Array, Uint32Array};
use pcmvs_core::{Form, export::glb::Compress};
use std::cell::RefCell;
use wasm_bindgen::prelude::*;

#[wasm_bindgen(typescript_custom_section)]
const TYPES: &str = r#"
/** `MeshoptEncoder` of the npm package `meshoptimizer`, once its `ready` has resolved. */
export interface MeshoptEncoder {
    reorderMesh(indices: Uint32Array, triangles: boolean, optsize: boolean): [Uint32Array, number];
    encodeVertexBufferLevel(source: Uint8Array, count: number, size: number, level: number, version?: number): Uint8Array;
    encodeIndexBuffer(source: Uint8Array, count: number, size: number): Uint8Array;
}
"#;

#[wasm_bindgen]
extern "C" {
    /// `MeshoptEncoder`.
    #[wasm_bindgen(typescript_type = "MeshoptEncoder")]
    pub type MeshoptEncoder;
    #[wasm_bindgen(method, catch, js_name = reorderMesh)]
    fn reorder_mesh(
        this: &MeshoptEncoder,
        indices: &Uint32Array,
        triangles: bool,
        optsize: bool,
    ) -> Result<Array, JsValue>;
    #[wasm_bindgen(method, catch, js_name = encodeVertexBufferLevel)]
    fn encode_vertex_buffer_level(
        this: &MeshoptEncoder,
        source: &Uint8Array,
        count: usize,
        size: usize,
        level: u32,
        version: u32,
    ) -> Result<Uint8Array, JsValue>;
    #[wasm_bindgen(method, catch, js_name = encodeIndexBuffer)]
    fn encode_index_buffer(
        this: &MeshoptEncoder,
        source: &Uint8Array,
        count: usize,
        size: usize,
    ) -> Result<Uint8Array, JsValue>;
}

/// Version of the format that EXT_meshopt_compression has.
const VERTEX_FORMAT: u32 = 0;
/// As the command line has it. The format's version 0 has a single level.
const LEVEL: u32 = 2;

/// The encoder, and what it threw.
pub struct Meshopt<'a> {
    encoder: &'a MeshoptEncoder,
    thrown: RefCell<Option<JsValue>>,
}

impl<'a> Meshopt<'a> {
    pub fn new(encoder: &'a MeshoptEncoder) -> Self {
        Self { encoder, thrown: RefCell::default() }
    }

    /// What was made with it, unless the encoder threw an error meanwhile.
    pub fn checked<T>(self, made: T) -> Result<T, Failed> {
        self.thrown.into_inner().map_or(Ok(made), |thrown| Err(thrown.into()))
    }

    /// Sorts triangles so that neighbours follow each other, and vertices in the order in which they are used first.
    /// Compression and drawing need that. Returns the sorted form.
    pub fn sort(&self, form: &Form) -> Result<Form, Failed> {
        let corners = Uint32Array::new_from_slice(form.mesh.triangles.as_flattened());
        let found = self.encoder.reorder_mesh(&corners, true, true)?;
        let places = found.get(0).dyn_into::<Uint32Array>().map(|places| places.to_vec());
        let places = places.map_err(|_| Failed::input("`compress` is not the MeshoptEncoder of meshoptimizer"))?;
        Ok(form.clone().reordered(&places, corners.to_vec().as_chunks::<3>().0.to_vec()))
    }

    fn kept(&self, made: Result<Uint8Array, JsValue>) -> Vec<u8> {
        made.map_or_else(
            |thrown| {
                self.thrown.borrow_mut().get_or_insert(thrown);
                Vec::new()
            },
            |bytes| bytes.to_vec(),
        )
    }
}

impl Compress for Meshopt<'_> {
    fn attributes(&self, bytes: &[u8], stride: usize) -> Vec<u8> {
        let (source, count) = (Uint8Array::new_from_slice(bytes), bytes.len() / stride);
        self.kept(self.encoder.encode_vertex_buffer_level(&source, count, stride, LEVEL, VERTEX_FORMAT))
    }

    fn triangles(&self, triangles: &[[u32; 3]], _: usize) -> Vec<u8> {
        let corners = Uint32Array::new_from_slice(triangles.as_flattened());
        let count = corners.length() as usize;
        self.kept(self.encoder.encode_index_buffer(&Uint8Array::new(&corners.buffer()), count, size_of::<u32>()))
    }
}

//! Compression by meshoptimizer, whose functions the host hands in, so that the library needs no C++.

use crate::{
    failure::{Failure, Result},
    status::pcmvs_status::{InvalidArgument, NullPointer},
};
use glam::DVec3;
use pcmvs_core::{
    Form,
    export::glb::{self, Compress},
};
use std::{
    cell::RefCell,
    ffi::{c_int, c_uchar, c_uint, c_void},
};

// C++ may throw an exception when memory is out. With "C-unwind" that ends the process instead of being undefined.
pub(crate) type OptimizeVertexCacheStrip =
    unsafe extern "C-unwind" fn(*mut c_uint, *const c_uint, index_count: usize, vertex_count: usize);
pub(crate) type OptimizeVertexFetchRemap =
    unsafe extern "C-unwind" fn(*mut c_uint, *const c_uint, index_count: usize, vertex_count: usize) -> usize;
pub(crate) type EncodeBound = unsafe extern "C-unwind" fn(count: usize, of: usize) -> usize;
pub(crate) type EncodeVertexBufferLevel = unsafe extern "C-unwind" fn(
    *mut c_uchar,
    buffer_size: usize,
    *const c_void,
    vertex_count: usize,
    vertex_size: usize,
    level: c_int,
    version: c_int,
) -> usize;
pub(crate) type EncodeIndexBuffer =
    unsafe extern "C-unwind" fn(*mut c_uchar, buffer_size: usize, *const c_uint, index_count: usize) -> usize;

/// Version of the vertices' format that EXT_meshopt_compression has, and the first byte of its data.
const VERTEX_FORMAT: (c_int, u8) = (0, 0xA0);
/// As the command line has it. The format's version 0 has a single level.
const LEVEL: c_int = 2;
/// The first byte of triangles, which says the version of their format.
const TRIANGLE_FORMAT: u8 = 0xE1;

/// The functions of meshoptimizer, and the first failure of one of them.
pub(crate) struct Meshopt {
    cache_strip: OptimizeVertexCacheStrip,
    fetch_remap: OptimizeVertexFetchRemap,
    vertex_bound: EncodeBound,
    vertices: EncodeVertexBufferLevel,
    index_bound: EncodeBound,
    triangles: EncodeIndexBuffer,
    failure: RefCell<Option<Failure>>,
}

impl Meshopt {
    /// With the functions of options; `None` if there are none.
    pub fn new(
        cache_strip: Option<OptimizeVertexCacheStrip>,
        fetch_remap: Option<OptimizeVertexFetchRemap>,
        vertex_bound: Option<EncodeBound>,
        vertices: Option<EncodeVertexBufferLevel>,
        index_bound: Option<EncodeBound>,
        triangles: Option<EncodeIndexBuffer>,
    ) -> Result<Option<Self>> {
        let given = [
            ("meshopt_optimizeVertexCacheStrip", cache_strip.is_some()),
            ("meshopt_optimizeVertexFetchRemap", fetch_remap.is_some()),
            ("meshopt_encodeVertexBufferBound", vertex_bound.is_some()),
            ("meshopt_encodeVertexBufferLevel", vertices.is_some()),
            ("meshopt_encodeIndexBufferBound", index_bound.is_some()),
            ("meshopt_encodeIndexBuffer", triangles.is_some()),
        ];
        if given.iter().all(|(_, is_given)| !is_given) {
            return Ok(None);
        }
        let all = (|| {
            Some(Self {
                cache_strip: cache_strip?,
                fetch_remap: fetch_remap?,
                vertex_bound: vertex_bound?,
                vertices: vertices?,
                index_bound: index_bound?,
                triangles: triangles?,
                failure: RefCell::default(),
            })
        })();
        let missing = || {
            let missing: Vec<&str> = given.iter().filter(|(_, is_given)| !is_given).map(|&(name, _)| name).collect();
            let missing = missing.join(", ");
            Failure::new(
                NullPointer,
                format!("{missing}: NULL, but compression needs all six functions of meshoptimizer"),
            )
        };
        all.map(Some).ok_or_else(missing)
    }

    /// Sorts triangles so that neighbours follow each other, and vertices in the order in which they are used first.
    /// Compression and drawing need that. Returns the sorted form.
    fn sort(&self, form: Form) -> Result<Form> {
        let vertices = form.mesh.positions.len();
        let before = form.mesh.triangles.as_flattened();
        if before.is_empty() {
            return Ok(form);
        }
        // What a function leaves out is recognised by a number that no vertex has.
        let mut corners = vec![u32::MAX; before.len()];
        let mut places = vec![u32::MAX; vertices];
        // SAFETY: both arrays have as many numbers as meshoptimizer's functions write, and what they read is valid for them.
        // The numbers of vertices are checked before they are passed on.
        unsafe {
            (self.cache_strip)(corners.as_mut_ptr(), before.as_ptr(), before.len(), vertices);
            if corners.iter().any(|&corner| corner as usize >= vertices) {
                return Err(strange("meshopt_optimizeVertexCacheStrip", "numbers of vertices that do not exist"));
            }
            (self.fetch_remap)(places.as_mut_ptr(), corners.as_ptr(), corners.len(), vertices);
        }
        check_places(&places, &corners)?;
        let triangles = corners.as_chunks::<3>().0.iter().map(|t| t.map(|v| places[v as usize])).collect();
        Ok(form.reordered(&places, triangles))
    }

    /// A form as a compressed GLB file.
    pub fn compressed(self, form: Form, origin: DVec3, options: &glb::Options) -> Result<Vec<u8>> {
        let file = glb::write_form(&self.sort(form)?, origin, options, Some(&self));
        self.failure.into_inner().map_or(Ok(file), Err)
    }

    /// Has data encoded in a buffer of `bound` bytes. `raw` is the size of the data, and the result begins with `format`.
    /// After a failure nothing more is encoded.
    fn encoded(
        &self,
        names: [&str; 2],
        raw: usize,
        format: u8,
        bound: impl FnOnce() -> usize,
        encode: impl FnOnce(&mut [u8]) -> usize,
    ) -> Vec<u8> {
        if self.failure.borrow().is_some() {
            return Vec::new();
        }
        let [bounding, encoding] = names;
        let made = || {
            let bound = bound();
            // meshoptimizer's bounds are below twice the data and some kilobytes. More would be another function's number.
            if bound > 4 * raw + (64 << 10) {
                return Err(strange(bounding, &format!("{bound} bytes for {raw} bytes of data")));
            }
            let mut buffer = vec![0; bound];
            let size = encode(&mut buffer);
            if size == 0 || size > bound {
                return Err(strange(encoding, &format!("{size} bytes in a buffer of {bound}")));
            }
            buffer.truncate(size);
            if buffer[0] != format {
                let why = format!("data of another version (0x{:02x} instead of 0x{format:02x})", buffer[0]);
                return Err(strange(encoding, &why));
            }
            Ok(buffer)
        };
        made().unwrap_or_else(|failure| {
            *self.failure.borrow_mut() = Some(failure);
            Vec::new()
        })
    }
}

/// Checks that vertices have places of their own without gaps, and those of triangles have one.
fn check_places(places: &[u32], corners: &[u32]) -> Result<()> {
    let used = places.iter().filter(|&&place| place != u32::MAX).count();
    let mut taken = vec![false; used];
    let mut take = |place: u32| taken.get_mut(place as usize).is_some_and(|taken| !std::mem::replace(taken, true));
    let are_places = places.iter().filter(|&&place| place != u32::MAX).all(|&place| take(place));
    if !are_places || corners.iter().any(|&corner| places[corner as usize] == u32::MAX) {
        return Err(strange("meshopt_optimizeVertexFetchRemap", "places that are not an order of the vertices"));
    }
    Ok(())
}

fn strange(function: &str, gave: &str) -> Failure {
    let problem = format!("{function} gave {gave}: set it to the function of that name of meshoptimizer 1.0 or later");
    Failure::new(InvalidArgument, problem)
}

impl Compress for Meshopt {
    fn attributes(&self, bytes: &[u8], stride: usize) -> Vec<u8> {
        let (count, (version, format)) = (bytes.len() / stride, VERTEX_FORMAT);
        let names = ["meshopt_encodeVertexBufferBound", "meshopt_encodeVertexBufferLevel"];
        // SAFETY: the function only computes.
        let bound = || unsafe { (self.vertex_bound)(count, stride) };
        let encode = |buffer: &mut [u8]| {
            let (to, size, from) = (buffer.as_mut_ptr(), buffer.len(), bytes.as_ptr().cast());
            // SAFETY: `size` bytes are writable, and `count` vertices are readable.
            unsafe { (self.vertices)(to, size, from, count, stride, LEVEL, version) }
        };
        self.encoded(names, bytes.len(), format, bound, encode)
    }

    fn triangles(&self, triangles: &[[u32; 3]], vertices: usize) -> Vec<u8> {
        let corners = triangles.as_flattened();
        let names = ["meshopt_encodeIndexBufferBound", "meshopt_encodeIndexBuffer"];
        // SAFETY: the function only computes.
        let bound = || unsafe { (self.index_bound)(corners.len(), vertices) };
        let encode = |buffer: &mut [u8]| {
            // SAFETY: the buffer's bytes are writable, and the corners are readable.
            unsafe { (self.triangles)(buffer.as_mut_ptr(), buffer.len(), corners.as_ptr(), corners.len()) }
        };
        self.encoded(names, size_of_val(corners), TRIANGLE_FORMAT, bound, encode)
    }
}

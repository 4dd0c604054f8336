//! Binary glTF 2.0 (GLB) with one unlit mesh, with the colours of its vertices or with a texture.

mod attribute;
mod attributes;
mod calm;
mod colours;
mod compress;
mod container;
mod layout;
mod node;
mod picture;

use super::{Frame, local_bounds};
use crate::{frame::Form, point_cloud::Mesh};
use alloc::{format, string::String, vec, vec::Vec};
use attribute::Attribute;
pub use compress::Compress;
use container::container;
use glam::DVec3;
use layout::Layout;
use node::Placement;
use picture::Picture;

/// Optional content of a GLB, besides positions, colours and triangles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Whether to write normals. The unlit material does not need them, but hosts that light the mesh do.
    pub normals: bool,
    /// The scene's upward direction. The file states it as `scenes[0].extras.up`, in its own frame.
    pub up: Option<[f64; 3]>,
    /// Turns the mesh's node by [`Options::rotation`], so that the object stands upright in every player. Without it the file is in the
    /// scene's frame, for tools that work there.
    pub upright: bool,
    /// Writes integers of few bits instead of single-precision numbers (KHR_mesh_quantization). Coordinates are within
    /// 1/32,000 of the object's size, and closer in fine meshes, or within 1/10,000 where two vertices would meet. Colours are within one sRGB code.
    pub compact: bool,
    /// Quality of a texture's JPEG picture, 1 to 100.
    pub jpeg_quality: u8,
}

impl Default for Options {
    fn default() -> Self {
        Self { normals: true, up: None, upright: false, compact: false, jpeg_quality: 90 }
    }
}

impl Options {
    /// Says what is wrong with the upward direction, if it is set, and what to do. A direction of no length would turn nothing.
    pub fn check_up(&self) -> Result<(), &'static str> {
        self.up.map_or(Ok(()), node::check_up)
    }

    /// The upward direction in the frame of the file.
    pub fn up_in_file(&self) -> Option<[f64; 3]> {
        self.up.map(|up| if self.upright { [0.0, 1.0, 0.0] } else { up })
    }

    /// The rotation, as a quaternion x, y, z, w, that turns the frame of the scene to that of the file: `up` becomes +y, which
    /// is upwards in glTF. `None` if they are the same.
    pub fn rotation(&self) -> Option<[f64; 4]> {
        let up = self.up.filter(|_| self.upright)?;
        node::upright(DVec3::from_array(up)).map(|rotation| rotation.to_array().map(|v| v + 0.0))
    }
}

/// Writes a mesh as the bytes of a GLB file.
///
/// Positions are in the scene's frame (`origin` is [`crate::Rig::origin`]). Those of an object far from the scene's origin
/// are relative to the translation of the mesh's node. Colours are linear and in single precision.
/// Indices have 16 bits if that is sufficient. A mesh without triangles gives a valid file without a scene.
pub fn write(mesh: &Mesh, origin: DVec3, options: &Options) -> Vec<u8> {
    file(mesh, None, origin, options, None)
}

/// Writes a form of a mesh as the bytes of a GLB file, as [`write()`] does. A texture is a JPEG picture in the file. With a
/// compressor, readers need EXT_meshopt_compression.
pub fn write_form(form: &Form, origin: DVec3, options: &Options, compress: Option<&dyn Compress>) -> Vec<u8> {
    let picture = form.texture.as_ref().map(|texture| Picture::new(texture, options.jpeg_quality));
    file(&form.mesh, picture.as_ref(), origin, options, compress)
}

fn file(
    mesh: &Mesh,
    picture: Option<&Picture>,
    origin: DVec3,
    options: &Options,
    compress: Option<&dyn Compress>,
) -> Vec<u8> {
    let asset = concat!(r#""asset":{"version":"2.0","generator":"pcmvs "#, env!("CARGO_PKG_VERSION"), r#""}"#);
    let frame = Frame::of_mesh(mesh, origin);
    let bounds = match local_bounds(mesh, frame) {
        Some(bounds) if !mesh.triangles.is_empty() => bounds,
        _ => return container(format!("{{{asset}}}"), Vec::new()),
    };
    let mut layout = Layout::new(compress);
    let (primitive, placement) = put_mesh(&mut layout, mesh, picture, frame, bounds, options);
    let (base, pictures) = match picture {
        Some(picture) => {
            let view = layout.put_picture(&picture.jpeg);
            (r#""baseColorTexture":{"index":0},"#, Picture::json(view))
        }
        None => ("", String::new()),
    };
    let extras =
        options.up_in_file().map_or_else(String::new, |[x, y, z]| format!(r#","extras":{{"up":[{x},{y},{z}]}}"#));
    let json = format!(
        concat!(
            r#"{{{asset},{extensions},"#,
            r#""scene":0,"scenes":[{{"nodes":[0]{extras}}}],"nodes":[{{"mesh":0{node}}}],"#,
            r#""meshes":[{{"primitives":[{{{primitive}}}]}}],"#,
            r#""materials":[{{"pbrMetallicRoughness":{{{base}"metallicFactor":0,"roughnessFactor":1}},"#,
            r#""extensions":{{"KHR_materials_unlit":{{}}}}}}],{pictures}"#,
            r#""accessors":[{accessors}],"bufferViews":[{views}],"buffers":[{buffers}]}}"#
        ),
        asset = asset,
        extensions = extensions(options.compact, compress.is_some()),
        extras = extras,
        node = node::json(placement, options.rotation()),
        primitive = primitive,
        base = base,
        pictures = pictures,
        accessors = layout.accessors.join(","),
        views = layout.views.join(","),
        buffers = layout.buffers(),
    );
    container(json, layout.binary)
}

/// Adds the attributes and triangles of a mesh. Returns the JSON of its primitive, and where its node must put it.
fn put_mesh(
    layout: &mut Layout,
    mesh: &Mesh,
    picture: Option<&Picture>,
    frame: Frame,
    bounds: [[f32; 3]; 2],
    options: &Options,
) -> (String, Placement) {
    let count = mesh.positions.len();
    let (positions, placement) = if options.compact {
        let (positions, scale, low) = attributes::compact_positions(mesh, frame, bounds);
        (positions, Placement { scale, offset: frame.translation + low })
    } else {
        (attributes::positions(mesh, frame, bounds), Placement { scale: 1.0, offset: frame.translation })
    };
    let mut found = vec![("POSITION", positions)];
    let of = |plain: fn(&Mesh) -> Attribute, compact: fn(&Mesh) -> Attribute| {
        if options.compact { compact(mesh) } else { plain(mesh) }
    };
    if options.normals && mesh.normals.len() == count {
        found.push(("NORMAL", of(attributes::normals, attributes::compact_normals)));
    }
    if let Some(picture) = picture {
        let make = if options.compact { attributes::compact_uvs } else { attributes::uvs };
        found.push(("TEXCOORD_0", make(picture.uvs)));
    } else if mesh.colours.len() == count {
        let compact = if layout.is_compressed() { colours::compressed_colours } else { attributes::compact_colours };
        found.push(("COLOR_0", of(attributes::colours, compact)));
    }
    let named = |(name, attribute): &(&str, Attribute)| {
        let accessor = layout.put_attribute(attribute, count);
        format!(r#""{name}":{accessor}"#)
    };
    let attributes = found.iter().map(named).collect::<Vec<_>>().join(",");
    let triangles = layout.put_triangles(&mesh.triangles, count);
    (format!(r#""attributes":{{{attributes}}},"indices":{triangles},"material":0"#), placement)
}

/// The JSON of the extensions that a file uses, and of those that readers must have.
fn extensions(compact: bool, compressed: bool) -> String {
    let needed = [(compact, r#""KHR_mesh_quantization""#), (compressed, r#""EXT_meshopt_compression""#)];
    let needed = needed.into_iter().filter_map(|(is_used, name)| is_used.then_some(name)).collect::<Vec<_>>().join(",");
    if needed.is_empty() {
        r#""extensionsUsed":["KHR_materials_unlit"]"#.into()
    } else {
        format!(r#""extensionsUsed":["KHR_materials_unlit",{needed}],"extensionsRequired":[{needed}]"#)
    }
}

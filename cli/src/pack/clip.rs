//! The clip under construction: the frames' files joined, and what is equal in them stored once.

use super::{
    binary::Binary,
    document::{
        Accessor, Asset, BufferView, Document, Image, Material, Mesh, Node, NodeExtensions, Raw, Scene, Texture,
        Visibility, raw,
    },
    flipbook::{Flipbook, FrameNodes},
    frame_file::FrameFile,
    shared::Shared,
};
use pcmvs_core::glam::DVec3;
use pcmvs_scene::Failure;

/// Bytes of a frame's file that go to the clip's file.
pub struct Piece {
    /// Place in the frame's binary chunk.
    pub source: u64,
    pub length: u64,
    /// Place in the clip's binary chunk.
    pub target: u64,
}

/// A clip to which frames are added.
#[derive(Default)]
pub struct Clip {
    /// What all frames have in common.
    common: Option<Common>,
    nodes: Vec<Node>,
    frames: Vec<FrameNodes>,
    meshes: Shared<Mesh>,
    materials: Shared<Material>,
    textures: Shared<Texture>,
    images: Shared<Image>,
    samplers: Shared<Raw>,
    accessors: Shared<Accessor>,
    binary: Binary,
}

/// What must be the same in all frames of a clip.
struct Common {
    /// The first frame's file, for messages.
    file: String,
    form: String,
    asset: Asset,
    /// Those of the scene.
    extras: Option<Raw>,
    extensions_used: Vec<String>,
    extensions_required: Vec<String>,
}

/// What is left to write when all frames are added.
pub struct Packed {
    pub json: Vec<u8>,
    /// Bytes that come after those of the frames, with their places in the binary chunk.
    pub bytes: Vec<(u64, Vec<u8>)>,
    /// Size of the binary chunk.
    pub binary: u64,
}

impl Clip {
    /// Adds a frame under a name. Returns the bytes that its file contributes.
    pub fn add(&mut self, name: String, file: &FrameFile) -> Result<Vec<Piece>, Failure> {
        let frame = file.document()?;
        self.check(&frame, file)?;
        let middle = file.middle(&frame)?;
        let new = |table: &[u32], old: u32| file.item(table, old).copied();

        let mut pieces = Vec::new();
        let views = each(frame.buffer_views, |view| self.add_view(view, file, &mut pieces))?;
        let accessors = each(frame.accessors, |mut accessor| {
            accessor.buffer_view = new(&views, accessor.buffer_view)?;
            Ok(self.accessors.add(accessor))
        })?;
        let images = each(frame.images, |mut image| {
            image.buffer_view = new(&views, image.buffer_view)?;
            Ok(self.images.add(image))
        })?;
        let samplers = each(frame.samplers, |sampler| Ok(self.samplers.add(sampler)))?;
        let textures = each(frame.textures, |texture| {
            let (sampler, source) = (new(&samplers, texture.sampler)?, new(&images, texture.source)?);
            Ok(self.textures.add(Texture { sampler, source }))
        })?;
        let materials = each(frame.materials, |mut material| {
            if let Some(texture) = &mut material.pbr_metallic_roughness.base_color_texture {
                texture.index = new(&textures, texture.index)?;
            }
            Ok(self.materials.add(material))
        })?;
        let meshes = each(frame.meshes, |mut mesh| {
            for primitive in &mut mesh.primitives {
                for accessor in primitive.attributes.values_mut() {
                    *accessor = new(&accessors, *accessor)?;
                }
                primitive.indices = new(&accessors, primitive.indices)?;
                primitive.material = new(&materials, primitive.material)?;
            }
            Ok(self.meshes.add(mesh))
        })?;
        for mut node in frame.nodes {
            node.mesh = node.mesh.map(|mesh| new(&meshes, mesh)).transpose()?;
            self.add_nodes(name.clone(), middle, node);
        }
        Ok(pieces)
    }

    /// Adds the node of a frame's file, above it one that takes back the translation of the next, and the node that is scaled.
    /// The middle of the mesh is the centre of scaling, so that a hidden frame shrinks to a point within its own box, and the
    /// box around the scene contains all frames' places and nothing else.
    fn add_nodes(&mut self, name: String, middle: DVec3, own: Node) {
        let scaled = self.nodes.len() as u32;
        let translation = |v: DVec3| (v != DVec3::ZERO).then(|| raw(&(v + 0.0).to_array()));
        // Players that do not play the animation show the first frame.
        let scale = (!self.frames.is_empty()).then(|| raw(&[0; 3]));
        let (name, children) = (Some(name), vec![scaled + 1]);
        self.nodes.push(Node { name, children, translation: translation(middle), scale, ..Node::default() });
        self.nodes.push(Node { children: vec![scaled + 2], translation: translation(-middle), ..Node::default() });
        self.nodes.push(own);
        self.frames.push(FrameNodes { scaled, own: scaled + 2 });
    }

    fn add_view(&mut self, view: BufferView, file: &FrameFile, pieces: &mut Vec<Piece>) -> Result<u32, Failure> {
        let (buffer, source, length) = match &view.extensions {
            None => (view.buffer, view.byte_offset, view.byte_length),
            Some(extensions) => {
                let compressed = &extensions.compressed;
                (compressed.buffer, compressed.byte_offset, compressed.byte_length)
            }
        };
        // Compressed views are decompressed into the second buffer.
        let is_as_written = buffer == 0 && view.buffer == u32::from(view.extensions.is_some());
        if !is_as_written || view.byte_length > u64::from(u32::MAX) {
            return Err(file.damaged("the bytes of a buffer view are not in the file"));
        }
        let (index, target) = self.binary.add(view, file.bytes(source, length)?);
        pieces.extend(target.map(|target| Piece { source, length, target }));
        Ok(index)
    }

    /// Refuses a frame of another version or form than the first one.
    fn check(&mut self, frame: &Document, file: &FrameFile) -> Result<(), Failure> {
        let name = file.path().display().to_string();
        let form = form(frame);
        match &self.common {
            Some(common) if common.form == form => Ok(()),
            Some(common) => Err(Failure::Input(format!(
                "{name}: is of another version or form ({form}) than {} ({}): run `pcmvs reconstruct` for all frames with \
                 the same version and options",
                common.file, common.form
            ))),
            None => {
                self.common = Some(Common {
                    file: name,
                    form,
                    asset: frame.asset.clone(),
                    extras: frame.scenes.iter().find_map(|scene| scene.extras.clone()),
                    extensions_used: frame.extensions_used.clone(),
                    extensions_required: frame.extensions_required.clone(),
                });
                Ok(())
            }
        }
    }

    /// Adds the root and the animation. With `visibility`, frames are shown and hidden by KHR_node_visibility besides.
    pub fn finish(mut self, fps: f64, visibility: bool) -> Packed {
        let common = self.common.expect("a clip has frames");
        let mut flipbook = Flipbook { binary: &mut self.binary, accessors: &mut self.accessors, bytes: Vec::new() };
        let animation = flipbook.animation(&self.frames, fps, visibility);
        let bytes = flipbook.bytes;
        let mut extensions_used = common.extensions_used;
        if visibility {
            extensions_used.extend(["KHR_node_visibility", "KHR_animation_pointer"].map(str::to_owned));
            for (i, frame) in self.frames.iter().enumerate() {
                let visibility = Visibility { visible: i == 0 };
                self.nodes[frame.own as usize].extensions = Some(NodeExtensions { visibility });
            }
        }
        let root = self.nodes.len() as u32;
        let children = self.frames.iter().map(|frame| frame.scaled).collect();
        self.nodes.push(Node { name: Some("clip".to_owned()), children, ..Node::default() });
        let binary = self.binary.size();
        let (buffers, buffer_views) = self.binary.into_parts();
        let document = Document {
            asset: common.asset,
            extensions_used,
            extensions_required: common.extensions_required,
            scene: 0,
            scenes: vec![Scene { nodes: vec![root], extras: common.extras }],
            nodes: self.nodes,
            meshes: self.meshes.into_items(),
            materials: self.materials.into_items(),
            textures: self.textures.into_items(),
            images: self.images.into_items(),
            samplers: self.samplers.into_items(),
            accessors: self.accessors.into_items(),
            buffer_views,
            buffers,
            animations: vec![animation],
        };
        let mut json = serde_json::to_vec(&document).expect("the document has names as keys and finite numbers");
        json.resize(json.len().next_multiple_of(4), b' ');
        Packed { json, bytes, binary }
    }
}

/// Adds each item of a list, and returns the new indices.
fn each<T>(items: Vec<T>, add: impl FnMut(T) -> Result<u32, Failure>) -> Result<Vec<u32>, Failure> {
    items.into_iter().map(add).collect()
}

/// What distinguishes the files of different versions, forms and frames of reference.
fn form(frame: &Document) -> String {
    let primitives = frame.meshes.iter().flat_map(|mesh| &mesh.primitives);
    let attributes = primitives.flat_map(|primitive| primitive.attributes.keys().cloned());
    let extras = frame.scenes.iter().filter_map(|scene| scene.extras.as_ref().map(ToString::to_string));
    let parts = [frame.asset.generator.clone()].into_iter().chain(attributes);
    parts.chain(frame.extensions_used.iter().cloned()).chain(extras).collect::<Vec<_>>().join(" ")
}

//! The JSON of GLB files, with the members that pcmvs writes. Reading refuses all others, so that packing cannot lose any.

use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;
use std::collections::BTreeMap;

/// What packing passes on as it is. Numbers keep all their digits.
pub type Raw = Box<RawValue>;

/// The JSON of a file.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Document {
    pub asset: Asset,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub extensions_used: Vec<String>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub extensions_required: Vec<String>,
    pub scene: u32,
    pub scenes: Vec<Scene>,
    pub nodes: Vec<Node>,
    pub meshes: Vec<Mesh>,
    pub materials: Vec<Material>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub textures: Vec<Texture>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub images: Vec<Image>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub samplers: Vec<Raw>,
    pub accessors: Vec<Accessor>,
    pub buffer_views: Vec<BufferView>,
    pub buffers: Vec<Buffer>,
    #[serde(skip_deserializing)]
    pub animations: Vec<Animation>,
}

#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Asset {
    pub version: String,
    pub generator: String,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    pub nodes: Vec<u32>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub extras: Option<Raw>,
}

#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Node {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mesh: Option<u32>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub children: Vec<u32>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub translation: Option<Raw>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rotation: Option<Raw>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<Raw>,
    #[serde(skip_deserializing, skip_serializing_if = "Option::is_none")]
    pub extensions: Option<NodeExtensions>,
}

#[derive(Debug, Serialize)]
pub struct NodeExtensions {
    #[serde(rename = "KHR_node_visibility")]
    pub visibility: Visibility,
}

#[derive(Debug, Serialize)]
pub struct Visibility {
    pub visible: bool,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Mesh {
    pub primitives: Vec<Primitive>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Primitive {
    pub attributes: BTreeMap<String, u32>,
    pub indices: u32,
    pub material: u32,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Material {
    pub pbr_metallic_roughness: MetallicRoughness,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub extensions: Option<Raw>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct MetallicRoughness {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub base_color_texture: Option<TextureOfMaterial>,
    pub metallic_factor: Raw,
    pub roughness_factor: Raw,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TextureOfMaterial {
    pub index: u32,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Texture {
    pub sampler: u32,
    pub source: u32,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Image {
    pub buffer_view: u32,
    pub mime_type: String,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Accessor {
    pub buffer_view: u32,
    #[serde(default, skip_serializing_if = "is_zero")]
    pub byte_offset: u64,
    pub component_type: u32,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub normalized: Option<bool>,
    pub count: u64,
    #[serde(rename = "type")]
    pub kind: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub min: Option<Raw>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max: Option<Raw>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct BufferView {
    pub buffer: u32,
    #[serde(default)]
    pub byte_offset: u64,
    pub byte_length: u64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub byte_stride: Option<u32>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub target: Option<u32>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub extensions: Option<ViewExtensions>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ViewExtensions {
    #[serde(rename = "EXT_meshopt_compression")]
    pub compressed: Compressed,
}

/// Where the compressed bytes of a buffer view are, and how they are compressed.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Compressed {
    pub buffer: u32,
    pub byte_offset: u64,
    pub byte_length: u64,
    pub byte_stride: u32,
    pub count: u64,
    pub mode: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub filter: Option<String>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "camelCase", deny_unknown_fields)]
pub struct Buffer {
    pub byte_length: u64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub extensions: Option<Raw>,
}

#[derive(Debug, Serialize)]
pub struct Animation {
    pub name: &'static str,
    pub channels: Vec<Channel>,
    pub samplers: Vec<Sampler>,
}

#[derive(Debug, Serialize)]
pub struct Channel {
    pub sampler: u32,
    pub target: Target,
}

#[derive(Debug, Serialize)]
pub struct Target {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub node: Option<u32>,
    pub path: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub extensions: Option<TargetExtensions>,
}

#[derive(Debug, Serialize)]
pub struct TargetExtensions {
    #[serde(rename = "KHR_animation_pointer")]
    pub pointer: Pointer,
}

#[derive(Debug, Serialize)]
pub struct Pointer {
    pub pointer: String,
}

#[derive(Debug, Serialize)]
pub struct Sampler {
    pub input: u32,
    pub output: u32,
    pub interpolation: &'static str,
}

/// A value as JSON that is passed on as it is.
pub fn raw(value: &impl Serialize) -> Raw {
    serde_json::value::to_raw_value(value).expect("numbers and names are JSON")
}

fn is_zero(offset: &u64) -> bool {
    *offset == 0
}

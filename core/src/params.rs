//! Every parameter of the method, in one struct with four presets.
//!
//! The paper's Table 2 (its parameter values) is lost. The values here were found by measurement over scenes with
//! ground truth, one set for all of them (BENCHMARKS.md). Lengths are in L = V^(1/3), V the volume of the hull's
//! bounding box, or in pixels of footprint (depth / focal length), never in scene units.

/// All parameters of a reconstruction.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Params {
    /// Which steps run.
    pub method: Method,
    /// Visual hull (§0).
    pub hull: HullParams,
    /// Meshing (§6).
    pub meshing: MeshingParams,
    /// Colours (§7).
    pub colour: ColourParams,
}

/// Which result is made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Method {
    /// The visual hull's own mesh, the baseline.
    Hull,
    /// The whole of PCMVS.
    Pcmvs,
}

/// Visual hull (§0).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HullParams {
    /// Distance of the grid's nodes in pixels of footprint at the object.
    pub voxel_pixels: f32,
}

/// Meshing (§6).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshingParams {
    /// Distance of the grid's nodes in pixels of footprint at the object.
    pub voxel_pixels: f32,
    /// Weight of the screening term: how closely the surface follows the points rather than their normals.
    /// Zero is the unscreened solver of the paper.
    pub screening: f32,
    /// Envelope constraint (Dirichlet zero outside the hull) instead of the paper's rectify-and-rerun (§6.2).
    pub envelope: bool,
    /// The space constraint of §6.2 in either form; off only for ablation.
    pub space_constraint: bool,
    /// Components with less than this share of the largest one's volume are dropped.
    pub smallest_component: f32,
}

/// Colours (§7).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ColourParams {
    /// Solve one gain per camera and channel from overlapping views.
    pub gains: bool,
    /// Blend this many of the best views; 1 is the paper's choice.
    pub blended_views: u32,
}

/// Names of the presets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum Preset {
    /// What measures best.
    Default = 0,
    /// The paper's method, §4 to §6 as printed.
    Paper = 1,
    /// The visual hull.
    Hull = 2,
    /// Seconds in a browser.
    Preview = 3,
}

impl Params {
    /// The parameters of a preset.
    pub fn preset(preset: Preset) -> Self {
        let default = Self {
            method: Method::Pcmvs,
            hull: HullParams { voxel_pixels: 1.5 },
            meshing: MeshingParams {
                voxel_pixels: 1.25,
                screening: 4.0,
                envelope: true,
                space_constraint: true,
                smallest_component: 0.01,
            },
            colour: ColourParams { gains: true, blended_views: 1 },
        };
        match preset {
            Preset::Default => default,
            Preset::Hull => Self { method: Method::Hull, ..default },
            Preset::Paper => Self {
                meshing: MeshingParams { screening: 0.0, envelope: false, ..default.meshing },
                colour: ColourParams { gains: false, blended_views: 1 },
                ..default
            },
            Preset::Preview => Self {
                hull: HullParams { voxel_pixels: 2.5 },
                meshing: MeshingParams { voxel_pixels: 2.5, ..default.meshing },
                ..default
            },
        }
    }
}

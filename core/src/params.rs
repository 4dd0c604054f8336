//! Every parameter of the method, in one struct with four presets.
//!
//! The paper's Table 2 (its parameter values) is lost. The values here were found by measurement over scenes with
//! ground truth, one set for all of them (BENCHMARKS.md). Lengths are in L = V^(1/3), V the volume of the hull's
//! bounding box, or in pixels of footprint (depth / focal length), never in scene units.

use crate::{
    detect::{CleanParams, FrontierParams, SearchParams, VoteParams},
    merge::{ConflictParams, DownsampleParams},
};

/// All parameters of a reconstruction.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
#[non_exhaustive]
pub struct Params {
    /// Which steps run.
    pub method: Method,
    /// Visual hull (§0).
    pub hull: HullParams,
    /// A first, coarse search whose mesh guides the second; none searches the hull at once, as the paper does.
    pub coarse: Option<CoarseParams>,
    /// Point cloud detection (§4).
    pub detection: DetectionParams,
    /// Frontier points (§4.4), if they are used.
    pub frontier: Option<FrontierParams>,
    /// Implicit points (§4.4), if they are used.
    pub implicit: bool,
    /// Merging (§5).
    pub merging: MergingParams,
    /// Meshing (§6).
    pub meshing: MeshingParams,
    /// Colours (§7).
    pub colour: ColourParams,
    /// Most bytes that a frame may need ([`crate::memory`]); one that needs more fails before it takes them.
    pub max_memory: Option<u64>,
}

/// Which result is made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize))]
#[non_exhaustive]
pub enum Method {
    /// The visual hull's own mesh, the baseline.
    Hull,
    /// The whole of PCMVS.
    Pcmvs,
}

/// Visual hull (§0).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
pub struct HullParams {
    /// Distance of the grid's nodes in pixels of footprint at the object.
    pub voxel_pixels: f32,
}

/// A pass of detection and meshing whose result guides the next.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
pub struct CoarseParams {
    /// How it detects.
    pub detection: DetectionParams,
    /// Distance of its mesh's grid nodes in pixels of footprint.
    pub voxel_pixels: f32,
}

/// Point cloud detection (§4).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
pub struct DetectionParams {
    /// In pictures of half the resolution.
    pub halved: bool,
    /// §4.1.
    pub search: SearchParams,
    /// How far round a guiding mesh the search runs, in pixels of footprint along the ray.
    pub band_pixels: f32,
    /// §4.2: below this share of the number of neighbours stereo has failed.
    pub substitute_below: f32,
    /// §4.2: whether a point of the guide (the hull) then takes its place.
    pub substitute: bool,
    /// Weight of such a point in meshing.
    pub substituted_weight: f32,
    /// §4.3.
    pub clean: CleanParams,
}

/// Merging (§5).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
pub struct MergingParams {
    /// §5.1, if it runs.
    pub downsample: Option<DownsampleParams>,
    /// §5.2, if it runs.
    pub conflicts: Option<ConflictParams>,
    /// Weight in meshing of a frontier point whose contact is certain.
    pub frontier_weight: f32,
    /// Weight in meshing of an implicit point.
    pub implicit_weight: f32,
    /// Points weigh as much as they are trusted (eq. 3, §6.1); off, only for ablation, all weigh the same.
    pub fidelity_weights: bool,
}

/// Meshing (§6).
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
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
#[cfg_attr(feature = "serde", derive(serde::Deserialize), serde(deny_unknown_fields))]
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
        let clean = CleanParams { radius_pixels: 4.0, density: 0.5, flatness: 0.5, facing: 0.3 };
        let vote = VoteParams { smoothing: 0.0, local_maximum: true, spread: 1.0, agreement_radius: 2 };
        let search =
            SearchParams { neighbours: 4, window_radius: 2, step_pixels: 0.7, follow_guide: true, vote, refine: true };
        let detection = DetectionParams {
            halved: false,
            search: SearchParams { neighbours: 3, ..search },
            band_pixels: 6.0,
            substitute_below: 0.25,
            substitute: true,
            substituted_weight: 0.3,
            clean,
        };
        let coarse = CoarseParams {
            detection: DetectionParams {
                halved: true,
                search: SearchParams {
                    window_radius: 3,
                    step_pixels: 0.6,
                    vote: VoteParams { agreement_radius: 0, ..vote },
                    ..search
                },
                clean: CleanParams { radius_pixels: 2.5, ..clean },
                ..detection
            },
            voxel_pixels: 4.0,
        };
        let default = Self {
            method: Method::Pcmvs,
            hull: HullParams { voxel_pixels: 1.5 },
            coarse: Some(coarse),
            detection,
            frontier: Some(FrontierParams { longest_pixels: 40.0 }),
            implicit: true,
            merging: MergingParams {
                downsample: None,
                conflicts: None,
                frontier_weight: 16.0,
                implicit_weight: 0.1,
                fidelity_weights: true,
            },
            meshing: MeshingParams {
                voxel_pixels: 1.5,
                screening: 2.2,
                envelope: true,
                space_constraint: true,
                smallest_component: 0.01,
            },
            colour: ColourParams { gains: true, blended_views: 3 },
            max_memory: None,
        };
        match preset {
            Preset::Default => default,
            Preset::Hull => Self { method: Method::Hull, ..default },
            Preset::Paper => Self {
                coarse: None,
                detection: DetectionParams {
                    search: SearchParams {
                        window_radius: 3,
                        follow_guide: false,
                        refine: false,
                        vote: VoteParams { smoothing: 0.8, spread: 0.0, agreement_radius: 0, ..vote },
                        ..search
                    },
                    substituted_weight: 0.25,
                    ..detection
                },
                merging: MergingParams {
                    downsample: Some(DownsampleParams { radius_pixels: 1.0, normal_agreement: 0.5, keep_above: 0.8 }),
                    conflicts: Some(ConflictParams { distance_pixels: 10.0, virtual_views: 50 }),
                    ..default.merging
                },
                meshing: MeshingParams { screening: 0.0, envelope: false, ..default.meshing },
                colour: ColourParams { gains: false, blended_views: 1 },
                ..default
            },
            // The coarse pass alone.
            Preset::Preview => Self {
                hull: HullParams { voxel_pixels: 2.5 },
                coarse: None,
                detection: coarse.detection,
                meshing: MeshingParams { voxel_pixels: 2.5, ..default.meshing },
                ..default
            },
        }
    }
}

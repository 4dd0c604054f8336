//! All parameters of the method in one struct, with four presets. The parameter type of each stage is defined next to
//! that stage.
//!
//! The paper's Table 2, which lists its parameter values, is lost. The values here were found by measurement on scenes
//! with ground truth, with one set for all scenes (BENCHMARKS.md). Lengths are in pixels of footprint: the size of one
//! pixel at the object, which is depth / focal length. No length is in scene units.

use crate::{
    coarse::{CoarseParams, GapParams, SeenThroughParams},
    colour::{ColourParams, GainParams},
    contours::{Certainty, FrontierParams, ImplicitParams},
    detect::{CleanParams, DetectionParams, SearchParams, SubstitutionParams, Support, VoteParams, Windows},
    hull::{AgreementParams, HullParams},
    merge::{ConflictParams, DownsampleParams, MergingParams},
    mesh::{MeshingParams, SpaceConstraint, WeightParams},
    reading::ReadingParams,
    silhouette::ContourParams,
};

/// All parameters of a reconstruction. An optional step runs if its parameters are present.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[non_exhaustive]
pub struct Params {
    /// The kind of result.
    pub method: Method,
    /// Resolution at which pictures are read. The paper reads them as they are.
    pub reading: ReadingParams,
    /// Contours from the photographs (§0). Without it mattes are taken as they are given, as in the paper.
    pub contour: Option<ContourParams>,
    /// Visual hull (§0).
    pub hull: HullParams,
    /// Setting aside of silhouettes that contradict the others (§0). Without it all are believed, as in the paper.
    pub agreement: Option<AgreementParams>,
    /// A coarse pass whose mesh guides detection. Without it, detection searches the whole hull as in the paper.
    pub coarse: Option<CoarseParams>,
    /// Point cloud detection (§4).
    pub detection: DetectionParams,
    /// Frontier points (§4.4).
    pub frontier: Option<FrontierParams>,
    /// Implicit points (§4.4).
    pub implicit: Option<ImplicitParams>,
    /// Merging (§5).
    pub merging: MergingParams,
    /// Meshing (§6).
    pub meshing: MeshingParams,
    /// Colours (§7).
    pub colour: ColourParams,
}

/// The kind of result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Method {
    /// The mesh of the visual hull: the baseline.
    Hull,
    /// The full method.
    Pcmvs,
}

/// Names of the presets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u32)]
pub enum Preset {
    /// The parameters with the best measured results.
    Default = 0,
    /// The method of the paper, as printed in §4 to §6.
    Paper = 1,
    /// The visual hull alone.
    Hull = 2,
    /// A fast preview: takes seconds in a browser.
    Preview = 3,
}

impl Params {
    /// The parameters of a preset.
    pub fn preset(preset: Preset) -> Self {
        let clean = CleanParams { radius_pixels: 4.0, density: Some(0.5), flatness: Some(0.5), facing: None };
        let vote = VoteParams { smoothing: None, support: Support::SpreadPeaks(1.0), agreement_radius: Some(2) };
        let search = SearchParams {
            neighbours: 4,
            window_radius: 2,
            step_pixels: 0.7,
            windows: Windows::Slanted,
            vote,
            interpolate: true,
        };
        let detection = DetectionParams {
            octave: 0,
            search: SearchParams { neighbours: 3, ..search },
            band_pixels: 6.0,
            substitution: Some(SubstitutionParams { below: 0.2 }),
            clean,
        };
        // The coarse pass searches the whole hull, so that it needs more support than the search around its result.
        let coarse = CoarseParams {
            detection: DetectionParams {
                octave: 1,
                search: SearchParams {
                    window_radius: 3,
                    step_pixels: 0.6,
                    vote: VoteParams { agreement_radius: None, ..vote },
                    ..search
                },
                substitution: Some(SubstitutionParams { below: 0.35 }),
                clean: CleanParams { radius_pixels: 2.5, ..clean },
                ..detection
            },
            voxel_pixels: 4.0,
            seen_through: Some(SeenThroughParams { views: 2, distance_pixels: 6.0 }),
            gaps: Some(GapParams { smallest_pixels: 20, inside_pixels: 4 }),
        };
        let weights = WeightParams { frontier: 58.0, substituted: 0.2, implicit: 0.1 };
        let default = Self {
            method: Method::Pcmvs,
            reading: ReadingParams { octave: 0, blurred: Some(0.25) },
            contour: Some(ContourParams { reach_pixels: 4.5 }),
            hull: HullParams { voxel_pixels: 1.5 },
            agreement: Some(AgreementParams { blame: AgreementParams::BLAME, uncovered: 0.1, largest_share: 0.45 }),
            coarse: Some(coarse),
            detection,
            frontier: Some(FrontierParams { longest_pixels: 40.0, certainty: Certainty::Precision }),
            implicit: None,
            merging: MergingParams { downsample: None, conflicts: None },
            meshing: MeshingParams {
                voxel_pixels: 1.5,
                weights: Some(weights),
                screening: Some(0.4),
                calm: Some(0.15),
                even_passes: 2,
                space_constraint: Some(SpaceConstraint::Envelope),
                smallest_component: 0.01,
            },
            colour: ColourParams { gains: Some(GainParams { min_score: 0.5, prior: 1.0 }), blended_views: 3 },
        };
        match preset {
            Preset::Default => default,
            Preset::Hull => Self { method: Method::Hull, ..default },
            Preset::Paper => Self {
                reading: ReadingParams::FULL,
                contour: None,
                agreement: None,
                coarse: None,
                detection: DetectionParams {
                    search: SearchParams {
                        window_radius: 3,
                        windows: Windows::Upright,
                        interpolate: false,
                        vote: VoteParams { smoothing: Some(0.8), support: Support::Peaks, agreement_radius: None },
                        ..search
                    },
                    substitution: Some(SubstitutionParams { below: 0.25 }),
                    clean: CleanParams { facing: Some(0.3), ..clean },
                    ..detection
                },
                frontier: Some(FrontierParams { longest_pixels: 40.0, certainty: Certainty::Interval }),
                implicit: Some(ImplicitParams { contour_pixels: 1.5, hidden_pixels: 3.0 }),
                merging: MergingParams {
                    downsample: Some(DownsampleParams { radius_pixels: 1.0, normal_agreement: 0.5, keep_above: 0.8 }),
                    conflicts: Some(ConflictParams { distance_pixels: 10.0, virtual_views: 50 }),
                },
                meshing: MeshingParams {
                    weights: Some(WeightParams { frontier: 16.0, substituted: 0.25, ..weights }),
                    screening: None,
                    calm: None,
                    even_passes: 0,
                    space_constraint: Some(SpaceConstraint::Rectify),
                    ..default.meshing
                },
                colour: ColourParams { gains: None, blended_views: 1 },
                ..default
            },
            // The coarse pass as the only pass, of pictures at half the resolution.
            Preset::Preview => Self {
                reading: ReadingParams { octave: 1, ..default.reading },
                contour: Some(ContourParams { reach_pixels: 3.0 }),
                hull: HullParams { voxel_pixels: 1.6 },
                coarse: None,
                detection: DetectionParams {
                    octave: 0,
                    search: SearchParams {
                        step_pixels: 0.8,
                        neighbours: 3,
                        window_radius: 2,
                        ..coarse.detection.search
                    },
                    ..coarse.detection
                },
                meshing: MeshingParams { voxel_pixels: 1.5, ..default.meshing },
                ..default
            },
        }
    }
}

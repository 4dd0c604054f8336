//! Parameters of the motion between two frames.

use super::target::DEGREES;

/// Parameters of the motion between two frames. Lengths are in pixels of footprint, colours in grey levels.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct MotionParams {
    /// Distance of the nodes. Details that are smaller are averaged.
    pub node_pixels: f32,
    /// Motion below which a node is taken to be at rest, softly.
    pub rest_pixels: f32,
    /// How strongly nodes at rest are held: 1 is as strongly as the vertices around them pull.
    pub rest: f32,
    /// From coarse to fine.
    pub levels: [LevelParams; DEGREES],
}

/// Parameters of one level of the search.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct LevelParams {
    /// Largest distance between a vertex and its nearest vertex of the other mesh.
    pub search_pixels: f32,
    /// Every how many vertices one is laid onto the other mesh.
    pub stride: u32,
    /// Every how many vertices one of the other mesh is considered.
    pub target_stride: u32,
    /// A difference in colour of one grey level counts like this distance in the search.
    pub colour_pixels: f32,
    /// A difference in luma of one grey level counts like this distance from the tangent plane.
    pub luma_pixels: f32,
    /// How strongly adjacent nodes move alike: 1 is as strongly as the vertices around them pull.
    pub stiffness: f32,
    /// Number of iterations.
    pub iterations: u32,
}

impl MotionParams {
    /// The measured values.
    pub const DEFAULT: Self = Self {
        node_pixels: 16.0,
        rest_pixels: 0.12,
        rest: 4.0,
        levels: [
            LevelParams {
                search_pixels: 40.0,
                stride: 24,
                target_stride: 12,
                colour_pixels: 0.2,
                luma_pixels: 0.02,
                stiffness: 4.0,
                iterations: 8,
            },
            LevelParams {
                search_pixels: 12.0,
                stride: 12,
                target_stride: 4,
                colour_pixels: 0.1,
                luma_pixels: 0.03,
                stiffness: 1.0,
                iterations: 6,
            },
            LevelParams {
                search_pixels: 4.0,
                stride: 6,
                target_stride: 1,
                colour_pixels: 0.05,
                luma_pixels: 0.05,
                stiffness: 0.3,
                iterations: 4,
            },
        ],
    };
}

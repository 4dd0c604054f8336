//! The sketch: something to look at before all pictures are there.
//!
//! It is not one of the library's presets, because it is not a reconstruction of the frame: it uses the cameras whose
//! pictures have come so far, and its grid is so coarse that it takes a fraction of a second.

use crate::error::Failed;
use pcmvs_core::{Camera, Params, Preset, Rig, colour::ColourParams, hull::HullParams};

/// Voxel of the grid, in pixels of footprint.
const VOXEL_PIXELS: f32 = 4.0;

/// A coarse visual hull, coloured by one view per vertex.
pub fn params() -> Params {
    let mut params = Params::preset(Preset::Hull);
    // Mattes as they are: a sketch must be quick.
    params.contour = None;
    params.hull = HullParams { voxel_pixels: VOXEL_PIXELS };
    params.colour = ColourParams { gains: None, blended_views: 1 };
    params
}

/// The rig of some of a rig's cameras.
pub fn rig_of(rig: &Rig, cameras: &[usize]) -> Result<Rig, Failed> {
    let cameras: Vec<Camera> = cameras.iter().map(|&camera| rig.cameras()[camera]).collect();
    Rig::new(&cameras).map_err(|error| Failed::core(&error, None))
}

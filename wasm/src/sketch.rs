//! The sketch: something to look at before all pictures are there.
//!
//! It is not one of the library's presets, because it is not a reconstruction of the frame: it uses the cameras whose
//! pictures have come so far, and its grid is so coarse that it takes a fraction of a second.

use crate::{
    error::Failed,
    frame::Frame,
    reconstruction::{Reconstruction, run},
};
use pcmvs_core::{Camera, Params, Preset, Rig, ViewInput, colour::ColourParams, hull::HullParams};
use wasm_bindgen::prelude::*;

/// Voxel of the grid, in pixels of footprint.
const VOXEL_PIXELS: f32 = 4.0;

#[wasm_bindgen]
impl Frame {
    /// A coarse visual hull from the cameras that have their pictures so far, to be looked at early. Its only stage output
    /// is the hull, and it has neither warnings nor figures of views. Throws `PcmvsError`.
    pub fn sketch(&self) -> Result<Reconstruction, Failed> {
        let present: Vec<usize> = (0..self.rig().cameras().len()).filter(|&i| self.has_picture(i)).collect();
        let inputs: Vec<Option<ViewInput>> = present.iter().map(|&i| self.input(i)).collect::<Result<_, _>>()?;
        let made = rig_of(self.rig(), &present).and_then(|rig| run(&rig, &inputs, &params(), None));
        made.map(Reconstruction::without_findings).map_err(|failed| failed.of_cameras(&present))
    }
}

/// A coarse visual hull, coloured by one view per vertex.
fn params() -> Params {
    let mut params = Params::preset(Preset::Hull);
    // Mattes as they are: a sketch must be quick.
    params.contour = None;
    params.hull = HullParams { voxel_pixels: VOXEL_PIXELS };
    params.colour = ColourParams { gains: None, blended_views: 1 };
    params
}

/// The rig of some of a rig's cameras.
fn rig_of(rig: &Rig, cameras: &[usize]) -> Result<Rig, Failed> {
    let cameras: Vec<Camera> = cameras.iter().map(|&camera| rig.cameras()[camera]).collect();
    Rig::new(&cameras).map_err(|error| Failed::core(&error, None))
}

//! The stages of a reconstruction, as queries: a stage that the core gains appears here by itself.

use crate::{
    failure::{Failure, Result},
    status::pcmvs_status::InvalidArgument,
};
use pcmvs_core::{Stage, frame::ORDER};
use std::ffi::c_char;

/// Stages of a reconstruction. A stage keeps its number for ever, and the number does not say when the stage runs: ask
/// `pcmvs_stage_count` and `pcmvs_stage_at` for the order. A newer library may have stages that are not listed here.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum pcmvs_stage {
    /// Undistorts the pictures and finds the silhouettes, view by view.
    Views = 0,
    /// Carves the visual hull.
    Hull = 1,
    /// Finds the points that follow from the silhouettes alone.
    Contours = 2,
    /// Detects and meshes at reduced resolution to guide the stages after it.
    Coarse = 3,
    /// Detects points by stereo, view by view.
    Detect = 4,
    /// Merges all points into one cloud.
    Merge = 5,
    /// Turns the cloud into a closed mesh.
    Mesh = 6,
    /// Colours the mesh.
    Colour = 7,
    /// Makes a form of the finished mesh, see `pcmvs_frame_form`. It belongs to progress and errors only: it is not in the
    /// order, and `pcmvs_frame_step` does not know it.
    Form = 8,
    /// Averages the finished mesh with those of neighbouring frames, see `pcmvs_frame_steady`. As `PCMVS_STAGE_FORM`, it belongs
    /// to progress and errors only.
    Steady = 9,
}

/// Returned by `pcmvs_stage_at` beyond the last stage.
pub const PCMVS_NO_STAGE: u32 = 0xFFFF_FFFF;

/// Bytes for a stage's name with its final zero.
const NAME_SIZE: usize = 24;

/// The stages that progress and errors may name besides those of [`ORDER`].
const OTHERS: [Stage; 2] = [Stage::Form, Stage::Steady];

/// The names of [`ORDER`] and then those of [`OTHERS`], as C reads them.
static NAMES: [[u8; NAME_SIZE]; ORDER.len() + OTHERS.len()] = names();

const fn names() -> [[u8; NAME_SIZE]; ORDER.len() + OTHERS.len()] {
    let mut names = [[0; NAME_SIZE]; ORDER.len() + OTHERS.len()];
    let mut stage = 0;
    while stage < names.len() {
        let name = if stage < ORDER.len() { ORDER[stage] } else { OTHERS[stage - ORDER.len()] }.name().as_bytes();
        assert!(name.len() < NAME_SIZE, "the name needs a final zero");
        let mut i = 0;
        while i < name.len() {
            names[stage][i] = name[i];
            i += 1;
        }
        stage += 1;
    }
    names
}

/// A stage by its number.
pub(crate) fn by_id(id: u32) -> Result<Stage> {
    let unknown = || Failure::new(InvalidArgument, format!("stage {id} is not known"));
    ORDER.into_iter().find(|stage| stage.id() == id).ok_or_else(unknown)
}

/// Returns the number of stages that this library runs for a frame.
#[unsafe(no_mangle)]
pub extern "C" fn pcmvs_stage_count() -> u32 {
    ORDER.len() as u32
}

/// Returns the stage that runs at a place of the order, from 0 to `pcmvs_stage_count() - 1`, and `PCMVS_NO_STAGE`
/// beyond that.
#[unsafe(no_mangle)]
pub extern "C" fn pcmvs_stage_at(index: u32) -> u32 {
    ORDER.get(index as usize).map_or(PCMVS_NO_STAGE, |stage| stage.id())
}

/// Returns the name of a stage as in reports ("views", "hull" and so on), or "unknown" for a number that this library
/// does not know. The string is static.
#[unsafe(no_mangle)]
pub extern "C" fn pcmvs_stage_name(stage: u32) -> *const c_char {
    let place = ORDER.iter().chain(&OTHERS).position(|s| s.id() == stage);
    place.map_or(c"unknown".as_ptr(), |place| NAMES[place].as_ptr().cast())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::ffi::CStr;

    fn name(stage: u32) -> &'static str {
        // SAFETY: a static string.
        unsafe { CStr::from_ptr(pcmvs_stage_name(stage)) }.to_str().unwrap()
    }

    #[test]
    fn every_stage_of_the_core_appears_in_its_order() {
        for (i, stage) in ORDER.into_iter().enumerate() {
            assert_eq!(pcmvs_stage_at(i as u32), stage.id());
            assert_eq!(name(stage.id()), stage.name());
            assert_eq!(by_id(stage.id()).ok(), Some(stage));
        }
        assert_eq!(pcmvs_stage_at(pcmvs_stage_count()), PCMVS_NO_STAGE);
        assert_eq!(name(PCMVS_NO_STAGE), "unknown");
        assert!(by_id(PCMVS_NO_STAGE).is_err());
    }

    #[test]
    fn constants_are_the_cores_numbers() {
        use pcmvs_stage as C;
        let constants = [C::Views, C::Hull, C::Contours, C::Coarse, C::Detect, C::Merge, C::Mesh, C::Colour, C::Form];
        for constant in constants {
            assert_eq!(format!("{constant:?}").to_lowercase(), name(constant as u32));
        }
    }
}

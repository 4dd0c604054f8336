//! Seconds of each stage.

use pcmvs_core::{
    Stage,
    frame::{ORDER, position},
};
use std::sync::{Mutex, PoisonError};

/// Adds up the seconds that a frame's stages take.
#[derive(Debug, Default)]
pub(crate) struct Clock(Mutex<[f64; ORDER.len()]>);

impl Clock {
    pub fn add(&self, stage: Stage, seconds: f64) {
        // Forms are not part of a frame's time.
        if let Some(sum) = self.0.lock().unwrap_or_else(PoisonError::into_inner).get_mut(position(stage)) {
            *sum += seconds;
        }
    }

    pub fn seconds(&self, stage: Stage) -> f64 {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)[position(stage)]
    }
}

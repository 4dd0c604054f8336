//! Progress of the stage `Mesh`.

use crate::{
    error::Result,
    progress::{self, Progress},
    stage::Stage,
};

/// Counts and reports the steps of meshing.
pub(super) struct Steps<'a> {
    pub progress: &'a dyn Progress,
    pub done: u32,
    pub total: u32,
}

impl Steps<'_> {
    pub fn step(&mut self) -> Result<()> {
        self.done = (self.done + 1).min(self.total);
        progress::step(self.progress, Stage::Mesh, self.done, self.total)
    }
}

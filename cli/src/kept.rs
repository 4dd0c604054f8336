//! What is kept of a frame for those beside it.

use pcmvs_core::{Mesh, lost_part::Beside};

/// What a frame's neighbours need of it.
#[derive(Default)]
pub struct Kept {
    /// The mesh of the frame alone.
    pub mesh: Mesh,
    /// The cameras whose silhouettes its other views have overruled.
    pub overruled: Vec<u32>,
}

impl Kept {
    /// What tells a neighbour whether it has lost a part.
    pub fn beside(&self) -> Beside<'_> {
        Beside { mesh: &self.mesh, overruled: &self.overruled }
    }
}

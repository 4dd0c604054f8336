//! What work on the pictures of a scene needs.

use crate::{progress::Console, video::Videos};
use pcmvs_core::Executor;
use pcmvs_scene::{Scene, Silhouettes};

pub struct Run<'a> {
    pub scene: &'a Scene,
    pub silhouettes: Silhouettes,
    pub videos: &'a Videos,
    pub threads: &'a dyn Executor,
    pub console: &'a Console<'a>,
}

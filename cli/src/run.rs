//! What work on the pictures of a scene needs.

use crate::{inputs::Silhouettes, progress::Console, threads::Threads, video::Videos};
use pcmvs_scene::Scene;

pub struct Run<'a> {
    pub scene: &'a Scene,
    pub silhouettes: Silhouettes,
    pub videos: &'a Videos,
    pub threads: &'a Threads,
    pub console: &'a Console<'a>,
}

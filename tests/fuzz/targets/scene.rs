//! Any bytes as scene.json.
#![no_main]

use libfuzzer_sys::fuzz_target;
use pcmvs_core::Rig;
use pcmvs_fuzz::Tree;
use pcmvs_scene::Scene;
use std::path::Path;

fuzz_target!(|bytes: &[u8]| {
    let mut files = Tree::default();
    files.0.insert("scene/scene.json".into(), bytes.to_vec());
    if let Ok(scene) = Scene::load(&files, Path::new("scene")) {
        let cameras: Vec<_> = scene.cameras.iter().flat_map(|camera| camera.camera()).collect();
        let _ = Rig::new(&cameras);
    }
});

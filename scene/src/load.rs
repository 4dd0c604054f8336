//! A scene from its file, and from that of its cameras.

use crate::{
    failure::Failure,
    files::Files,
    paths,
    scene::{FILE_NAME, Scene, SceneCamera, VERSION},
    take::Take,
};
use pcmvs_core::export::glb;
use std::path::Path;

impl Scene {
    /// Reads a scene. `path` is its folder or its scene.json.
    pub fn load(files: &dyn Files, path: &Path) -> Result<Self, Failure> {
        let path = if files.is_folder(path) { path.join(FILE_NAME) } else { path.to_path_buf() };
        let mut take = Take::read(files, &path)?;
        let wrong = |problem: String| Failure::Input(format!("{}: {problem}", path.display()));
        let rig = take.rig().map_err(wrong)?.map(|rig| paths::resolve(path.parent().unwrap_or(Path::new("")), &rig));
        let cameras = match (take.cameras.take(), &rig) {
            (None, Some(rig)) => {
                let shared = Take::read(files, rig)?;
                take.units = take.units.or(shared.units);
                take.up = take.up.or(shared.up);
                let none = || Failure::Input(format!("{}: has no `cameras`: name the file with them", rig.display()));
                shared.cameras.ok_or_else(none)?
            }
            (Some(cameras), None) => cameras,
            _ => return Err(wrong(String::from("write either `cameras` or `rig`, the path of a file with them"))),
        };
        let scene = Self::new(take, cameras).map_err(wrong)?;
        Ok(Self { path, rig, ..scene })
    }

    fn new(take: Take, mut cameras: Vec<SceneCamera>) -> Result<Self, String> {
        take.set_offsets(&mut cameras)?;
        let (frames, [videos, mask_videos]) = (take.frames(&cameras)?, take.are_videos());
        let Take { units, up, fps, background, .. } = take;
        let scene = Self {
            version: VERSION,
            units,
            up,
            fps,
            cameras,
            frames,
            background,
            videos,
            mask_videos,
            ..Self::default()
        };
        scene.check().map(|()| scene)
    }

    fn check(&self) -> Result<(), String> {
        if self.cameras.is_empty() || self.frames.is_empty() {
            return Err(String::from("there are no cameras or no frames: add both"));
        }
        if self.fps.is_some_and(|fps| fps <= 0.0) {
            return Err(String::from("fps must be greater than 0: remove it if it is unknown"));
        }
        if let Some(up) = self.up
            && let Err(problem) = (glb::Options { up: Some(up), ..glb::Options::default() }).check_up()
        {
            return Err(format!("{problem}, or remove it"));
        }
        if let Some(plates) = self.background.as_ref().and_then(|background| background.plates.as_ref())
            && plates.len() != self.cameras.len()
        {
            return Err(format!(
                "background.plates: {} plates for {} cameras: list one per camera, in the order of the cameras, null where \
                 there is none",
                plates.len(),
                self.cameras.len()
            ));
        }
        Ok(())
    }
}

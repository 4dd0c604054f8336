//! scene.json as it is written, for programs that change a part of it.

use crate::{
    failure::Failure,
    files::Files,
    paths::written,
    scene::{FILE_NAME, SceneCamera},
    text,
};
use serde::Serialize;
use serde_json::{Map, Value};
use std::path::Path;

/// The keys of scene.json.
#[derive(Debug, Clone, Serialize)]
pub struct Document(pub Map<String, Value>);

impl Document {
    /// Reads a scene as it is written. `path` is its folder or its scene.json.
    pub fn load(files: &dyn Files, path: &Path) -> Result<Self, Failure> {
        let path = if files.is_folder(path) { path.join(FILE_NAME) } else { path.to_path_buf() };
        let bytes = files.read(&path).map_err(|e| Failure::unreadable(&path, &e))?;
        let keys = text::decode(&bytes).and_then(|text| serde_json::from_str(text).map_err(|e| e.to_string()));
        keys.map(Self).map_err(|problem| Failure::Input(format!("{}: {problem}", path.display())))
    }

    /// Whether the cameras are in another file.
    pub fn has_rig(&self) -> bool {
        self.0.get("rig").is_some_and(|rig| !rig.is_null())
    }

    /// Puts the cameras into the document.
    pub fn set_cameras(&mut self, cameras: &[SceneCamera]) {
        let cameras = cameras.iter().filter_map(|camera| serde_json::to_value(camera).ok());
        self.0.insert(String::from("cameras"), cameras.collect());
    }

    /// Makes all paths start in another folder, which leads to that of the document.
    pub fn move_to(&mut self, lead: &Path) {
        let literal = |path: &str| written(&lead.join(path));
        let escaped = written(lead).replace('{', "{{").replace('}', "}}");
        let pattern = |path: &str| written(&Path::new(&escaped).join(path));
        for (key, value) in &mut self.0 {
            match key.as_str() {
                "rig" => change(value, &literal),
                "images" | "masks" | "videos" | "mask_videos" => change(value, &pattern),
                "background" => value.get_mut("plates").into_iter().for_each(|plates| change(plates, &literal)),
                "frames" => {
                    for frame in value.as_array_mut().into_iter().flatten().filter_map(Value::as_object_mut) {
                        let lists = frame.iter_mut().filter(|(key, _)| matches!(key.as_str(), "images" | "masks"));
                        lists.for_each(|(_, list)| change(list, &literal));
                    }
                }
                _ => {}
            }
        }
    }
}

/// Changes a text, or all texts of a list.
fn change(value: &mut Value, to: &dyn Fn(&str) -> String) {
    match value {
        Value::String(text) => *text = to(text),
        Value::Array(list) => list.iter_mut().for_each(|value| change(value, to)),
        _ => {}
    }
}

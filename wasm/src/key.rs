//! A chroma key as JavaScript writes it.

use crate::{error::Failed, types::ChromaKeyObject};
use pcmvs_core::{ChromaKey, silhouette::MORE_COLOURS};
use serde::Deserialize;

/// What is left out is the default.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Key {
    rgb: [u8; 3],
    more: Option<Vec<[u8; 3]>>,
    tolerance: Option<f32>,
    darkest_shadow: Option<f32>,
    smallest_part: Option<f32>,
    smallest_hole: Option<f32>,
}

impl TryFrom<ChromaKeyObject> for ChromaKey {
    type Error = Failed;

    fn try_from(object: ChromaKeyObject) -> Result<Self, Failed> {
        let key: Key = serde_wasm_bindgen::from_value(object.into())?;
        let mut colours = vec![key.rgb];
        colours.extend(key.more.unwrap_or_default());
        let default = Self::with_colours(&colours).ok_or_else(|| {
            Failed::input(&format!("a chroma key holds {} colours at most: leave out some of `more`", 1 + MORE_COLOURS))
        })?;
        Ok(Self {
            tolerance: key.tolerance.unwrap_or(default.tolerance),
            darkest_shadow: key.darkest_shadow.unwrap_or(default.darkest_shadow),
            smallest_part: key.smallest_part.unwrap_or(default.smallest_part),
            smallest_hole: key.smallest_hole.unwrap_or(default.smallest_hole),
            ..default
        })
    }
}

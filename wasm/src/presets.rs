//! Parameters by name.

use crate::{error::Failed, types::PresetName};
use pcmvs_core::{Params, Preset};

/// The parameters of a preset.
pub fn params(name: &PresetName) -> Result<Params, Failed> {
    let preset = match name.as_string().as_deref() {
        Some("default") => Preset::Default,
        Some("paper") => Preset::Paper,
        Some("hull") => Preset::Hull,
        Some("preview") => Preset::Preview,
        _ => return Err(Failed::input("a preset is one of default, paper, hull, preview")),
    };
    Ok(Params::preset(preset))
}

//! `--set KEY=VALUE`: overrides single parameters of a preset, for ablations.

use crate::json;
use pcmvs_core::Params;
use serde_json::Value;

/// Changes one parameter. `assignment` is the path of a field in [`Params`] and its value as JSON, such as
/// `detection.search.vote.smoothing=0.5`, `frontier=null` or
/// `merging.conflicts={"distance_pixels": 10, "virtual_views": 0}`.
pub fn set(params: &Params, assignment: &str) -> Result<Params, String> {
    let problem = |what: &str| format!("--set {assignment}: {what}");
    let (key, value) = assignment.split_once('=').ok_or_else(|| problem("write KEY=VALUE"))?;
    let value: Value = serde_json::from_str(value).map_err(|e| problem(&format!("the value is not JSON ({e})")))?;
    let mut all = json::to_value(params);
    let place = key.split('.').try_fold(&mut all, |at, name| at.get_mut(name));
    *place.ok_or_else(|| problem("there is no such parameter, or the preset leaves out its step"))? = value;
    serde_json::from_value(all).map_err(|e| problem(&e.to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use pcmvs_core::Preset;

    #[test]
    fn one_parameter_changes_and_all_others_stay() {
        for preset in [Preset::Default, Preset::Paper, Preset::Hull, Preset::Preview] {
            let params = Params::preset(preset);
            let mut expected = params;
            expected.detection.search.vote.smoothing = Some(0.123);
            assert_eq!(set(&params, "detection.search.vote.smoothing=0.123"), Ok(expected));
            assert_eq!(set(&expected, "frontier=null").unwrap().frontier, None);
        }
        let paper = Params::preset(Preset::Paper);
        let changed = set(&paper, r#"merging.conflicts={"distance_pixels": 5, "virtual_views": 0}"#).unwrap();
        assert_eq!(changed.merging.conflicts.unwrap().distance_pixels, 5.0);
    }

    #[test]
    fn slips_are_refused() {
        let params = Params::preset(Preset::Paper);
        for wrong in ["frontier", "frontier=", "frontiers=null", "frontier=1", "frontier={}", "coarse.voxel_pixels=1"] {
            assert!(set(&params, wrong).unwrap_err().contains(wrong), "{wrong}");
        }
    }
}

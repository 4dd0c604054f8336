//! JSON of the core's parameters and counts.

use serde::Serialize;
use serde_json::Value;

/// A value as JSON. Single-precision numbers keep their shortest form (0.3, not 0.30000001192092896), which
/// `serde_json::to_value` does not give.
pub fn to_value(value: &impl Serialize) -> Value {
    let text = serde_json::to_string(value).expect("the core's structs have names as keys and finite numbers");
    serde_json::from_str(&text).expect("serde_json reads what it writes")
}

#[cfg(test)]
mod tests {
    use super::*;
    use pcmvs_core::{Counts, Params, Preset};

    #[test]
    fn parameters_read_back() {
        for preset in [Preset::Default, Preset::Paper, Preset::Hull, Preset::Preview] {
            let params = Params::preset(preset);
            assert_eq!(serde_json::from_value::<Params>(to_value(&params)).unwrap(), params);
        }
    }

    #[test]
    fn numbers_keep_their_shortest_form() {
        let params = to_value(&Params::preset(Preset::Default));
        assert_eq!(params["meshing"]["weights"]["substituted"].to_string(), "0.2");
        assert_eq!(to_value(&Counts::default())["detected"], 0);
    }
}

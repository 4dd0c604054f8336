//! Paths of all frames and cameras as one line: `cam{camera}/{frame:06}.jpg`.

use crate::scene::SceneCamera;
use serde_json::Value;

/// Most digits to which the number of a frame is padded.
const MOST_DIGITS: usize = 20;
/// Most bytes of a pattern, and of a name in it.
const LONGEST: usize = 4096;

/// The pattern of every camera: one that all share and that names the camera, or a list of one per camera, null where a
/// camera has none. Null for all is an empty list.
pub fn patterns<'v>(value: &'v Value, cameras: &[SceneCamera]) -> Result<Vec<Option<&'v str>>, String> {
    let all = match value {
        Value::Null => return Ok(Vec::new()),
        Value::String(text) => {
            if cameras.len() > 1 && expand(text, "a", 0)? == expand(text, "b", 0)? {
                return Err(format!("`{text}` is the same for all cameras: add {{camera}}, or list one per camera"));
            }
            vec![value; cameras.len()]
        }
        Value::Array(list) => list.iter().collect(),
        _ => Vec::new(),
    };
    if all.len() != cameras.len() || !all.iter().all(|value| value.is_null() || value.is_string()) {
        return Err(String::from(
            "write a pattern such as \"{camera}/{frame:06}.jpg\", or a list of one per camera, null where there is none",
        ));
    }
    for (value, camera) in all.iter().zip(cameras) {
        expand(value.as_str().unwrap_or_default(), &camera.name, 0)?;
    }
    Ok(all.into_iter().map(Value::as_str).collect())
}

/// Whether a pattern gives another path for every frame.
pub fn has_frame(pattern: &str) -> bool {
    expand(pattern, "", 0) != expand(pattern, "", 1)
}

/// The path of a camera's picture in a frame. `{camera}`, `{frame}` and `{frame:06}` are replaced, and a brace that is
/// written twice is a brace.
pub fn expand(pattern: &str, camera: &str, frame: u32) -> Result<String, String> {
    if pattern.len().max(camera.len()) > LONGEST {
        return Err(format!("a pattern or a name is longer than {LONGEST} bytes: shorten it"));
    }
    let mut path = String::new();
    let mut rest = pattern;
    while let Some(at) = rest.bytes().position(|byte| byte == b'{' || byte == b'}') {
        path.push_str(&rest[..at]);
        let (brace, after) = rest[at..].split_at(1);
        if let Some(doubled) = after.strip_prefix(brace) {
            path.push_str(brace);
            rest = doubled;
            continue;
        }
        let (name, end) = after.split_once('}').filter(|_| brace == "{").unwrap_or_default();
        if name == "camera" {
            path.push_str(camera);
        } else if let Some(digits) = digits(name) {
            path.push_str(&format!("{frame:0digits$}"));
        } else {
            return Err(format!(
                "`{pattern}`: the brace before `{after}` is not understood: write {{camera}}, {{frame}} or {{frame:06}}, and a \
                 literal brace twice"
            ));
        }
        rest = end;
    }
    path.push_str(rest);
    Ok(path)
}

/// The digits of `frame` or `frame:06`.
fn digits(name: &str) -> Option<usize> {
    match name.strip_prefix("frame")? {
        "" => Some(0),
        format => format.strip_prefix(":0")?.parse().ok().filter(|digits| (1..=MOST_DIGITS).contains(digits)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_hold_the_camera_and_the_number_of_the_frame() {
        for (pattern, frame, path) in [
            ("cam{camera}/{frame:06}.jpg", 42, "camleft/000042.jpg"),
            ("{frame}_{camera}_{frame:02}", 123, "123_left_123"),
            ("plain.png", 1, "plain.png"),
            ("{{{camera}}}/{{frame}}", 1, "{left}/{frame}"),
        ] {
            assert_eq!(expand(pattern, "left", frame).as_deref(), Ok(path));
            assert_eq!(has_frame(pattern), pattern.contains("{frame:"), "{pattern}");
        }
    }

    #[test]
    fn braces_that_mean_nothing_are_refused() {
        for wrong in
            ["{cam}", "{frame", "frame}", "{frame:6}", "{frame:0}", "{frame:021}", "{}", "a{", "}", "{frame:0x}"]
        {
            assert!(expand(wrong, "", 0).unwrap_err().contains(wrong), "{wrong}");
        }
    }
}

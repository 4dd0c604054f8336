//! XML of OpenCV's FileStorage as JSON. All scalars are text, as they are written.

use roxmltree::{Document, Node};
use serde_json::{Map, Value};

/// Most elements within each other. Each takes stack.
const DEEPEST: usize = 100;
/// Elements of a list.
const ITEM: &str = "_";

/// Reads a document.
pub fn from_xml(text: &str) -> Result<Value, String> {
    let document = Document::parse(text).map_err(|e| format!("{e}: correct that line"))?;
    let root = document.root_element();
    if !root.has_tag_name("opencv_storage") {
        return Err(String::from(
            "is not XML of OpenCV's FileStorage, whose root is <opencv_storage>: name another file",
        ));
    }
    value(root, 0)
}

fn value(node: Node, depth: usize) -> Result<Value, String> {
    if depth > DEEPEST {
        return Err(format!("there are more than {DEEPEST} elements within each other: name another file"));
    }
    let children: Vec<Node> = node.children().filter(Node::is_element).collect();
    if children.is_empty() {
        return Ok(scalars(node.text().unwrap_or_default()));
    }
    if children.iter().all(|child| child.has_tag_name(ITEM)) {
        return children.into_iter().map(|child| value(child, depth + 1)).collect();
    }
    let mut map = Map::new();
    for child in children {
        // A name that starts with a digit has an underscore in front.
        let name = child.tag_name().name();
        let name = name.strip_prefix('_').filter(|rest| rest.starts_with(|c: char| c.is_ascii_digit())).unwrap_or(name);
        if map.insert(name.to_owned(), value(child, depth + 1)?).is_some() {
            return Err(format!("the key `{name}` occurs twice: correct it"));
        }
    }
    Ok(map.into())
}

/// A scalar, or a list of numbers between spaces. Texts with spaces are in quotes.
fn scalars(text: &str) -> Value {
    let text = text.trim();
    if let Some(quoted) = text.strip_prefix('"').and_then(|rest| rest.strip_suffix('"')) {
        return quoted.into();
    }
    let words: Vec<&str> = text.split_whitespace().collect();
    let numbers = words.len() > 1 && words.iter().all(|word| word.parse::<f64>().is_ok());
    if numbers {
        words.into()
    } else if text.is_empty() {
        Value::Null
    } else {
        text.into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn elements_become_keys_lists_and_text() {
        let text = "<?xml version=\"1.0\"?>\n<opencv_storage>\n<K type_id=\"opencv-matrix\"><rows>1</rows><data>\n 60. .5\n \
                    -1e-2</data></K>\n<name>\"left cam\"</name><w>64</w><empty></empty><list><_>a</_><_><b>1</b></_></list>\n\
                    <_007>x</_007></opencv_storage>";
        assert_eq!(
            from_xml(text).unwrap(),
            json!({ "K": { "rows": "1", "data": ["60.", ".5", "-1e-2"] }, "name": "left cam", "w": "64", "empty": null,
                    "list": ["a", { "b": "1" }], "007": "x" })
        );
    }

    #[test]
    fn what_would_be_lost_is_an_error() {
        assert!(
            from_xml("<opencv_storage><a>1</a><a>2</a></opencv_storage>").unwrap_err().contains("`a` occurs twice")
        );
        assert!(from_xml("<document/>").unwrap_err().contains("opencv_storage"));
        let deep = format!("<opencv_storage>{}{}</opencv_storage>", "<_>".repeat(200), "</_>".repeat(200));
        assert!(from_xml(&deep).unwrap_err().contains("within each other"));
        assert!(from_xml("<opencv_storage><a></opencv_storage>").unwrap_err().contains("correct that line"));
    }
}

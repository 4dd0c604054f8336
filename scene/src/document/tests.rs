use crate::{Document, Failure, Files, Scene};
use std::{
    collections::BTreeMap,
    io,
    path::{Path, PathBuf},
};

const CAMERAS: &str = r#""cameras": [
    { "name": "a", "width": 1, "height": 1, "t": [0, 0, 1],
      "K": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "R": [[1, 0, 0], [0, 1, 0], [0, 0, 1]] },
    { "name": "b", "width": 1, "height": 1, "t": [0, 0, 2],
      "K": [[1, 0, 0], [0, 1, 0], [0, 0, 1]], "R": [[1, 0, 0], [0, 1, 0], [0, 0, 1]] } ]"#;

/// Texts by their paths.
struct Texts(BTreeMap<PathBuf, String>);

impl Files for Texts {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        self.0.get(path).map(|text| text.clone().into_bytes()).ok_or_else(|| io::ErrorKind::NotFound.into())
    }

    fn is_file(&self, path: &Path) -> bool {
        self.0.contains_key(path)
    }

    fn is_folder(&self, path: &Path) -> bool {
        path.extension().is_none()
    }

    fn list(&self, _: &Path) -> io::Result<Vec<PathBuf>> {
        Ok(Vec::new())
    }
}

fn load(files: &[(&str, String)]) -> Result<Scene, String> {
    let files = Texts(files.iter().map(|(path, text)| (PathBuf::from(path), text.clone())).collect());
    Scene::load(&files, Path::new("takes/one")).map_err(|failure| match failure {
        Failure::Input(message) => message,
        other => panic!("{other}"),
    })
}

/// The scene with these keys and both cameras.
fn scene(keys: &str) -> Result<Scene, String> {
    load(&[("takes/one/scene.json", format!(r#"{{ "version": 1, {CAMERAS}, {keys} }}"#))])
}

/// The frames of a scene, and the pictures of its cameras in each.
fn pictures(scene: &Scene) -> Vec<(u32, [Option<&str>; 2])> {
    scene
        .frames
        .iter()
        .map(|frame| (frame.index, [0, 1].map(|camera| frame.image(camera).and_then(Path::to_str))))
        .collect()
}

#[track_caller]
fn assert_refused(keys: &str, words: &[&str]) {
    let message = scene(keys).unwrap_err();
    for word in words.iter().chain(&["takes/one/scene.json: "]) {
        assert!(message.contains(word), "`{word}` is missing in: {message}");
    }
}

#[test]
fn a_range_and_patterns_give_the_paths_of_all_frames() {
    let scene = scene(
        r#""images": "cam{camera}/{frame:03}.jpg", "masks": [null, "m/{frame}.png"], "frames": { "first": 8, "last": 13, "step": 2 }"#,
    )
    .unwrap();
    assert_eq!(
        pictures(&scene),
        [
            (8, [Some("cama/008.jpg"), Some("camb/008.jpg")]),
            (10, [Some("cama/010.jpg"), Some("camb/010.jpg")]),
            (12, [Some("cama/012.jpg"), Some("camb/012.jpg")]),
        ]
    );
    assert_eq!((scene.frames[1].mask(0), scene.frames[1].mask(1)), (None, Some(Path::new("m/10.png"))));
}

#[test]
fn an_offset_chooses_the_picture_of_another_frame() {
    let range =
        scene(r#""offsets": { "b": -1 }, "images": "{camera}{frame}", "frames": { "first": 0, "last": 1 }"#).unwrap();
    // No number is before 0. The number may be outside of the range.
    assert_eq!(pictures(&range), [(0, [Some("a0"), None]), (1, [Some("a1"), Some("b0")])]);
    let list = scene(
        r#""offsets": { "b": 1 }, "frames": [
            { "index": 5, "images": ["a5", "b5"], "masks": ["A5", "B5"] },
            { "index": 6, "images": ["a6", "b6"], "masks": ["A6", "B6"] } ]"#,
    )
    .unwrap();
    assert_eq!(pictures(&list), [(5, [Some("a5"), Some("b6")]), (6, [Some("a6"), None])]);
    assert_eq!([0, 1].map(|i| list.frames[i].mask(1)), [Some(Path::new("B6")), None]);
}

#[test]
fn offsets_name_cameras() {
    let frames = r#""images": "{camera}{frame}", "frames": { "first": 0, "last": 1 }"#;
    assert_refused(&format!(r#""offsets": {{ "c": 1 }}, {frames}"#), &["offsets", "`c`"]);
    let twice = CAMERAS.replace(r#""b""#, r#""a""#);
    let text = format!(r#"{{ "version": 1, {twice}, "offsets": {{ "a": 1 }}, {frames} }}"#);
    assert!(load(&[("takes/one/scene.json", text)]).unwrap_err().contains("several cameras are called `a`"));
}

#[test]
fn takes_share_the_cameras_of_a_rig() {
    let take = |more: &str| {
        format!(
            r#"{{ "version": 1, "rig": "../../rigs/monday.json", "images": "{{camera}}", "frames": {{ "first": 3, "last": 3 }}{more} }}"#
        )
    };
    let rig = format!(r#"{{ "version": 1, "units": "m", "up": [0, 1, 0], {CAMERAS} }}"#);
    let rig = ("takes/one/../../rigs/monday.json", rig);
    let scene = load(&[("takes/one/scene.json", take("")), rig.clone()]).unwrap();
    assert_eq!(pictures(&scene), [(3, [Some("a"), Some("b")])]);
    assert_eq!((scene.units.as_deref(), scene.up), (Some("m"), Some([0.0, 1.0, 0.0])));
    assert_eq!(scene.resolve(Path::new("a")), Path::new("takes/one/a"));
    let own = load(&[("takes/one/scene.json", take(r#", "up": [0, 0, 1]"#)), rig.clone()]).unwrap();
    assert_eq!(own.up, Some([0.0, 0.0, 1.0]));
    let broken = (rig.0, rig.1.replace(r#""K""#, r#""L""#));
    for (rig, word) in [(Some(broken), "(camera `a`)"), (None, "cannot be read")] {
        let files: Vec<_> = [("takes/one/scene.json", take(""))].into_iter().chain(rig).collect();
        let message = load(&files).unwrap_err();
        assert!(message.starts_with("takes/one/../../rigs/monday.json: ") && message.contains(word), "{message}");
    }
    let both = load(&[("takes/one/scene.json", take(&format!(", {CAMERAS}"))), rig]);
    assert!(both.unwrap_err().contains("both `cameras` and `rig`"));
    let neither = r#"{ "version": 1, "frames": [] }"#.to_owned();
    assert!(load(&[("takes/one/scene.json", neither)]).unwrap_err().contains("`rig`"));
}

#[test]
fn frames_without_paths_and_paths_without_frames_are_refused() {
    let range = r#""frames": { "first": 0, "last": 9 }"#;
    assert_refused(range, &["no `images`"]);
    assert_refused(
        r#""images": "{camera}{frame}", "frames": [{ "index": 0, "images": ["a", "b"] }]"#,
        &["`images` is a pattern"],
    );
    assert_refused(&format!(r#""images": "{{frame}}", {range}"#), &["images: ", "{camera}"]);
    assert_refused(&format!(r#""images": "{{camera}}", {range}"#), &["camera `a`", "{frame}"]);
    assert_refused(
        &format!(r#""images": "{{camera}}{{frame}}", "masks": ["{{frame}}"], {range}"#),
        &["masks: 1 patterns for 2"],
    );
    assert_refused(&format!(r#""images": "{{camera}}{{nr}}", {range}"#), &["images: ", "{nr}"]);
    for wrong in [r#""first": 2, "last": 1"#, r#""first": 0, "last": 1, "step": 0"#] {
        assert_refused(&format!(r#""images": "{{camera}}{{frame}}", "frames": {{ {wrong} }}"#), &["there are none"]);
    }
    assert_refused(r#""images": 3, "frames": []"#, &["images: ", "pattern such as"]);
    assert_refused(r#""images": "{camera}", "frames": 3"#, &["frames: ", "range such as"]);
}

#[test]
fn a_take_that_needs_much_memory_is_refused_before_it_is_taken() {
    let frames = r#""frames": { "first": 0, "last": 4294967295 }"#;
    assert_refused(&format!(r#""images": "{{camera}}{{frame}}", {frames}"#), &["4294967296 frames", "split"]);
    let long = format!("{}{{frame}}", "{camera}".repeat(1 << 20));
    assert_refused(&format!(r#""images": "{long}", "frames": {{ "first": 0, "last": 9 }}"#), &["10 frames", "split"]);
}

#[test]
fn a_document_is_written_as_it_is_read() {
    let text = format!(
        r#"{{ "version": 1, {CAMERAS}, "offsets": {{ "b": -2 }}, "images": "{{camera}}{{frame:03}}", "masks": ["m{{frame}}", null],
            "frames": {{ "first": 0, "last": 9 }} }}"#
    );
    let files = Texts(BTreeMap::from([(PathBuf::from("scene.json"), text.clone())]));
    let (document, _) = Document::load(&files, Path::new("scene.json")).unwrap();
    let [written, read]: [serde_json::Value; 2] =
        [serde_json::to_string(&document).unwrap(), text].map(|text| serde_json::from_str(&text).unwrap());
    for key in ["offsets", "images", "masks", "frames"] {
        assert_eq!(written[key], read[key]);
    }
    assert_eq!(written.get("rig"), None);
}

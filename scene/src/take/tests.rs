use crate::{Failure, Files, Scene, open};
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

    fn list(&self, folder: &Path) -> io::Result<Vec<PathBuf>> {
        Ok(self.0.keys().filter(|path| path.parent() == Some(folder)).cloned().collect())
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
    let message = scene(keys).map(drop).unwrap_err();
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
    assert!(load(&[("takes/one/scene.json", text)]).unwrap_err().contains("not one camera `a`"));
}

/// Path of a rig as a take spells it.
const PATH: &str = "takes/one/../../rigs/monday.json";

#[test]
fn takes_share_the_cameras_of_a_rig() {
    let take = |more: &str| {
        format!(
            r#"{{ "version": 1, "rig": "../../rigs/monday.json", "images": "{{camera}}", "frames": {{ "first": 3, "last": 3 }}{more} }}"#
        )
    };
    let rig = format!(r#"{{ "version": 1, "units": "m", "up": [0, 1, 0], {CAMERAS} }}"#);
    let rig = (PATH, rig);
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
        assert!(message.starts_with(&format!("{PATH}: ")) && message.contains(word), "{message}");
    }
    let both = load(&[("takes/one/scene.json", take(&format!(", {CAMERAS}"))), rig]);
    let neither = load(&[("takes/one/scene.json", r#"{ "version": 1, "frames": [] }"#.to_owned())]);
    for message in [both, neither].map(|scene| scene.map(drop).unwrap_err()) {
        assert!(message.contains("either `cameras` or `rig`"), "{message}");
    }
    let chain = r#"{ "version": 1, "rig": "other.json" }"#.to_owned();
    let chained = load(&[("takes/one/scene.json", take("")), (PATH, chain)]);
    assert!(chained.map(drop).unwrap_err().contains("monday.json: has no `cameras`"));
}

#[test]
fn an_upward_direction_without_length_is_refused() {
    let frames = r#""images": "{camera}{frame}", "frames": { "first": 0, "last": 1 }"#;
    assert_refused(&format!(r#""up": [0, 0, 0], {frames}"#), &["up has no length", "(0, 0, 1), or remove it"]);
    assert!(scene(&format!(r#""up": [0, -1, 0], {frames}"#)).is_ok());
}

#[test]
fn frames_without_paths_and_paths_without_frames_are_refused() {
    let range = |keys: &str| format!(r#"{keys}, "frames": {{ "first": 0, "last": 9 }}"#);
    assert_refused(r#""frames": { "first": 0, "last": 9 }"#, &["no `images`"]);
    assert_refused(r#""images": "{camera}{frame}""#, &["frames: "]);
    let list = r#""images": "{camera}{frame}", "frames": [{ "index": 0, "images": ["a", "b"] }]"#;
    assert_refused(list, &["`frames` is a list"]);
    assert_refused(&range(r#""images": "{frame}""#), &["images: ", "{camera}"]);
    assert_refused(&range(r#""images": "{camera}""#), &["images: ", "`{camera}`", "{frame}"]);
    assert_refused(&range(r#""images": "{camera}{frame}", "masks": ["{frame}"]"#), &["masks: ", "one per camera"]);
    assert_refused(&range(r#""images": "{camera}{nr}""#), &["images: ", "{nr}"]);
    assert_refused(&range(r#""images": 3"#), &["images: ", "pattern such as"]);
    for wrong in [r#""first": 2, "last": 1"#, r#""first": 0, "last": 1, "step": 0"#, r#""first": 0"#, r#""last": -1"#] {
        assert_refused(&format!(r#""images": "{{camera}}{{frame}}", "frames": {{ {wrong} }}"#), &["frames: ", "range"]);
    }
    assert_refused(r#""images": "{camera}", "frames": 3"#, &["frames: ", "expected a sequence"]);
}

#[test]
fn videos_have_one_path_for_all_frames() {
    let range = r#""frames": { "first": 4, "last": 5 }"#;
    let text = format!(
        r#"{{ "version": 1, {CAMERAS}, "offsets": {{ "b": -5 }}, "videos": "{{camera}}.mp4", "masks": "m/{{camera}}{{frame}}", {range} }}"#
    );
    let scene = load(&[("takes/one/scene.json", text.clone())]).unwrap();
    // Number 4 - 5 is before the first picture.
    assert_eq!(pictures(&scene), [(4, [Some("a.mp4"), None]), (5, [Some("a.mp4"), Some("b.mp4")])]);
    assert_eq!((scene.videos, scene.mask_videos, scene.cameras[1].number(5)), (true, false, Some(0)));
    assert_eq!(scene.frames[1].mask(1), Some(Path::new("m/b0")));
    let path = |keys: &str| format!(r#"{keys}, {range}"#);
    assert_refused(&path(r#""videos": "{camera}{frame}.mp4""#), &["videos: ", "{frame}"]);
    assert_refused(&path(r#""images": "{camera}{frame}", "videos": "{camera}""#), &["both `images` and `videos`"]);
    // Those who have no program to read them get a message.
    let files = Texts(BTreeMap::from([(PathBuf::from("take/scene.json"), text)]));
    assert!(
        open(&files, Path::new("take"))
            .map(drop)
            .unwrap_err()
            .to_string()
            .contains("videos, which only the command line")
    );
}

#[test]
fn a_take_that_needs_much_memory_is_refused_before_it_is_taken() {
    let frames = r#""frames": { "first": 0, "last": 4294967295 }"#;
    assert_refused(&format!(r#""images": "{{camera}}{{frame}}", {frames}"#), &["4294967296 frames", "split"]);
    let long = |repeats: usize| {
        format!(r#""images": "{}{{frame}}", "frames": {{ "first": 0, "last": 999999 }}"#, "{camera}".repeat(repeats))
    };
    assert_refused(&long(500), &["1000000 frames", "split"]);
    assert_refused(&long(1000), &["images: ", "longer than 4096 bytes"]);
}

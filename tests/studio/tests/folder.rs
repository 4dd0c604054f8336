//! A written scene folder reads back as it was recorded.

use std::{env, fs, process};
use studio::{Capture, Faults, Ring, Subject, write::SceneFile};

#[test]
fn a_folder_reads_back() {
    let cameras =
        Ring { count: 3, distortion: [-0.1, 0.02, 0.001, 0.0, 0.0], ..Ring::default() }.sized(64, 48).cameras();
    let faults = Faults { calibration: 0.7, unmasked: vec![1], missing: vec![2], ..Faults::default() };
    let capture = Capture::new(Subject::TwoBodies, &cameras, &[0.0, 0.04], &faults);
    let folder = env::temp_dir().join(format!("studio-folder-{}", process::id()));
    capture.write(&folder).unwrap();

    let text = fs::read_to_string(folder.join("scene.json")).unwrap();
    let file: SceneFile = serde_json::from_str(&text).unwrap();
    assert_eq!(file, capture.scene_file());
    assert_eq!((file.version, file.units.as_str(), file.up), (1, "m", [0.0, 0.0, 1.0]));
    assert_eq!(file.cameras.iter().map(|c| c.camera()).collect::<Vec<_>>(), capture.cameras);
    assert!(text.contains("\"K\"") && text.contains("\"R\""));
    for (entry, frame) in file.frames.iter().zip(&capture.frames) {
        assert_eq!(entry.masks.iter().map(Option::is_some).collect::<Vec<_>>(), [true, false, false]);
        for i in 0..2 {
            let picture = image::open(folder.join(&entry.images[i])).unwrap();
            assert_eq!(picture.into_rgb8().into_raw(), frame.images[i].rgb);
        }
        assert!(!folder.join(&entry.images[2]).exists());
        let mask = image::open(folder.join(entry.masks[0].as_ref().unwrap())).unwrap();
        assert_eq!(mask.into_luma8().into_raw(), *frame.masks[0].as_ref().unwrap());
    }
    fs::remove_dir_all(&folder).unwrap();
}

//! A scene folder that was written reads back as recorded.

use pcmvs_scene::{Disk, Scene};
use std::{env, fs, process};
use studio::{Capture, Faults, Ring, Subject};

#[test]
fn a_folder_reads_back() {
    let cameras =
        Ring { count: 3, distortion: [-0.1, 0.02, 0.001, 0.0, 0.0], ..Ring::default() }.sized(64, 48).cameras();
    let faults = Faults { calibration: 0.7, unmasked: vec![1], missing: vec![2], ..Faults::default() };
    let capture = Capture::new(Subject::TwoBodies, &cameras, &[0.0, 0.04], &faults);
    let folder = env::temp_dir().join(format!("studio-folder-{}", process::id()));
    capture.write(&folder).unwrap();

    let text = fs::read_to_string(folder.join("scene.json")).unwrap();
    let scene = Scene::load(&Disk, &folder).unwrap();
    assert_eq!((scene.version, scene.units.as_deref(), scene.up), (1, Some("m"), Some([0.0, 0.0, 1.0])));
    assert_eq!(scene.cameras.iter().map(|c| c.camera().unwrap()).collect::<Vec<_>>(), capture.cameras);
    assert!(text.contains("\"K\"") && text.contains("\"R\""));
    for (entry, frame) in scene.frames.iter().zip(&capture.frames) {
        assert_eq!([0, 1, 2].map(|camera| entry.mask(camera).is_some()), [true, false, false]);
        for i in 0..2 {
            let picture = image::open(folder.join(entry.image(i).unwrap())).unwrap();
            assert_eq!(picture.into_rgb8().into_raw(), frame.images[i].rgb);
        }
        assert!(!folder.join(entry.image(2).unwrap()).exists());
        let mask = image::open(folder.join(entry.mask(0).unwrap())).unwrap();
        assert_eq!(mask.into_luma8().into_raw(), *frame.masks[0].as_ref().unwrap());
    }
    fs::remove_dir_all(&folder).unwrap();
}

//! Any bytes as another program's calibration. The first byte chooses the files' names.
#![no_main]

use libfuzzer_sys::fuzz_target;
use pcmvs_core::Rig;
use pcmvs_fuzz::{Tree, files_between};
use pcmvs_scene::{Source, import, recognise};
use std::path::Path;

const NAMES: [(&[&str], Source); 19] = [
    (&["ring_par.txt"], Source::Middlebury),
    (&["cameras.txt", "images.txt", "points3D.txt"], Source::Colmap),
    (&["cameras.bin", "images.bin"], Source::Colmap),
    (&["cameras.yml", "extrinsics.yml"], Source::Opencv),
    (&["cameras.json"], Source::Opencv),
    (&["transforms.json", "transforms_test.json"], Source::Transforms),
    (&["intri.yml", "extri.yml"], Source::Easymocap),
    (&["bundle.out", "list.txt"], Source::Bundler),
    (&["cameras.xml"], Source::Metashape),
    (&["cameras_sphere.npz"], Source::Neus),
    (&["calibration.toml"], Source::Anipose),
    (&["calibration_1.json"], Source::Panoptic),
    (&["cams/00000000_cam.txt"], Source::Mvsnet),
    (&["camchain.yaml"], Source::Kalibr),
    (&["images/c0.xmp"], Source::Realitycapture),
    (&["cameras.csv"], Source::Realitycapture),
    (&["annots.npy"], Source::Zju),
    (&["cameras.xml"], Source::Opencv),
    (&["a.qca.txt"], Source::Qualisys),
];

fuzz_target!(|bytes: &[u8]| {
    let Some((&first, rest)) = bytes.split_first() else { return };
    let (names, source) = NAMES[usize::from(first) % NAMES.len()];
    let mut files = Tree::default();
    for (name, file) in names.iter().zip(files_between(rest, names.len())) {
        files.0.insert(Path::new("capture").join(name), file);
    }
    let folder = Path::new("capture");
    let _ = recognise(&files, folder);
    let path = if source == Source::Opencv { folder.join(names[0]) } else { folder.to_path_buf() };
    for path in [&path, folder] {
        let Ok(imported) = import(&files, source, path) else { continue };
        let cameras: Vec<_> = imported.scene.cameras.iter().flat_map(|camera| camera.camera()).collect();
        let _ = Rig::new(&cameras);
        for camera in &imported.scene.cameras {
            let name = Path::new(&camera.name);
            assert!(name.components().count() == 1 && name.file_name().is_some(), "{:?} is no file name", camera.name);
        }
    }
});

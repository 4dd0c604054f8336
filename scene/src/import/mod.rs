//! Other programs' calibrations as scenes, most of one frame.
//!
//! Every importer turns its convention into the scene's: world to camera `x = K · distort(R X + t)`, x right, y down,
//! z forward, the first pixel's centre at (0, 0).

#[cfg(feature = "formats")]
mod bundler;
mod clip;
mod colmap;
mod easymocap;
#[cfg(feature = "formats")]
mod essential;
mod formats;
mod found;
#[cfg(feature = "formats")]
mod further;
mod instants;
mod json;
#[cfg(feature = "formats")]
mod kalibr;
mod keys;
mod lens;
#[cfg(feature = "formats")]
mod marks;
#[cfg(feature = "formats")]
mod metashape;
mod middlebury;
#[cfg(feature = "formats")]
mod mvsnet;
mod names;
#[cfg(feature = "formats")]
mod neus;
mod notes;
mod opencv;
#[cfg(feature = "formats")]
mod opencv_chain;
mod opencv_contents;
mod opencv_keys;
#[cfg(feature = "formats")]
mod opencv_pair;
#[cfg(feature = "formats")]
mod opencv_part;
mod opencv_storage;
#[cfg(feature = "formats")]
mod opencv_xml;
#[cfg(feature = "formats")]
mod panoptic;
#[cfg(feature = "formats")]
mod projects;
#[cfg(feature = "formats")]
mod qualisys;
#[cfg(feature = "formats")]
mod realitycapture;
mod recognise;
#[cfg(feature = "formats")]
mod rig_toml;
mod source;
mod transforms;
mod values;
mod video_names;
mod view;
#[cfg(feature = "formats")]
mod zju;

use crate::{
    failure::Failure,
    files::Files,
    scene::{Scene, SceneCamera, SceneFrame, VERSION},
};
use clip::Clip;
pub use formats::Source;
use notes::Notes;
use pcmvs_core::{Camera, Error, Rig};
pub use recognise::{KNOWN, of_folder, recognise};
use source::{failure, picture_size, usual_mask};
pub use source::{is_picture, is_video};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};
use view::ImportedView;

/// A scene that was made from another program's calibration.
#[derive(Debug)]
pub struct Imported {
    /// The scene, with one frame unless the source has pictures of several instants. Picture paths are those of the source.
    /// Camera names differ in more than upper and lower case, and are safe as file names. If [`Scene::videos`] is set, the one
    /// frame has the paths of the videos, which are not opened here: how many frames they show is unknown.
    pub scene: Scene,
    /// What was ignored or assumed, for the user.
    pub notes: Vec<String>,
}

/// Reads the calibration of another program.
pub fn import(files: &dyn Files, source: Source, path: &Path) -> Result<Imported, Failure> {
    let mut notes = Notes::default();
    #[cfg(feature = "formats")]
    let path = &further::only_file(files, source, path)?;
    let views = match source {
        Source::Middlebury => middlebury::read(files, path)?,
        Source::Colmap => colmap::read(files, path, &mut notes)?,
        Source::Opencv => opencv::read(files, path, &mut notes)?,
        Source::Transforms => transforms::read(files, path, &mut notes)?,
        Source::Easymocap => easymocap::read(files, path, &mut notes)?,
        #[cfg(feature = "formats")]
        Source::Bundler => bundler::read(files, path, &mut notes)?,
        #[cfg(feature = "formats")]
        Source::Metashape => metashape::read(files, path, &mut notes)?,
        #[cfg(feature = "formats")]
        Source::Neus => neus::import(files, path, &mut notes)?,
        #[cfg(feature = "formats")]
        Source::Anipose => rig_toml::read(files, path, &mut notes)?,
        #[cfg(feature = "formats")]
        Source::Panoptic => panoptic::read(files, path, &mut notes)?,
        #[cfg(feature = "formats")]
        Source::Mvsnet => mvsnet::read(files, path, &mut notes)?,
        #[cfg(feature = "formats")]
        Source::Kalibr => kalibr::read(files, path, &mut notes)?,
        #[cfg(feature = "formats")]
        Source::Realitycapture => realitycapture::read(files, path, &mut notes)?,
        #[cfg(feature = "formats")]
        Source::Qualisys => qualisys::read(files, path, &mut notes)?,
        #[cfg(feature = "formats")]
        Source::Zju => zju::import(files, path, &mut notes)?,
    };
    if views.is_empty() {
        let why: String = notes.into_list().into_iter().map(|note| format!("; {note}")).collect();
        return Err(Failure::Input(format!("{}: contains no camera that can be used{why}", path.display())));
    }
    let capture = if files.is_folder(path) { path } else { path.parent().unwrap_or(Path::new("")) };
    let of_videos = are_videos(&views)?;
    if of_videos {
        check_videos(&views)?;
    }
    let mut views = if of_videos { views } else { instants::find(files, capture, views) };
    let mut found = BTreeMap::new();
    for view in &mut views {
        view.camera.check().map_err(|problem| failure(&view.file, &view.name, &problem))?;
        let size = [view.camera.width, view.camera.height];
        if !of_videos {
            check_size(files, &view.image, &view.name, "picture", size)?;
        }
        if view.mask.is_none()
            && let Some(mask) = usual_mask(files, path, &view.image)
        {
            if let Some(other) = found.insert(mask.clone(), view.name.clone()) {
                let problem = format!(
                    "would be the mask of camera `{other}` too: repeat the folders of the pictures in the folder of the masks"
                );
                return Err(failure(&mask, &view.name, &problem));
            }
            view.mask = Some(mask);
        }
        match &view.mask {
            Some(mask) if of_videos && !is_video(mask) => {
                let problem =
                    "is one mask for a video: remove its key, and put a video of masks under the same name in `masks`";
                return Err(failure(mask, &view.name, problem));
            }
            Some(mask) if !of_videos => check_size(files, mask, &view.name, "mask", size)?,
            _ => {}
        }
    }
    let clip = clip::arrange(&views).map_err(|problem| Failure::Input(format!("{}: {problem}", path.display())))?;
    let names = camera_names(&views, &clip, &mut notes)?;
    clip.note(&views, &mut notes);
    note_equal_cameras(&views, &clip, &mut notes);
    note_refusal(&views, &clip, path, &mut notes);
    let scene = scene(&views, &clip, names);
    let mask_videos = of_videos && views.iter().any(|view| view.mask.is_some());
    Ok(Imported { scene: Scene { videos: of_videos, mask_videos, ..scene }, notes: notes.into_list() })
}

/// Whether the views have videos. A scene has either pictures or videos.
fn are_videos(views: &[ImportedView]) -> Result<bool, Failure> {
    let has_video = |view: &&ImportedView| is_video(&view.image);
    let (video, picture) = (views.iter().find(has_video), views.iter().find(|view| !has_video(view)));
    match (video, picture) {
        (Some(video), Some(picture)) => Err(failure(
            &video.image,
            &video.name,
            &format!("is a video, but camera `{}` has pictures: give all cameras the same", picture.name),
        )),
        _ => Ok(video.is_some()),
    }
}

/// Refuses a video that two cameras would have.
fn check_videos(views: &[ImportedView]) -> Result<(), Failure> {
    let mut cameras = BTreeMap::new();
    for view in views {
        if let Some(other) = cameras.insert(&view.image, &view.name) {
            let problem = format!("is the video of camera `{other}`, too: name videos after their cameras");
            return Err(failure(&view.image, &view.name, &problem));
        }
    }
    Ok(())
}

fn check_size(files: &dyn Files, file: &Path, camera: &str, what: &str, calibrated: [u32; 2]) -> Result<(), Failure> {
    let [width, height] = picture_size(files, file, camera)?;
    if [width, height] == calibrated {
        return Ok(());
    }
    let remedy = if [height, width] == calibrated {
        format!("its sides are exchanged: turn the pixels of the {what}, because an orientation in EXIF is not applied")
    } else {
        format!("give a {what} of the calibrated size")
    };
    let problem = format!(
        "the {what} is {width} x {height} pixels but the camera was calibrated at {} x {}: {remedy}",
        calibrated[0], calibrated[1]
    );
    Err(failure(file, camera, &problem))
}

/// The cameras' names, which are safe as file names. Two views of the same name are an error.
fn camera_names(views: &[ImportedView], clip: &Clip, notes: &mut Notes) -> Result<Vec<String>, Failure> {
    let mut unique = BTreeSet::new();
    let same = |view: &ImportedView| (view.name.clone(), view.time.map(f64::to_bits));
    if let Some(twice) = views.iter().find(|view| !unique.insert(same(view))) {
        return Err(failure(&twice.file, &twice.name, "occurs twice: give every camera its own name"));
    }
    let names: Vec<&str> = clip.cameras.iter().map(|&first| views[first].name.as_str()).collect();
    Ok(names::safe_names(&names, notes))
}

/// A clip in the form of many cameras would be one frame of pictures that contradict each other.
fn note_equal_cameras(views: &[ImportedView], clip: &Clip, notes: &mut Notes) {
    let equal = |a: &Camera, b: &Camera| (a.r, a.t, a.k) == (b.r, b.t, b.k);
    let cameras: Vec<&ImportedView> = clip.cameras.iter().map(|&first| &views[first]).collect();
    let pair = cameras.iter().enumerate().find_map(|(i, a)| {
        let b = cameras[..i].iter().find(|b| equal(&a.camera, &b.camera))?;
        Some((&b.name, &a.name))
    });
    if let Some((a, b)) = pair {
        notes.add(format!(
            "cameras `{a}` and `{b}` have the same pose and focal length: if their pictures show different instants, import \
             every instant by itself"
        ));
    }
}

/// Notes that frames of these cameras will fail, for example because poses are in another convention. Too few cameras are no
/// reason: the user may import more later.
fn note_refusal(views: &[ImportedView], clip: &Clip, path: &Path, notes: &mut Notes) {
    let cameras: Vec<Camera> = clip.cameras.iter().map(|&first| views[first].camera).collect();
    let problem = match Rig::check(&cameras) {
        Err(Error::Cameras { problem }) => problem,
        Err(Error::Camera { camera, problem }) => {
            format!("camera `{}`: {problem}", views[clip.cameras[camera as usize]].name)
        }
        _ => return,
    };
    notes.add(format!("{}: these cameras will be refused when a frame is made: {problem}", path.display()));
}

fn scene(views: &[ImportedView], clip: &Clip, names: Vec<String>) -> Scene {
    let frame = |(slots, index): (&Vec<Option<usize>>, u32)| SceneFrame {
        index,
        images: slots.iter().map(|slot| slot.map(|i| views[i].image.clone())).collect(),
        masks: Some(slots.iter().map(|slot| views[(*slot)?].mask.clone()).collect()),
    };
    Scene {
        version: VERSION,
        cameras: clip
            .cameras
            .iter()
            .zip(names)
            .map(|(&first, name)| SceneCamera::new(name, &views[first].camera))
            .collect(),
        frames: clip.frames.iter().zip(0..).map(frame).collect(),
        ..Scene::default()
    }
}

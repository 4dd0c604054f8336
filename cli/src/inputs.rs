//! The pictures and masks of a frame, from files to what the core takes.

use crate::{arguments::MaskSource, fingerprint::Fingerprint, threads::Threads, video::Videos, warning::WarningReport};
use pcmvs_core::{ChromaKey, Executor, Mask, ViewInput, silhouette::MORE_COLOURS};
use pcmvs_scene::{Background, Failure, Picture, Scene, SceneFrame, SilhouetteFiles};
use std::{
    fs, io,
    mem::take,
    path::Path,
    sync::{Mutex, PoisonError},
    thread,
};

/// Where the silhouettes come from.
#[derive(Debug, Clone, Copy)]
pub enum Silhouettes {
    /// Mask files; without one, the alpha channel of the picture.
    Files,
    /// The backdrop's colours.
    Key(ChromaKey),
    /// Pictures of the empty set.
    Plates,
}

impl Silhouettes {
    /// What was asked for, with what the scene holds for it. The scene notes which files that are, for its messages.
    pub fn new(masks: MaskSource, scene: &mut Scene) -> Result<Self, Failure> {
        let chosen = Self::of(masks, scene)?;
        scene.silhouettes = match chosen {
            Self::Files => SilhouetteFiles::Masks,
            Self::Plates => SilhouetteFiles::Plates,
            Self::Key(_) => SilhouetteFiles::None,
        };
        Ok(chosen)
    }

    fn of(masks: MaskSource, scene: &Scene) -> Result<Self, Failure> {
        let background = scene.background.as_ref();
        let problem = |problem: String| Failure::Input(format!("{}: {problem}", scene.path.display()));
        match masks {
            MaskSource::File => Ok(Self::Files),
            MaskSource::Plates if background.is_some_and(|background| background.plates.is_some()) => Ok(Self::Plates),
            MaskSource::Plates => Err(problem(String::from(
                "--masks plates needs pictures of the empty set: add \"background\": { \"plates\": [one path per camera] }",
            ))),
            MaskSource::Chroma => match background.map(Background::all_colours).unwrap_or_default() {
                colours if colours.is_empty() => Err(problem(String::from(
                    "--masks chroma needs the backdrop's colour: add \"background\": { \"chroma_rgb\": [r, g, b] }",
                ))),
                colours => ChromaKey::with_colours(&colours).map(Self::Key).ok_or_else(|| {
                    problem(format!(
                        "background.colours: {} colours are more than the {} that a chroma key holds: leave out similar ones",
                        colours.len(),
                        1 + MORE_COLOURS
                    ))
                }),
            },
        }
    }
}

/// What a path of the scene leads to.
enum Content {
    /// A file, not yet decoded.
    File(Vec<u8>),
    /// A picture of a video.
    Decoded(Picture),
    /// Nothing, and why.
    Missing(String),
}

/// What a camera has in a frame. A camera without picture needs no mask.
#[derive(Default)]
struct ViewFiles {
    image: Option<Content>,
    mask: Option<Content>,
}

/// The pictures and masks of a frame. Those in files are not yet decoded.
pub struct FrameFiles<'s> {
    scene: &'s Scene,
    frame: &'s SceneFrame,
    silhouettes: Silhouettes,
    views: Vec<ViewFiles>,
    /// Pictures and masks that scene.json names but that do not exist.
    pub warnings: Vec<WarningReport>,
}

/// The decoded pictures of a frame, one per camera: the picture, and the mask or clean plate. A camera without picture has none.
pub struct Pictures {
    views: Vec<Option<(Picture, Option<Picture>)>>,
    silhouettes: Silhouettes,
}

impl<'s> FrameFiles<'s> {
    /// Reads the files and videos of a frame. What does not exist is a warning. Videos are read fastest if the frames are asked
    /// for in their order.
    pub fn read(
        scene: &'s Scene,
        frame: &'s SceneFrame,
        silhouettes: Silhouettes,
        videos: &Videos,
    ) -> Result<Self, Failure> {
        let count = scene.cameras.len();
        let read = |camera: usize| ViewFiles::read(scene, frame, camera, silhouettes, videos);
        let views: Vec<Result<ViewFiles, Failure>> = if videos.is_empty() {
            (0..count).map(read).collect()
        } else {
            // Each video is decoded by a process of its own, so that threads only wait for them. The pool's threads would
            // take up other frames meanwhile, which come later in the videos.
            thread::scope(|scope| {
                let started: Vec<_> = (0..count).map(|camera| scope.spawn(move || read(camera))).collect();
                let panicked = |_| Err(Failure::Other(String::from("internal error while videos were read")));
                started.into_iter().map(|thread| thread.join().unwrap_or_else(panicked)).collect()
            })
        };
        let views = views.into_iter().collect::<Result<_, _>>()?;
        let mut files = Self { scene, frame, silhouettes, views, warnings: Vec::new() };
        files.warnings = files.missing();
        Ok(files)
    }

    /// Warnings about what does not exist.
    fn missing(&self) -> Vec<WarningReport> {
        let Self { scene, frame, .. } = *self;
        let plates = matches!(self.silhouettes, Silhouettes::Plates);
        let mask_code = if plates { "missing-plate" } else { "missing-mask" };
        let mut warnings = Vec::new();
        for (camera, view) in self.views.iter().enumerate() {
            for (content, path, code, effect) in [
                (&view.image, frame.image(camera), "missing-picture", "the view contributes nothing to the frame"),
                (&view.mask, scene.silhouette_file(frame, camera), mask_code, "the view does not carve the hull"),
            ] {
                let (Some(Content::Missing(why)), Some(path)) = (content, path) else { continue };
                warnings.push(WarningReport {
                    code: code.to_owned(),
                    frame: Some(frame.index),
                    camera: Some(scene.cameras[camera].name.clone()),
                    message: format!(
                        "{}: {why}, so that {effect}: check the path or pattern in scene.json, or write null",
                        scene.place_of(frame, camera, path)
                    ),
                });
            }
        }
        warnings
    }

    /// Adds the content of all files.
    pub fn add_to(&self, fingerprint: &mut Fingerprint) {
        for view in &self.views {
            for content in [&view.image, &view.mask] {
                let (kind, bytes) = match content {
                    None | Some(Content::Missing(_)) => (0, &[][..]),
                    Some(Content::File(bytes)) => (1, &bytes[..]),
                    Some(Content::Decoded(picture)) => (2, picture.pixels()),
                };
                fingerprint.add(&[kind]);
                fingerprint.add(bytes);
            }
        }
    }

    /// Decodes all files.
    pub fn decode(self, threads: &Threads) -> Result<Pictures, Failure> {
        let Self { scene, frame, silhouettes, .. } = self;
        let decode = |camera: usize, content: Option<Content>, path: Option<&Path>| match (content, path) {
            (Some(Content::File(bytes)), Some(path)) => {
                let place = |problem| Failure::Input(format!("{}: {problem}", scene.place_of(frame, camera, path)));
                Picture::decode(&bytes).map(Some).map_err(place)
            }
            (Some(Content::Decoded(picture)), _) => Ok(Some(picture)),
            _ => Ok(None),
        };
        let contents: Vec<Mutex<ViewFiles>> = self.views.into_iter().map(Mutex::new).collect();
        let views = threads.map(contents.len(), |camera| {
            let ViewFiles { image, mask } = take(&mut *contents[camera].lock().unwrap_or_else(PoisonError::into_inner));
            let Some(image) = decode(camera, image, frame.image(camera))? else { return Ok(None) };
            let mask = match (decode(camera, mask, scene.silhouette_file(frame, camera))?, silhouettes) {
                (Some(mask), Silhouettes::Files) => Some(mask.into_mask()),
                (None, Silhouettes::Files) => image.alpha(),
                (other, Silhouettes::Plates | Silhouettes::Key(_)) => other,
            };
            Ok(Some((image, mask)))
        });
        Ok(Pictures { views: views.into_iter().collect::<Result<_, Failure>>()?, silhouettes })
    }
}

impl ViewFiles {
    /// Reads what a camera has in a frame.
    fn read(
        scene: &Scene,
        frame: &SceneFrame,
        camera: usize,
        silhouettes: Silhouettes,
        videos: &Videos,
    ) -> Result<Self, Failure> {
        let content = |path: Option<&Path>, is_video: bool| {
            let Some(path) = path else { return Ok(None) };
            let problem =
                |problem: String| Failure::Input(format!("{}: {problem}", scene.place_of(frame, camera, path)));
            if is_video {
                let Some(number) = scene.cameras[camera].number(frame.index) else { return Ok(None) };
                let found = videos.picture(path, number).map_err(problem)?;
                return Ok(Some(found.map_or_else(Content::Missing, Content::Decoded)));
            }
            match fs::read(scene.resolve(path)) {
                Ok(bytes) => Ok(Some(Content::File(bytes))),
                Err(e) if e.kind() == io::ErrorKind::NotFound => {
                    Ok(Some(Content::Missing(String::from("the file does not exist"))))
                }
                Err(e) => Err(problem(format!("cannot be read ({e}): check that it is a file and readable"))),
            }
        };
        let image = content(frame.image(camera), scene.videos)?;
        let mask = match &image {
            None | Some(Content::Missing(_)) => None,
            Some(_) => {
                let is_video = scene.mask_videos && matches!(silhouettes, Silhouettes::Files);
                content(scene.silhouette_file(frame, camera), is_video)?
            }
        };
        Ok(Self { image, mask })
    }
}

impl Pictures {
    /// The pictures as the core takes them.
    pub fn inputs(&self) -> Vec<Option<ViewInput<'_>>> {
        self.views.iter().map(|view| view.as_ref().map(|(image, mask)| self.input(image, mask.as_ref()))).collect()
    }

    fn input<'p>(&self, image: &'p Picture, mask: Option<&'p Picture>) -> ViewInput<'p> {
        let mask = match (self.silhouettes, mask) {
            (Silhouettes::Key(key), _) => Mask::ChromaKey(key),
            (Silhouettes::Files, Some(mask)) => Mask::Given(mask.view()),
            (Silhouettes::Plates, Some(plate)) => Mask::CleanPlate(plate.view()),
            (Silhouettes::Files | Silhouettes::Plates, None) => Mask::Unknown,
        };
        ViewInput { image: image.view(), mask }
    }
}

//! The pictures and masks of a frame, from files to what the core takes.

use crate::{
    failure::Failure,
    files::Files,
    pictures::Picture,
    scene::{Background, Scene, SceneFrame, SilhouetteFiles},
};
use pcmvs_core::{ChromaKey, Executor, Mask, ViewInput, silhouette::MORE_COLOURS};
use std::{io, path::Path};

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
    pub fn new(files: SilhouetteFiles, scene: &mut Scene) -> Result<Self, Failure> {
        let chosen = Self::of(files, scene)?;
        scene.silhouettes = files;
        Ok(chosen)
    }

    fn of(files: SilhouetteFiles, scene: &Scene) -> Result<Self, Failure> {
        let background = scene.background.as_ref();
        let problem = |problem: String| Failure::Input(format!("{}: {problem}", scene.path.display()));
        match files {
            SilhouetteFiles::Masks => Ok(Self::Files),
            SilhouetteFiles::Plates if background.is_some_and(|background| background.plates.is_some()) => Ok(Self::Plates),
            SilhouetteFiles::Plates => Err(problem(String::from(
                "--masks plates needs pictures of the empty set: add \"background\": { \"plates\": [one path per camera] }",
            ))),
            SilhouetteFiles::None => match background.map(Background::all_colours).unwrap_or_default() {
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

/// The files of one camera and one frame, not yet decoded. A camera without picture has none.
#[derive(Default)]
struct ViewFiles {
    image: Option<Vec<u8>>,
    mask: Option<Vec<u8>>,
}

/// A file that scene.json names but that does not exist.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MissingFile {
    /// Stable name of the kind of file, in kebab-case.
    pub code: &'static str,
    /// Index of its camera.
    pub camera: usize,
    /// What is missing, what follows from it, and what to do.
    pub message: String,
}

/// The files of a frame, not yet decoded.
pub struct FrameFiles<'s> {
    scene: &'s Scene,
    frame: &'s SceneFrame,
    silhouettes: Silhouettes,
    views: Vec<ViewFiles>,
    /// Files that scene.json names but that do not exist.
    pub missing: Vec<MissingFile>,
}

/// The decoded pictures of a frame, one per camera: the picture, and the mask or clean plate. A camera without picture has none.
pub struct Pictures {
    views: Vec<Option<(Picture, Option<Picture>)>>,
    silhouettes: Silhouettes,
}

impl<'s> FrameFiles<'s> {
    /// Reads the files of a frame. One that does not exist is noted in [`Self::missing`].
    pub fn read(
        files: &dyn Files,
        scene: &'s Scene,
        frame: &'s SceneFrame,
        silhouettes: Silhouettes,
    ) -> Result<Self, Failure> {
        let mut found = Self { scene, frame, silhouettes, views: Vec::new(), missing: Vec::new() };
        for camera in 0..scene.cameras.len() {
            let mut read = |path: Option<&Path>, code: &'static str, effect: &str| {
                let Some(path) = path else { return Ok(None) };
                let place = || scene.place_of(frame, camera, path);
                match files.read(&scene.resolve(path)) {
                    Ok(bytes) => Ok(Some(bytes)),
                    Err(e) if e.kind() == io::ErrorKind::NotFound => {
                        found.missing.push(MissingFile {
                            code,
                            camera,
                            message: format!(
                                "{}: the file does not exist, so that {effect}: check the path in scene.json, or write null",
                                place()
                            ),
                        });
                        Ok(None)
                    }
                    Err(e) => Err(Failure::Input(format!(
                        "{}: cannot be read ({e}): check that it is a file and readable",
                        place()
                    ))),
                }
            };
            let image = read(frame.image(camera), "missing-picture", "the view contributes nothing to the frame")?;
            let code = if let Silhouettes::Plates = silhouettes { "missing-plate" } else { "missing-mask" };
            let mask = match &image {
                Some(_) => read(scene.silhouette_file(frame, camera), code, "the view does not carve the hull")?,
                None => None,
            };
            found.views.push(ViewFiles { image, mask });
        }
        Ok(found)
    }

    /// The content of all files: of each camera its picture, and its mask or clean plate.
    pub fn contents(&self) -> impl Iterator<Item = Option<&[u8]>> {
        self.views.iter().flat_map(|view| [view.image.as_deref(), view.mask.as_deref()])
    }

    /// Decodes all files.
    pub fn decode(self, executor: &impl Executor) -> Result<Pictures, Failure> {
        let Self { scene, frame, silhouettes, .. } = self;
        let decode = |camera: usize, file: &Option<Vec<u8>>, path: Option<&Path>| {
            let (Some(file), Some(path)) = (file, path) else { return Ok(None) };
            let decoded = Picture::decode(file);
            decoded
                .map(Some)
                .map_err(|problem| Failure::Input(format!("{}: {problem}", scene.place_of(frame, camera, path))))
        };
        let views = executor.map(self.views.len(), |camera| {
            let ViewFiles { image, mask } = &self.views[camera];
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

impl Pictures {
    /// The pictures of a host that has decoded them itself, with what their silhouettes are made of.
    pub fn new(views: Vec<Option<(Picture, Option<Picture>)>>, silhouettes: Silhouettes) -> Self {
        Self { views, silhouettes }
    }

    /// Of each camera its picture, and its mask or clean plate.
    pub fn views(&self) -> &[Option<(Picture, Option<Picture>)>] {
        &self.views
    }

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

//! The pictures and masks of a frame, from files to what the core takes.

use crate::{arguments::MaskSource, fingerprint::Fingerprint, threads::Threads, warning::WarningReport};
use pcmvs_core::{ChromaKey, Executor, Mask, ViewInput, silhouette::MORE_COLOURS};
use pcmvs_scene::{Background, Failure, Picture, Scene, SceneCamera, SceneFrame, SilhouetteFiles};
use std::{fs, io, path::Path};

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

/// The files of one camera and one frame, not yet decoded. A camera without picture has none.
#[derive(Default)]
struct ViewFiles {
    image: Option<Vec<u8>>,
    mask: Option<Vec<u8>>,
}

/// The files of a frame, not yet decoded.
pub struct FrameFiles<'s> {
    scene: &'s Scene,
    frame: &'s SceneFrame,
    silhouettes: Silhouettes,
    views: Vec<ViewFiles>,
    /// Files that scene.json names but that do not exist.
    pub warnings: Vec<WarningReport>,
}

/// The decoded pictures of a frame, one per camera: the picture, and the mask or clean plate. A camera without picture has none.
pub struct Pictures {
    views: Vec<Option<(Picture, Option<Picture>)>>,
    silhouettes: Silhouettes,
}

impl<'s> FrameFiles<'s> {
    /// Reads the files of a frame. A file that does not exist is a warning.
    pub fn read(scene: &'s Scene, frame: &'s SceneFrame, silhouettes: Silhouettes) -> Result<Self, Failure> {
        let mut files = Self { scene, frame, silhouettes, views: Vec::new(), warnings: Vec::new() };
        for (camera, SceneCamera { name, .. }) in scene.cameras.iter().enumerate() {
            let mut read = |path: Option<&Path>, code: &str, effect: &str| {
                let Some(path) = path else { return Ok(None) };
                let place = || scene.place_of(frame, camera, path);
                match fs::read(scene.resolve(path)) {
                    Ok(bytes) => Ok(Some(bytes)),
                    Err(e) if e.kind() == io::ErrorKind::NotFound => {
                        files.warnings.push(WarningReport {
                            code: code.to_owned(),
                            frame: Some(frame.index),
                            camera: Some(name.clone()),
                            message: format!(
                                "{}: the file does not exist, so that {effect}: check the path or pattern in scene.json, or write null",
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
            files.views.push(ViewFiles { image, mask });
        }
        Ok(files)
    }

    /// Adds the content of all files.
    pub fn add_to(&self, fingerprint: &mut Fingerprint) {
        for view in &self.views {
            for file in [&view.image, &view.mask] {
                fingerprint.add(&[u8::from(file.is_some())]);
                fingerprint.add(file.as_deref().unwrap_or_default());
            }
        }
    }

    /// Decodes all files.
    pub fn decode(self, threads: &Threads) -> Result<Pictures, Failure> {
        let Self { scene, frame, silhouettes, .. } = self;
        let decode = |camera: usize, file: &Option<Vec<u8>>, path: Option<&Path>| {
            let (Some(file), Some(path)) = (file, path) else { return Ok(None) };
            let decoded = Picture::decode(file);
            decoded
                .map(Some)
                .map_err(|problem| Failure::Input(format!("{}: {problem}", scene.place_of(frame, camera, path))))
        };
        let views = threads.map(self.views.len(), |camera| {
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

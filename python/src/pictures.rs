//! The pictures of a frame, from arrays to what the core takes.

use crate::{
    arrays::{Kind, of_picture, to_picture},
    error::Problem,
};
use pcmvs_core::{ChromaKey, Error, silhouette::MORE_COLOURS};
use pcmvs_scene::{Picture, Pictures, Silhouettes};
use pyo3::{prelude::*, types::PyDict};

/// An array or None per camera.
pub type Arrays<'py> = Vec<Option<Bound<'py, PyAny>>>;

/// The pictures of one frame as the caller gives them.
pub struct Given<'py> {
    pub images: Arrays<'py>,
    pub masks: Option<Arrays<'py>>,
    pub chroma: Option<Vec<[u8; 3]>>,
    pub plates: Option<Arrays<'py>>,
}

impl<'py> Given<'py> {
    /// From a dictionary of the arguments' names.
    pub fn from_dict(dict: &Bound<'py, PyDict>) -> PyResult<Self> {
        const NAMES: [&str; 4] = ["images", "masks", "chroma", "plates"];
        if let Some(unknown) = dict.keys().iter().find(|key| !NAMES.iter().any(|name| key.eq(*name).unwrap_or(false))) {
            let problem = format!("frames: {unknown} is not one of {NAMES:?}");
            return Err(Problem::argument(problem).into());
        }
        let get = |name: &str| Ok::<_, PyErr>(dict.get_item(name)?.filter(|value| !value.is_none()));
        let arrays = |name: &str| get(name)?.map(|value| value.extract()).transpose();
        let images = arrays("images")?.ok_or_else(|| Problem::argument("frames: one of them has no \"images\""))?;
        let chroma = get("chroma")?.map(|value| value.extract()).transpose()?;
        Ok(Self { images, masks: arrays("masks")?, chroma, plates: arrays("plates")? })
    }

    /// Copies all pixels. Without masks and a backdrop, the alpha channel of a picture that was cut out is its mask.
    pub fn read(&self, cameras: usize) -> PyResult<Pictures> {
        if self.images.len() != cameras {
            let error = Error::ViewCount { given: self.images.len() as u32, cameras: cameras as u32 };
            return Err(Problem::from(error).into());
        }
        let (silhouettes, second, kind) = self.silhouettes()?;
        if let Some(arrays) = second.filter(|arrays| arrays.len() != cameras) {
            let problem = format!(
                "{} masks or plates given for {cameras} cameras: give one per camera, in the same order, None where there is none",
                arrays.len()
            );
            return Err(Problem::argument(problem).into());
        }
        let view = |camera: usize| {
            let Some(image) = &self.images[camera] else { return Ok(None) };
            let image = to_picture(image, Kind::Image, camera)?;
            let second = second.and_then(|arrays| arrays[camera].as_ref());
            let second = second.map(|array| to_picture(array, kind, camera)).transpose()?;
            let second = match (silhouettes, second) {
                (Silhouettes::Files, None) => image.alpha(),
                (Silhouettes::Files, Some(mask)) => Some(mask.into_mask()),
                (_, plate) => plate,
            };
            Ok(Some((image, second)))
        };
        let views = (0..cameras).map(view).collect::<PyResult<_>>()?;
        Ok(Pictures::new(views, silhouettes))
    }

    /// What the silhouettes are made of, and the masks or plates for it.
    fn silhouettes(&self) -> PyResult<(Silhouettes, Option<&Arrays<'py>>, Kind)> {
        match (&self.masks, &self.chroma, &self.plates) {
            (masks, None, None) => Ok((Silhouettes::Files, masks.as_ref(), Kind::Mask)),
            (None, Some(colours), None) => match ChromaKey::with_colours(colours) {
                Some(key) => Ok((Silhouettes::Key(key), None, Kind::Mask)),
                None => {
                    let problem = format!("chroma has {} colours: give 1 to {}", colours.len(), 1 + MORE_COLOURS);
                    Err(Problem::argument(problem).into())
                }
            },
            (None, None, Some(plates)) => Ok((Silhouettes::Plates, Some(plates), Kind::Plate)),
            _ => Err(Problem::argument("give masks, chroma or plates, and only one of them").into()),
        }
    }
}

/// The arguments that give these pictures, as arrays.
pub fn to_dict<'py>(py: Python<'py>, pictures: &Pictures, silhouettes: Silhouettes) -> PyResult<Bound<'py, PyDict>> {
    let arrays = |of: fn(&(Picture, Option<Picture>)) -> Option<&Picture>| {
        let pictures = pictures.views().iter().map(|view| view.as_ref().and_then(of));
        pictures.map(|picture| picture.map(|picture| of_picture(py, picture)).transpose()).collect::<PyResult<Vec<_>>>()
    };
    let dict = PyDict::new(py);
    dict.set_item("images", arrays(|(image, _)| Some(image))?)?;
    match silhouettes {
        Silhouettes::Files => dict.set_item("masks", arrays(|(_, mask)| mask.as_ref())?)?,
        Silhouettes::Plates => dict.set_item("plates", arrays(|(_, plate)| plate.as_ref())?)?,
        Silhouettes::Key(ChromaKey { rgb, more, .. }) => {
            let colours = [rgb].into_iter().chain(more.into_iter().flatten());
            dict.set_item("chroma", colours.map(|[r, g, b]| (r, g, b)).collect::<Vec<_>>())?;
        }
    }
    Ok(dict)
}

//! NumPy arrays, in and out.

use crate::error::Problem;
use numpy::{
    Element, PyArray1, PyArray2, PyArray3, PyArrayDescrMethods, PyArrayMethods, PyReadonlyArrayDyn, PyUntypedArray,
    PyUntypedArrayMethods, dtype,
};
use pcmvs_core::PixelFormat;
use pcmvs_scene::Picture;
use pyo3::prelude::*;

/// An array with N columns.
pub fn rows<'py, T: Element, const N: usize>(
    py: Python<'py>,
    rows: impl IntoIterator<Item = [T; N]>,
) -> PyResult<Bound<'py, PyArray2<T>>> {
    let flat: Vec<T> = rows.into_iter().flatten().collect();
    let count = flat.len() / N;
    PyArray1::from_vec(py, flat).reshape([count, N])
}

/// Pixels as an array of height x width, or height x width x channels.
pub fn of_picture<'py>(py: Python<'py>, picture: &Picture) -> PyResult<Bound<'py, PyAny>> {
    let view = picture.view();
    pixels(py, view.data, [view.height, view.width].map(|side| side as usize), view.format.bytes_per_pixel())
}

/// As [`of_picture`], with the number of bytes per pixel.
pub fn pixels<'py>(
    py: Python<'py>,
    bytes: &[u8],
    [height, width]: [usize; 2],
    channels: usize,
) -> PyResult<Bound<'py, PyAny>> {
    let flat = PyArray1::from_slice(py, bytes);
    match channels {
        1 => flat.reshape([height, width]).map(Bound::into_any),
        _ => flat.reshape([height, width, channels]).map(Bound::<PyArray3<u8>>::into_any),
    }
}

/// What an array holds.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    Image,
    Mask,
    Plate,
}

impl Kind {
    /// The argument that the array comes from.
    const fn argument(self) -> &'static str {
        match self {
            Self::Image => "images",
            Self::Mask => "masks",
            Self::Plate => "plates",
        }
    }
}

/// A copy of an array's pixels, so that the core can work while other threads of the program go on. Views with strides of
/// any kind are taken as they look in Python.
pub fn to_picture(array: &Bound<PyAny>, kind: Kind, camera: usize) -> PyResult<Picture> {
    let name = format!("{}[{camera}]", kind.argument());
    let refused = |problem: String| PyErr::from(Problem::argument(format!("{name} {problem}")).of_camera(camera));
    let Ok(untyped) = array.cast::<PyUntypedArray>() else {
        let class = array.get_type().name()?;
        return Err(refused(format!("is a {class}: give a NumPy array, or None")));
    };
    let (py, shape) = (array.py(), untyped.shape());
    let format = match *shape {
        [_, _] | [_, _, 1] => PixelFormat::Gray8,
        [_, _, 3] => PixelFormat::Rgb8,
        [_, _, 4] => PixelFormat::Rgba8,
        _ => {
            let problem = format!("has the shape {shape:?}: give height x width, or height x width x 3 or 4 channels");
            return Err(refused(problem));
        }
    };
    let side = |of: usize| u32::try_from(shape[of]).map_err(|_| refused(format!("has the shape {shape:?}: too large")));
    let (height, width) = (side(0)?, side(1)?);
    let packed = py.import("numpy")?.call_method1("ascontiguousarray", (array,))?;
    let found = untyped.dtype();
    let bytes = if found.is_equiv_to(&dtype::<u8>(py)) {
        packed.extract::<PyReadonlyArrayDyn<u8>>()?.as_slice()?.to_vec()
    } else if kind == Kind::Mask && found.is_equiv_to(&dtype::<bool>(py)) {
        let bools = packed.extract::<PyReadonlyArrayDyn<bool>>()?;
        bools.as_slice()?.iter().map(|&set| if set { 255 } else { 0 }).collect()
    } else {
        let or_bool = if kind == Kind::Mask { " or bool" } else { "" };
        return Err(refused(format!(
            "holds {found}: give uint8{or_bool}; multiply values of 0 to 1 by 255, divide those of 16 bits by 257, and then use \
             .astype(\"uint8\")"
        )));
    };
    if kind == Kind::Mask && found.is_equiv_to(&dtype::<u8>(py)) && bytes.iter().max() == Some(&1) {
        return Err(refused(String::from("holds nothing above 1: give bool, or 255 on the object")));
    }
    Ok(Picture::new(bytes, width, height, format))
}

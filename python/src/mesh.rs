//! Meshes and point clouds as arrays and files.

use crate::{
    arrays::{pixels, rows},
    error::Problem,
};
use numpy::{PyArray1, PyArray2};
use pcmvs_core::{
    Form, Point, PointCloud,
    export::{glb, ply},
    glam::DVec3,
};
use pcmvs_scene::{
    compress::{self, Meshopt},
    output,
};
use pyo3::{prelude::*, types::PyBytes};
use std::path::PathBuf;

/// A triangle mesh. The arrays are copies, so that changing them changes no file.
#[pyclass(frozen, module = "pcmvs")]
pub struct Mesh {
    form: Form,
    origin: DVec3,
    /// x, y, z per vertex in the scene's frame, float64, n x 3.
    #[pyo3(get)]
    positions: Py<PyArray2<f64>>,
    /// Outward unit normal per vertex, float32, n x 3.
    #[pyo3(get)]
    normals: Py<PyArray2<f32>>,
    /// Red, green, blue per vertex in sRGB, uint8, n x 3. None if the mesh has no colours of vertices.
    #[pyo3(get)]
    colours: Option<Py<PyArray2<u8>>>,
    /// Three vertices per triangle, counter-clockwise seen from outside, uint32, m x 3.
    #[pyo3(get)]
    triangles: Py<PyArray2<u32>>,
    /// Texture coordinates per vertex, float32, n x 2. (0, 0) is the upper left corner of the picture. None without a
    /// texture.
    #[pyo3(get)]
    uvs: Option<Py<PyArray2<f32>>>,
    /// The texture in sRGB, uint8, s x s x 3. None without one.
    #[pyo3(get)]
    texture: Option<Py<PyAny>>,
}

/// The positions of points in the scene's frame.
fn scene_positions<'a>(origin: DVec3, points: impl Iterator<Item = &'a pcmvs_core::glam::Vec3>) -> Vec<[f64; 3]> {
    points.map(|p| (origin + p.as_dvec3()).to_array()).collect()
}

impl Mesh {
    pub fn new(py: Python, form: Form, origin: DVec3) -> PyResult<Self> {
        let mesh = &form.mesh;
        let colours = (!mesh.colours.is_empty()).then(|| rows(py, mesh.colours.iter().copied()));
        let uvs = form.texture.as_ref().map(|texture| rows(py, texture.uvs.iter().copied()));
        let texels = form.texture.as_ref().map(|texture| pixels(py, &texture.texels, [texture.size as usize; 2], 3));
        Ok(Self {
            positions: rows(py, scene_positions(origin, mesh.positions.iter()))?.unbind(),
            normals: rows(py, mesh.normals.iter().map(|n| n.to_array()))?.unbind(),
            colours: colours.transpose()?.map(Bound::unbind),
            triangles: rows(py, mesh.triangles.iter().copied())?.unbind(),
            uvs: uvs.transpose()?.map(Bound::unbind),
            texture: texels.transpose()?.map(Bound::unbind),
            form,
            origin,
        })
    }
}

/// How a GLB file is written.
struct Glb {
    options: glb::Options,
    /// EXT_meshopt_compression.
    compress: bool,
}

/// Checked options of a GLB file.
fn options(
    normals: Option<bool>,
    up: Option<[f64; 3]>,
    upright: bool,
    compact: bool,
    compress: bool,
    jpeg_quality: u8,
) -> Result<Glb, Problem> {
    if upright && up.is_none() {
        return Err(Problem::argument("upright needs the upward direction: give up, such as (0, 0, 1)"));
    }
    if !(1..=100).contains(&jpeg_quality) {
        return Err(Problem::argument(format!("jpeg_quality is {jpeg_quality}: it is 1 to 100")));
    }
    // As the command line's --compress.
    let (normals, compact) = (normals.unwrap_or(!compress), compact || compress);
    let options = glb::Options { normals, up, upright, compact, jpeg_quality };
    options.check_up().map_err(Problem::argument)?;
    Ok(Glb { options, compress })
}

impl Mesh {
    fn glb(&self, file: &Glb) -> Vec<u8> {
        if file.compress {
            let sorted = compress::sort(self.form.clone());
            glb::write_form(&sorted, self.origin, &file.options, Some(&Meshopt))
        } else {
            glb::write_form(&self.form, self.origin, &file.options, None)
        }
    }

    fn ply(&self) -> Result<Vec<u8>, Problem> {
        match self.form.texture {
            Some(_) => Err(Problem::argument("PLY files have no texture: write a GLB")),
            None => Ok(ply::write_mesh(&self.form.mesh, self.origin)),
        }
    }
}

#[pymethods]
impl Mesh {
    /// The bytes of a GLB file.
    ///
    /// ``normals`` are only needed by programs that light the mesh. They are written unless ``compress`` is set; True or
    /// False decides otherwise. ``up`` is the scene's upward direction, which the file records; with ``upright`` the mesh is
    /// also turned so that it stands in every player. ``compact`` writes integers of few bits (KHR_mesh_quantization).
    /// ``compress`` compresses them, too, by meshoptimizer (EXT_meshopt_compression), and is the command line's
    /// ``--compress``. Its vertices and triangles are in another order than those of the arrays. ``jpeg_quality``, 1 to 100,
    /// is that of a texture, and changes nothing in files without one.
    #[pyo3(signature = (*, normals = None, up = None, upright = false, compact = false, compress = false, jpeg_quality = 90))]
    fn to_glb<'py>(
        &self,
        py: Python<'py>,
        normals: Option<bool>,
        up: Option<[f64; 3]>,
        upright: bool,
        compact: bool,
        compress: bool,
        jpeg_quality: u8,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let file = options(normals, up, upright, compact, compress, jpeg_quality)?;
        let bytes = py.detach(|| self.glb(&file));
        Ok(PyBytes::new(py, &bytes))
    }

    /// The bytes of a binary PLY file with sRGB colours, in the scene's frame.
    fn to_ply<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = py.detach(|| self.ply())?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// Writes a file, ``.glb`` or ``.ply``. The options are those of ``to_glb``. PLY files have normals, are in the scene's
    /// frame and have no place for ``up``: other options than ``up`` and ``jpeg_quality`` are refused for them. The file has its
    /// name only once it is complete.
    #[pyo3(signature = (
        path, *, normals = None, up = None, upright = false, compact = false, compress = false, jpeg_quality = 90
    ))]
    fn save(
        &self,
        py: Python,
        path: PathBuf,
        normals: Option<bool>,
        up: Option<[f64; 3]>,
        upright: bool,
        compact: bool,
        compress: bool,
        jpeg_quality: u8,
    ) -> PyResult<()> {
        let file = options(normals, up, upright, compact, compress, jpeg_quality)?;
        let asked = [
            (upright, "upright"),
            (compact, "compact"),
            (compress, "compress"),
            // A PLY has normals.
            (normals == Some(false), "normals=False"),
        ];
        let only_for_glb = asked.into_iter().find_map(|(is_asked, option)| is_asked.then_some(option));
        let write = || {
            let bytes = match path.extension().and_then(|extension| extension.to_str()) {
                Some("glb") => self.glb(&file),
                Some("ply") => match only_for_glb {
                    Some(option) => {
                        let problem = format!("{option} is for GLB files: write a .glb, or leave it out");
                        return Err(Problem::argument(problem));
                    }
                    None => self.ply()?,
                },
                _ => {
                    let path = path.display();
                    return Err(Problem::argument(format!("{path}: the name must end with .glb or .ply")));
                }
            };
            Ok(output::write(&path, &bytes)?)
        };
        Ok(py.detach(write)?)
    }

    fn __repr__(&self) -> String {
        let mesh = &self.form.mesh;
        format!("Mesh({} vertices, {} triangles)", mesh.positions.len(), mesh.triangles.len())
    }
}

/// Oriented points of one of the stages. The arrays are copies.
#[pyclass(frozen, module = "pcmvs")]
pub struct Points {
    points: PointCloud,
    origin: DVec3,
    /// x, y, z in the scene's frame, float64, n x 3.
    #[pyo3(get)]
    positions: Py<PyArray2<f64>>,
    /// Outward unit normals, float32, n x 3.
    #[pyo3(get)]
    normals: Py<PyArray2<f32>>,
    /// How well the neighbouring views agree (eq. 1 of the paper), float32.
    #[pyo3(get)]
    fidelity: Py<PyArray1<f32>>,
    /// Standard deviation along the normal in pixels of footprint, float32.
    #[pyo3(get)]
    sigma: Py<PyArray1<f32>>,
    /// Weight in meshing (eq. 3), float32.
    #[pyo3(get)]
    weight: Py<PyArray1<f32>>,
    /// Index of the camera that detected the point, int32. -1 where none did.
    #[pyo3(get)]
    camera: Py<PyArray1<i32>>,
    /// Kind of point, uint8: 0 implicit, 1 substituted by the hull, 2 detected by stereo, 3 frontier.
    #[pyo3(get)]
    rank: Py<PyArray1<u8>>,
}

impl Points {
    /// `order` gives the index of the camera of each place in the rig's order.
    pub fn new(py: Python, points: &[Point], origin: DVec3, order: &[u32]) -> PyResult<Self> {
        let floats = |of: fn(&Point) -> f32| PyArray1::from_vec(py, points.iter().map(of).collect()).unbind();
        let camera = |p: &Point| if p.view == Point::NO_VIEW { -1 } else { order[usize::from(p.view)] as i32 };
        Ok(Self {
            positions: rows(py, scene_positions(origin, points.iter().map(|p| &p.position)))?.unbind(),
            normals: rows(py, points.iter().map(|p| p.normal.to_array()))?.unbind(),
            fidelity: floats(|p| p.fidelity),
            sigma: floats(|p| p.sigma),
            weight: floats(|p| p.weight),
            camera: PyArray1::from_vec(py, points.iter().map(camera).collect()).unbind(),
            rank: PyArray1::from_vec(py, points.iter().map(|p| p.rank as u8).collect()).unbind(),
            points: points.to_vec(),
            origin,
        })
    }
}

#[pymethods]
impl Points {
    /// The bytes of a binary PLY file in the scene's frame.
    fn to_ply<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        let bytes = py.detach(|| ply::write_cloud(&self.points, self.origin));
        PyBytes::new(py, &bytes)
    }

    fn __len__(&self) -> usize {
        self.points.len()
    }

    fn __repr__(&self) -> String {
        format!("Points({})", self.points.len())
    }
}

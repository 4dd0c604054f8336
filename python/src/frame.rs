//! Frames.

use crate::{
    arrays::rows,
    error::Problem,
    mesh::{Mesh, Points},
    params::{Asked, to_python},
    pictures::{Arrays, Given},
    report::{CaptureWarning, ViewDiagnostics},
    rig::Rig,
    work::run,
};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pcmvs_core::{
    Error, Executor, Form, FormParams, Memory, Progress, Stage, TextureParams,
    frame::{ORDER, position},
    lost_part::Beside,
    silhouette::Silhouette,
    steady::SteadyParams,
};
use pcmvs_scene::Pictures;
use pyo3::{
    prelude::*,
    types::{PyDict, PyTuple},
};
use std::{borrow::Cow, num::NonZeroUsize, sync::Arc};

type CoreFrame = pcmvs_core::Frame<Arc<pcmvs_core::Rig>>;

/// One instant, from pictures to a coloured mesh.
///
/// ``images`` has one uint8 array per camera, in the order of the rig: height x width x 3 in RGB, x 4 in RGBA, or height x
/// width in gray. None is a camera without picture. The silhouettes come from one of:
///
/// - ``masks``: one uint8 or bool array per camera, white on the object. Gray edges place the contour between pixels. None
///   carves nothing.
/// - the alpha channels of the images, if there are no masks,
/// - ``chroma``: up to four approximate colours of a painted backdrop, such as ``[(40, 165, 75)]``,
/// - ``plates``: one picture of the empty set per camera.
///
/// ``params`` is the name of a preset ("default", "paper", "hull", "preview") or a changed ``pcmvs.preset(...)``. A frame
/// that needs more than ``max_memory`` bytes fails before it takes them.
///
/// ``before`` and ``after`` are the pictures of the frames before and after, as dictionaries of ``images`` and what else these
/// arguments name. Parts that a silhouette lacks and those of both other frames have are then added to it, if the picture shows
/// them, such as an arm that the masks of one frame lack. ``may_have_lost_part`` of a frame that was made without them says
/// whether it is worth the time.
///
/// The arrays are copied, and the pictures are kept until the frame is freed: keep its ``mesh()`` rather than the frame.
#[pyclass(module = "pcmvs")]
pub struct Frame {
    frame: CoreFrame,
    /// Until all of them have been read.
    pictures: Option<Pictures>,
    /// Those of the frames before and after.
    beside: Option<[Pictures; 2]>,
    restored: u32,
}

/// The stage with a name.
fn stage(name: &str) -> Result<Stage, Problem> {
    let found = ORDER.into_iter().find(|stage| stage.name() == name);
    found.ok_or_else(|| {
        Problem::argument(format!("there is no stage {name:?}: it is one of {:?}", ORDER.map(Stage::name)))
    })
}

/// The texture that the caller asks for.
#[derive(FromPyObject)]
enum TextureSize {
    Chosen(bool),
    Given(u32),
}

impl TextureSize {
    fn params(self) -> Option<TextureParams> {
        match self {
            Self::Chosen(false) => None,
            Self::Chosen(true) => Some(TextureParams { size: None }),
            Self::Given(size) => Some(TextureParams { size: Some(size) }),
        }
    }
}

impl Frame {
    fn has(&self, stage: Stage) -> bool {
        self.frame.require(stage).is_ok()
    }

    fn require(&self, stage: Stage) -> Result<(), Problem> {
        Ok(self.frame.require(stage)?)
    }

    /// Place of a camera in the rig's order.
    fn place(&self, camera: usize) -> Result<usize, Problem> {
        Ok(self.frame.place(camera)?)
    }

    /// Fails unless another frame is complete and has the same cameras.
    fn check_neighbour(&self, other: &Self) -> Result<(), Problem> {
        other.require(Stage::Colour)?;
        if other.frame.rig().origin() != self.frame.rig().origin() {
            return Err(Problem::argument("a neighbour has other cameras: use frames of the same rig"));
        }
        Ok(())
    }

    /// Runs the stages up to one of them that are not complete.
    fn advance(&mut self, last: Stage, executor: &dyn Executor, progress: &dyn Progress) -> Result<(), Problem> {
        if let Some(pictures) = &self.pictures {
            let inputs = pictures.inputs();
            if let Some(beside) = &self.beside {
                let [before, after] = beside.each_ref().map(Pictures::inputs);
                self.restored = self.frame.read_views_between(executor, progress, |camera, give| {
                    give(inputs[camera].as_ref(), [before[camera].as_ref(), after[camera].as_ref()])
                })?;
            } else {
                let read = executor.map(inputs.len(), |camera| match &inputs[camera] {
                    Some(input) => self.frame.view(camera, input, progress),
                    None => self.frame.without_picture(camera),
                });
                read.into_iter().collect::<Result<(), Error>>()?;
            }
        }
        (self.pictures, self.beside) = (None, None);
        for stage in ORDER.into_iter().take_while(|&stage| position(stage) <= position(last)) {
            if !self.has(stage) {
                self.frame.step(stage, executor, progress)?;
            }
        }
        Ok(())
    }

    /// A mesh of a stage.
    fn mesh_of(&self, py: Python, stage: Stage, mesh: &pcmvs_core::Mesh) -> PyResult<Mesh> {
        self.require(stage)?;
        Mesh::new(py, Form { mesh: mesh.clone(), texture: None }, self.frame.rig().origin())
    }
}

#[pymethods]
impl Frame {
    #[new]
    #[pyo3(
        signature = (rig, images, masks = None, *, chroma = None, plates = None, before = None, after = None,
                     params = Asked::default(), max_memory = None),
        text_signature = "(rig, images, masks=None, *, chroma=None, plates=None, before=None, after=None, params='default', \
                          max_memory=None)"
    )]
    fn new(
        rig: PyRef<Rig>,
        images: Arrays,
        masks: Option<Arrays>,
        chroma: Option<Vec<[u8; 3]>>,
        plates: Option<Arrays>,
        before: Option<Bound<PyDict>>,
        after: Option<Bound<PyDict>>,
        params: Asked,
        max_memory: Option<u64>,
    ) -> PyResult<Self> {
        let cameras = rig.rig.cameras().len();
        let pictures = Given { images, masks, chroma, plates }.read(cameras)?;
        let beside = match (before, after) {
            (Some(before), Some(after)) => {
                let read = |dict: &Bound<PyDict>| Given::from_dict(dict)?.read(cameras);
                Some([read(&before)?, read(&after)?])
            }
            (None, None) => None,
            _ => return Err(Problem::argument("give the pictures of both frames, before and after, or of none").into()),
        };
        let memory = max_memory.map_or_else(Memory::default, Memory::limited);
        let frame = CoreFrame::new(rig.rig.clone(), params.read()?, memory);
        Ok(Self { frame, pictures: Some(pictures), beside, restored: 0 })
    }

    /// Runs the stages that are not complete, up to the stage ``until``, or all of them.
    ///
    /// ``progress(stage, done)`` is called on this thread with the name of a stage and the share of it that is done, 0 to 1.
    /// If it returns False, the call fails with ``Cancelled``. An exception in it, or Ctrl-C, also stops the work and comes
    /// out. The frame then is as it was after the last complete stage, and ``run`` goes on from there.
    ///
    /// Other threads of the program run meanwhile, but this frame cannot be used. ``threads`` is the number of threads, that of
    /// the cores by default. It does not change the result.
    #[pyo3(signature = (until = "colour", *, threads = None, progress = None))]
    fn run(
        &mut self,
        py: Python,
        until: &str,
        threads: Option<NonZeroUsize>,
        progress: Option<&Bound<PyAny>>,
    ) -> PyResult<()> {
        let last = stage(until)?;
        run(py, threads, progress, |executor, progress| self.advance(last, executor, progress))
    }

    /// Names of the stages in their order.
    #[classattr]
    #[pyo3(name = "STAGES")]
    fn stages(py: Python) -> PyResult<Bound<PyTuple>> {
        PyTuple::new(py, ORDER.map(Stage::name))
    }

    /// Name of the last complete stage. None before the first.
    #[getter]
    fn reached(&self) -> Option<&'static str> {
        ORDER.into_iter().rev().find(|&stage| self.has(stage)).map(Stage::name)
    }

    /// The mesh, closed and manifold. It has colours after the stage "colour".
    fn mesh(&self, py: Python) -> PyResult<Mesh> {
        self.mesh_of(py, Stage::Mesh, self.frame.mesh())
    }

    /// The mesh of the visual hull, after the stage "hull".
    fn hull(&self, py: Python) -> PyResult<Mesh> {
        self.mesh_of(py, Stage::Hull, &self.frame.intermediates().hull)
    }

    /// The mesh that guides detection, after the stage "coarse". Empty if the parameters have no coarse pass.
    fn coarse(&self, py: Python) -> PyResult<Mesh> {
        self.mesh_of(py, Stage::Coarse, &self.frame.intermediates().coarse)
    }

    /// Number of cameras whose silhouettes lacked a part that ``before`` and ``after`` have and the picture shows. 0 until the
    /// stage "views" is complete, and without these frames.
    #[getter]
    fn restored(&self) -> u32 {
        self.restored
    }

    /// Whether the finished frame may have lost a part, such as an arm, that the frames before and after it have, because many
    /// or all of its masks lack it. If so, make the frame again with their pictures, ``Frame(..., before=..., after=...)``. If
    /// its ``restored`` is not 0, use that one instead, averaged with the same neighbours. The meshes of the neighbours count as
    /// they were reconstructed. No pictures are read, and the answer is nearly always False. If one of them lacks the part, too,
    /// name the frame beyond it.
    #[pyo3(signature = (before, after, *, threads = None))]
    fn may_have_lost_part(
        &self,
        py: Python,
        before: PyRef<Self>,
        after: PyRef<Self>,
        threads: Option<NonZeroUsize>,
    ) -> PyResult<bool> {
        self.require(Stage::Colour)?;
        let neighbours = [&*before, &*after];
        neighbours.into_iter().try_for_each(|other| self.check_neighbour(other))?;
        let overruled = neighbours.map(|other| other.frame.overruled());
        let beside = [0, 1].map(|i| Beside { mesh: neighbours[i].frame.own_mesh(), overruled: &overruled[i] });
        run(py, threads, None, |executor, _| Ok(self.frame.may_have_lost_part(beside, executor)?))
    }

    /// Averages the finished mesh with those of neighbouring frames, such as the one before and the one after it, along
    /// surfaces that move with the subject. ``mesh()`` and ``form()`` then have the mean. The meshes of the neighbours count as
    /// they were reconstructed, so that the order in which frames are averaged does not matter. A later call replaces the
    /// result of an earlier one; without neighbours, the frame has its own mesh again.
    #[pyo3(signature = (neighbours, *, threads = None, progress = None))]
    fn steady(
        &mut self,
        py: Python,
        neighbours: Vec<PyRef<Self>>,
        threads: Option<NonZeroUsize>,
        progress: Option<&Bound<PyAny>>,
    ) -> PyResult<()> {
        let own_mesh = |other: PyRef<Self>| -> Result<pcmvs_core::Mesh, Problem> {
            self.check_neighbour(&other)?;
            Ok(other.frame.own_mesh().clone())
        };
        // Copies, because the work runs without Python's lock.
        let meshes = neighbours.into_iter().map(own_mesh).collect::<Result<Vec<_>, _>>()?;
        let meshes: Vec<&pcmvs_core::Mesh> = meshes.iter().collect();
        run(py, threads, progress, |executor, progress| {
            Ok(self.frame.steady(&meshes, &SteadyParams::DEFAULT, executor, progress)?)
        })
    }

    /// Another form of the finished mesh.
    ///
    /// It has at most ``faces`` triangles; more remain if fewer would change the surface visibly. ``texture`` replaces the
    /// colours of vertices: True chooses the size by the detail of the photographs, a number is the size in texels. With a
    /// texture, a vertex at a border of charts is there once per chart, at the same position.
    #[pyo3(signature = (*, faces = None, texture = TextureSize::Chosen(false), threads = None, progress = None),
           text_signature = "($self, *, faces=None, texture=False, threads=None, progress=None)")]
    fn form(
        &self,
        py: Python,
        faces: Option<u32>,
        texture: TextureSize,
        threads: Option<NonZeroUsize>,
        progress: Option<&Bound<PyAny>>,
    ) -> PyResult<Mesh> {
        let params = FormParams { faces, texture: texture.params() };
        let make =
            |executor: &dyn Executor, progress: &dyn Progress| Ok(self.frame.form(&params, executor, progress)?);
        let form = run(py, threads, progress, make)?;
        Mesh::new(py, form, self.frame.rig().origin())
    }

    /// Points of a stage: "frontier" and "implicit" after "contours", "detected" after "detect", "merged" after "merge".
    /// ``camera`` selects those that one camera has detected.
    #[pyo3(signature = (kind = "merged", *, camera = None))]
    fn points(&self, py: Python, kind: &str, camera: Option<usize>) -> PyResult<Points> {
        let of = self.frame.intermediates();
        let (stage, points) = match (kind, camera) {
            ("frontier", None) => (Stage::Contours, Cow::Borrowed(&of.frontier)),
            ("implicit", None) => (Stage::Contours, Cow::Borrowed(&of.implicit)),
            ("merged", None) => (Stage::Merge, Cow::Borrowed(&of.merged)),
            ("detected", None) => (Stage::Detect, Cow::Owned(of.detected.concat())),
            ("detected", Some(camera)) => {
                self.require(Stage::Detect)?;
                (Stage::Detect, Cow::Borrowed(&of.detected[self.place(camera)?]))
            }
            ("frontier" | "implicit" | "merged", Some(_)) => {
                return Err(Problem::argument("camera is for \"detected\" points").into());
            }
            _ => {
                let problem = "it is one of frontier, implicit, detected, merged";
                return Err(Problem::argument(format!("there are no points {kind:?}: {problem}")).into());
            }
        };
        self.require(stage)?;
        Points::new(py, &points, self.frame.rig().origin(), self.frame.rig().order())
    }

    /// The silhouette of a camera without lens distortion, after the stage "hull": the signed distance of each pixel to the
    /// contour, in pixels, positive on the object, float32, height x width. Not-a-number where the picture does not show the
    /// pixel. None without a silhouette. Smaller than the picture by a power of two where that was read at a lower
    /// resolution: with the preset "preview", or because it is blurred.
    fn silhouette<'py>(&self, py: Python<'py>, camera: usize) -> PyResult<Option<Bound<'py, PyArray2<f32>>>> {
        self.require(Stage::Hull)?;
        let Some(found) = &self.frame.views()[self.place(camera)?].silhouette else { return Ok(None) };
        let pixels = |&d: &i16| if d == i16::MAX { f32::NAN } else { f32::from(d) / Silhouette::UNITS };
        let flat = PyArray1::from_vec(py, found.distances().iter().map(pixels).collect());
        flat.reshape([found.height as usize, found.width as usize]).map(Some)
    }

    /// What may make the result worse although nothing failed. Empty before the stage "hull".
    #[getter]
    fn warnings(&self) -> Vec<CaptureWarning> {
        self.frame.warnings().iter().map(CaptureWarning::from).collect()
    }

    /// How well each camera's view agrees with the others, after the stage "hull".
    #[getter]
    fn diagnostics(&self) -> PyResult<Vec<ViewDiagnostics>> {
        self.require(Stage::Hull)?;
        Ok(self.frame.diagnostics().iter().map(ViewDiagnostics::from).collect())
    }

    /// The factors by which the red, green and blue of each camera were multiplied, float32, n x 3, after the stage "colour".
    #[getter]
    fn gains<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        self.require(Stage::Colour)?;
        rows(py, self.frame.gains().iter().copied())
    }

    /// What the complete stages have counted, by name.
    #[getter]
    fn counts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, self.frame.counts())
    }

    /// A hash of the output of each complete stage, in hexadecimal, as in report.json. Equal inputs give equal hashes on
    /// every machine.
    #[getter]
    fn hashes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let hashes = PyDict::new(py);
        for &(stage, hash) in self.frame.hashes() {
            hashes.set_item(stage.name(), format!("{hash:016x}"))?;
        }
        Ok(hashes)
    }

    /// All parameters.
    #[getter]
    fn params<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, self.frame.params())
    }

    fn __repr__(&self) -> String {
        format!("Frame({} cameras, reached {:?})", self.frame.cameras(), self.reached().unwrap_or("nothing"))
    }
}

/// Reconstructs one frame: makes a ``Frame`` and runs it. The arguments are those of ``Frame`` and of ``Frame.run``.
#[pyfunction]
#[pyo3(
    signature = (rig, images, masks = None, *, chroma = None, plates = None, params = Asked::default(), max_memory = None,
                 threads = None, progress = None),
    text_signature = "(rig, images, masks=None, *, chroma=None, plates=None, params='default', max_memory=None, \
                      threads=None, progress=None)"
)]
pub fn reconstruct(
    py: Python,
    rig: PyRef<Rig>,
    images: Arrays,
    masks: Option<Arrays>,
    chroma: Option<Vec<[u8; 3]>>,
    plates: Option<Arrays>,
    params: Asked,
    max_memory: Option<u64>,
    threads: Option<NonZeroUsize>,
    progress: Option<&Bound<PyAny>>,
) -> PyResult<Frame> {
    let mut frame = Frame::new(rig, images, masks, chroma, plates, None, None, params, max_memory)?;
    frame.run(py, Stage::Colour.name(), threads, progress)?;
    Ok(frame)
}

//! Records the outputs of all stages for a capture.

use crate::{
    capture_file::CaptureFile,
    record::{Array, Detail, Record, Stage},
};
use pcmvs_core::{
    Error, Mesh, Params, Point, Preset, Rig, Serial, Silent, Stage as Core, View, export::glb, hash::Hash64,
    reconstruct, silhouette::ContourParams,
};

/// A preset by name, if results are recorded for it.
pub fn preset(name: &str) -> Option<Preset> {
    match name {
        "default" => Some(Preset::Default),
        "paper" => Some(Preset::Paper),
        _ => None,
    }
}

/// Reconstructs a capture on one thread and records the output of every stage.
///
/// # Errors
/// Those of [`reconstruct`].
pub fn measure(capture: &CaptureFile, preset: Preset, detail: Detail) -> Result<Record, Error> {
    let rig = Rig::new(&capture.cameras)?;
    let inputs = capture.inputs();
    let params = Params::preset(preset);
    let result = reconstruct(&rig, &inputs, &params, &Serial, &Silent)?;
    let (stages, mesh) = (&result.intermediates, &result.mesh);
    let of_stage = |&(stage, hash): &(Core, u64)| {
        let arrays = match stage {
            Core::Views => views(&rig, capture, params.contour.as_ref(), detail)?,
            Core::Hull => surface(&stages.hull, detail),
            Core::Contours => cloud(stages.frontier.iter().chain(&stages.implicit), detail),
            Core::Coarse => surface(&stages.coarse, detail),
            Core::Detect => cloud(stages.detected.iter().flatten(), detail),
            Core::Merge => cloud(&stages.merged, detail),
            Core::Mesh => surface(mesh, detail),
            _ => vec![Array::words("colours", detail, mesh.colours.iter().map(|&c| rgb(c)))],
        };
        Ok(Stage { name: stage.name().to_owned(), hash, arrays })
    };
    let read = Stage { name: "input".to_owned(), hash: hash(&capture.to_bytes()), arrays: Vec::new() };
    let file = glb::write(mesh, rig.origin(), &glb::Options::default());
    let words = file.chunks(4).map(|b| b.iter().rev().fold(0, |word, &b| word << 8 | u32::from(b)));
    let written =
        Stage { name: "glb".to_owned(), hash: hash(&file), arrays: vec![Array::words("file", detail, words)] };
    let of_stages = result.hashes.iter().map(of_stage);
    let stages = [Ok(read)].into_iter().chain(of_stages).chain([Ok(written)]).collect::<Result<_, Error>>()?;
    Ok(Record { stages })
}

fn hash(bytes: &[u8]) -> u64 {
    let mut hash = Hash64::default();
    hash.word(bytes.len() as u64);
    bytes.chunks(8).for_each(|b| hash.word(b.iter().fold(0, |word, &b| word << 8 | u64::from(b))));
    hash.finish()
}

fn rgb([r, g, b]: [u8; 3]) -> u32 {
    u32::from(r) << 16 | u32::from(g) << 8 | u32::from(b)
}

/// The undistorted pictures and the silhouettes, which the core does not keep.
fn views(
    rig: &Rig,
    capture: &CaptureFile,
    contour: Option<&ContourParams>,
    detail: Detail,
) -> Result<Vec<Array>, Error> {
    let (mut pixels, mut distances) = (Vec::new(), Vec::new());
    let inputs = capture.inputs();
    for &given in rig.order() {
        let view = View::new(rig, given as usize, &inputs[given as usize], contour)?;
        pixels.extend(view.rgb.chunks_exact(3).map(|p| rgb([p[0], p[1], p[2]])));
        let silhouette = view.silhouette.iter().flat_map(|s| s.distances());
        distances.extend(silhouette.map(|&d| u32::from(d as u16)));
    }
    Ok(vec![Array::words("pixels", detail, pixels), Array::words("distances", detail, distances)])
}

fn surface(mesh: &Mesh, detail: Detail) -> Vec<Array> {
    vec![
        Array::floats("positions", detail, mesh.positions.iter().flat_map(|p| p.to_array())),
        Array::floats("normals", detail, mesh.normals.iter().flat_map(|n| n.to_array())),
        Array::words("triangles", detail, mesh.triangles.iter().flatten().copied()),
    ]
}

fn cloud<'a>(points: impl IntoIterator<Item = &'a Point> + Clone, detail: Detail) -> Vec<Array> {
    let points = || points.clone().into_iter();
    vec![
        Array::floats("positions", detail, points().flat_map(|p| p.position.to_array())),
        Array::floats("normals", detail, points().flat_map(|p| p.normal.to_array())),
        Array::floats("fidelities", detail, points().map(|p| p.fidelity)),
        Array::floats("sigmas", detail, points().map(|p| p.sigma)),
        Array::floats("weights", detail, points().map(|p| p.weight)),
        Array::words("origins", detail, points().map(|p| u32::from(p.view) << 8 | p.rank as u32)),
    ]
}

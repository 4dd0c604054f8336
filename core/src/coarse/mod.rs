//! The coarse pass: detection (§4) and meshing (§6) at a lower resolution. Its mesh guides the detection that follows.
//!
//! The paper has no coarse pass: it searches the whole hull at full resolution.
//!
//! `seen_through` drops points of the hull that other views see through, and `gaps` closes gaps of the mesh where silhouettes
//! show the object.

mod gaps;
mod seen_through;

pub use gaps::GapParams;
pub use seen_through::SeenThroughParams;

use crate::{
    camera::Pinhole,
    context::Context,
    detect::{DetectionParams, DetectionScratch, Guide, PyramidLevel, detect_view},
    error::Result,
    executor::Executor,
    mesh::{self, MeshingParams, weigh},
    point_cloud::{Mesh, Point, PointCloud, concat},
    progress::Part,
    silhouette::Silhouette,
    sort::short,
    stage::Stage,
    surface::drop_small_components,
    view::View,
    workspace::Workspace,
};
use alloc::vec::Vec;
use core::{iter::once, mem::replace};
use seen_through::drop_seen_through;

/// Parameters of the coarse pass.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
pub struct CoarseParams {
    /// Detection in this pass.
    pub detection: DetectionParams,
    /// Spacing of the meshing grid's nodes, in pixels of footprint.
    pub voxel_pixels: f32,
    /// Drops points of the hull that other views see through. Without it all substituted points stay.
    pub seen_through: Option<SeenThroughParams>,
    /// Closes gaps of the mesh in front of which silhouettes show the object. Without it they stay open.
    pub gaps: Option<GapParams>,
}

/// The search of the whole hull begins as many octaves higher as the pictures can be halved until the object covers fewer than
/// this many pixels of the median one. A window at a higher octave shows more of the object, so that cloth with little texture
/// is found, too, and there are fewer depths to choose from.
const SEARCHED: usize = 10_000;

/// Number of octaves by which the coarse pass begins above that of its parameters, because the object is large in the
/// pictures.
fn further_octaves(views: &[View]) -> u32 {
    let inside = |view: &View| {
        let silhouette = view.shown().filter(|_| view.is_used())?;
        Some(silhouette.distances().iter().filter(|&&d| d > 0 && d != Silhouette::UNKNOWN).count())
    };
    octaves_of(views.iter().filter_map(inside).collect())
}

/// The number of octaves for the numbers of the object's pixels in the pictures.
fn octaves_of(mut areas: Vec<usize>) -> u32 {
    short(&mut areas);
    let mut area = areas.get(areas.len() / 2).copied().unwrap_or(0);
    let mut octaves = 0;
    while area / 4 >= SEARCHED {
        area /= 4;
        octaves += 1;
    }
    octaves
}

/// Runs the coarse pass and returns its mesh.
///
/// Where the object is large in the pictures, the pass begins some octaves above that of its parameters. Each octave below is
/// searched around the surface of the one before, by the parameters `detection` of the search that follows the pass. Where a
/// silhouette shows the object and that surface is not seen, the whole hull is searched again, because thin parts such as
/// fingers may get lost at a higher octave. Octaves above the last one search a mesh of the hull with wider voxels, because a
/// search looks at every triangle of the hull in every view. Gaps are closed at the last octave only, because the octave
/// below an open gap searches the hull there.
///
/// `hull_mesh` is the hull's own mesh, which the last octave searches, and `frontier` the weighted frontier points. `scratch`
/// holds one buffer per job that runs at the same time; the executor adds more if there are too few.
///
/// # Errors
/// [`crate::Error::NoSurface`] and [`crate::Error::Cancelled`].
pub fn coarse(
    context: Context,
    hull_mesh: &Mesh,
    frontier: &[Point],
    params: &CoarseParams,
    meshing: &MeshingParams,
    executor: &dyn Executor,
    scratch: &mut Vec<DetectionScratch>,
    workspace: &mut Workspace,
) -> Result<Mesh> {
    let further = further_octaves(context.views);
    let mut pass = Pass {
        context,
        frontier,
        params,
        meshing,
        executor,
        scratch,
        workspace,
        part: 0,
        parts: PARTS * (further + 1) + CLOSING,
    };
    let last = params.detection.octave;
    let mut surface: Option<Mesh> = None;
    for octave in (last..=last + further).rev() {
        // The hull's voxels are as much wider as the octave's pixels.
        let coarser = (octave > last).then(|| pass.coarser_hull(octave - last));
        let hull = coarser.as_ref().unwrap_or(hull_mesh);
        let (guide, band_pixels) = match &surface {
            None => (Guide::Hull(hull), params.detection.band_pixels),
            Some(surface) => (Guide::Incomplete { surface, hull }, params.detection.band_pixels * pass.scale(octave)),
        };
        let better = pass.surface(guide, hull_mesh, &DetectionParams { octave, band_pixels, ..params.detection })?;
        coarser.into_iter().chain(surface.replace(better)).for_each(|mesh| mesh.recycle_into(pass.workspace));
    }
    Ok(surface.expect("there is at least one octave"))
}

/// Steps of an octave that report their progress: detection, points seen through, and meshing.
const PARTS: u32 = 3;
/// Steps after those of the last octave: gaps, and meshing again.
const CLOSING: u32 = 2;

/// What the octaves of the pass share.
struct Pass<'a> {
    context: Context<'a>,
    frontier: &'a [Point],
    params: &'a CoarseParams,
    meshing: &'a MeshingParams,
    executor: &'a dyn Executor,
    scratch: &'a mut Vec<DetectionScratch>,
    workspace: &'a mut Workspace,
    /// The step that comes next, of all `parts`.
    part: u32,
    parts: u32,
}

impl<'a> Pass<'a> {
    /// The hull's mesh without stray components, of voxels that are 2^`halvings` times as wide.
    fn coarser_hull(&mut self, halvings: u32) -> Mesh {
        let mut mesh = self.context.hull.coarser_mesh(halvings, self.workspace, self.executor);
        drop_small_components(&mut mesh, self.meshing.smallest_component, self.workspace);
        mesh
    }

    /// The surface of an octave, that of `detection`. At the last one its gaps are closed by parts of `hull`, the hull's mesh.
    fn surface(&mut self, guide: Guide, hull: &Mesh, detection: &DetectionParams) -> Result<Mesh> {
        let octave = detection.octave;
        let voxel_pixels = self.params.voxel_pixels * self.scale(octave);
        let made = self.made(octave);
        let levels = levels(self.context.views, &made);
        let cameras: Vec<Pinhole> = levels.iter().map(|level| level.camera).collect();
        let mut clouds = self.detect(guide, detection, &levels)?;
        let closing = self.params.gaps.as_ref().filter(|_| octave == self.params.detection.octave);
        let shown = match closing {
            Some(_) => gaps::pixels_with_points(self.context.views, &clouds, &cameras, self.executor),
            None => Vec::new(),
        };
        let footprint = self.context.hull.footprint();
        let progress = self.next();
        if let Some(params) = &self.params.seen_through {
            let distance = params.distance_pixels * footprint * (1u32 << octave) as f32;
            clouds = drop_seen_through(clouds, &cameras, params, distance, self.executor, &progress)?;
        }
        let mut cloud = self.merged(&clouds);
        drop(clouds);
        let mut surface = self.mesh(&cloud, voxel_pixels)?;
        if let Some(params) = closing {
            let progress = self.next();
            let thickness = voxel_pixels * footprint;
            let filling = gaps::filling(shown, &levels, &surface, hull, params, thickness, self.executor, &progress)?;
            if !filling.is_empty() {
                cloud.extend(filling);
                let closed = self.mesh(&cloud, voxel_pixels)?;
                replace(&mut surface, closed).recycle_into(self.workspace);
            }
        }
        self.workspace.recycle(cloud);
        Ok(surface)
    }

    /// Width of an octave's pixels, relative to those of the pass's last octave.
    fn scale(&self, octave: u32) -> f32 {
        (1u32 << (octave - self.params.detection.octave)) as f32
    }

    /// The views that are used, at an octave.
    fn made(&self, octave: u32) -> Vec<Option<PyramidLevel<'static>>> {
        let views = self.context.views;
        let made = |i: usize| if views[i].is_used() { PyramidLevel::made(&views[i], octave) } else { None };
        self.executor.map(views.len(), made)
    }

    /// The weighted points of each view around a guide.
    fn detect(
        &mut self,
        guide: Guide,
        detection: &DetectionParams,
        levels: &[PyramidLevel],
    ) -> Result<Vec<PointCloud>> {
        let progress = self.next();
        let context = self.context.reporting_to(&progress);
        let level = |i: usize| levels[i].borrowed();
        let weights = self.meshing.weights.as_ref();
        let found = self.executor.map_with(self.scratch, levels.len(), |scratch, i| {
            let (mut cloud, _) = detect_view(context, i, &level, guide, detection, scratch)?;
            weigh(&mut cloud, weights);
            Ok(cloud)
        });
        found.into_iter().collect()
    }

    /// The points of all views, and the frontier points.
    fn merged(&mut self, clouds: &[PointCloud]) -> PointCloud {
        concat(once(self.frontier).chain(clouds.iter().map(|cloud| &cloud[..])), self.workspace)
    }

    /// The mesh of a cloud. Its voxels are so many pixels of footprint wide.
    fn mesh(&mut self, cloud: &[Point], voxel_pixels: f32) -> Result<Mesh> {
        let progress = self.next();
        let hull = self.context.hull;
        let voxel = voxel_pixels * hull.footprint();
        // It gets no colours, for which vertices are spread evenly.
        let params = MeshingParams { even_passes: 0, ..*self.meshing };
        let meshed = mesh::mesh(cloud.into(), hull, voxel, &params, self.workspace, self.executor, &progress)?;
        Ok(meshed.mesh)
    }

    /// Receives the progress of the next step.
    fn next(&mut self) -> Part<'a> {
        let part = self.part;
        self.part += 1;
        Part { of: self.context.progress, stage: Stage::Coarse, part, parts: self.parts }
    }
}

/// All views at an octave: those that were made, and others as they are.
fn levels<'a>(views: &'a [View], made: &'a [Option<PyramidLevel<'static>>]) -> Vec<PyramidLevel<'a>> {
    views.iter().zip(made).map(|(view, made)| PyramidLevel::new(view, made.as_ref())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn larger_objects_are_searched_from_higher_octaves() {
        let of = |inside: [usize; 3]| octaves_of(inside.to_vec());
        // The median decides, because the object may leave single pictures or be near to single cameras.
        assert_eq!(of([0, 4 * SEARCHED - 1, 64 * SEARCHED]), 0);
        assert_eq!(of([0, 4 * SEARCHED, 64 * SEARCHED]), 1);
        assert_eq!(of([0, 16 * SEARCHED, 64 * SEARCHED]), 2);
        assert_eq!(octaves_of(Vec::new()), 0);
    }
}

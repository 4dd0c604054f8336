//! The mean of a finished frame and its neighbours in time.

use crate::{
    failure::{Failure, Result},
    frame::{content, exclusive, pcmvs_frame},
    status::pcmvs_status::{self, InvalidArgument, NullPointer},
    work::Work,
};
use pcmvs_core::{Mesh, Stage};
use std::slice::from_raw_parts;

/// Largest number of neighbours.
const MOST: usize = 16;

/// Averages a finished mesh with those of neighbouring frames, such as the one before and the one after it, along surfaces that
/// move with the subject, so that surfaces and colours are steady in time. `neighbours` are at most 16 other handles of finished
/// frames, of rigs with the same cameras. The mesh of each as it was before this function counts, so that the order in which
/// frames are averaged does not matter. `PCMVS_MESH_KIND_FINAL`, forms and files then have the mean; a later call replaces it,
/// and without neighbours the frame has its own mesh again. Discards the form. The command line averages each frame with one
/// before and one after it. The neighbours are in use only at the beginning of the call. Fails with `PCMVS_STATUS_WRONG_ORDER`
/// unless all frames are complete. On failure nothing but the form changes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_steady(
    frame: *mut pcmvs_frame,
    neighbours: *const *const pcmvs_frame,
    count: usize,
) -> pcmvs_status {
    let steady = |_: &_, work: &mut Work| {
        let at = |failure: Failure| failure.at(Stage::Steady);
        if count > MOST {
            let problem = format!("{count} neighbours were given: at most {MOST} can be averaged");
            return Err(at(Failure::new(InvalidArgument, problem)));
        }
        if neighbours.is_null() && count > 0 {
            return Err(at(Failure::new(NullPointer, "`neighbours` is NULL, but `count` is not 0")));
        }
        // SAFETY: the caller's promise, and not NULL.
        let handles = if count == 0 { &[] } else { unsafe { from_raw_parts(neighbours, count) } };
        if handles.contains(&frame.cast_const()) {
            return Err(at(Failure::new(InvalidArgument, "a frame cannot be its own neighbour")));
        }
        // Copies, so that the neighbours can be used while this frame is averaged.
        let meshes = handles.iter().map(|&neighbour| own_mesh(neighbour, work)).collect::<Result<Vec<_>>>();
        let meshes = meshes.map_err(at)?;
        work.steady(&meshes.iter().collect::<Vec<_>>())
    };
    exclusive(frame, steady)
}

/// The mesh of a neighbour as it was reconstructed.
fn own_mesh(neighbour: *const pcmvs_frame, of: &Work) -> Result<Mesh> {
    let mut mesh = Mesh::default();
    content(neighbour, |other| {
        of.check_neighbour(other)?;
        mesh.clone_from(other.frame.own_mesh());
        Ok(())
    })?;
    Ok(mesh)
}

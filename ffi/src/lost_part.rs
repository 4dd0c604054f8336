//! A part that one frame has lost and that the frames before and after it have.

use crate::{
    boundary::out,
    failure::{Failure, Result},
    frame::{content, pcmvs_frame, shared},
    sized::read,
    status::pcmvs_status::{self, InvalidArgument},
    view::{GivenView, pcmvs_view},
    work::Work,
};
use pcmvs_core::Stage;

/// Finds out whether a finished frame may have lost a part, such as an arm, that the frames before and after it have, because
/// many or all of its masks lack it. Writes 1 to `may_have` if so, otherwise 0. `before` and `after` are other handles of
/// finished frames, of rigs with the same cameras. Their meshes as they were before `pcmvs_frame_steady` count. If the answer
/// is 1, make the frame again on another handle, with `pcmvs_frame_view_between` for every camera. This function reads no
/// pictures, and its answer is nearly always 0. Fails with `PCMVS_STATUS_WRONG_ORDER` unless all frames are complete.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_may_have_lost_part(
    frame: *const pcmvs_frame,
    before: *const pcmvs_frame,
    after: *const pcmvs_frame,
    may_have: *mut u32,
) -> pcmvs_status {
    let find = |work: &Work| {
        let may_have = out(may_have, "may_have")?;
        if [before, after].contains(&frame) {
            return Err(Failure::new(InvalidArgument, "a frame cannot be its own neighbour"));
        }
        work.require(Stage::Colour)?;
        content(before, |before| {
            content(after, |after| {
                let found = work.may_have_lost_part([before, after])?;
                // SAFETY: the caller's promise, and not NULL.
                unsafe { may_have.write(u32::from(found)) };
                Ok(())
            })
        })
    };
    shared(frame, find)
}

/// `pcmvs_frame_view` with the same camera's views of the frames before and after. Parts that the silhouette lacks and those of
/// both other frames have are added to it, if the picture shows them: in the part's colours, and different from the background
/// that the other frames show there. Writes the number of pixels that were added to `restored`, which may be NULL. If it is 0
/// for all cameras, the frame has lost nothing. If one of the three views has no picture, nothing is added. May be called on
/// several threads at once, for different cameras.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pcmvs_frame_view_between(
    frame: *mut pcmvs_frame,
    camera: u32,
    view: *const pcmvs_view,
    before: *const pcmvs_view,
    after: *const pcmvs_view,
    restored: *mut u32,
) -> pcmvs_status {
    let read_views = |work: &Work| {
        let at = |failure: Failure| failure.of_camera(camera).at(Stage::Views);
        let size = work.calibrated(camera)?;
        let named = [(view, "view"), (before, "before"), (after, "after")];
        // SAFETY: the caller's promise.
        let views = named.map(|(view, name)| unsafe { read(view, name) }.map_err(at));
        let [view, before, after] = views;
        let views = [view?, before?, after?];
        // SAFETY: the caller's promise.
        let copies = views.iter().map(|view| unsafe { GivenView::copied(view, size) }).sum::<u64>();
        work.check_copies(copies + work.between()).map_err(at)?;
        // SAFETY: the caller's promise.
        let given = views.iter().map(|view| unsafe { GivenView::new(view, size) }.map_err(at));
        let given = given.collect::<Result<Vec<_>>>()?;
        let inputs = [0, 1, 2].map(|i: usize| given[i].input());
        let pixels = match inputs.each_ref().map(Option::as_ref) {
            [Some(own), Some(before), Some(after)] => work.view_between(camera, own, [before, after])?,
            [own, ..] => work.view(camera, own).map(|()| 0)?,
        };
        if !restored.is_null() {
            // SAFETY: the caller's promise, and not NULL.
            unsafe { restored.write(pixels) };
        }
        Ok(())
    };
    shared(frame, read_views)
}

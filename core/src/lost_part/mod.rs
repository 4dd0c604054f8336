//! A part that one frame has lost: a limb that its silhouettes lack although those of the frames before and after it have it.
//! The other views of the same frame make up for one or two silhouettes ([`crate::hull::AgreementParams`]). Where many or all
//! of them lack the part, only the neighbouring frames tell.
//!
//! 1. Two neighbouring frames have surface where the frame has none near ([`has_lost_part`]), or the other views have overruled
//!    several silhouettes that they have not overruled in the neighbouring frames ([`crate::Frame::may_have_lost_part`]). This
//!    asks for no pictures.
//! 2. In each camera, the picture decides whether the part is there: its colours are those of the part in the neighbouring
//!    frames, and differ from the background, which the neighbouring frames show where the part is not (`pixels`).
//!
//! Where one of the two neighbours lacks the part as well, the frame beyond it takes its place ([`crate::Frame::look_beyond`]).
//! So parts come back that two frames in a row lack.
//!
//! A person who has really bent an arm away gets none, because the pictures show the background there.

mod mesh;
mod pixels;

pub use mesh::{Beside, has_lost_part, look_beyond, may_have_lost_part};
pub(crate) use pixels::{Shown, lost_pixels};

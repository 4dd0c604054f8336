//! What the pictures say about the contours of several cameras.

use super::ContourEdge;
use crate::math::median;
use alloc::vec::Vec;
use core::fmt;

/// The masks as a whole are at fault if in more than half of the pictures another edge is stronger than this share of the
/// contour's own.
const BESIDE_MOST: f32 = 0.2;
/// One camera's mask is at fault if another edge is stronger than this share of its contour's own.
const BESIDE_ONE: f32 = 0.5;
/// An edge that is this many times stronger than the contour's own is the object's, even if the contour is without edge.
const CLEARLY: f32 = 5.0;

/// A fault of silhouettes that the pictures show. Cameras are numbered as given to [`crate::Rig::new`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum ContourFault {
    /// Most pictures show the object's edge beside the contour.
    BesideEdges {
        /// The median over these pictures of how far the edge lies inside the contour, in pixels; negative outside.
        pixels: f32,
    },
    /// A camera's picture shows the object's edge beside the contour.
    BesideEdge {
        /// Index of the camera.
        camera: u32,
        /// How far the edge lies inside the contour, in pixels; negative outside.
        pixels: f32,
    },
    /// A camera's picture shows no edge along the contour.
    WithoutEdge {
        /// Index of the camera.
        camera: u32,
    },
}

impl ContourFault {
    /// The faults of cameras, each with what its picture shows around its contour.
    pub(crate) fn of(edges: impl Iterator<Item = (u32, ContourEdge)> + Clone) -> Vec<Self> {
        let beside = || edges.clone().filter(|(_, edge)| edge.strength > BESIDE_MOST).map(|(_, edge)| edge.other);
        if 2 * beside().count() > edges.clone().count() {
            return median(beside()).map(|pixels| Self::BesideEdges { pixels }).into_iter().collect();
        }
        let fault = |(camera, edge): (u32, ContourEdge)| {
            if !edge.is_along() && edge.strength < CLEARLY {
                Some(Self::WithoutEdge { camera })
            } else {
                (edge.strength > BESIDE_ONE).then_some(Self::BesideEdge { camera, pixels: edge.other })
            }
        };
        edges.clone().filter_map(fault).collect()
    }

    /// Stable name of the kind of fault, in kebab-case.
    pub const fn code(&self) -> &'static str {
        match self {
            Self::BesideEdges { .. } => "contours-beside-edges",
            Self::BesideEdge { .. } => "contour-beside-edge",
            Self::WithoutEdge { .. } => "contour-without-edge",
        }
    }

    /// Index of the camera that the fault is about, if it is about one.
    pub const fn camera(&self) -> Option<u32> {
        match self {
            Self::BesideEdges { .. } => None,
            Self::BesideEdge { camera, .. } | Self::WithoutEdge { camera } => Some(*camera),
        }
    }
}

impl fmt::Display for ContourFault {
    /// What is wrong and what to do, without the camera.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let (whose, pixels) = match self {
            Self::BesideEdges { pixels } => ("the masks are", pixels),
            Self::BesideEdge { pixels, .. } => ("its mask is", pixels),
            Self::WithoutEdge { .. } => {
                return f.write_str(
                    "its picture shows no edge along the contour of its mask: check that the mask belongs to this picture and \
                     follows the object's outline",
                );
            }
        };
        let (how, side, remedy) =
            if *pixels > 0.0 { ("wide", "inside", "shrink") } else { ("narrow", "outside", "widen") };
        write!(
            f,
            "{whose} too {how}: the object's edge in the picture lies about {:.0} px {side} the contour, although that was moved \
             as far as is certain. Correct the mask, or {remedy} it",
            pixels.abs()
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::string::ToString;

    const GOOD: ContourEdge = ContourEdge { other: 6.0, strength: 0.1, usual: 0.1 };
    const WIDE: ContourEdge = ContourEdge { other: 8.0, strength: 3.0, usual: 0.3 };
    const NARROW: ContourEdge = ContourEdge { other: -9.0, strength: 0.3, usual: 0.1 };
    const STRANGE: ContourEdge = ContourEdge { other: 8.0, strength: 0.2, usual: 0.9 };

    fn faults(edges: [ContourEdge; 5]) -> Vec<ContourFault> {
        ContourFault::of((0..).zip(edges))
    }

    #[test]
    fn what_most_pictures_show_is_one_fault_of_all() {
        assert_eq!(faults([GOOD; 5]), []);
        assert_eq!(faults([NARROW, GOOD, NARROW, GOOD, NARROW]), [ContourFault::BesideEdges { pixels: -9.0 }]);
        let [fault] = faults([WIDE; 5])[..] else { panic!("one of all") };
        assert!(fault.to_string().contains("too wide") && fault.to_string().contains("8 px inside"), "{fault}");
    }

    #[test]
    fn single_pictures_must_show_it_more_clearly() {
        assert_eq!(
            faults([GOOD, WIDE, GOOD, NARROW, STRANGE]),
            [ContourFault::BesideEdge { camera: 1, pixels: 8.0 }, ContourFault::WithoutEdge { camera: 4 }]
        );
    }
}

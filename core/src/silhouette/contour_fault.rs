//! What the pictures of several cameras show along the contours: masks that are at fault, and pictures that are blurred.

use super::ContourEdge;
use crate::math::{max, median};
use alloc::vec::Vec;
use core::fmt;

/// The masks as a whole are at fault if in more than half of the pictures another edge is stronger than this share of the
/// contour's own, or more than half of the contour was moved far to one side.
const BESIDE_MOST: f32 = 0.2;
/// The masks as a whole are not those of their pictures if in more than half of them at least this share of the contour was
/// moved far inwards, and as much outwards. This is so in none of the clean, rough and real captures.
const ACROSS_MOST: f32 = 0.1;
/// One camera's mask is not that of its picture if at least this share of its contour was moved far inwards, and as much
/// outwards. In no view of the clean, rough and real captures it is more than a fifth of this.
const ACROSS_ONE: f32 = 0.05;
/// A mask follows its picture if less than this share of its contour was moved far.
const FOLLOWS: f32 = 0.1;
/// One camera's mask is at fault if another edge is stronger than this share of its contour's own.
const BESIDE_ONE: f32 = 0.5;
/// An edge that is this many times stronger than the contour's own is the object's, even if the contour is without edge.
const CLEARLY: f32 = 5.0;
/// A picture is blurred if the object's edge is at least this many pixels wide in it, and this many times as wide as in the
/// median of all. In sharp pictures, rendered and real ones, it is one to four pixels wide.
const BLURRED: [f32; 2] = [5.0, 2.5];

/// A fault of silhouettes that the pictures show, or of a picture itself. Cameras are numbered as given to [`crate::Rig::new`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum ContourFault {
    /// Most pictures show the object's edge beside the contour.
    BesideEdges {
        /// The median over these pictures of how far the edge lies inside the mask's contour, in pixels; negative outside.
        pixels: f32,
    },
    /// Most pictures show the object's edge far inside the contour in some places, and far outside in others.
    AcrossEdges {
        /// The median over these pictures of the share of the contour that lies far from the edge, 0 to 1.
        share: f32,
    },
    /// A camera's picture shows the object's edge beside the contour.
    BesideEdge {
        /// Index of the camera.
        camera: u32,
        /// How far the edge lies inside the mask's contour, in pixels; negative outside.
        pixels: f32,
    },
    /// A camera's picture shows the object's edge far inside the contour in some places, and far outside in others.
    AcrossEdge {
        /// Index of the camera.
        camera: u32,
        /// The share of the contour that lies far from the edge, 0 to 1.
        share: f32,
    },
    /// A camera's picture shows no edge along the contour.
    WithoutEdge {
        /// Index of the camera.
        camera: u32,
    },
    /// A camera's picture is blurred, and those of the others are not.
    Blurred {
        /// Index of the camera.
        camera: u32,
        /// Width of the object's edge in the picture, in pixels.
        pixels: f32,
        /// The median of this width over all pictures.
        usual: f32,
    },
}

impl ContourFault {
    /// The faults of cameras, each with what its picture shows around its contour.
    pub(crate) fn of(edges: impl Iterator<Item = (u32, ContourEdge)> + Clone) -> Vec<Self> {
        let count = edges.clone().count();
        let across = || edges.clone().filter(|(_, edge)| edge.is_across(ACROSS_MOST));
        if 2 * across().count() > count {
            let share = median(across().map(|(_, edge)| edge.far_share()));
            return share.map(|share| Self::AcrossEdges { share }).into_iter().collect();
        }
        let beside = || edges.clone().filter(|(_, edge)| edge.is_beside()).map(|(_, edge)| edge.off(BESIDE_MOST));
        if 2 * beside().count() > count {
            return median(beside()).map(|pixels| Self::BesideEdges { pixels }).into_iter().collect();
        }
        let usual = median(edges.clone().map(|(_, edge)| edge.width)).unwrap_or(0.0);
        let [least, times] = BLURRED;
        let blurred = max(least, times * usual);
        let fault = |(camera, edge): (u32, ContourEdge)| {
            if !edge.is_along() && edge.strength < CLEARLY {
                Some(Self::WithoutEdge { camera })
            } else if edge.is_across(ACROSS_ONE) {
                Some(Self::AcrossEdge { camera, share: edge.far_share() })
            } else if edge.strength > BESIDE_ONE {
                Some(Self::BesideEdge { camera, pixels: edge.off(BESIDE_ONE) })
            } else {
                (edge.width >= blurred).then_some(Self::Blurred { camera, pixels: edge.width, usual })
            }
        };
        edges.clone().filter_map(fault).collect()
    }

    /// Stable name of the kind of fault, in kebab-case.
    pub const fn code(&self) -> &'static str {
        match self {
            Self::BesideEdges { .. } => "contours-beside-edges",
            Self::AcrossEdges { .. } => "contours-across-edges",
            Self::BesideEdge { .. } => "contour-beside-edge",
            Self::AcrossEdge { .. } => "contour-across-edge",
            Self::WithoutEdge { .. } => "contour-without-edge",
            Self::Blurred { .. } => "picture-blurred",
        }
    }

    /// Index of the camera that the fault is about, if it is about one.
    pub const fn camera(&self) -> Option<u32> {
        match self {
            Self::BesideEdges { .. } | Self::AcrossEdges { .. } => None,
            Self::BesideEdge { camera, .. }
            | Self::AcrossEdge { camera, .. }
            | Self::WithoutEdge { camera }
            | Self::Blurred { camera, .. } => Some(*camera),
        }
    }
}

impl ContourEdge {
    /// Whether the mask's contour follows the object's edge in the picture, so that the mask is not that of another picture and
    /// was not shifted.
    pub fn is_followed(&self) -> bool {
        self.is_along() && self.strength <= BESIDE_MOST && self.far_share() < FOLLOWS
    }

    /// The share of the contour that was moved far, to either side.
    fn far_share(&self) -> f32 {
        self.far[0] + self.far[1]
    }

    /// Whether more than a share of the contour was moved far inwards, and as much outwards.
    fn is_across(&self, share: f32) -> bool {
        self.far.iter().all(|&far| far > share)
    }

    /// Whether the picture shows the object's edge beside the mask's contour, which has perhaps been moved there.
    fn is_beside(&self) -> bool {
        self.strength > BESIDE_MOST || self.far.iter().any(|&share| share > 0.5)
    }

    /// How far the object's edge lies inside the mask's contour: how far the contour was moved, and how far the other edge
    /// lies inside of where it is now, if that is at least so strong. In pixels, negative outside.
    fn off(&self, strong: f32) -> f32 {
        self.moved + if self.strength > strong { self.other } else { 0.0 }
    }
}

/// How far the contours as a whole may lie beside the object's edges, further than contours usually do, in pixels of the
/// pictures as they were given.
pub(crate) fn beyond_usual(edges: impl Iterator<Item = ContourEdge> + Clone) -> f32 {
    let faults = ContourFault::of(edges.map(|edge| (0, edge)));
    let of = |fault: &ContourFault| if let ContourFault::BesideEdges { pixels } = fault { pixels.abs() } else { 0.0 };
    faults.iter().map(of).fold(0.0, max)
}

impl fmt::Display for ContourFault {
    /// What is wrong and what to do, without the camera.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let (whose, pixels) = match self {
            Self::BesideEdges { pixels } => ("the masks are", pixels),
            Self::BesideEdge { pixels, .. } => ("its mask is", pixels),
            Self::AcrossEdges { share } | Self::AcrossEdge { share, .. } => {
                let [what, contours, remedy] = match self.camera() {
                    None => [
                        "the masks do not follow the object's outlines in their pictures",
                        "the contours lie more than two pixels from them",
                        "the masks are those of these pictures and not of another instant",
                    ],
                    Some(_) => [
                        "its mask does not follow the object's outline in the picture",
                        "the contour lies more than two pixels from it",
                        "the mask is that of this picture and was not shifted",
                    ],
                };
                return write!(
                    f,
                    "{what}: {:.0} % of {contours}, inside in some places and outside in others. Check that {remedy}",
                    100.0 * share
                );
            }
            Self::WithoutEdge { .. } => {
                return f.write_str(
                    "its picture shows no edge along the contour of its mask: check that the mask belongs to this picture and \
                     follows the object's outline",
                );
            }
            Self::Blurred { pixels, usual, .. } => {
                return write!(
                    f,
                    "its picture is blurred: the object's edge is about {pixels:.0} px wide in it, and {usual:.0} px in the median \
                     of all cameras. Check the focus, and use a shorter exposure if the object moves fast"
                );
            }
        };
        let (how, side, remedy) =
            if *pixels > 0.0 { ("wide", "inside", "shrink") } else { ("narrow", "outside", "widen") };
        write!(
            f,
            "{whose} too {how}: the object's edge in the picture lies about {:.0} px {side} the mask's contour, which \
             was moved there only as far as is certain. Correct the mask, or {remedy} it",
            pixels.abs()
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::string::ToString;

    const GOOD: ContourEdge =
        ContourEdge { other: 6.0, strength: 0.1, usual: 0.1, moved: 0.0, far: [0.2, 0.04], width: 2.0 };
    const WIDE: ContourEdge = ContourEdge { other: 8.0, strength: 3.0, usual: 0.3, ..GOOD };
    const NARROW: ContourEdge = ContourEdge { other: -9.0, strength: 0.3, usual: 0.1, ..GOOD };
    const STRANGE: ContourEdge = ContourEdge { other: 8.0, strength: 0.2, usual: 0.9, ..GOOD };

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
    fn how_far_contours_were_moved_counts() {
        let moved = ContourEdge { moved: -5.0, far: [0.0, 0.9], ..GOOD };
        assert_eq!(faults([moved; 5]), [ContourFault::BesideEdges { pixels: -5.0 }]);
        assert_eq!(faults([moved, GOOD, GOOD, GOOD, moved]), [], "what is corrected in few is no fault");
        // Moved by a part of the way only.
        let partly = ContourEdge { moved: 4.0, far: [0.9, 0.0], other: 6.0, ..WIDE };
        assert_eq!(faults([partly; 5]), [ContourFault::BesideEdges { pixels: 10.0 }]);
        assert_eq!(beyond_usual([partly; 5].into_iter()), 10.0);
        assert_eq!(beyond_usual([GOOD; 5].into_iter()), 0.0);
    }

    #[test]
    fn contours_that_cross_the_edges_are_not_those_of_the_pictures() {
        let across = ContourEdge { far: [0.3, 0.2], ..GOOD };
        let [fault] = faults([across, across, WIDE, across, GOOD])[..] else { panic!("one of all") };
        assert!(matches!(fault, ContourFault::AcrossEdges { share } if (share - 0.5).abs() < 1e-6), "{fault:?}");
        assert_eq!((fault.code(), fault.camera()), ("contours-across-edges", None));
        assert!(fault.to_string().contains("50 %") && fault.to_string().contains("another instant"), "{fault}");
    }

    #[test]
    fn single_pictures_must_show_it_more_clearly() {
        assert_eq!(
            faults([GOOD, WIDE, GOOD, NARROW, STRANGE]),
            [ContourFault::BesideEdge { camera: 1, pixels: 8.0 }, ContourFault::WithoutEdge { camera: 4 }]
        );
    }

    #[test]
    fn a_contour_that_crosses_the_edge_is_not_that_of_its_picture() {
        let across = ContourEdge { far: [0.06, 0.2], ..GOOD };
        let [fault] = faults([GOOD, across, GOOD, GOOD, GOOD])[..] else { panic!("one camera's") };
        assert!(
            matches!(fault, ContourFault::AcrossEdge { camera: 1, share } if (share - 0.26).abs() < 1e-6),
            "{fault:?}"
        );
        assert_eq!((fault.code(), fault.camera()), ("contour-across-edge", Some(1)));
        assert!(fault.to_string().contains("26 %") && fault.to_string().contains("shifted"), "{fault}");
        // Most of a contour on one side is a matter of its width.
        assert_eq!(faults([GOOD, ContourEdge { far: [0.3, 0.04], ..GOOD }, GOOD, GOOD, GOOD]), []);
    }

    #[test]
    fn a_picture_is_blurred_if_its_edge_is_wider_than_those_of_the_others() {
        let blurred = ContourEdge { width: 8.0, ..GOOD };
        let fault = ContourFault::Blurred { camera: 2, pixels: 8.0, usual: 2.0 };
        assert_eq!(faults([GOOD, GOOD, blurred, GOOD, GOOD]), [fault]);
        assert_eq!((fault.code(), fault.camera()), ("picture-blurred", Some(2)));
        assert!(fault.to_string().contains("8 px wide"), "{fault}");
        assert_eq!(faults([blurred; 5]), [], "nothing tells that all of them are not soft");
        // What is wrong with the mask is said first.
        assert_eq!(
            faults([GOOD, GOOD, ContourEdge { width: 8.0, ..WIDE }, GOOD, GOOD]),
            [ContourFault::BesideEdge { camera: 2, pixels: 8.0 }]
        );
    }

    #[test]
    fn only_a_contour_along_the_edge_follows_it() {
        let sharp = ContourEdge { far: [0.02, 0.01], ..GOOD };
        assert!(sharp.is_followed());
        let off = [
            ContourEdge { strength: 0.3, ..sharp },
            ContourEdge { usual: 0.9, ..sharp },
            ContourEdge { far: [0.0, 0.2], ..sharp },
        ];
        assert!(off.iter().all(|edge| !edge.is_followed()));
    }
}

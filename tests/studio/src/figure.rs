//! An articulated, clothed person: one hand is on the hip, the other waves, the legs dance.

use crate::{
    material::Material::{self, Black, Denim, Face, Hair, Leather, Print, Rubber, Skin},
    part::{Part, Pose, RoundCone, Shape},
    rotation::turn,
};
use core::f64::consts::TAU;
use glam::{DMat3, DVec3};

const UPPER_ARM: f64 = 0.28;
const FOREARM: f64 = 0.25;
const THIGH: f64 = 0.42;
const SHIN: f64 = 0.41;
/// Height of the ankle joint above the sole.
const ANKLE: f64 = 0.085;

/// Joint angles of a limb in radians.
struct Limb {
    /// Forward swing.
    swing: f64,
    /// Angle to the middle plane of the body.
    spread: f64,
    /// Rotation around its own axis, inward.
    twist: f64,
    /// Bend of the elbow or knee.
    bend: f64,
}

/// The parts of the figure at a time in seconds, in the world. The feet stand on the floor at the origin, facing +x.
/// Pelvis and legs are those of the time `legs`.
pub fn parts(time: f64, legs: f64) -> Vec<Part> {
    let beat_at = |time: f64, turns: f64, phase: f64| libm::sin(TAU * (turns * time + phase));
    let beat = |turns: f64, phase: f64| beat_at(time, turns, phase);
    let step = |phase: f64| beat_at(legs, 0.7, phase);
    let legs = [
        Limb { swing: 0.10 + 0.26 * step(0.0), spread: 0.13, twist: -0.25, bend: 0.28 + 0.22 * step(0.05) },
        Limb { swing: 0.10 - 0.26 * step(0.0), spread: 0.13, twist: -0.25, bend: 0.28 - 0.22 * step(0.05) },
    ];
    let arms = [
        Limb { swing: -0.15 + 0.05 * beat(0.7, 0.2), spread: 0.80 + 0.05 * beat(0.7, 0.1), twist: 1.35, bend: 1.62 },
        Limb { swing: 0.25, spread: 1.15 + 0.15 * beat(1.0, 0.1), twist: -1.35, bend: 1.15 + 0.45 * beat(1.0, 0.0) },
    ];
    // Pose the body around the pelvis, then move it so that the lower sole stands on the floor.
    let pose = |height: f64| {
        let sway = 0.03 * step(0.1);
        Pose { rotation: turn(0.04 * step(0.1), 0.03, 0.22 * step(0.0)), origin: DVec3::new(0.0, sway, height) }
    };
    let pelvis = pose(0.0);
    let lowest = (0..2).map(|i| foot(&pelvis, side(i), &legs[i]).origin.z - ANKLE).fold(f64::MAX, f64::min);
    let pelvis = pose(0.008 - lowest);
    let chest = pelvis.then(
        DVec3::new(0.0, 0.0, 0.15),
        turn(-0.05 * beat(0.7, 0.15), 0.04 + 0.02 * beat(1.4, 0.0), -0.30 * beat(0.7, 0.0)),
    );
    let head = chest.then(DVec3::new(0.03, 0.0, 0.50), turn(0.06 * beat(0.7, 0.3), 0.05, 0.15 * beat(0.5, 0.2)));

    let mut parts = Vec::new();
    trunk(&mut parts, &pelvis, &chest);
    for i in 0..2 {
        leg(&mut parts, &pelvis, side(i), &legs[i]);
    }
    for i in 0..2 {
        arm(&mut parts, &chest, side(i), &arms[i]);
    }
    neck_and_head(&mut parts, &chest, &head);
    parts
}

/// +1 for the left limb (index 0), -1 for the right.
fn side(index: usize) -> f64 {
    if index == 0 { 1.0 } else { -1.0 }
}

/// Left and right limbs have different patterns.
fn pattern(side: f64) -> u32 {
    if side > 0.0 { 1 } else { 2 }
}

fn cone(frame: Pose, length: f64, top: f64, bottom: f64, material: Material) -> Part {
    Part::new(Shape::RoundCone(RoundCone::new(length, top, bottom)), frame, material)
}

fn ball(frame: Pose, radius: f64, material: Material) -> Part {
    Part::new(Shape::Ball { radius }, frame, material)
}

/// A frame whose -z axis points along a direction of its parent.
fn aimed(parent: &Pose, offset: DVec3, direction: DVec3) -> Pose {
    let z = -direction.normalize();
    let y = z.cross(DVec3::X).try_normalize().unwrap_or(DVec3::Y);
    parent.then(offset, DMat3::from_cols(y.cross(z), y, z))
}

/// The frame of a joint. -z runs down the limb.
fn joint(parent: &Pose, offset: DVec3, side: f64, limb: &Limb) -> Pose {
    let direction = turn(side * limb.spread, 0.0, 0.0) * turn(0.0, -limb.swing, 0.0);
    parent.then(offset, direction * turn(0.0, 0.0, -side * limb.twist))
}

fn hip(pelvis: &Pose, side: f64, limb: &Limb) -> Pose {
    joint(pelvis, DVec3::new(0.0, 0.085 * side, -0.05), side, limb)
}

fn knee(hip: &Pose, limb: &Limb) -> Pose {
    hip.then(DVec3::new(0.0, 0.0, -THIGH), turn(0.0, limb.bend, 0.0))
}

/// The ankle joint, level with the floor and turned like the leg.
fn foot(pelvis: &Pose, side: f64, limb: &Limb) -> Pose {
    let knee = knee(&hip(pelvis, side, limb), limb);
    let forward = knee.rotation.x_axis;
    let x = DVec3::new(forward.x, forward.y, 0.0).normalize();
    Pose {
        rotation: DMat3::from_cols(x, DVec3::Z.cross(x), DVec3::Z),
        origin: knee.to_world(DVec3::new(0.0, 0.0, -SHIN)),
    }
}

fn trunk(parts: &mut Vec<Part>, pelvis: &Pose, chest: &Pose) {
    let folds = DVec3::new(0.05, 0.05, 0.11);
    let up = |frame: &Pose, x: f64, z: f64| frame.then(DVec3::new(x, 0.0, z), DMat3::IDENTITY);
    // Trousers' seat.
    parts.push(cone(up(pelvis, -0.01, 0.05), 0.09, 0.150, 0.152, Black).scaled(0.74, 1.0, 1.0));
    // The shirt hangs over the belt in folds.
    parts.push(
        cone(up(chest, 0.0, 0.02), 0.14, 0.142, 0.166, Print)
            .scaled(0.78, 1.0, 1.0)
            .blended(0.008)
            .folded(0.007, folds)
            .cut_from(chest),
    );
    parts.push(
        cone(up(chest, 0.0, 0.22), 0.20, 0.165, 0.142, Print)
            .scaled(0.70, 1.0, 1.0)
            .blended(0.05)
            .folded(0.006, folds)
            .cut_from(chest),
    );
    for s in [1.0, -1.0] {
        let frame = aimed(chest, DVec3::new(-0.005, 0.05 * s, 0.315), DVec3::new(-0.02, 0.12 * s, -0.035));
        parts.push(cone(frame, 0.125, 0.070, 0.066, Print).blended(0.05).folded(0.004, folds).cut_from(chest));
        let frame = chest.then(DVec3::new(0.055, 0.07 * s, 0.21), DMat3::IDENTITY);
        parts.push(ball(frame, 0.075, Print).blended(0.05).cut_from(chest));
    }
}

fn leg(parts: &mut Vec<Part>, pelvis: &Pose, side: f64, limb: &Limb) {
    let folds = DVec3::new(0.05, 0.05, 0.06);
    let hip = hip(pelvis, side, limb);
    parts.push(cone(hip, THIGH, 0.096, 0.068, Black).blended(0.035).folded(0.004, folds).seeded(pattern(side)));
    let knee = knee(&hip, limb);
    let cuff = knee.then(DVec3::new(0.0, 0.0, 0.02), DMat3::IDENTITY);
    parts.push(cone(cuff, SHIN - 0.03, 0.064, 0.060, Denim).blended(0.025).folded(0.006, folds).seeded(pattern(side)));
    let foot = foot(pelvis, side, limb);
    let lower = |x: f64, z: f64| foot.then(DVec3::new(x, 0.0, z), DMat3::IDENTITY);
    let toes = aimed(&foot, DVec3::new(-0.035, 0.0, -0.042), DVec3::new(1.0, 0.0, -0.04));
    parts.push(cone(toes, 0.175, 0.044, 0.038, Leather).blended(0.01));
    parts.push(cone(lower(0.0, 0.02), 0.05, 0.048, 0.046, Leather).blended(0.03));
    let sole = aimed(&foot, DVec3::new(-0.04, 0.0, -0.072), DVec3::X);
    parts.push(cone(sole, 0.185, 0.047, 0.045, Rubber).scaled(0.28, 1.0, 1.0));
}

fn arm(parts: &mut Vec<Part>, chest: &Pose, side: f64, limb: &Limb) {
    let folds = DVec3::new(0.04, 0.04, 0.05);
    let shoulder = joint(chest, DVec3::new(-0.01, 0.185 * side, 0.275), side, limb);
    parts.push(cone(shoulder, 0.19, 0.068, 0.058, Print).blended(0.04).folded(0.006, folds).seeded(pattern(side)));
    parts.push(cone(shoulder, UPPER_ARM, 0.046, 0.034, Skin).blended(0.004));
    let elbow = shoulder.then(DVec3::new(0.0, 0.0, -UPPER_ARM), turn(0.0, -limb.bend, 0.0));
    parts.push(cone(elbow, FOREARM, 0.036, 0.025, Skin).blended(0.02));
    // In the frame of the hand, fingers point along -z, the palm faces the body, and the thumb is in front.
    let wrist = elbow.then(DVec3::new(0.0, 0.0, -FOREARM), turn(0.0, 0.0, 0.0));
    let along = |x: f64, z: f64| wrist.then(DVec3::new(x, 0.0, z), DMat3::IDENTITY);
    parts.push(cone(along(0.0, -0.03), 0.045, 0.036, 0.040, Skin).scaled(1.0, 0.42, 1.0).blended(0.02));
    for (i, length) in [0.055, 0.068, 0.064, 0.050].into_iter().enumerate() {
        let x = 0.030 - 0.020 * i as f64;
        let finger = aimed(&wrist, DVec3::new(x, 0.0, -0.095), DVec3::new(1.6 * x, -0.15 * side, -1.0));
        parts.push(cone(finger, length, 0.0095, 0.0075, Skin).blended(0.006));
    }
    let thumb = aimed(&wrist, DVec3::new(0.022, -0.008 * side, -0.045), DVec3::new(0.8, -0.25 * side, -0.75));
    parts.push(cone(thumb, 0.062, 0.013, 0.009, Skin).blended(0.012));
}

fn neck_and_head(parts: &mut Vec<Part>, chest: &Pose, head: &Pose) {
    let neck = aimed(chest, DVec3::new(0.02, 0.0, 0.45), DVec3::new(-0.2, 0.0, -1.0));
    parts.push(cone(neck, 0.12, 0.052, 0.060, Skin).blended(0.01));
    let place = |x: f64, y: f64, z: f64| head.then(DVec3::new(x, y, z), DMat3::IDENTITY);
    parts.push(ball(place(0.0, 0.0, 0.0), 0.1, Face).scaled(0.98, 0.78, 1.18).blended(0.02));
    parts.push(ball(place(0.028, 0.0, -0.062), 0.058, Face).blended(0.035).cut_from(head));
    let nose = aimed(head, DVec3::new(0.092, 0.0, 0.012), DVec3::new(0.35, 0.0, -1.0));
    parts.push(cone(nose, 0.032, 0.007, 0.0125, Face).blended(0.012).cut_from(head));
    for s in [1.0, -1.0] {
        parts.push(ball(place(-0.008, 0.078 * s, -0.005), 0.028, Skin).scaled(0.7, 0.4, 1.1).blended(0.008));
    }
    let strands = DVec3::new(0.02, 0.02, 0.12);
    parts.push(
        ball(place(-0.022, 0.0, 0.034), 0.1, Hair).scaled(0.98, 0.90, 1.02).blended(0.006).folded(0.003, strands),
    );
    let nape = aimed(head, DVec3::new(-0.062, 0.0, 0.01), DVec3::new(-0.25, 0.0, -1.0));
    parts.push(cone(nape, 0.12, 0.062, 0.046, Hair).scaled(0.8, 1.15, 1.0).blended(0.03).folded(0.004, strands));
    let tail = aimed(head, DVec3::new(-0.115, 0.0, 0.06), DVec3::new(-0.35, 0.0, -1.0));
    parts.push(cone(tail, 0.22, 0.036, 0.014, Hair).blended(0.015).folded(0.003, strands));
}

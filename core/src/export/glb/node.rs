//! Where the node of a GLB file puts its mesh.

use alloc::{format, string::String};
use glam::{DQuat, DVec3};

/// What takes the positions in a file to the scene's frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Placement {
    /// A factor. Compact positions are integers.
    pub scale: f64,
    /// What is added to the scaled positions.
    pub offset: DVec3,
}

/// The JSON members of a node that places a mesh and turns it.
pub(super) fn json(placement: Placement, rotation: Option<[f64; 4]>) -> String {
    let rotation = rotation.map(DQuat::from_array);
    let translation = rotation.map_or(placement.offset, |rotation| rotation * placement.offset);
    let mut json = String::new();
    if translation != DVec3::ZERO {
        let DVec3 { x, y, z } = translation + 0.0;
        json += &format!(r#","translation":[{x},{y},{z}]"#);
    }
    if let Some(rotation) = rotation {
        let [x, y, z, w] = rotation.to_array();
        json += &format!(r#","rotation":[{x},{y},{z},{w}]"#);
    }
    if placement.scale != 1.0 {
        let scale = placement.scale;
        json += &format!(r#","scale":[{scale},{scale},{scale}]"#);
    }
    json
}

/// The length of a direction; `None` if it has none.
fn length_of(direction: DVec3) -> Option<f64> {
    let length = libm::sqrt(direction.length_squared());
    (length > 0.0 && length.is_finite()).then_some(length)
}

/// What is wrong with an upward direction, and what to do.
pub(super) fn check_up(up: [f64; 3]) -> Result<(), &'static str> {
    let up = DVec3::from_array(up);
    match length_of(up) {
        Some(_) => Ok(()),
        None if !up.is_finite() => Err("up is not finite: give a direction, such as (0, 0, 1)"),
        None => Err("up has no length that can be computed with: give a direction, such as (0, 0, 1)"),
    }
}

/// The shortest rotation that turns a direction to +y, or `None` if it is +y or no direction.
pub(super) fn upright(up: DVec3) -> Option<DQuat> {
    let length = length_of(up)?;
    if up == DVec3::Y * length {
        return None;
    }
    let up = up / length;
    // With the sum of both directions as the half-way direction. Opposite directions turn about any axis across.
    let (axis, w) = (up.cross(DVec3::Y), 1.0 + up.y);
    if w < 1e-12 {
        return Some(DQuat::from_xyzw(1.0, 0.0, 0.0, 0.0));
    }
    let scale = 1.0 / libm::sqrt(axis.length_squared() + w * w);
    Some(DQuat::from_xyzw(axis.x * scale, axis.y * scale, axis.z * scale, w * scale))
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;

    #[test]
    fn the_upward_direction_becomes_plus_y() {
        let cases = [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [3.0, -4.0, 0.5], [0.0, 2.0, 1e-9]];
        for up in cases {
            let up = DVec3::from_array(up);
            let turned = upright(up).expect("it is not +y") * (up / libm::sqrt(up.length_squared()));
            assert!((turned - DVec3::Y).abs().max_element() < 1e-12, "{up}: {turned}");
        }
        for none in [[0.0, 2.0, 0.0], [0.0; 3], [f64::NAN, 0.0, 1.0], [f64::INFINITY, 0.0, 0.0]] {
            assert_eq!(upright(DVec3::from_array(none)), None, "{none:?}");
        }
    }

    #[test]
    fn what_is_no_direction_is_refused_with_its_reason() {
        assert_eq!(check_up([0.0, -0.1, 3.0]), Ok(()));
        for (up, reason) in [([f64::NAN, 0.0, 1.0], "not finite"), ([0.0; 3], "no length"), ([1e200; 3], "no length")] {
            let problem = check_up(up).expect_err("it is no direction");
            assert!(problem.contains(reason) && problem.contains("such as (0, 0, 1)"), "{problem}");
        }
    }

    #[test]
    fn what_is_turned_is_where_it_was() {
        let placement = Placement { scale: 0.5, offset: DVec3::new(1.0, 2.0, 3.0) };
        assert_eq!(json(placement, None), r#","translation":[1,2,3],"scale":[0.5,0.5,0.5]"#);
        // z up: x stays, y becomes -z, z becomes y.
        let json = json(placement, upright(DVec3::Z).map(|rotation| rotation.to_array()));
        let numbers: Vec<f64> = json[16..].split(']').next().unwrap().split(',').map(|v| v.parse().unwrap()).collect();
        assert!(numbers.iter().zip([1.0, 3.0, -2.0]).all(|(a, b)| (a - b).abs() < 1e-12), "{json}");
    }
}

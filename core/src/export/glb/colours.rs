//! Colours of vertices in a compressed file.
//!
//! They are floating-point numbers of one byte, each with a power of two (the filter EXPONENTIAL of EXT_meshopt_compression).
//! Three powers are enough for all sRGB codes in linear light, and neighbours mostly have the same, so that little more than a
//! byte changes from vertex to vertex. Integers of 16 bits need two changing bytes where colours are dark.

use super::{
    attribute::{Attribute, FLOAT},
    attributes::{WITHIN, linear},
    calm::{Near, cheapest},
};
use crate::point_cloud::Mesh;
use alloc::{string::String, vec, vec::Vec};

/// Powers of two, as the filter has them: numbers are bytes times two to the power of this.
const POWERS: [i8; 3] = [-8, -10, -11];
/// Bytes of a number: three for its digits, of which one is used, and one for its power.
const NUMBER: usize = 4;

/// The bytes for each sRGB code, per power; `None` if the power gives no number that is near enough.
type Table = [[Option<Near>; 256]; POWERS.len()];

fn table() -> Table {
    POWERS.map(|power| {
        let scale = libm::ldexp(1.0, -i32::from(power));
        core::array::from_fn(|code| {
            let at = |code: f64| linear(code.clamp(0.0, 255.0)) * scale;
            let low = libm::ceil(at(code as f64 - WITHIN));
            let high = libm::floor(at(code as f64 + WITHIN)).min(255.0);
            (low <= high).then_some([low as u8, high as u8])
        })
    })
}

/// Linear colours for a compressor, within one sRGB code.
pub(super) fn compressed_colours(mesh: &Mesh) -> Attribute {
    let table = table();
    let mut bytes = vec![0; mesh.colours.len() * 3 * NUMBER];
    for channel in 0..3 {
        let codes = mesh.colours.iter().map(|colour| usize::from(colour[channel]));
        // The power changes only where it must.
        let mut power = 0;
        let mut near: Vec<Near> = Vec::with_capacity(mesh.colours.len());
        for (vertex, code) in codes.enumerate() {
            let others = (0..POWERS.len()).map(|other| (other, table[other][code]));
            let mut order = core::iter::once((power, table[power][code])).chain(others);
            let found = order.find_map(|(power, near)| Some((power, near?)));
            let (chosen, bytes_of_code) = found.expect("a test states that there is a number for each code");
            power = chosen;
            near.push(bytes_of_code);
            bytes[(vertex * 3 + channel) * NUMBER + 3] = POWERS[power].cast_unsigned();
        }
        for (vertex, digits) in cheapest(&near).into_iter().enumerate() {
            bytes[(vertex * 3 + channel) * NUMBER] = digits;
        }
    }
    Attribute {
        component: FLOAT,
        normalised: false,
        kind: "VEC3",
        stride: 3 * NUMBER,
        used: 3 * NUMBER,
        bytes,
        range: String::new(),
        filter: Some("EXPONENTIAL"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn compressed_colours_keep_their_code() {
        assert!((0..256).all(|code| table().iter().any(|power| power[code].is_some())), "a code has no number");
        // All codes up, down, and in an order that jumps.
        let codes = (0..=255u8).chain((0..=255).rev()).chain((0..=255).map(|i: u8| i.wrapping_mul(101)));
        let colours: Vec<[u8; 3]> = codes.map(|code| [code, 255 - code, code / 2]).collect();
        let attribute = compressed_colours(&Mesh { colours: colours.clone(), ..Mesh::default() });
        let numbers = attribute.bytes.chunks(NUMBER).zip(colours.as_flattened());
        for (number, &code) in numbers {
            assert_eq!(number[1..3], [0, 0]);
            let light = libm::ldexp(f64::from(number[0]), i32::from(number[3].cast_signed()));
            let srgb = if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * libm::pow(light, 1.0 / 2.4) - 0.055 };
            assert!((srgb * 255.0 - f64::from(code)).abs() < 0.91, "{code}: {}", srgb * 255.0);
        }
    }
}

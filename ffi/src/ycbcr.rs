//! Camera formats with luma and colour differences, converted to RGB.

use crate::{
    failure::{Failure, Result},
    pixel_format::pcmvs_pixel_format,
    plane::Plane,
    status::pcmvs_status::InvalidArgument,
};

/// How luma and colour differences code red, green and blue. Numbers never change.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum pcmvs_ycbcr {
    /// ITU-R BT.601 (standard definition, and most webcams), video range: luma from 16 to 235.
    Bt601Video = 0,
    /// ITU-R BT.601, full range: luma from 0 to 255, as JPEG has it.
    Bt601Full = 1,
    /// ITU-R BT.709 (high definition), video range.
    Bt709Video = 2,
    /// ITU-R BT.709, full range.
    Bt709Full = 3,
}

/// A conversion in integers, so that the result is the same on every machine. The factors are in 1/256.
struct Conversion {
    /// Luma of black, in 8 bits.
    black: i32,
    luma: i32,
    red_cr: i32,
    green_cb: i32,
    green_cr: i32,
    blue_cb: i32,
}

/// By [`pcmvs_ycbcr`]. Red gets 2 (1 - Kr) of Cr and blue 2 (1 - Kb) of Cb, and green follows from the luma
/// Kr R + Kg G + Kb B. Video range has 219 levels of luma and 224 of the differences.
const CONVERSIONS: [Conversion; 4] = [
    Conversion { black: 16, luma: 298, red_cr: 409, green_cb: 100, green_cr: 208, blue_cb: 516 },
    Conversion { black: 0, luma: 256, red_cr: 359, green_cb: 88, green_cr: 183, blue_cb: 454 },
    Conversion { black: 16, luma: 298, red_cr: 459, green_cb: 55, green_cr: 136, blue_cb: 541 },
    Conversion { black: 0, luma: 256, red_cr: 403, green_cb: 48, green_cr: 120, blue_cb: 475 },
];

impl Conversion {
    /// Red, green and blue of values of 8 + `more` bits.
    fn rgb(&self, [y, cb, cr]: [u16; 3], more: u32) -> [u8; 3] {
        let y = (i32::from(y) - (self.black << more)) * self.luma;
        let [cb, cr] = [cb, cr].map(|v| i32::from(v) - (128 << more));
        let channel = |v: i32| ((v + (128 << more)) >> (8 + more)).clamp(0, 255) as u8;
        [
            channel(y + self.red_cr * cr),
            channel(y - self.green_cb * cb - self.green_cr * cr),
            channel(y + self.blue_cb * cb),
        ]
    }
}

/// Whether a picture is converted. NV12 of BT.601 in video range is what the core reads itself.
pub(crate) fn is_converted(format: pcmvs_pixel_format, ycbcr: u32) -> bool {
    match format {
        pcmvs_pixel_format::Nv12 => ycbcr != pcmvs_ycbcr::Bt601Video as u32,
        pcmvs_pixel_format::I420 | pcmvs_pixel_format::P010 | pcmvs_pixel_format::Yuy2 => true,
        _ => false,
    }
}

/// Packed RGB of a picture of `width` x `height` pixels with a plane of luma, and planes of colour differences where its format
/// has them.
pub(crate) fn to_rgb(
    (format, ycbcr): (pcmvs_pixel_format, u32),
    [width, height]: [usize; 2],
    luma: &Plane,
    differences: &[Option<Plane>; 2],
    name: &str,
) -> Result<Vec<u8>> {
    let Some(conversion) = CONVERSIONS.get(ycbcr as usize) else {
        return Err(Failure::new(InvalidArgument, format!("`{name}.ycbcr` is {ycbcr}, which is not known")));
    };
    let picture = Picture { width, height, luma, differences };
    let byte = |row: &[u8], i: usize| u16::from(row[i]);
    let ten_bits = |row: &[u8], i: usize| u16::from_ne_bytes([row[2 * i], row[2 * i + 1]]) >> 6;
    Ok(match format {
        pcmvs_pixel_format::I420 => {
            picture.converted(conversion, 0, |[y, cb, cr], x| [byte(y, x), byte(cb, x / 2), byte(cr, x / 2)])
        }
        pcmvs_pixel_format::P010 => picture.converted(conversion, 2, |[y, pairs, _], x| {
            [ten_bits(y, x), ten_bits(pairs, x / 2 * 2), ten_bits(pairs, x / 2 * 2 + 1)]
        }),
        pcmvs_pixel_format::Yuy2 => picture.converted(conversion, 0, |[row, ..], x| {
            [byte(row, 2 * x), byte(row, x / 2 * 4 + 1), byte(row, x / 2 * 4 + 3)]
        }),
        _ => picture.converted(conversion, 0, |[y, pairs, _], x| {
            [byte(y, x), byte(pairs, x / 2 * 2), byte(pairs, x / 2 * 2 + 1)]
        }),
    })
}

/// The planes of a picture.
struct Picture<'a> {
    width: usize,
    height: usize,
    luma: &'a Plane<'a>,
    differences: &'a [Option<Plane<'a>>; 2],
}

impl Picture<'_> {
    /// Packed RGB. `read` gives luma, Cb and Cr of a column from the rows of the planes, as values of 8 + `more` bits.
    fn converted(&self, conversion: &Conversion, more: u32, read: impl Fn([&[u8]; 3], usize) -> [u16; 3]) -> Vec<u8> {
        let mut rgb = Vec::with_capacity(self.width * self.height * 3);
        for y in 0..self.height {
            let [first, second] =
                [0, 1].map(|k| self.differences[k].as_ref().map_or(&[][..], |plane| plane.row(y / 2)));
            let rows = [self.luma.row(y), first, second];
            rgb.extend((0..self.width).flat_map(|x| conversion.rgb(read(rows, x), more)));
        }
        rgb
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Shares of red and blue in the luma.
    const SHARES: [[f64; 2]; 2] = [[0.299, 0.114], [0.2126, 0.0722]];

    /// Luma and differences of a colour, in steps of `1 / scale` of 8 bits.
    fn coded([r, g, b]: [f64; 3], kind: usize, scale: f64) -> [u16; 3] {
        let [kr, kb] = SHARES[kind / 2];
        let luma = kr * r + (1.0 - kr - kb) * g + kb * b;
        let (black, light, difference) =
            if kind % 2 == 1 { (0.0, 1.0, 1.0) } else { (16.0, 219.0 / 255.0, 224.0 / 255.0) };
        let value = |v: f64| ((v * scale).round() as i64).clamp(0, (256.0 * scale) as i64 - 1) as u16;
        [
            value(black + light * luma),
            value(128.0 + difference * (b - luma) / (2.0 * (1.0 - kb))),
            value(128.0 + difference * (r - luma) / (2.0 * (1.0 - kr))),
        ]
    }

    #[test]
    fn colours_come_back_in_every_standard_and_range() {
        for kind in 0..4 {
            for (more, tolerance) in [(0, 3), (2, 2)] {
                for code in 0..125 {
                    let colour = [code % 5, code / 5 % 5, code / 25].map(|step| f64::from(step) * 60.0 + 7.0);
                    let coded = coded(colour, kind, f64::from(1 << more));
                    let found = CONVERSIONS[kind].rgb(coded, more);
                    for (found, colour) in found.into_iter().zip(colour) {
                        let error = (i32::from(found) - colour as i32).abs();
                        assert!(error <= tolerance, "{kind}, {more} more bits, {colour}: {found}");
                    }
                }
            }
        }
    }

    #[test]
    fn black_and_white_are_exact() {
        for (kind, conversion) in CONVERSIONS.iter().enumerate() {
            let [black, white] = if kind % 2 == 1 { [0, 255] } else { [16, 235] };
            assert_eq!(conversion.rgb([black, 128, 128], 0), [0; 3]);
            assert_eq!(conversion.rgb([white, 128, 128], 0), [255; 3]);
            assert_eq!(conversion.rgb([4 * black, 512, 512], 2), [0; 3]);
        }
    }
}

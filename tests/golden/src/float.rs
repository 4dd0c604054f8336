//! Floating-point numbers as text that shows every bit.

/// A number in the format `%a` of C.
pub fn hexadecimal(v: f32) -> String {
    if !v.is_finite() {
        return format!("{v} (bits {:08x})", v.to_bits());
    }
    let (exponent, fraction) = ((v.to_bits() >> 23 & 0xff) as i32, v.to_bits() & 0x7f_ffff);
    let sign = if v.is_sign_negative() { "-" } else { "" };
    if v == 0.0 {
        return format!("{sign}0x0p+0");
    }
    // Numbers below 2^-126 have no leading one.
    let (leading, exponent) = if exponent == 0 { (0, -126) } else { (1, exponent - 127) };
    let digits = format!("{:06x}", fraction << 1);
    let digits = digits.trim_end_matches('0');
    let point = if digits.is_empty() { "" } else { "." };
    format!("{sign}0x{leading}{point}{digits}p{exponent:+}")
}

#[test]
fn every_bit_shows() {
    let known = [
        (0.0, "0x0p+0"),
        (-1.0, "-0x1p+0"),
        (0.1, "0x1.99999ap-4"),
        (f32::MAX, "0x1.fffffep+127"),
        (f32::MIN_POSITIVE, "0x1p-126"),
        (f32::from_bits(1), "0x0.000002p-126"),
    ];
    for (number, text) in known {
        assert_eq!(hexadecimal(number), text);
    }
    assert_eq!(hexadecimal(f32::INFINITY), "inf (bits 7f800000)");
}

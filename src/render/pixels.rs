//! Conversion of a read-back texture to the rows of a picture.

/// Bytes of a row in a read-back buffer, whose rows start at multiples of 256 bytes (WebGPU,
/// `bytesPerRow`).
#[must_use]
pub const fn padded_row(width_px: u32) -> u32 {
    (4 * width_px).next_multiple_of(256)
}

/// Rows of RGBA pixels with straight (not premultiplied) opacity, from top to bottom.
///
/// `padded` holds sRGB pixels, premultiplied in linear light, in rows of [`padded_row`] bytes; if
/// `bgra` is set, blue comes first. Colours are divided by the opacity in linear light. If `opaque`
/// is set, every opacity is 255 instead.
///
/// # Panics
///
/// If `padded` is shorter than `height_px` rows.
#[must_use]
pub fn straight_rgba(padded: &[u8], width_px: u32, height_px: u32, bgra: bool, opaque: bool) -> Vec<u8> {
    let row = 4 * width_px as usize;
    let stride = padded_row(width_px) as usize;
    let mut out = Vec::with_capacity(row * height_px as usize);
    for y in 0..height_px as usize {
        out.extend_from_slice(&padded[y * stride..y * stride + row]);
    }
    for pixel in out.as_chunks_mut::<4>().0 {
        if bgra {
            pixel.swap(0, 2);
        }
        if opaque {
            pixel[3] = 255;
        } else if pixel[3] < 255 {
            let opacity = f32::from(pixel[3]) / 255.0;
            for c in &mut pixel[..3] {
                *c = if opacity > 0.0 { encode(decode(f32::from(*c) / 255.0) / opacity) } else { 0 };
            }
        }
    }
    out
}

/// Linear value of an sRGB component from 0 to 1 (IEC 61966-2-1).
pub(super) fn decode(c: f32) -> f32 {
    if c <= 0.04045 { c / 12.92 } else { libm::powf((c + 0.055) / 1.055, 2.4) }
}

/// sRGB component of a linear value.
fn encode(linear: f32) -> u8 {
    let c = linear.clamp(0.0, 1.0);
    let c = if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * libm::powf(c, 1.0 / 2.4) - 0.055 };
    (c * 255.0).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn padding_is_dropped_and_bgra_becomes_rgba() {
        let (width, height) = (3, 2);
        let mut padded = vec![99_u8; (padded_row(width) * height) as usize];
        for y in 0..2 {
            for x in 0..3 {
                let at = y * padded_row(width) as usize + 4 * x;
                padded[at..at + 4].copy_from_slice(&[10 * x as u8, 100 + y as u8, 7, 255]);
            }
        }
        let rgba = straight_rgba(&padded, width, height, false, false);
        assert_eq!(rgba.len(), 24);
        assert_eq!(&rgba[8..12], &[20, 100, 7, 255]);
        assert_eq!(&rgba[12..16], &[0, 101, 7, 255]);
        let bgra = straight_rgba(&padded, width, height, true, false);
        assert_eq!(&bgra[8..12], &[7, 100, 20, 255]);
    }

    #[test]
    fn rows_are_padded_to_256_bytes() {
        assert_eq!([1, 63, 64, 65, 800].map(padded_row), [256, 256, 256, 512, 3328]);
    }

    #[test]
    fn opacity_is_divided_out_in_linear_light() {
        let half_of_white = encode(0.5);
        let mut padded = vec![0_u8; 256];
        padded[..4].copy_from_slice(&[half_of_white, half_of_white, 0, 128]);
        let rgba = straight_rgba(&padded, 1, 1, false, false);
        assert!(rgba[0] >= 253 && rgba[1] >= 253 && rgba[2] == 0 && rgba[3] == 128, "{rgba:?}");
        assert_eq!(straight_rgba(&[0; 256], 1, 1, false, false), [0, 0, 0, 0]);
        assert_eq!(straight_rgba(&[5; 256], 1, 1, false, true), [5, 5, 5, 255]);
    }

    #[test]
    fn every_byte_survives_the_curve() {
        for byte in 0..=255 {
            assert_eq!(encode(decode(f32::from(byte) / 255.0)), byte);
        }
    }
}

//! Small images embedded in the page: indexed PNG as a data URL.
//!
//! Values have the colours of viridis, which is perceptually uniform and keeps its order in grey
//! and for the colour-blind (Smith and van der Walt, matplotlib 2015, public domain). Differences
//! have those of Moreland (2009, Diverging color maps for scientific visualization): grey at zero,
//! blue below and red above, also distinct for the colour-blind.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use png::{BitDepth, ColorType, Compression, Encoder, EncodingError};

/// Colours of a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Palette {
    /// From dark to light, for values.
    Sequential,
    /// Two colours around a neutral zero, for differences.
    Diverging,
}

/// Returns the data URL of an image with one palette entry per pixel, row by row from the top.
///
/// # Panics
/// If `pixels` is empty, or its length is not a multiple of `width`.
#[must_use]
pub fn address(palette: Palette, width: usize, pixels: &[u8]) -> String {
    assert!(!pixels.is_empty() && pixels.len().is_multiple_of(width), "an image has full rows");
    let image = encoded(palette, width, pixels).expect("encoding a small image to memory succeeds");
    format!("data:image/png;base64,{}", STANDARD.encode(image))
}

/// Encodes an indexed PNG with eight bits per pixel; entry 0 is transparent.
fn encoded(palette: Palette, width: usize, pixels: &[u8]) -> Result<Vec<u8>, EncodingError> {
    let size = |length: usize| u32::try_from(length).unwrap_or(u32::MAX);
    let colours = (1..=COLOURS).map(|index| colour(palette, index));
    let palette = std::iter::once([0; 3]).chain(colours);
    let mut out = Vec::new();
    let mut encoder = Encoder::new(&mut out, size(width), size(pixels.len() / width));
    encoder.set_color(ColorType::Indexed);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_palette(palette.flatten().collect::<Vec<u8>>());
    encoder.set_trns(vec![0]);
    encoder.set_compression(Compression::Balanced);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(pixels)?;
    writer.finish()?;
    Ok(out)
}

/// Viridis at equal steps from 0 to 1. Linear interpolation between the steps is within 2 of 255 of
/// the original.
const VIRIDIS: [[u8; 3]; 33] = [
    [68, 1, 84],
    [71, 13, 96],
    [72, 24, 106],
    [72, 35, 116],
    [71, 45, 123],
    [69, 54, 129],
    [66, 64, 134],
    [63, 73, 137],
    [59, 82, 139],
    [55, 90, 141],
    [51, 99, 141],
    [47, 106, 142],
    [44, 114, 142],
    [41, 122, 142],
    [38, 129, 142],
    [35, 137, 142],
    [33, 144, 140],
    [31, 152, 139],
    [31, 159, 136],
    [33, 166, 133],
    [40, 174, 128],
    [49, 181, 123],
    [62, 188, 116],
    [76, 194, 108],
    [93, 201, 99],
    [110, 206, 88],
    [130, 211, 76],
    [150, 216, 63],
    [171, 220, 50],
    [192, 223, 36],
    [213, 226, 26],
    [234, 229, 26],
    [253, 231, 37],
];

/// Moreland's map from blue to red at equal steps from −1 to 1, computed from its end colours.
const COOL_WARM: [[u8; 3]; 33] = [
    [59, 76, 192],
    [68, 90, 204],
    [78, 104, 215],
    [88, 117, 225],
    [98, 130, 234],
    [108, 142, 241],
    [119, 154, 247],
    [130, 165, 251],
    [141, 176, 254],
    [152, 185, 255],
    [163, 194, 255],
    [174, 201, 253],
    [184, 208, 249],
    [194, 213, 244],
    [204, 217, 238],
    [213, 219, 230],
    [221, 221, 221],
    [229, 216, 209],
    [236, 211, 198],
    [241, 204, 185],
    [245, 196, 173],
    [247, 187, 160],
    [247, 177, 148],
    [247, 166, 135],
    [244, 154, 123],
    [241, 141, 111],
    [236, 127, 99],
    [229, 112, 87],
    [222, 97, 76],
    [213, 80, 66],
    [203, 62, 56],
    [192, 40, 47],
    [180, 4, 38],
];

/// Number of colours of a palette. Entry 0 is transparent and stands for a missing value.
pub const COLOURS: u8 = 255;

/// Colour of palette entry `index`, counted from 1, as red, green and blue.
#[must_use]
pub fn colour(palette: Palette, index: u8) -> [u8; 3] {
    let steps = match palette {
        Palette::Sequential => &VIRIDIS,
        Palette::Diverging => &COOL_WARM,
    };
    let place = f64::from(index.saturating_sub(1)) / f64::from(COLOURS - 1);
    let along = place * (steps.len() - 1) as f64;
    let below = (along.floor() as usize).min(steps.len() - 2);
    let part = along - below as f64;
    let mix = |low: u8, high: u8| {
        (f64::from(low) + part * (f64::from(high) - f64::from(low))).round() as u8
    };
    std::array::from_fn(|c| mix(steps[below][c], steps[below + 1][c]))
}

/// Palette entry of a value in a range; 0 if the value is not finite.
#[must_use]
pub fn entry(value: f64, [low, high]: [f64; 2]) -> u8 {
    if !value.is_finite() {
        return 0;
    }
    let part = if high > low { ((value - low) / (high - low)).clamp(0.0, 1.0) } else { 0.0 };
    1 + (part * f64::from(COLOURS - 1)).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    fn viridis(index: u8) -> [u8; 3] {
        colour(Palette::Sequential, index)
    }

    #[test]
    fn an_image_reads_back_as_it_was() {
        let pixels: Vec<u8> = (0..80 * 60).map(|n| (n % 80) as u8).collect();
        let address = address(Palette::Sequential, 80, &pixels);
        let code = address.strip_prefix("data:image/png;base64,").unwrap();
        let image = std::io::Cursor::new(STANDARD.decode(code).unwrap());
        let mut decoder = png::Decoder::new(image);
        decoder.set_transformations(png::Transformations::IDENTITY);
        let mut reader = decoder.read_info().unwrap();
        let mut back = vec![0; reader.output_buffer_size().unwrap()];
        let frame = reader.next_frame(&mut back).unwrap();
        assert_eq!((frame.width, frame.height, back), (80, 60, pixels));
        assert_eq!(reader.info().trns.as_deref(), Some(&[0][..]));
        let first = reader.info().palette.as_ref().unwrap()[3..6].to_vec();
        assert_eq!(first, viridis(1));
    }

    /// Relative luminance of the linear sRGB components (IEC 61966-2-1, Rec. 709 weights).
    fn luminance(colour: [u8; 3]) -> f64 {
        let linear = |c: u8| {
            let c = f64::from(c) / 255.0;
            if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
        };
        0.2126 * linear(colour[0]) + 0.7152 * linear(colour[1]) + 0.0722 * linear(colour[2])
    }

    #[test]
    fn lightness_only_rises() {
        let all: Vec<f64> = (1..=COLOURS).map(|index| luminance(viridis(index))).collect();
        assert!(all.windows(2).all(|pair| pair[1] > pair[0] - 2e-3));
        let steps: Vec<f64> = all.iter().step_by(32).copied().collect();
        assert!(steps.windows(2).all(|pair| pair[1] > pair[0]), "{steps:?}");
    }

    /// The middle of a symmetric range is grey, and both sides are equally dark.
    #[test]
    fn a_difference_of_zero_is_neutral() {
        let at = |value: f64| colour(Palette::Diverging, entry(value, [-2.0, 2.0]));
        assert_eq!(at(0.0), [221; 3]);
        assert!(at(-2.0)[2] > 150 && at(2.0)[0] > 150);
        for value in [0.5, 1.0, 2.0] {
            let [below, above] = [-value, value].map(|value| luminance(at(value)));
            assert!((below - above).abs() < 0.05, "{value}: {below} {above}");
        }
    }

    #[test]
    fn a_range_has_both_ends() {
        assert_eq!(viridis(entry(-1.0, [-1.0, 3.0])), [68, 1, 84]);
        assert_eq!(viridis(entry(3.0, [-1.0, 3.0])), [253, 231, 37]);
        assert_eq!(entry(f64::NAN, [0.0, 1.0]), 0);
        assert_eq!(entry(2.0, [2.0, 2.0]), 1);
    }
}

//! The colour map of surface maps: viridis, which is perceptually uniform and keeps its order in
//! grey and for the colour-blind (Smith and van der Walt, matplotlib 2015, public domain).

/// Viridis at equal steps from 0 to 1; between these the colours are interpolated linearly, which
/// is within 2 of 255 of the original.
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

/// Colours of a palette: entry 0 is transparent and stands for no value.
pub const COLOURS: u8 = 255;

/// Entry `index` of the palette, from 1 on, red, green and blue.
#[must_use]
pub fn colour(index: u8) -> [u8; 3] {
    let place = f64::from(index.saturating_sub(1)) / f64::from(COLOURS - 1);
    let along = place * (VIRIDIS.len() - 1) as f64;
    let below = (along.floor() as usize).min(VIRIDIS.len() - 2);
    let part = along - below as f64;
    let mix = |low: u8, high: u8| {
        (f64::from(low) + part * (f64::from(high) - f64::from(low))).round() as u8
    };
    std::array::from_fn(|c| mix(VIRIDIS[below][c], VIRIDIS[below + 1][c]))
}

/// The entry for a value in a range; 0 for what is not finite.
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
        let all: Vec<f64> = (1..=COLOURS).map(|index| luminance(colour(index))).collect();
        assert!(all.windows(2).all(|pair| pair[1] > pair[0] - 2e-3));
        let steps: Vec<f64> = all.iter().step_by(32).copied().collect();
        assert!(steps.windows(2).all(|pair| pair[1] > pair[0]), "{steps:?}");
    }

    #[test]
    fn a_range_has_both_ends() {
        assert_eq!(colour(entry(-1.0, [-1.0, 3.0])), [68, 1, 84]);
        assert_eq!(colour(entry(3.0, [-1.0, 3.0])), [253, 231, 37]);
        assert_eq!(entry(f64::NAN, [0.0, 1.0]), 0);
        assert_eq!(entry(2.0, [2.0, 2.0]), 1);
    }
}

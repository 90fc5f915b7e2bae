//! Effect `roughness`: heights of the surfaces, added to the undeformed distance.
//!
//! The heights come from a map in a file, from one wave, or from a self-affine surface that is
//! generated from a seed. The wave is h cos(2πx/λ_x) cos(2πy/λ_y). The self-affine surface is a sum
//! of cosine waves with random directions and phases,
//!
//! z(x, y) = √(2/M) h Σ_m w_m cos(q_m·(x, y) + φ_m),
//!
//! whose wave numbers lie between 2π over the longest and 2π over the shortest wavelength, equally
//! spaced in ln q. The amplitudes w_m ~ q^(−H) with the Hurst exponent H are normalised to Σ
//! w² = M, so that h is the root mean square height. The surface does not depend on the grid: a
//! finer grid samples the same surface.
//!
//! Wave numbers are rounded to multiples of 2π/L in a contact with the periods L along x and y. A
//! wave that would become constant by the rounding is refused. A map or a wave must fit into the
//! period a whole number of times.
//!
//! Source: Persson et al., J. Phys.: Condens. Matter 17 (2005) R1–R62, for self-affine surfaces;
//! Longuet-Higgins, Phil. Trans. R. Soc. A 250 (1957) 157–174, for the sum of waves.

use crate::advice::situation::{PRESSURE, Situation};
use crate::case::keys::CheckedParams;
use crate::registry::entry::Effect;
use crate::terms::{GapTerm, Kind, State, Terms};
use proto::advice::Advice;
use proto::configuration::{Configuration, Refusal};
use proto::description::KeySpec;
use proto::figure::contact::{SEMI_AXIS_A, SEMI_AXIS_B};
use proto::readable::quantity;
use proto::table::{Reading, Table};
use std::f64::consts::{PI, TAU};
use std::path::Path;

/// Registry entry of the effect.
pub const EFFECT: Effect = Effect {
    name: "roughness",
    law: "heights from a map, of a wave or of a self-affine surface, added to the undeformed distance",
    source: "Persson et al., J. Phys.: Condens. Matter 17 (2005) R1-R62; Longuet-Higgins, Phil. \
             Trans. R. Soc. A 250 (1957) 157-174",
    kinds: &[Kind::Gap],
    consumes: &[],
    provides: &[],
    keys,
    figures: Vec::new,
    advise: Some(advise),
    terms,
};

/// Number of waves of a self-affine surface.
const WAVES: usize = 400;
/// Relative tolerance for a period that is a whole multiple of a length.
const WHOLE: f64 = 1e-9;
/// Largest size of a file [byte].
const MOST_BYTES: u64 = 1 << 28;

const FILE: &str = "effects.roughness.file";
const SPACING: &str = "effects.roughness.spacing";
const SCALE: &str = "effects.roughness.scale";
const RMS: &str = "effects.roughness.rms_height";
const HURST: &str = "effects.roughness.hurst";
const LONGEST: &str = "effects.roughness.longest_wavelength";
const SHORTEST: &str = "effects.roughness.shortest_wavelength";
const SEED: &str = "effects.roughness.seed";
const AMPLITUDE: &str = "effects.roughness.amplitude";
const WAVELENGTHS: [&str; 2] = ["effects.roughness.wavelength_x", "effects.roughness.wavelength_y"];

fn keys() -> Vec<KeySpec> {
    const SOURCE: &str = "effects.roughness.source";
    vec![
        KeySpec::file(
            FILE,
            "height map: a table of numbers without a header, a row along x for each y",
        )
        .one_of(SOURCE),
        KeySpec::quantity(SPACING, "m", "distance between the points of the height map").above(0.0),
        KeySpec::quantity(SCALE, "m", "height of the number 1 in the height map")
            .default_value(1.0)
            .above(0.0),
        KeySpec::quantity(RMS, "m", "root mean square height of a self-affine surface")
            .above(0.0)
            .one_of(SOURCE),
        KeySpec::number(HURST, "Hurst exponent").default_value(0.8).above(0.0).at_most(1.0),
        KeySpec::quantity(LONGEST, "m", "longest wavelength").default_value(4e-3).above(0.0),
        KeySpec::quantity(SHORTEST, "m", "shortest wavelength").default_value(4e-4).above(0.0),
        KeySpec::integer(SEED, "seed of the random phases").default_value(1).at_least(0.0),
        KeySpec::quantity(AMPLITUDE, "m", "amplitude of a wave, which opens the gap at the origin")
            .one_of(SOURCE),
        KeySpec::quantity(
            WAVELENGTHS[0],
            "m",
            "length of the wave along x; absent: constant along x",
        )
        .above(0.0),
        KeySpec::quantity(
            WAVELENGTHS[1],
            "m",
            "length of the wave along y; absent: constant along y",
        )
        .above(0.0),
    ]
}

/// Heights of a rough surface.
#[derive(Debug, PartialEq)]
enum Roughness {
    /// Points of a regular map, continued periodically.
    Map(HeightMap),
    /// A sum of waves.
    Waves(Vec<Wave>),
    /// Amplitude [m] and wave numbers [rad/m] of a product of cosines.
    Wave(f64, [f64; 2]),
}

/// A regular map of heights.
#[derive(Debug, PartialEq)]
struct HeightMap {
    columns: usize,
    spacing: f64,
    heights: Vec<f64>,
}

/// Wave of a self-affine surface.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Wave {
    /// Wave numbers along x and y [rad/m].
    wave_number: [f64; 2],
    /// Phase [rad].
    phase: f64,
    /// Amplitude [m].
    amplitude: f64,
}

fn terms(configuration: &Configuration) -> Result<Terms, Refusal> {
    Ok(Terms { gap: vec![Box::new(read(configuration)?)], ..Terms::default() })
}

/// Reads the roughness of a configuration. Refuses values that are missing or out of range, and a
/// file that is not a height map.
fn read(configuration: &Configuration) -> Result<Roughness, Refusal> {
    let case = CheckedParams::new(&configuration.case, keys());
    if case.has(FILE) {
        let path = case.text(FILE)?;
        let wrong = |reason: String| {
            Refusal::new(FILE, format!("`{path}` {reason}"), "give rows with equally many numbers")
        };
        let table = Table::read(Path::new(path), MOST_BYTES, Reading::NUMBERS);
        let table = table.map_err(|error| wrong(error.to_string()))?;
        let map = HeightMap::from_table(&table, case.number(SPACING)?, case.number(SCALE)?);
        return map.map(Roughness::Map).map_err(wrong);
    }
    if let Some(amplitude) = case.maybe_number(AMPLITUDE)? {
        let number = |key: &str| {
            case.maybe_number(key).map(|length| length.map_or(0.0, |length| TAU / length))
        };
        return Ok(Roughness::Wave(amplitude, [number(WAVELENGTHS[0])?, number(WAVELENGTHS[1])?]));
    }
    let (longest, shortest) = (case.number(LONGEST)?, case.number(SHORTEST)?);
    if shortest >= longest {
        return Err(Refusal::new(
            SHORTEST,
            format!("{shortest} m is not below the longest wavelength of {longest} m"),
            format!("lower it, or raise {LONGEST}"),
        ));
    }
    let seed = case.integer(SEED)?.unsigned_abs();
    let waves = self_affine(case.number(RMS)?, case.number(HURST)?, [longest, shortest], seed);
    Ok(Roughness::Waves(waves))
}

impl State for Roughness {}

impl GapTerm for Roughness {
    fn height(&self, x: f64, y: f64) -> f64 {
        match self {
            Self::Map(map) => map.height(x, y),
            Self::Waves(waves) => {
                let term = |wave: &Wave| {
                    let [qx, qy] = wave.wave_number;
                    wave.amplitude * (qx * x + qy * y + wave.phase).cos()
                };
                waves.iter().map(term).sum()
            }
            Self::Wave(amplitude, [kx, ky]) => amplitude * (kx * x).cos() * (ky * y).cos(),
        }
    }

    fn repeat(&mut self, periods: [f64; 2]) -> Result<(), Refusal> {
        let fits = |times: f64| (times - times.round()).abs() < WHOLE * times.max(1.0);
        let whole = |key: &str, what: &str, length: f64, period: f64| match fits(period / length) {
            true => Ok(()),
            false => {
                let reason = format!(
                    "{what} of {length} m does not fit a contact with the period {period} m"
                );
                Err(Refusal::new(key, reason, "make the period a whole multiple of it"))
            }
        };
        match self {
            Self::Map(map) => {
                let rows = map.heights.len() / map.columns;
                let sides = [map.columns, rows].map(|count| count as f64 * map.spacing);
                let mut sides = sides.into_iter().zip(periods);
                sides.try_for_each(|(side, period)| whole(SPACING, "a map", side, period))
            }
            Self::Wave(_, numbers) => {
                let mut each = numbers.iter().zip(WAVELENGTHS).zip(periods);
                each.try_for_each(|((number, key), period)| match number {
                    0.0 => Ok(()),
                    _ => whole(key, "a wave", TAU / number, period),
                })
            }
            Self::Waves(waves) => {
                for wave in waves {
                    for (number, period) in wave.wave_number.iter_mut().zip(periods) {
                        let base = TAU / period;
                        *number = base * (*number / base).round();
                    }
                    // A wave that is longer than the period would become a constant height.
                    if wave.wave_number == [0.0; 2] {
                        let reason = format!(
                            "waves of this length do not fit a contact with the periods {} and {} m",
                            periods[0], periods[1]
                        );
                        return Err(Refusal::new(
                            LONGEST,
                            reason,
                            "write at most half of the shorter period",
                        ));
                    }
                }
                Ok(())
            }
        }
    }
}

impl HeightMap {
    /// Creates a map from a table of numbers without a header.
    ///
    /// # Errors
    /// A table that is not a matrix; a scaled height that is not finite. The text follows the
    /// file's name.
    fn from_table(table: &Table, spacing: f64, scale: f64) -> Result<Self, String> {
        let (columns, mut heights) = table.matrix().map_err(|error| error.to_string())?;
        heights.iter_mut().for_each(|height| *height *= scale);
        match heights.iter().position(|height| !height.is_finite()) {
            Some(at) => {
                Err(format!("times the scale is not finite in line {}", table.line(at / columns)))
            }
            None => Ok(Self { columns, spacing, heights }),
        }
    }

    /// Height by bilinear interpolation between the points [m]; the first point lies at the origin.
    fn height(&self, x: f64, y: f64) -> f64 {
        let rows = self.heights.len() / self.columns;
        let cell = |at: f64, count: usize| {
            let at = (at / self.spacing).rem_euclid(count as f64);
            let low = (at as usize).min(count - 1);
            (low, (low + 1) % count, at - low as f64)
        };
        let ((i, right, s), (j, upper, t)) = (cell(x, self.columns), cell(y, rows));
        let row = |j: usize| {
            let at = |i: usize| self.heights[j * self.columns + i];
            (1.0 - s) * at(i) + s * at(right)
        };
        (1.0 - t) * row(j) + t * row(upper)
    }
}

/// Generates the waves of a surface with this root mean square height [m] and these wavelengths
/// [m].
fn self_affine(rms: f64, hurst: f64, [longest, shortest]: [f64; 2], seed: u64) -> Vec<Wave> {
    let mut random = SplitMix { state: seed };
    let mut waves: Vec<Wave> = (0..WAVES)
        .map(|m| {
            let share = (m as f64 + random.unit()) / WAVES as f64;
            let wavelength = longest * (shortest / longest).powf(share);
            let (angle, phase) = (TAU * random.unit(), TAU * random.unit());
            let size = TAU / wavelength;
            let wave_number = [size * angle.cos(), size * angle.sin()];
            Wave { wave_number, phase, amplitude: wavelength.powf(hurst) }
        })
        .collect();
    let square: f64 = waves.iter().map(|wave| 0.5 * wave.amplitude.powi(2)).sum();
    waves.iter_mut().for_each(|wave| wave.amplitude *= rms / square.sqrt());
    waves
}

/// Random generator splitmix64 (Steele, Lea & Flood 2014), with the same numbers on every machine.
struct SplitMix {
    state: u64,
}

impl SplitMix {
    /// Returns the next number in [0, 1).
    fn unit(&mut self) -> f64 {
        self.state = self.state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// Root mean square height of a run-in rail [m], used if the case has none.
const TYPICAL: f64 = 1e-6;
/// Highest pressure of a random field of many waves, approximately, relative to its root mean
/// square.
const HIGHEST: f64 = 3.0;
/// Parts of a spectrum, over the logarithm of the wave number, in a sum of its waves.
const PARTS: usize = 32;

/// Estimates the change of the pressure, from the waves that the contact holds.
fn advise(situation: &Situation<'_>) -> Advice {
    if [FILE, AMPLITUDE].iter().any(|key| situation.case.has(key)) {
        return Advice::new(EFFECT.name, "not estimated for a height map or a single wave");
    }
    let number = |key: &str| {
        let default = keys().into_iter().find(|spec| spec.path == key)?.default?.as_f64();
        situation.case.maybe_number(key).ok().flatten().or(default)
    };
    let rms = situation.case.maybe_number(RMS).ok().flatten().unwrap_or(TYPICAL);
    let advice = Advice::new(
        EFFECT.name,
        format!(
            "pressure of the highest wave within the contact, of a roughness of {rms}; where \
             the contact holds few waves, seeds differ by this much",
            rms = quantity(rms, "m", 2)
        ),
    )
    .with(format!("{RMS}={rms:e}"));
    let axes = [SEMI_AXIS_A, SEMI_AXIS_B].map(|key| situation.known(key));
    let (
        Some([pressure, approach]),
        Some(hurst),
        Some(longest),
        Some(shortest),
        [Some(a), Some(b)],
    ) = (situation.pressed(), number(HURST), number(LONGEST), number(SHORTEST), axes)
    else {
        return advice;
    };
    let modulus = situation.scene.contact_compliance().recip();
    let fluctuation = modulus * rms * flattened(hurst, [longest, shortest], a.min(b));
    let waves = PI * a * b / (0.5 * shortest).powi(2);
    let highest = (1.0 + 2.0 * waves.ln_1p()).sqrt().min(HIGHEST);
    advice
        .number("roughness over approach", rms / approach)
        .moves(PRESSURE, highest * fluctuation / pressure)
}

/// Returns the root mean square pressure of a self-affine surface in a contact of a semi-axis [m],
/// over the contact modulus and the root mean square height [1/m].
///
/// Pressing a wave of height h and wave number q flat takes the pressure ½ E* q h (Johnson, Contact
/// Mechanics, 13.2). A wave much longer than the contact only changes its curvature by q² h, and
/// with it Hertz's pressure by 2/(3π) E* a q² h. Between both limits the reciprocals are added.
fn flattened(hurst: f64, [longest, shortest]: [f64; 2], semi_axis: f64) -> f64 {
    let (first, last) = ((TAU / longest).ln(), (TAU / shortest).ln());
    let (mut squares, mut heights) = (0.0, 0.0);
    for part in 0..PARTS {
        let q = (first + (part as f64 + 0.5) / PARTS as f64 * (last - first)).exp();
        let height = q.powf(-2.0 * hurst);
        let curved = 4.0 / (3.0 * PI) * q * semi_axis;
        squares += height * (0.5 * q * curved / (1.0 + curved)).powi(2);
        heights += height;
    }
    (squares / heights).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Mean and mean square over an area many wavelengths wide. The tolerance covers the scatter of
    /// a finite area: the longest waves dominate, which leaves a few dozen independent patches.
    #[test]
    fn self_affine_heights_have_the_root_mean_square_asked_for() {
        let surface = Roughness::Waves(self_affine(2e-6, 0.8, [1e-3, 1e-4], 7));
        let heights: Vec<f64> = (0..40_000)
            .map(|k| surface.height(f64::from(k % 200) * 7.3e-5, f64::from(k / 200) * 7.1e-5))
            .collect();
        let mean = heights.iter().sum::<f64>() / heights.len() as f64;
        let square = heights.iter().map(|z| z * z).sum::<f64>() / heights.len() as f64;
        assert!(mean.abs() < 0.05 * 2e-6, "{mean}");
        assert!((square.sqrt() / 2e-6 - 1.0).abs() < 0.05, "{}", square.sqrt());
    }

    #[test]
    fn seeds_differ_and_repeat() {
        let surface = |seed| self_affine(1e-6, 0.5, [1e-3, 1e-4], seed);
        assert_eq!(surface(3), surface(3));
        assert_ne!(surface(3), surface(4));
    }

    #[test]
    fn a_map_is_bilinear_and_periodic() {
        let parse = |text: &str, spacing, scale| {
            let table = Table::parse(text.to_owned(), Reading::NUMBERS);
            HeightMap::from_table(&table.map_err(|error| error.to_string())?, spacing, scale)
        };
        let map = parse("# heights\n0, 1, 2\n3, 4, 5\n", 0.5, 2.0).unwrap();
        assert_eq!(map.height(0.5, 0.0), 2.0);
        assert_eq!(map.height(0.25, 0.25), 4.0);
        assert_eq!(map.height(0.5 + 1.5, 1.0), 2.0);
        assert_eq!(map.height(-0.5, 0.0), 4.0);
        for (text, part) in [("", "no rows"), ("1 2\n3", "line 2"), ("1 x", "column 2 of line 1")] {
            let error = parse(text, 1.0, 1.0).unwrap_err();
            assert!(error.contains(part), "{error}");
        }
        assert!(parse("1 inf", 1.0, 1.0).is_err());
        assert!(parse("1 1e300", 1.0, 1e300).unwrap_err().contains("not finite"));
    }

    proptest! {
        #[test]
        fn any_text_and_any_place(text in "[-0-9eE.,; \n]{0,100}", x in -1e6f64..1e6) {
            let table = Table::parse(text, Reading::NUMBERS);
            if let Ok(map) = table.map_err(|_| String::new()).and_then(|table| HeightMap::from_table(&table, 0.3, 1.0)) {
                prop_assert!(map.height(x, -x).is_finite());
            }
        }
    }
}

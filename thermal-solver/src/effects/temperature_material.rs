//! Effect `temperature_material`: conductivity and specific heat depend on temperature.
//!
//! A material with a `thermal_table` has them from lines of temperature [K], conductivity [W/(m·K)] and
//! specific heat [J/(kg·K)], straight between; temperatures are absolute: the body's `initial_temperature` and
//! the rise. One without has constant ones. Its density is constant.

use crate::fe::law::Point;
use crate::models::names;
use crate::scene::Scene;
use crate::situation::Situation;
use proto::advice::Advice;
use proto::configuration::Refusal;
use proto::description::{EffectSpec, KeySpec, names as field_names};
use proto::field;
use proto::params::Params;
use std::path::Path;

/// Name in the case file.
pub const NAME: &str = "temperature_material";

const BEYOND: &str = "effects.temperature_material.beyond";
const TABLE: &str = "thermal_table";
/// Larger files are refused.
const MOST_BYTES: u64 = 1 << 24;

/// The thermal participant's part of the effect.
#[must_use]
pub fn spec() -> EffectSpec {
    let help = "lines of temperature [K], conductivity [W/(m K)] and specific heat [J/(kg K)], \
                temperature rising";
    EffectSpec {
        figures: Vec::new(),
        name: NAME.to_owned(),
        law: "rho c(T) dT/dt = div(lambda(T) grad T), with lambda and c from a table".to_owned(),
        source: "Carslaw & Jaeger, Conduction of Heat in Solids, 1.6; EN 1993-1-2, 3.4.1"
            .to_owned(),
        models: vec![names::FE.to_owned()],
        consumes: field_names(&[&field::FRICTION_POWER]),
        provides: Vec::new(),
        keys: vec![
            KeySpec::file(&format!("materials.*.{TABLE}"), help),
            KeySpec::choice(BEYOND, &["refuse", "clamp"], "what happens beyond a table")
                .default_value("refuse"),
        ],
    }
}

/// The points of both bodies' materials, and whether what is beyond them counts as their ends.
pub fn read(case: &Params, scene: &Scene) -> Result<([Vec<Point>; 2], bool), Refusal> {
    let clamps = case.has(BEYOND) && case.text(BEYOND)? == "clamp";
    let mut points = [Vec::new(), Vec::new()];
    for (body, points) in points.iter_mut().enumerate() {
        let material = case.text(&scene.names.key(body, "material"))?;
        let key = format!("materials.{material}.{TABLE}");
        if !case.has(&key) {
            continue;
        }
        let path = case.text(&key)?;
        let density = scene.materials[body].density;
        let refused = |reason: String| {
            let fix =
                "give lines of temperature, conductivity and specific heat, temperature rising";
            Refusal::new(&key, format!("`{path}` {reason}"), fix)
        };
        let bytes = read_bytes(Path::new(path)).map_err(refused)?;
        *points = parse(&bytes, density).map_err(refused)?;
        let initial = scene.initial_temperatures[body];
        let (first, last) = (points[0].temperature, points[points.len() - 1].temperature);
        if !clamps && !(first..=last).contains(&initial) {
            return Err(refused(format!(
                "is from {first} to {last} K, and the body begins at {initial} K"
            )));
        }
    }
    Ok((points, clamps))
}

fn read_bytes(path: &Path) -> Result<String, String> {
    let length = std::fs::metadata(path).map_err(|error| format!("cannot be read: {error}"))?.len();
    if length > MOST_BYTES {
        return Err(format!("has {length} bytes, more than {MOST_BYTES}"));
    }
    std::fs::read_to_string(path).map_err(|error| format!("cannot be read: {error}"))
}

/// The points of a table; empty lines and those that begin with `#` say nothing.
///
/// # Errors
/// What is wrong with it, and where.
pub fn parse(text: &str, density: f64) -> Result<Vec<Point>, String> {
    let mut points: Vec<Point> = Vec::new();
    for (number, line) in (1..).zip(text.lines()) {
        let line = line.trim();
        if line.is_empty() || line.starts_with('#') {
            continue;
        }
        let words = line.split([',', ';', ' ', '\t']).filter(|word| !word.is_empty());
        let numbers: Result<Vec<f64>, _> = words.map(str::parse).collect();
        let Ok([temperature, conductivity, specific_heat]) =
            numbers.unwrap_or_default().try_into().map(|three: [f64; 3]| three)
        else {
            return Err(format!("has no three numbers in line {number}"));
        };
        let positive = |value: f64| value.is_finite() && value > 0.0;
        if ![temperature, conductivity, specific_heat].into_iter().all(positive) {
            return Err(format!("has a number in line {number} that is not positive"));
        }
        if points.last().is_some_and(|last| last.temperature >= temperature) {
            return Err(format!("does not rise in temperature in line {number}"));
        }
        points.push(Point { temperature, conductivity, capacity: density * specific_heat });
    }
    if points.is_empty() {
        return Err("has no line".to_owned());
    }
    Ok(points)
}

/// Relative rise of the effusivity of carbon steel with the temperature, from 20 to 400 °C [1/K].
const STEEL: f64 = 2.8e-4;

/// What it says of itself in a scene.
#[must_use]
pub fn advise(situation: &Situation<'_>) -> Advice {
    let body = situation.hotter();
    let rise = situation.rises[body];
    let why = "effusivity of carbon steel at half the rise (EN 1993-1-2); needs a thermal_table for the material";
    let better = 0.5 * STEEL * rise;
    situation.moved(Advice::new(NAME, why), body, -better / (1.0 + better))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn tables_are_read_line_by_line() {
        let points = parse("# T, lambda, c\n293, 50, 420\n\n800; 35 600\n", 2.0).unwrap();
        assert_eq!(points.len(), 2);
        assert_eq!((points[1].conductivity, points[1].capacity), (35.0, 1200.0));
        let wrong = |text: &str| parse(text, 1.0).unwrap_err();
        assert_eq!(wrong(""), "has no line");
        assert_eq!(wrong("293 50"), "has no three numbers in line 1");
        assert_eq!(wrong("293 50 4\n293 50 4"), "does not rise in temperature in line 2");
        assert_eq!(wrong("293 -50 4"), "has a number in line 1 that is not positive");
    }

    proptest! {
        /// Any text is read or refused.
        #[test]
        fn any_text_is_read_or_refused(text in "[-0-9eEinfa.,; #\n]{0,200}") {
            if let Ok(points) = parse(&text, 7850.0) {
                prop_assert!(points.windows(2).all(|pair| pair[0].temperature < pair[1].temperature));
                prop_assert!(points.iter().all(|point| point.capacity > 0.0));
            }
        }
    }
}

//! Effect `temperature_material`: conductivity and specific heat depend on temperature.
//!
//! A `thermal_table` of the material gives temperature [K], conductivity [W/(m·K)] and specific
//! heat [J/(kg·K)], interpolated linearly. Temperatures are absolute: the body's
//! `initial_temperature` plus the rise. Without a table the properties are constant. The density is
//! constant in either case.

use crate::scene::Scene;
use crate::situation::Situation;
use heat::Material;
use heat::fe::law::{Law, Point};
use proto::advice::Advice;
use proto::bodies::ABSOLUTE;
use proto::configuration::Refusal;
use proto::description::{EffectSpec, KeySpec, names as field_names};
use proto::field;
use proto::params::Params;
use proto::table::{Column, Reading, Table, headings};
use std::path::Path;

/// Name of the effect in the case file.
pub const NAME: &str = "temperature_material";

const BEYOND: &str = "effects.temperature_material.beyond";
const TABLE: &str = "thermal_table";
/// Largest size of a table file [byte].
const MOST_BYTES: u64 = 1 << 24;

/// Returns the columns of a table.
fn columns() -> [Column; 3] {
    [
        Column::new(&["temperature", "T"], "K").expected(100.0..=3000.0, ABSOLUTE),
        Column::new(&["conductivity", "lambda"], "W/(m K)")
            .expected(0.02..=430.0, "from foams to silver; check the order of the columns"),
        Column::new(&["specific_heat", "c"], "J/(kg K)")
            .expected(100.0..=1e4, "from lead to water; check the order of the columns"),
    ]
}

/// Returns the thermal participant's part of the effect.
#[must_use]
pub fn spec() -> EffectSpec {
    let help = "properties over a temperature that rises from row to row";
    EffectSpec {
        figures: Vec::new(),
        name: NAME.to_owned(),
        law: "rho c(T) dT/dt = div(lambda(T) grad T), with lambda and c from a table".to_owned(),
        source: "Carslaw & Jaeger, Conduction of Heat in Solids, 1.6; EN 1993-1-2, 3.4.1"
            .to_owned(),
        models: Vec::new(),
        consumes: field_names(&[&field::FRICTION_POWER]),
        provides: Vec::new(),
        keys: vec![
            KeySpec::table(&format!("materials.*.{TABLE}"), &columns(), help),
            KeySpec::choice(BEYOND, &["refuse", "hold"], "temperatures beyond a table: refuse ends the run, hold keeps the properties of the nearest end")
                .default_value("refuse"),
        ],
    }
}

/// Reads the property points of both bodies' materials, and whether the ends of a table hold beyond
/// it.
///
/// # Errors
/// A value or a table that cannot be read; an initial temperature beyond a table whose ends do not
/// hold there.
pub fn read(case: &Params, scene: &Scene) -> Result<([Vec<Point>; 2], bool), Refusal> {
    let clamps = case.has(BEYOND) && case.text(BEYOND)? == "hold";
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
            let fix = format!("give a table of {}", headings(&columns()));
            Refusal::new(&key, format!("`{path}` {reason}"), fix)
        };
        let table = Table::read(Path::new(path), MOST_BYTES, Reading::NUMBERS);
        *points = table
            .map_err(|error| error.to_string())
            .and_then(|table| points_of(&table, density))
            .map_err(refused)?;
        let initial = scene.initial_temperatures[body];
        let (first, last) = (points[0].temperature, points[points.len() - 1].temperature);
        if !clamps && !(first..=last).contains(&initial) {
            return Err(refused(format!(
                "covers {first} to {last} K, and the body begins at {initial} K"
            )));
        }
    }
    Ok((points, clamps))
}

/// Converts a table to property points.
///
/// # Errors
/// A description of the fault and its line.
fn points_of(table: &Table, density: f64) -> Result<Vec<Point>, String> {
    let found = table.columns(&columns()).map_err(|error| error.to_string())?;
    table.check_rising("temperature", &found[0], false).map_err(|error| error.to_string())?;
    let point = |row: usize| {
        let [temperature, conductivity, specific_heat] = [0, 1, 2].map(|k: usize| found[k][row]);
        if ![temperature, conductivity, specific_heat].into_iter().all(|value| value > 0.0) {
            return Err(format!("has a number in line {} that is not positive", table.line(row)));
        }
        Ok(Point { temperature, conductivity, capacity: density * specific_heat })
    };
    (0..table.rows()).map(point).collect()
}

/// Conductivity [W/(m·K)] and specific heat [J/(kg·K)] of carbon steel at a temperature [K], up to
/// 600 °C (EN 1993-1-2, 3.4.1).
fn steel(temperature: f64) -> [f64; 2] {
    let celsius = (temperature - 273.15).clamp(0.0, 600.0);
    let specific_heat = 425.0 + celsius * (0.773 + celsius * (-1.69e-3 + celsius * 2.22e-6));
    [54.0 - 3.33e-2 * celsius, specific_heat]
}

/// Property points of a body without a table: its own properties at the initial temperature, with
/// the relative variation of carbon steel.
fn typical(scene: &Scene, body: usize) -> Vec<Point> {
    let Material { density, specific_heat, conductivity } = scene.materials[body];
    let initial = scene.initial_temperatures[body];
    let point = |k: u32| {
        let temperature = initial + 50.0 * f64::from(k);
        let [[lambda, c], [cold_lambda, cold_c]] = [steel(temperature), steel(initial)];
        Point {
            temperature,
            conductivity: conductivity * lambda / cold_lambda,
            capacity: density * specific_heat * c / cold_c,
        }
    };
    (0..=20).map(point).collect()
}

/// Estimates how much the effect matters in a scene.
#[must_use]
pub fn advise(situation: &Situation<'_>) -> Advice {
    let (body, scene) = (situation.hotter(), situation.scene);
    let (tables, _) = read(situation.case, scene).unwrap_or_default();
    let why = match tables[body].is_empty() {
        true => {
            "conductivity and heat capacity over the rise, of carbon steel (EN 1993-1-2); needs a thermal_table for the material"
        }
        false => "conductivity and heat capacity over the rise, from the thermal_table",
    };
    let points = match tables[body].is_empty() {
        true => typical(scene, body),
        false => tables[body].clone(),
    };
    let law = Law::new(&points, scene.initial_temperatures[body]);
    let relative = situation.rise_with(body, &law) / situation.rises[body] - 1.0;
    situation.moved(Advice::new(NAME, why), body, relative)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn points(text: &str, density: f64) -> Result<Vec<Point>, String> {
        let table =
            Table::parse(text.to_owned(), Reading::NUMBERS).map_err(|error| error.to_string())?;
        points_of(&table, density)
    }

    #[test]
    fn tables_are_read_by_their_header_or_in_order() {
        let read = points("# T, lambda, c\n293; 50; 420\n\n800; 35; 600\n", 2.0).unwrap();
        assert_eq!(read.len(), 2);
        assert_eq!((read[1].conductivity, read[1].capacity), (35.0, 1200.0));
        let named = points("c [kJ/(kg K)], lambda, T [°C]\n0.42, 50, 20\n", 2.0).unwrap();
        assert_eq!((named[0].temperature, named[0].conductivity), (293.15, 50.0));
        assert_eq!(named[0].capacity, 840.0);
        let wrong = |text: &str| points(text, 1.0).unwrap_err();
        assert_eq!(wrong(""), "has no rows");
        assert!(wrong("293 50").contains("2 columns and no header"));
        assert!(wrong("293 50 4\n293 50 4").contains("from line 1 to line 2"));
        assert_eq!(wrong("293 -50 4"), "has a number in line 1 that is not positive");
    }

    proptest! {
        /// Any text is read or refused.
        #[test]
        fn any_text_is_read_or_refused(text in "[-0-9eEinfa.,; #\n]{0,200}") {
            if let Ok(points) = points(&text, 7850.0) {
                prop_assert!(points.windows(2).all(|pair| pair[0].temperature < pair[1].temperature));
                prop_assert!(points.iter().all(|point| point.capacity > 0.0));
            }
        }
    }
}

//! A value that a key would accept, to show what to write.

use super::quote::quoted;
use super::schema::Shape;
use contract::description::{KeyKind, KeySpec};
use contract::quantity::parse_quantity;

/// Magnitudes that people know, by unit; of those of one unit the first that is expected of a key.
const FAMILIAR: &[(&str, &str)] = &[
    ("m", "0.5 m"),
    ("m", "0.1 mm"),
    ("N", "100 kN"),
    ("N", "1 kN"),
    ("Pa", "200 GPa"),
    ("Pa", "500 MPa"),
    ("W/(m K)", "50 W/(m K)"),
    ("J/(kg K)", "450 J/(kg K)"),
    ("1/K", "1.2e-5 1/K"),
    ("N m", "100 N m"),
    ("m2", "1e-4 m2"),
    ("kg", "1000 kg"),
    ("N/m", "1e6 N/m"),
    ("N s/m", "2500 N s/m"),
    ("A", "100 A"),
    ("K/s", "100 K/s"),
    ("m3/J", "1e-14 m3/J"),
    ("V m/A", "2e-7 V m/A"),
    ("W/(m2 K)", "20 W/(m2 K)"),
    ("Pa s", "0.1 Pa s"),
    ("m/Pa", "1e-15 m/Pa"),
    ("s/m", "0.01 s/m"),
    ("m/s", "30 m/s"),
    ("s", "1 ms"),
    ("kg/m3", "7850 kg/m3"),
    ("kg/m^3", "7850 kg/m^3"),
    ("K", "300 K"),
    ("B", "64 MB"),
];

/// The number is within the range of the key.
pub(super) fn in_range(spec: &KeySpec, number: f64) -> bool {
    number.is_finite()
        && spec.above.is_none_or(|bound| number > bound)
        && spec.at_least.is_none_or(|bound| number >= bound)
        && spec.at_most.is_none_or(|bound| number <= bound)
}

/// The range in words, with the unit: "above 0 m"; empty if there is none.
pub(super) fn range(spec: &KeySpec, unit: &str) -> String {
    let word = |name: &str, bound: Option<f64>| {
        bound.map(|bound| format!("{name} {}", with_unit(bound, unit)))
    };
    let words =
        [word("above", spec.above), word("at least", spec.at_least), word("at most", spec.at_most)];
    words.into_iter().flatten().collect::<Vec<_>>().join(" and ")
}

/// A number with its unit, for people.
pub(super) fn with_unit(number: f64, unit: &str) -> String {
    let magnitude = number.abs();
    let plain = magnitude == 0.0 || (1e-4..1e7).contains(&magnitude);
    let digits = if plain { number.to_string() } else { format!("{number:e}") };
    if unit == "1" || unit.is_empty() { digits } else { format!("{digits} {unit}") }
}

/// A value that the key accepts, in TOML.
pub(super) fn example(spec: &KeySpec, shape: Shape) -> String {
    let one = match &spec.kind {
        KeyKind::Quantity { unit } => quantity(spec, unit),
        KeyKind::Integer => number(spec, &[40.0, 1.0]).to_string(),
        KeyKind::Flag => "true".to_owned(),
        KeyKind::Choice { of } => quoted(of.first().map_or("", String::as_str)),
        KeyKind::Text | KeyKind::NameIn { .. } => "\"NAME\"".to_owned(),
        KeyKind::File => "\"FILE\"".to_owned(),
    };
    if shape == Shape::List { format!("[{one}]") } else { one }
}

fn quantity(spec: &KeySpec, unit: &str) -> String {
    let familiar = FAMILIAR.iter().filter(|(of, _)| *of == unit).map(|(_, text)| *text);
    let allowed = |value| in_range(spec, value);
    let expected = |value| spec.plausible.as_ref().is_none_or(|p| p.bound_passed(value).is_none());
    let find = |fits: &dyn Fn(f64) -> bool| {
        let fits = |text: &&str| parse_quantity(text, unit).is_ok_and(fits);
        familiar.clone().find(fits)
    };
    let found = find(&|value| allowed(value) && expected(value)).or_else(|| find(&allowed));
    if let Some(text) = found {
        return quoted(text);
    }
    // Poisson's ratio of metals, and a coefficient of friction.
    let text = with_unit(number(spec, &[0.3, 1.0]), unit);
    if unit == "1" { text } else { quoted(&text) }
}

/// A number within the range: one of the usual, or one made from the bounds.
fn number(spec: &KeySpec, usual: &[f64]) -> f64 {
    let low = spec.above.or(spec.at_least);
    let middle = low.zip(spec.at_most).map(|(low, high)| f64::midpoint(low, high));
    let made = [middle, spec.at_least, spec.at_most, spec.above.map(|bound| bound + 1.0)];
    let mut candidates = usual.iter().copied().chain(made.into_iter().flatten());
    candidates.find(|candidate| in_range(spec, *candidate)).unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_familiar_magnitude_is_one() {
        for (unit, text) in FAMILIAR {
            assert!(parse_quantity(text, unit).is_ok(), "{text} in {unit}");
        }
    }

    #[test]
    fn examples_lie_in_the_range() {
        let of = |spec: KeySpec| example(&spec, Shape::One);
        assert_eq!(of(KeySpec::quantity("a", "N", "").above(0.0)), "\"100 kN\"");
        assert_eq!(of(KeySpec::quantity("a", "N", "").at_most(-1.0)), "\"-1 N\"");
        assert_eq!(of(KeySpec::quantity("a", "J/(kg K)", "")), "\"450 J/(kg K)\"");
        assert_eq!(of(KeySpec::quantity("a", "m", "").expected(0.0..=1e-3, "small")), "\"0.1 mm\"");
        assert_eq!(of(KeySpec::quantity("a", "m", "").expected(9.0..=9.0, "large")), "\"0.5 m\"");
        assert_eq!(of(KeySpec::quantity("a", "rad", "")), "\"0.3 rad\"");
        assert_eq!(of(KeySpec::number("a", "").above(2.0).at_most(3.0)), "2.5");
        assert_eq!(of(KeySpec::integer("a", "").at_most(9.0)), "1");
        assert_eq!(of(KeySpec::choice("a", &["x", "y"], "")), "\"x\"");
        assert_eq!(example(&KeySpec::text("a", ""), Shape::List), "[\"NAME\"]");
    }

    #[test]
    fn ranges_read_well() {
        let spec = KeySpec::quantity("a", "Pa", "").above(0.0).at_most(2.1e11);
        assert_eq!(range(&spec, "Pa"), "above 0 Pa and at most 2.1e11 Pa");
    }
}

//! Ranges of values: `FROM..TO/COUNT` (even spacing), `FROM..TO/COUNTlog` (constant ratio) and
//! `FROM..TO/COUNTcheb` (denser towards the ends, as polynomial interpolation needs). The last are
//! the extrema of a Chebyshev polynomial (Trefethen, Approximation Theory and Approximation
//! Practice, 2013, ch. 2). A unit is written at both ends: `40kN..90kN/3`.

/// Largest number of values.
const MOST: u32 = 100_000;

/// Units whose zero is not nothing.
const OWN_ZERO: [&str; 2] = ["°C", "degC"];

/// Values of a range in TOML syntax; `None` if the text is not a range.
///
/// # Errors
/// The reason why the range is invalid, as a phrase that follows the text of the option.
pub(super) fn read(text: &str) -> Option<Result<Vec<String>, String>> {
    let (ends, count) = text.rsplit_once('/')?;
    let (from, to) = ends.split_once("..")?;
    Some(values(from, to, count.trim()))
}

/// Spacing of the values between the ends.
#[derive(Clone, Copy, PartialEq)]
enum Spacing {
    Even,
    Log,
    Chebyshev,
}

fn values(from: &str, to: &str, count: &str) -> Result<Vec<String>, String> {
    let (Some((from, unit)), Some((to, other))) = (quantity(from), quantity(to)) else {
        return Err("has an end that is not a number".to_owned());
    };
    // Nothing of a unit is 0 without it, except on a scale with its own zero.
    let is_nothing = |value: f64, own: &str, other: &str| {
        value == 0.0 && own.is_empty() && !OWN_ZERO.iter().any(|name| other.contains(name))
    };
    let unit = match unit == other {
        true => unit,
        false if is_nothing(from, unit, other) => other,
        false if is_nothing(to, other, unit) => unit,
        false => return Err("has ends with different units".to_owned()),
    };
    let spacings = [("log", Spacing::Log), ("cheb", Spacing::Chebyshev)];
    let spaced = spacings.iter().find_map(|(word, one)| Some((count.strip_suffix(word)?, *one)));
    let (count, spacing) = spaced.unwrap_or((count, Spacing::Even));
    let count: u32 =
        count.parse().map_err(|_| "has a count that is not a whole number".to_owned())?;
    if !(2..=MOST).contains(&count) {
        return Err(format!("has {count} values, and a range has 2 to {MOST}"));
    }
    if spacing == Spacing::Log && from * to <= 0.0 {
        return Err(
            "has no constant ratio: both ends need the same sign, and neither may be 0".to_owned()
        );
    }
    let value = |n: u32| {
        let part = f64::from(n) / f64::from(count - 1);
        let value = match (n, spacing) {
            (0, _) => from,
            (n, _) if n == count - 1 => to,
            (_, Spacing::Log) => from * (to / from).powf(part),
            (_, Spacing::Even) => from + part * (to - from),
            (_, Spacing::Chebyshev) => {
                from + 0.5 * (1.0 - (std::f64::consts::PI * part).cos()) * (to - from)
            }
        };
        // Drop rounding errors, so that values read as if written by hand.
        let short: f64 = format!("{value:.12e}").parse().unwrap_or(value);
        let space = if unit.is_empty() { "" } else { " " };
        format!("{short:?}{space}{unit}")
    };
    Ok((0..count).map(value).collect())
}

/// A finite number and its unit, which may be empty.
fn quantity(text: &str) -> Option<(f64, &str)> {
    let text = text.trim();
    let ends = (1..=text.len()).rev().filter(|end| text.is_char_boundary(*end));
    let parts = ends.map(|end| text.split_at(end));
    let number = |(number, unit): (&str, &'_ str)| Some((number.parse::<f64>().ok()?, unit.len()));
    let (value, unit) = parts.into_iter().find_map(number)?;
    value.is_finite().then(|| (value, text[text.len() - unit..].trim()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_lie_between_two_ends() {
        let of = |text: &str| read(text).map(Result::unwrap);
        let some = |values: &[&str]| Some(values.iter().map(|v| (*v).to_owned()).collect());
        assert_eq!(of("0.1..0.4/4"), some(&["0.1", "0.2", "0.3", "0.4"]));
        assert_eq!(of("-10..50/4"), some(&["-10.0", "10.0", "30.0", "50.0"]));
        assert_eq!(of("1..1e4/3log"), some(&["1.0", "100.0", "10000.0"]));
        assert_eq!(
            of("0..2/5cheb"),
            some(&["0.0", "0.2928932188135", "1.0", "1.707106781187", "2.0"])
        );
        assert_eq!(of("-1..-4/3log"), some(&["-1.0", "-2.0", "-4.0"]));
        assert_eq!(of("40kN..90kN/3"), some(&["40.0 kN", "65.0 kN", "90.0 kN"]));
        assert_eq!(of("0..-5%/3"), some(&["0.0 %", "-2.5 %", "-5.0 %"]));
        assert_eq!(of("2 kN..0/2"), some(&["2.0 kN", "0.0 kN"]));
        assert_eq!(of("36 km/h..72 km/h/2"), some(&["36.0 km/h", "72.0 km/h"]));
        assert_eq!(of("1e3N..4e3 N/3log"), some(&["1000.0 N", "2000.0 N", "4000.0 N"]));
        assert_eq!(of("up/down,left"), None);
        for (wrong, why) in [
            ("1..x/3", "not a number"),
            ("1..inf/3", "not a number"),
            ("1 kN..2e3/3", "different units"),
            ("0..20 °C/3", "different units"),
            ("1 kN..2000 N/3", "different units"),
            ("1..2/1", "has 1 values"),
            ("1..2/2.5", "not a whole number"),
            ("-1..2/4log", "no constant ratio"),
        ] {
            assert!(read(wrong).unwrap().unwrap_err().contains(why), "{wrong}");
        }
    }
}

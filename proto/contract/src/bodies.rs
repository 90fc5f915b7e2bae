//! The two bodies in contact: `upper` and `lower` in the contract, with the names from the case
//! wherever a person reads them.
//!
//! A case has a table `[bodies.NAME]` for each body, with its `position`. Names of fields and grids
//! of one body begin with the position (`upper_temperature`). Results show the name from the case
//! instead (`wheel_temperature`).

use crate::description::KeySpec;
use crate::grid::check_name;
use crate::params::Params;
use crate::refusal::Refusal;
use serde::{Deserialize, Serialize};

/// Name of the table of bodies in a case.
pub const TABLE: &str = "bodies";
/// The positions, in the order of pairs of values.
pub const POSITIONS: [&str; 2] = ["upper", "lower"];
/// Index of the upper body, body 1, in a pair.
pub const UPPER: usize = 0;
/// Index of the lower body, body 2, in a pair.
pub const LOWER: usize = 1;
/// Reason why an absolute temperature below 100 K is implausible.
pub const ABSOLUTE: &str = "it is an absolute temperature; \"20 °C\" is 293.15 K";

/// Default initial temperature of a body [K].
pub const INITIAL_TEMPERATURE: f64 = 293.15;

/// Returns the key of a body's position, shared by all participants that read keys of bodies.
#[must_use]
pub fn position_key() -> KeySpec {
    KeySpec::choice("bodies.*.position", &POSITIONS, "which of the two bodies it is").required()
}

/// Returns the key of a body's initial temperature, the reference of temperature rises.
#[must_use]
pub fn initial_temperature_key() -> KeySpec {
    let help = "initial temperature, over which temperatures are rises";
    KeySpec::quantity("bodies.*.initial_temperature", "K", help)
        .above(0.0)
        .expected(100.0..=3000.0, ABSOLUTE)
        .default_value(INITIAL_TEMPERATURE)
}

/// Returns the key of the speed at which a body's surface passes through the contact.
#[must_use]
pub fn surface_speed_key() -> KeySpec {
    let help = "speed at which the body's surface passes through the contact; absent: motion.speed";
    KeySpec::quantity("bodies.*.surface_speed", "m/s", help)
        .expected(0.0..=200.0, "the fastest trains reach 160 m/s; km/h is a unit, too")
        .at_least(0.0)
        .varies()
}

/// Names of the upper and the lower body in a case.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Bodies(pub [String; 2]);

impl Bodies {
    /// Reads the names of the bodies from a case.
    ///
    /// # Errors
    /// Fails unless the case has exactly one upper and one lower body and no other, or if a name
    /// cannot be used in results.
    pub fn read(case: &Params) -> Result<Self, Refusal> {
        let table = case.get(TABLE).and_then(serde_json::Value::as_object);
        let of = |position: &str| -> Vec<&String> {
            let at = |body: &serde_json::Value| {
                body.get("position").and_then(serde_json::Value::as_str) == Some(position)
            };
            table.into_iter().flatten().filter(|(_, b)| at(b)).map(|(name, _)| name).collect()
        };
        for (name, body) in table.into_iter().flatten() {
            let reason = match body.get("position") {
                Some(at) if POSITIONS.iter().any(|position| at == position) => continue,
                Some(_) => "is neither upper nor lower",
                None => "missing",
            };
            let key = format!("{TABLE}.{name}.position");
            return Err(Refusal::new(&key, reason, "write \"upper\" or \"lower\""));
        }
        match POSITIONS.map(of) {
            [upper, lower] if upper.len() == 1 && lower.len() == 1 => {
                let bodies = Self([upper[0].clone(), lower[0].clone()]);
                bodies.check_names().map(|()| bodies)
            }
            found => {
                let (position, names) = POSITIONS
                    .iter()
                    .zip(&found)
                    .find(|(_, names)| names.len() != 1)
                    .expect("one of them has not one body");
                Err(not_one(position, names))
            }
        }
    }

    /// Checks that names can be parts of field, file and key names, and that no body is named after
    /// the other position.
    fn check_names(&self) -> Result<(), Refusal> {
        for (body, name) in self.0.iter().enumerate() {
            let wrong = match check_name("body", name) {
                Err(why) => why,
                Ok(()) if *name == POSITIONS[1 - body] => {
                    format!("the {} body is called `{name}`", POSITIONS[body])
                }
                Ok(()) => continue,
            };
            return Err(Refusal::new(&format!("{TABLE}.{name}"), wrong, "choose another name"));
        }
        Ok(())
    }

    /// Returns the dotted key of a value of a body.
    #[must_use]
    pub fn key(&self, body: usize, name: &str) -> String {
        format!("{TABLE}.{}.{name}", self.0[body])
    }

    /// Returns the name of a field or grid as shown to people: a leading position becomes the name
    /// of the body.
    #[must_use]
    pub fn shown(&self, name: &str) -> String {
        replaced(name, &POSITIONS, &self.0.each_ref().map(String::as_str))
    }

    /// Returns the contract's name for a name shown to people; the inverse of [`Bodies::shown`].
    #[must_use]
    pub fn named(&self, shown: &str) -> String {
        replaced(shown, &self.0.each_ref().map(String::as_str), &POSITIONS)
    }
}

/// Replaces the leading word of `name`, before a `_`, if it is one of `from`.
fn replaced(name: &str, from: &[&str; 2], to: &[&str; 2]) -> String {
    let rest = |word: &str| name.strip_prefix(word).filter(|rest| rest.starts_with('_'));
    let found = from.iter().zip(to).find_map(|(from, to)| Some((to, rest(from)?)));
    found.map_or_else(|| name.to_owned(), |(word, rest)| format!("{word}{rest}"))
}

fn not_one(position: &str, names: &[&String]) -> Refusal {
    let (key, reason) = match names {
        [] => (TABLE.to_owned(), format!("there is no {position} body")),
        [first, second, ..] => {
            let reason = format!("`{first}` and `{second}` are both the {position} body");
            (format!("{TABLE}.{second}.position"), reason)
        }
        [_] => unreachable!("one body is as it should be"),
    };
    let fix = "write one table [bodies.NAME] with position = \"upper\" and one with \"lower\"";
    Refusal::new(&key, reason, fix)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn read(bodies: serde_json::Value) -> Result<Bodies, Refusal> {
        Bodies::read(&Params(json!({ "bodies": bodies })))
    }

    #[test]
    fn bodies_are_found_by_position_whatever_their_names() {
        let bodies = read(json!({"disc": {"position": "lower"}, "pin": {"position": "upper"}}));
        let bodies = bodies.unwrap();
        assert_eq!(bodies, Bodies(["pin".to_owned(), "disc".to_owned()]));
        assert_eq!(bodies.key(UPPER, "radius_x"), "bodies.pin.radius_x");
        assert_eq!(bodies.shown("lower_temperature"), "disc_temperature");
        assert_eq!(bodies.named("disc_temperature"), "lower_temperature");
        for name in ["pressure", "lowered_temperature", "disc"] {
            assert_eq!(bodies.shown(name), name);
        }
    }

    #[test]
    fn one_body_a_position() {
        let upper = || json!({"position": "upper"});
        let refused = |bodies| read(bodies).unwrap_err();
        assert_eq!(refused(json!({"a": upper()})).reason, "there is no lower body");
        assert_eq!(refused(json!({})).reason, "there is no upper body");
        assert_eq!(refused(json!({"a": upper(), "b": upper()})).key, "bodies.b.position");
        assert_eq!(refused(json!({"a": upper(), "b": {}})).key, "bodies.b.position");
        let lower = || json!({"position": "lower"});
        assert_eq!(refused(json!({"a b": upper(), "b": lower()})).key, "bodies.a b");
        assert_eq!(refused(json!({"a": upper(), "upper": lower()})).key, "bodies.upper");
        assert!(read(json!({"upper": upper(), "lower": lower()})).is_ok());
    }
}

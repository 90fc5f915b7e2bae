//! Parameters of an FMU that the case sets before the start: `[ROLE.start]`, with a key for every
//! parameter.

use crate::description::ModelDescription;
use crate::variable::{Kind, Variable};
use proto::configuration::Refusal;
use proto::description::KeySpec;
use proto::params::Params;
use proto::text::one_line;
use serde_json::Value;

/// Iterates over the parameters a case can set. A parameter is left out if its name is not a dotted
/// key, or is also a table of other parameters.
fn parameters(of: &ModelDescription) -> impl Iterator<Item = &Variable> {
    let part = |part: &str| {
        !part.is_empty() && part.chars().all(|c| c.is_ascii_alphanumeric() || c == '_')
    };
    let is_key = move |name: &str| name.split('.').all(part);
    let settable = || of.variables.iter().filter(|one| one.settable);
    let mut names: Vec<&str> = settable().map(|one| one.name.as_str()).collect();
    names.sort_unstable();
    let is_table = move |name: &str| {
        let inside = format!("{name}.");
        let first = names.partition_point(|other| *other < inside.as_str());
        names.get(first).is_some_and(|other| other.starts_with(&inside))
    };
    settable().filter(move |one| is_key(&one.name) && !is_table(&one.name))
}

fn path(role: &str, name: &str) -> String {
    format!("{role}.start.{name}")
}

/// Returns the keys of the parameters.
pub fn keys(role: &str, of: &ModelDescription) -> Vec<KeySpec> {
    let key = |one: &Variable| {
        let path = path(role, &one.name);
        let words = if one.words.is_empty() { &one.name } else { &one.words };
        let first = one.start.first().filter(|first| one.size == 1 && first.is_finite());
        let without = first.map_or_else(String::new, |first| {
            let unit = one.unit.name.as_str();
            let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
            format!("; absent: {first}{unit}")
        });
        let help = one_line(&format!("{words}{without}")).into_owned();
        let spec = match one.kind {
            Kind::Boolean => KeySpec::flag(&path, &help),
            kind if kind.is_real() => {
                KeySpec::quantity(&path, one.unit.base.as_deref().unwrap_or("1"), &help)
            }
            kind => {
                let spec = KeySpec::integer(&path, &help);
                match kind.range() {
                    Some([least, most]) => spec.at_least(least).at_most(most),
                    None => spec,
                }
            }
        };
        let spec = if one.size > 1 { spec.or_list() } else { spec };
        // The FMU has no start value.
        if one.start.iter().all(|start| start.is_finite()) { spec } else { spec.required() }
    };
    parameters(of).map(key).collect()
}

/// Reads the values set by the case, in the units of the FMU.
///
/// # Errors
/// Fails if the number of values differs from the size of the parameter, or an integer is outside
/// the range of its type.
pub fn read(
    role: &str,
    of: &ModelDescription,
    case: &Params,
) -> Result<Vec<(Variable, Vec<f64>)>, Refusal> {
    let mut given = Vec::new();
    for one in parameters(of) {
        let key = path(role, &one.name);
        let Some(value) = case.get(&key) else { continue };
        let listed = match value {
            Value::Array(list) => list.iter().map(number).collect(),
            single => number(single).map(|value| vec![value]),
        };
        match listed {
            Some(values) if values.len() == one.size => {
                if let Some([least, most]) = one.kind.range()
                    && values.iter().any(|value| !(least..=most).contains(value))
                {
                    let reason = format!("{value} is not an integer that `{}` can have", one.name);
                    let fix = format!("write a value from {least} to {most}");
                    return Err(Refusal::new(&key, reason, fix));
                }
                // A value without base unit is already in the unit of the FMU.
                let own = |value| match one.unit.base {
                    Some(_) => one.unit.in_own(value),
                    None => value,
                };
                given.push((one.clone(), values.into_iter().map(own).collect()));
            }
            _ => {
                let reason = format!("{value} is not as many numbers as `{}` has", one.name);
                return Err(Refusal::new(&key, reason, format!("write {} numbers", one.size)));
            }
        }
    }
    Ok(given)
}

fn number(value: &Value) -> Option<f64> {
    value.as_bool().map(|is| f64::from(u8::from(is))).or_else(|| value.as_f64())
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn description() -> ModelDescription {
        let text = r#"<fmiModelDescription fmiVersion="3.0" modelName="m"><CoSimulation modelIdentifier="m"/>
            <UnitDefinitions><Unit name="kN/m"><BaseUnit kg="1" s="-2" factor="1000"/></Unit></UnitDefinitions>
            <ModelVariables>
            <Float64 name="k.primary" valueReference="1" causality="parameter" start="2" unit="kN/m"/>
            <Float64 name="k" valueReference="2" causality="parameter"/>
            <Float64 name="a[1]" valueReference="3" causality="parameter"/>
            <Boolean name="on" valueReference="4" causality="parameter" start="true"/>
            <Float64 name="x" valueReference="5" causality="parameter"><Dimension start="2"/></Float64>
            <UInt8 name="n" valueReference="6" causality="parameter"/>
            </ModelVariables></fmiModelDescription>"#;
        ModelDescription::parse(text).unwrap()
    }

    #[test]
    fn parameters_are_keys() {
        let keys = keys("v", &description());
        let paths: Vec<_> = keys.iter().map(|key| key.path.as_str()).collect();
        assert_eq!(paths, ["v.start.k.primary", "v.start.on", "v.start.x", "v.start.n"]);
        assert_eq!(keys[0].kind.unit(), "N/m");
        assert_eq!(keys[0].help, "k.primary; absent: 2 kN/m");
    }

    /// Run time grows linearly with the number of parameters. Comparing all pairs of names took
    /// more than 30 s.
    #[test]
    fn a_hundred_thousand_parameters_are_read_at_once() {
        let parameter = |n: u32| {
            format!(r#"<Float64 name="a{n}.b" valueReference="{n}" causality="parameter"/>"#)
        };
        let variables: String = (0..100_000).map(parameter).collect();
        let text = format!(
            r#"<fmiModelDescription fmiVersion="3.0" modelName="m"><CoSimulation modelIdentifier="m"/>
            <ModelVariables>{variables}</ModelVariables></fmiModelDescription>"#
        );
        let of = ModelDescription::parse(&text).unwrap();
        let begun = std::time::Instant::now();
        assert_eq!(parameters(&of).count(), 100_000);
        assert!(begun.elapsed().as_secs_f64() < 10.0, "{:?}", begun.elapsed());
    }

    #[test]
    fn integers_have_the_range_of_their_type() {
        let keys = keys("v", &description());
        assert_eq!((keys[3].at_least, keys[3].at_most), (Some(0.0), Some(255.0)));
        let read = |n: f64| read("v", &description(), &Params(json!({"v": {"start": {"n": n}}})));
        assert_eq!(read(255.0).unwrap()[0].1, [255.0]);
        let refused = read(256.0).unwrap_err();
        assert_eq!(
            (refused.key.as_str(), refused.fix.as_str()),
            ("v.start.n", "write a value from 0 to 255")
        );
    }

    #[test]
    fn a_start_that_is_no_number_has_to_be_given() {
        let mut description = description();
        let of = |description: &ModelDescription| keys("v", description)[0].clone();
        assert!(!of(&description).required);
        description.variables[0].start = vec![f64::NAN];
        let key = of(&description);
        assert!(key.required && key.help == "k.primary", "{key:?}");
    }

    #[test]
    fn values_reach_the_fmu_in_its_units() {
        let read = |case| read("v", &description(), &Params(json!({"v": {"start": case}})));
        let given = read(json!({"k": {"primary": 3e6}, "on": false, "x": [1.0, 2.0]})).unwrap();
        let values: Vec<_> = given.iter().map(|(_, values)| values.as_slice()).collect();
        assert_eq!(values, [&[3e3][..], &[0.0], &[1.0, 2.0]]);
        let refused = read(json!({"x": [1.0]})).unwrap_err();
        assert_eq!((refused.key.as_str(), refused.fix.as_str()), ("v.start.x", "write 2 numbers"));
    }
}

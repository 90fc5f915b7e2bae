//! Wires of an FMU, given on the command line: variables that give or receive fields.
//!
//! ```text
//! Q -> load.normal_force                a variable gives a field, or the value of a key
//! T_wheel, T_rail -> body_temperature   several give one: a component each
//! Fx, Fy, Fz <- contact_force           a field is given to variables: a component each
//! q <- friction_power                   to an array: all its values
//! P <- integral(friction_power)         its integral over the surface
//! T <- mean(lower_temperature)          its mean over the surface
//! Q -> load.normal_force [N]            the SI unit, where the FMU does not define its own
//! "wheel,left" -> wheel_left            name with commas or arrows, in double quotes
//! ```

use crate::description::ModelDescription;
use crate::variable::{Causality, Variable};
use proto::field::{self, Body, FieldKind, FieldSpec, Mapping};
use proto::grid::check_dotted;
use proto::text::{masked, unquoted};

/// Maximum number of wires.
const MOST: usize = 64;

/// Part of a field given to an FMU.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// All values.
    Values,
    /// Surface integral.
    Integral,
    /// Mean over the surface.
    Mean,
}

/// Variables that give a field.
#[derive(Clone, Debug, PartialEq)]
pub struct Give {
    /// Variables, in the order of the components.
    pub variables: Vec<Variable>,
    /// Description of the field.
    pub kind: FieldKind,
    /// Field as known to the protocol library.
    pub spec: FieldSpec,
}

/// Variables that receive a field.
#[derive(Clone, Debug, PartialEq)]
pub struct Take {
    /// Variables, in the order of the components.
    pub variables: Vec<Variable>,
    /// Field.
    pub spec: FieldSpec,
    /// Part of the field they receive.
    pub measure: Measure,
}

/// All wires of an FMU.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Wiring {
    /// Fields given by the FMU.
    pub gives: Vec<Give>,
    /// Fields received by the FMU.
    pub takes: Vec<Take>,
}

impl Wiring {
    /// Parses wires and finds their variables.
    ///
    /// # Errors
    /// Fails if a wire is malformed, names an unknown variable, or sets a field or an input twice.
    pub fn read(wires: &[String], of: &ModelDescription) -> Result<Self, String> {
        let mut wiring = Self::default();
        if wires.len() > MOST {
            return Err(format!("{} wires, at most {MOST}", wires.len()));
        }
        for wire in wires {
            wiring.add(wire, of).map_err(|fault| format!("the wire {wire:?} {fault}"))?;
        }
        Ok(wiring)
    }

    /// True if a variable with several values is wired.
    #[must_use]
    pub fn has_arrays(&self) -> bool {
        let given = self.gives.iter().flat_map(|give| &give.variables);
        given.chain(self.takes.iter().flat_map(|take| &take.variables)).any(|one| one.size > 1)
    }

    fn add(&mut self, wire: &str, of: &ModelDescription) -> Result<(), String> {
        let Parsed { names, gives, field, measure, unit } = Parsed::read(wire)?;
        let variables: Vec<Variable> =
            names.iter().map(|name| found(name, of)).collect::<Result<_, _>>()?;
        let there = self.gives.iter().map(|give| give.spec.name);
        let there = there.chain(self.takes.iter().map(|take| take.spec.name));
        if there.into_iter().any(|name| name == field) {
            return Err(format!("names `{field}` a second time"));
        }
        match gives {
            true => {
                let kind = given(&field, &variables, unit)?;
                let spec = spec(&kind);
                self.gives.push(Give { variables, kind, spec });
            }
            false => {
                self.check_inputs(&variables)?;
                self.takes.push(Take { variables, spec: received(&field), measure });
            }
        }
        Ok(())
    }

    fn check_inputs(&self, variables: &[Variable]) -> Result<(), String> {
        for (place, variable) in variables.iter().enumerate() {
            let name = &variable.name;
            if variable.causality != Causality::Input {
                return Err(format!("sets `{name}`, which is not an input of the FMU"));
            }
            let set = self.takes.iter().flat_map(|take| &take.variables);
            if set.chain(&variables[..place]).any(|other| other.name == *name) {
                return Err(format!("sets `{name}` a second time"));
            }
        }
        Ok(())
    }
}

/// Parsed wire, before its variables are found.
#[derive(Clone, Debug, PartialEq)]
struct Parsed {
    names: Vec<String>,
    gives: bool,
    field: String,
    measure: Measure,
    unit: Option<String>,
}

impl Parsed {
    fn read(wire: &str) -> Result<Self, String> {
        let form = "is not of the form \"variable -> field\" or \"variable <- field\"";
        let mask = masked(wire);
        let (gives, at) = match (mask.find("->"), mask.find("<-")) {
            (Some(at), None) => (true, at),
            (None, Some(at)) => (false, at),
            _ => return Err(form.to_owned()),
        };
        let (names, target) = (&wire[..at], &wire[at + 2..]);
        let names: Vec<String> =
            listed(names).into_iter().map(|name| unquoted(name.trim()).into_owned()).collect();
        if names.iter().any(String::is_empty) {
            return Err(form.to_owned());
        }
        let (target, unit) =
            match target.trim().strip_suffix(']').and_then(|text| text.rsplit_once('[')) {
                Some((target, unit)) => (target.trim(), Some(unit.trim().to_owned())),
                None => (target.trim(), None),
            };
        let (measure, field) = measured(target);
        check_dotted("field", field)?;
        if gives && measure != Measure::Values {
            return Err("gives a field: only its values, no integral or mean".to_owned());
        }
        if !gives && unit.is_some() {
            return Err(
                "receives a field: its unit is already defined, remove the [unit]".to_owned()
            );
        }
        Ok(Self { names, gives, field: field.to_owned(), measure, unit })
    }
}

/// Splits at commas outside of brackets and quotes: `a[1,2], b`.
fn listed(names: &str) -> Vec<&str> {
    let (mut depth, mut start, mut parts) = (0_usize, 0, Vec::new());
    for (at, c) in masked(names).char_indices() {
        match c {
            '[' | '(' => depth += 1,
            ']' | ')' => depth = depth.saturating_sub(1),
            ',' if depth == 0 => {
                parts.push(&names[start..at]);
                start = at + 1;
            }
            _ => {}
        }
    }
    parts.push(&names[start..]);
    parts
}

fn measured(target: &str) -> (Measure, &str) {
    for (word, measure) in [("integral", Measure::Integral), ("mean", Measure::Mean)] {
        let inside = target.strip_prefix(word).and_then(|rest| rest.trim().strip_prefix('('));
        if let Some(field) = inside.and_then(|rest| rest.strip_suffix(')')) {
            return (measure, field.trim());
        }
    }
    (Measure::Values, target)
}

fn found(name: &str, of: &ModelDescription) -> Result<Variable, String> {
    let variable = of.find(name).ok_or_else(|| {
        let wired = |one: &&Variable| matches!(one.causality, Causality::Input | Causality::Output);
        let known: Vec<_> =
            of.variables.iter().filter(wired).map(|one| one.name.as_str()).collect();
        let more = known.len().saturating_sub(20);
        let mut listed = known[..known.len() - more].join(", ");
        if more > 0 {
            listed += &format!(", and {more} more");
        }
        format!(
            "names `{name}`, which is not a variable of the FMU; its inputs and outputs are: {listed}; \
             a name with a comma or an arrow stands in double quotes"
        )
    })?;
    match variable.kind.is_real() {
        true => Ok(variable.clone()),
        false => Err(format!("names `{name}`, whose values are not real numbers")),
    }
}

/// Returns the kind of a field given by variables.
fn given(field: &str, variables: &[Variable], unit: Option<String>) -> Result<FieldKind, String> {
    if let Some(spec) = field::find(field) {
        return match unit.filter(|unit| unit != spec.unit) {
            Some(unit) => Err(format!("gives `{field}` in {unit} instead of {}", spec.unit)),
            None => Ok(spec.kind()),
        };
    }
    let unit = match unit {
        Some(unit) => unit,
        None => own_unit(field, variables)?,
    };
    Ok(FieldKind {
        name: field.to_owned(),
        unit,
        components: u32::try_from(variables.len()).unwrap_or(u32::MAX),
        mapping: Mapping::Consistent,
        body: Body::Interface,
        meaning: meaning(variables),
    })
}

/// Returns the common SI unit of the variables.
fn own_unit(field: &str, variables: &[Variable]) -> Result<String, String> {
    let unit = variables[0].unit.si();
    match variables.iter().find(|other| other.unit.si() != unit) {
        Some(other) => Err(format!(
            "gives components in {unit} and {}; write the SI unit behind the field: {field} [{unit}]",
            other.unit.si()
        )),
        None => Ok(unit.to_owned()),
    }
}

fn meaning(variables: &[Variable]) -> String {
    let word = |one: &Variable| match one.words.is_empty() {
        true => one.name.clone(),
        false => one.words.clone(),
    };
    let words: Vec<String> = variables.iter().take(3).map(word).collect();
    proto::text::one_line(&words.join(", ")).into_owned()
}

/// Creates a field spec. Its names are leaked: they are few and live as long as the process.
fn spec(kind: &FieldKind) -> FieldSpec {
    FieldSpec {
        name: kind.name.clone().leak(),
        unit: kind.unit.clone().leak(),
        components: kind.components,
        mapping: kind.mapping,
        body: kind.body,
        meaning: "",
    }
}

/// Creates the spec of a received field; the participant that gives it describes it.
fn received(name: &str) -> FieldSpec {
    field::find(name).copied().unwrap_or_else(|| FieldSpec {
        name: name.to_owned().leak(),
        unit: "",
        components: 1,
        mapping: Mapping::Consistent,
        body: Body::Interface,
        meaning: "",
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn description() -> ModelDescription {
        let variable = |name: &str, causality: &str, number: usize| {
            format!(
                r#"<Float64 name="{name}" valueReference="{number}" causality="{causality}" unit="N"/>"#
            )
        };
        let variables = [
            variable("Q", "output", 1),
            variable("R", "output", 2),
            variable("Fx", "input", 3),
            variable("Fy", "input", 4),
            variable("k[1,2]", "input", 5),
            variable("wheel,left", "output", 6),
            variable("'x -> y'", "output", 7),
        ]
        .concat();
        let text = format!(
            r#"<fmiModelDescription fmiVersion="3.0" modelName="m"><CoSimulation modelIdentifier="m"/>
            <ModelVariables>{variables}<Int32 name="i" valueReference="9" causality="output"/></ModelVariables>
            </fmiModelDescription>"#
        );
        ModelDescription::parse(&text).unwrap()
    }

    fn read(wires: &[&str]) -> Result<Wiring, String> {
        let wires: Vec<String> = wires.iter().map(|wire| (*wire).to_owned()).collect();
        Wiring::read(&wires, &description())
    }

    #[test]
    fn wires_are_read() {
        let wiring =
            read(&["Q -> load.normal_force", "Fx,Fy<-own_force", "k[1,2] <- integral( traction )"]);
        let Wiring { gives, takes } = wiring.unwrap();
        let kind = &gives[0].kind;
        assert_eq!(
            (kind.name.as_str(), kind.unit.as_str(), kind.components),
            ("load.normal_force", "N", 1)
        );
        let [own, traction] = &takes[..] else { panic!("{takes:?}") };
        assert_eq!((own.variables.len(), own.measure), (2, Measure::Values));
        assert_eq!((traction.spec, traction.measure), (field::TRACTION, Measure::Integral));
        let quoted = read(&["\"wheel,left\", Q -> forces", "\"'x -> y'\" -> way"]).unwrap();
        let names = quoted.gives.iter().map(|give| {
            give.variables.iter().map(|variable| variable.name.as_str()).collect::<Vec<_>>()
        });
        assert_eq!(names.collect::<Vec<_>>(), [vec!["wheel,left", "Q"], vec!["'x -> y'"]]);
        let several = read(&["Q, R -> forces [kg m/s2]"]).unwrap();
        assert_eq!(
            (several.gives[0].kind.unit.as_str(), several.gives[0].kind.components),
            ("kg m/s2", 2)
        );
    }

    #[test]
    fn what_is_wrong_is_named() {
        let wrong = |wire: &str| read(&[wire]).unwrap_err();
        assert!(wrong("Q = load").contains("is not of the form"));
        assert!(wrong("Q -> x <- y").contains("is not of the form"));
        assert!(wrong("P -> load").contains("its inputs and outputs are: Q, R, Fx, Fy, k[1,2],"));
        assert!(wrong("i -> load").contains("not real numbers"));
        assert!(wrong("Q <- load").contains("not an input"));
        assert!(wrong("Q -> integral(load)").contains("no integral"));
        assert!(wrong("Q -> a b").contains("is not 1 to 31 letters"));
        assert!(wrong("Q -> pressure [bar]").contains("instead of Pa"));
        assert!(wrong("Fx, Fx <- a").contains("`Fx` a second time"));
        let twice = read(&["Q -> a", "R -> a"]).unwrap_err();
        assert!(twice.contains("names `a` a second time"), "{twice}");
        let set = read(&["Fx <- a", "Fx <- b"]).unwrap_err();
        assert!(set.contains("the wire \"Fx <- b\" sets `Fx` a second time"), "{set}");
    }

    proptest! {
        #[test]
        fn any_text_is_read_or_refused(text in "[ -~µ]{0,60}") {
            let _ = read(&[&text]);
        }

        #[test]
        fn any_change_is_read_or_refused(at in 0_usize..40, put in "[-<>,\\[\\]() a-z.]{0,8}") {
            let text = "Fx, k[1,2] <- integral(friction_power)";
            let (from, to) = text.split_at(at.min(text.len()));
            let _ = read(&[&format!("{from}{put}{to}")]);
        }
    }
}

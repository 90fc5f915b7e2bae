//! `modelDescription.xml` of FMI 2.0 and 3.0: the parts a participant needs.
//!
//! The file is untrusted: it must be XML without a document type, and sizes are checked before
//! memory is allocated.

use crate::depth::deepest;
use crate::unit::{BASE, Unit};
use crate::variable::{Causality, Kind, Variable};
use roxmltree::{Document, Node, ParsingOptions};
use std::collections::{BTreeMap, BTreeSet};

/// Maximum number of elements, texts and attributes.
const MOST_NODES: u32 = 4_000_000;
/// Maximum nesting depth of elements.
const DEEPEST: usize = 200;
/// Maximum number of values of an array.
pub const LARGEST_ARRAY: usize = 1 << 24;

/// Version of the FMI standard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Version {
    /// FMI 2.0.
    Two,
    /// FMI 3.0.
    Three,
}

/// Model description of an FMU.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelDescription {
    /// Version of the standard.
    pub version: Version,
    /// Name of the model.
    pub name: String,
    /// Description of the model; may be empty.
    pub words: String,
    /// Version of the model; may be empty.
    pub model_version: String,
    /// Program that generated the FMU; may be empty.
    pub tool: String,
    /// Token to pass when creating an instance.
    pub token: String,
    /// File name of the library without extension.
    pub identifier: String,
    /// True if a state can be saved and restored.
    pub keeps_states: bool,
    /// True if a state can be serialised.
    pub serialises: bool,
    /// True if communication steps may differ in length.
    pub varies_step: bool,
    /// Time at which the default experiment starts \[s\].
    pub start_time: f64,
    /// Relative tolerance of the default experiment.
    pub tolerance: Option<f64>,
    /// Numeric variables, in the order of the file.
    pub variables: Vec<Variable>,
}

impl ModelDescription {
    /// Parses the text of the file.
    ///
    /// # Errors
    /// Fails if the text is not a model description for co-simulation of FMI 2.0 or 3.0, or exceeds
    /// a limit.
    pub fn parse(text: &str) -> Result<Self, String> {
        if deepest(text) > DEEPEST {
            return Err(format!("nests elements more than {DEEPEST} deep"));
        }
        let options = ParsingOptions { allow_dtd: false, nodes_limit: MOST_NODES };
        let document = Document::parse_with_options(text, options)
            .map_err(|error| format!("is not a model description: {error}"))?;
        let root = document.root_element();
        if !root.has_tag_name("fmiModelDescription") {
            let name = root.tag_name().name();
            return Err(format!("is not a model description: its root element is `{name}`"));
        }
        let version = version(root)?;
        let about = child(root, "CoSimulation").ok_or(
            "has no co-simulation: an FMU for model exchange needs a solver for its equations",
        )?;
        let [keeps, serialises, token] = match version {
            Version::Two => ["canGetAndSetFMUstate", "canSerializeFMUstate", "guid"],
            Version::Three => {
                ["canGetAndSetFMUState", "canSerializeFMUState", "instantiationToken"]
            }
        };
        let identifier = of(about, "modelIdentifier").to_owned();
        let plain = |c: char| c.is_ascii_alphanumeric() || c == '_';
        if identifier.is_empty() || !identifier.chars().all(plain) {
            return Err(format!("has the model identifier {identifier:?}, which is not a C name"));
        }
        let keeps_states = flag(about, keeps);
        let experiment = |key| -> Option<f64> {
            let value = child(root, "DefaultExperiment")?.attribute(key)?.trim().parse().ok();
            value.filter(|value: &f64| value.is_finite())
        };
        Ok(Self {
            version,
            name: of(root, "modelName").to_owned(),
            words: of(root, "description").to_owned(),
            model_version: of(root, "version").to_owned(),
            tool: of(root, "generationTool").to_owned(),
            token: of(root, token).to_owned(),
            identifier,
            keeps_states,
            serialises: keeps_states && flag(about, serialises),
            varies_step: flag(about, "canHandleVariableCommunicationStepSize"),
            start_time: experiment("startTime").unwrap_or(0.0),
            tolerance: experiment("tolerance").filter(|tolerance| *tolerance > 0.0),
            variables: Reader::new(root, version).variables(root)?,
        })
    }

    /// Returns the variable with this name.
    #[must_use]
    pub fn find(&self, name: &str) -> Option<&Variable> {
        self.variables.iter().find(|variable| variable.name == name)
    }
}

fn version(root: Node<'_, '_>) -> Result<Version, String> {
    match of(root, "fmiVersion") {
        "2.0" => Ok(Version::Two),
        three if three.starts_with("3.") => Ok(Version::Three),
        other => Err(format!("follows FMI {other:?}; FMI 2.0 and 3.0 are supported")),
    }
}

/// Definitions that variables refer to.
struct Reader<'a> {
    version: Version,
    units: BTreeMap<&'a str, Unit>,
    /// Declared types. A variable inherits attributes it does not set itself.
    types: BTreeMap<&'a str, Node<'a, 'a>>,
    /// Values of structural parameters by reference: sizes of arrays.
    sizes: BTreeMap<u32, usize>,
}

impl<'a> Reader<'a> {
    fn new(root: Node<'a, 'a>, version: Version) -> Self {
        let units = children(root, "UnitDefinitions").map(|unit| (of(unit, "name"), unit_of(unit)));
        let types = children(root, "TypeDefinitions").filter_map(|one| {
            let typed = match version {
                Version::Two => one.first_element_child()?,
                Version::Three => one,
            };
            Some((of(one, "name"), typed))
        });
        let sizes = children(root, "ModelVariables")
            .filter(|one| of(*one, "causality") == "structuralParameter")
            .filter_map(|one| Some((reference(one).ok()?, of(one, "start").trim().parse().ok()?)));
        Self { version, units: units.collect(), types: types.collect(), sizes: sizes.collect() }
    }

    fn variables(&self, root: Node<'a, 'a>) -> Result<Vec<Variable>, String> {
        let mut variables = Vec::new();
        let mut names = BTreeSet::new();
        for node in children(root, "ModelVariables") {
            let name = of(node, "name");
            if !names.insert(name) {
                return Err(format!("has two variables `{name}`"));
            }
            let found = self.variable(node);
            variables.extend(found.map_err(|fault| format!("has a variable `{name}` {fault}"))?);
        }
        Ok(variables)
    }

    /// Reads a variable; `None` if its values are not numeric.
    fn variable(&self, node: Node<'a, 'a>) -> Result<Option<Variable>, String> {
        let (kind, typed) = match self.version {
            Version::Two => match node.children().find_map(|one| Some((two(one)?, one))) {
                Some(found) => found,
                None => return Ok(None),
            },
            Version::Three => match three(node) {
                Some(kind) => (kind, node),
                None => return Ok(None),
            },
        };
        let name = of(node, "name").to_owned();
        let causality = match of(node, "causality") {
            "parameter" => Causality::Parameter,
            "input" => Causality::Input,
            "output" => Causality::Output,
            "independent" => return Ok(None),
            _ => Causality::Inner,
        };
        let start = start(typed.attribute("start").unwrap_or_default(), kind)?;
        Ok(Some(Variable {
            reference: reference(node)?,
            kind,
            size: self.size(node)?,
            settable: causality == Causality::Parameter && of(node, "variability") != "constant",
            causality,
            start,
            unit: self.unit(typed),
            words: of(node, "description").to_owned(),
            name,
        }))
    }

    /// Returns the number of values.
    fn size(&self, node: Node<'_, '_>) -> Result<usize, String> {
        let mut size: usize = 1;
        for dimension in node.children().filter(|one| one.has_tag_name("Dimension")) {
            let given = dimension.attribute("start").map(|start| start.trim().parse().ok());
            let length = match given {
                Some(length) => length,
                None => reference(dimension).ok().and_then(|of| self.sizes.get(&of).copied()),
            };
            let length = length.ok_or("with a dimension of unknown length")?;
            size = size
                .checked_mul(length)
                .filter(|size| *size <= LARGEST_ARRAY)
                .ok_or_else(|| format!("with more than {LARGEST_ARRAY} values"))?;
        }
        match size {
            0 => Err("without values".to_owned()),
            size => Ok(size),
        }
    }

    fn unit(&self, typed: Node<'a, 'a>) -> Unit {
        let mut unit = match self.attribute(typed, "unit") {
            None => Unit::named(""),
            Some(name) => self.units.get(name).cloned().unwrap_or_else(|| Unit::named(name)),
        };
        // A difference has no offset, for example a temperature rise in degrees Celsius.
        if matches!(self.attribute(typed, "relativeQuantity"), Some("true" | "1")) {
            unit.offset = 0.0;
        }
        unit
    }

    /// Returns an attribute of a variable, or of its declared type.
    fn attribute(&self, typed: Node<'a, 'a>, key: &str) -> Option<&'a str> {
        let declared = || self.types.get(of(typed, "declaredType"))?.attribute(key);
        typed.attribute(key).or_else(declared)
    }
}

fn unit_of(node: Node<'_, '_>) -> Unit {
    let name = of(node, "name");
    let Some(base) = child(node, "BaseUnit") else { return Unit::named(name) };
    let number = |key, default: f64| {
        let value = base.attribute(key).and_then(|text| text.trim().parse().ok());
        value.filter(|value: &f64| value.is_finite()).unwrap_or(default)
    };
    let exponents = BASE.map(|(key, _)| of(base, key).trim().parse().unwrap_or_default());
    let factor = number("factor", 1.0);
    match factor == 0.0 {
        true => Unit::named(name),
        false => Unit::defined(name, exponents, factor, number("offset", 0.0)),
    }
}

/// Parses start values: one value, or an array separated by spaces.
fn start(text: &str, kind: Kind) -> Result<Vec<f64>, String> {
    let value = |word: &str| {
        let value = match word {
            "true" => 1.0,
            "false" => 0.0,
            word => {
                word.parse().map_err(|_| format!("that starts at {word:?}, which is no number"))?
            }
        };
        match kind.range() {
            // A double rounds large 64-bit integers; only help texts show these values.
            Some([least, most]) if !kind.is_long() && !(least..=most).contains(&value) => {
                Err(format!("that starts at {word}, which is not between {least} and {most}"))
            }
            _ => Ok(value),
        }
    };
    let words: Vec<&str> = text.split_whitespace().take(LARGEST_ARRAY).collect();
    words.into_iter().map(value).collect()
}

fn reference(node: Node<'_, '_>) -> Result<u32, String> {
    let text = of(node, "valueReference");
    text.trim().parse().map_err(|_| format!("with the value reference {text:?}"))
}

/// Returns the type of a variable of FMI 2.0, given by the element inside the variable.
fn two(node: Node<'_, '_>) -> Option<Kind> {
    match node.tag_name().name() {
        "Real" => Some(Kind::Float64),
        "Integer" | "Enumeration" => Some(Kind::Int32),
        "Boolean" => Some(Kind::Boolean),
        _ => None,
    }
}

/// Returns the type of a variable of FMI 3.0, given by its element.
fn three(node: Node<'_, '_>) -> Option<Kind> {
    Some(match node.tag_name().name() {
        "Float64" => Kind::Float64,
        "Float32" => Kind::Float32,
        "Int8" => Kind::Int8,
        "UInt8" => Kind::UInt8,
        "Int16" => Kind::Int16,
        "UInt16" => Kind::UInt16,
        "Int32" => Kind::Int32,
        "UInt32" => Kind::UInt32,
        "Int64" | "Enumeration" => Kind::Int64,
        "UInt64" => Kind::UInt64,
        "Boolean" => Kind::Boolean,
        _ => return None,
    })
}

fn child<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    node.children().find(|one| one.has_tag_name(name))
}

/// Iterates over the elements inside the child with this name.
fn children<'a, 'i: 'a>(
    node: Node<'a, 'i>,
    name: &str,
) -> impl Iterator<Item = Node<'a, 'i>> + use<'a, 'i> {
    child(node, name).into_iter().flat_map(|list| list.children()).filter(Node::is_element)
}

fn of<'a>(node: Node<'a, '_>, key: &str) -> &'a str {
    node.attribute(key).unwrap_or_default()
}

fn flag(node: Node<'_, '_>, key: &str) -> bool {
    matches!(of(node, key), "true" | "1")
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const THREE: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="3.0" modelName="Space" instantiationToken="{1}" description="a state space">
  <CoSimulation modelIdentifier="space" canGetAndSetFMUState="true" canSerializeFMUState="true"/>
  <UnitDefinitions><Unit name="kN"><BaseUnit kg="1" m="1" s="-2" factor="1000"/></Unit></UnitDefinitions>
  <TypeDefinitions><Float64Type name="Force" unit="kN"/></TypeDefinitions>
  <ModelVariables>
    <Float64 name="time" valueReference="0" causality="independent" variability="continuous"/>
    <UInt64 name="n" valueReference="1" causality="structuralParameter" variability="fixed" start="3"/>
    <Float64 name="y" valueReference="2" causality="output" declaredType="Force">
      <Dimension valueReference="1"/><Dimension start="2"/>
    </Float64>
    <Float64 name="x" valueReference="3" causality="input" start="1 2 3"><Dimension valueReference="1"/></Float64>
    <String name="text" valueReference="4"><Start value="a"/></String>
    <Boolean name="on" valueReference="5" causality="parameter" variability="fixed" start="true"/>
  </ModelVariables>
</fmiModelDescription>"#;

    const TWO: &str = r#"<fmiModelDescription fmiVersion="2.0" modelName="Ball" guid="{2}">
  <CoSimulation modelIdentifier="ball"/>
  <ModelVariables>
    <ScalarVariable name="h" valueReference="0" causality="output"><Real unit="m" start="1"/></ScalarVariable>
    <ScalarVariable name="g" valueReference="1" causality="parameter" variability="constant"><Real start="-9.81"/></ScalarVariable>
  </ModelVariables>
</fmiModelDescription>"#;

    #[test]
    fn variables_of_fmi_3() {
        let read = ModelDescription::parse(THREE).unwrap();
        assert_eq!((read.version, read.identifier.as_str()), (Version::Three, "space"));
        assert!(read.keeps_states && read.serialises);
        let names: Vec<_> = read.variables.iter().map(|one| one.name.as_str()).collect();
        assert_eq!(names, ["n", "y", "x", "on"]);
        let y = read.find("y").unwrap();
        assert_eq!((y.size, y.unit.factor, y.unit.si()), (6, 1000.0, "N"));
        assert_eq!(read.find("x").unwrap().start, [1.0, 2.0, 3.0]);
        assert_eq!(read.find("on").unwrap().start, [1.0]);
    }

    #[test]
    fn variables_of_fmi_2() {
        let read = ModelDescription::parse(TWO).unwrap();
        assert_eq!((read.version, read.keeps_states), (Version::Two, false));
        let [h, g] = &read.variables[..] else { panic!("{read:?}") };
        assert_eq!((h.causality, h.unit.name.as_str()), (Causality::Output, "m"));
        assert!(!g.settable && g.start == [-9.81]);
    }

    /// FMI 2.0.4 §2.2.7 and 3.0 §2.4.5: a variable inherits attributes of its declared type that it
    /// does not set itself.
    #[test]
    fn attributes_of_a_declared_type_are_inherited() {
        let units = r#"<UnitDefinitions><Unit name="degC"><BaseUnit K="1" offset="273.15"/></Unit></UnitDefinitions>"#;
        let three = THREE
            .replace("</UnitDefinitions>", r#"<Unit name="degC"><BaseUnit K="1" offset="273.15"/></Unit></UnitDefinitions>"#)
            .replace(
                r#"unit="kN"/></Type"#,
                r#"unit="kN"/><Float64Type name="Rise" unit="degC" relativeQuantity="true"/></Type"#,
            );
        let two = TWO.replace(
            "<ModelVariables>",
            &format!(
                r#"{units}<TypeDefinitions><SimpleType name="Rise"><Real unit="degC" relativeQuantity="true"/></SimpleType></TypeDefinitions><ModelVariables>"#
            ),
        );
        for own in ["", r#" relativeQuantity="false""#] {
            let three =
                three.replace(r#"name="x""#, &format!(r#"name="x" declaredType="Rise"{own}"#));
            let two = two.replace(r#"unit="m""#, &format!(r#"declaredType="Rise"{own}"#));
            for (text, name) in [(&three, "x"), (&two, "h")] {
                let read = ModelDescription::parse(text).unwrap();
                let unit = &read.find(name).unwrap().unit;
                let expected = if own.is_empty() { 0.018 } else { 0.018 + 273.15 };
                assert_eq!((unit.name.as_str(), unit.to_si(0.018)), ("degC", expected), "{text}");
            }
        }
    }

    #[test]
    fn steps_vary_where_the_fmu_says_so() {
        let three =
            THREE.replace("canGet", r#"canHandleVariableCommunicationStepSize="true" canGet"#);
        let varies = |text: &str| ModelDescription::parse(text).unwrap().varies_step;
        assert_eq!((varies(THREE), varies(TWO), varies(&three)), (false, false, true));
    }

    #[test]
    fn what_is_wrong_is_named() {
        let wrong = |text: &str| ModelDescription::parse(text).unwrap_err();
        let said = wrong(&TWO.replace("CoSimulation", "ModelExchange"));
        assert!(said.contains("has no co-simulation"), "{said}");
        assert!(wrong(&TWO.replace("\"2.0\"", "\"1.0\"")).contains("follows FMI \"1.0\""));
        assert!(wrong(&TWO.replace("\"ball\"", "\"../ball\"")).contains("not a C name"));
        assert!(wrong(&TWO.replace("name=\"g\"", "name=\"h\"")).contains("two variables `h`"));
        assert!(wrong(&THREE.replace("start=\"2\"", "start=\"99999999999\"")).contains("`y` with"));
        assert!(wrong(&THREE.replace("start=\"3\"", "start=\"0\"")).contains("without values"));
        assert!(wrong(&THREE.replace("\"1 2 3\"", "\"1 2 x\"")).contains("`x` that starts at"));
        let said = wrong(&TWO.replace(r#"Real start="-9.81""#, r#"Integer start="3000000000""#));
        assert!(said.contains("`g` that starts at 3000000000, which is not between"), "{said}");
        let entity = format!("<!DOCTYPE a [<!ENTITY e 'x'>]>{TWO}");
        assert!(wrong(&entity).contains("is not a model description"));
    }

    /// Deeply nested elements do not overflow the stack.
    #[test]
    fn depth_is_no_danger() {
        let deep = "<a>".repeat(100_000);
        let said = ModelDescription::parse(&deep).unwrap_err();
        assert!(said.contains("more than 200 deep"), "{said}");
        let most = format!("{}{}", "<a>".repeat(DEEPEST), "</a>".repeat(DEEPEST));
        assert!(ModelDescription::parse(&most).unwrap_err().contains("is `a`"));
    }

    proptest! {
        #[test]
        fn any_text_is_read_or_refused(text in ".{0,400}") {
            let _ = ModelDescription::parse(&text);
        }

        /// A description with any piece replaced by other text.
        #[test]
        fn any_change_is_read_or_refused(two: bool, at in 0_usize..2000, cut in 0_usize..60, put in "[ -~]{0,30}") {
            let text = if two { TWO } else { THREE };
            let from = at.min(text.len());
            let to = (from + cut).min(text.len());
            let _ = ModelDescription::parse(&format!("{}{put}{}", &text[..from], &text[to..]));
        }
    }
}

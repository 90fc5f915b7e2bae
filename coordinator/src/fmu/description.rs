//! Descriptions inside an FMU: `modelDescription.xml` of FMI 3.0, and the page about its variables.

use super::variables::{Variable, Variables};
use case::si_exponents;
use contact_fmu::manifest::{Manifest, TIME};
use pages::html::escape;
use std::collections::BTreeSet;
use std::fmt::{Result, Write};

/// Names in FMI of the exponents of [`si_exponents`].
const BASE: [&str; 7] = ["m", "kg", "s", "K", "A", "mol", "cd"];

/// Properties of the FMU as a whole.
pub(super) struct About<'a> {
    pub(super) name: &'a str,
    pub(super) title: Option<&'a str>,
    pub(super) identifier: &'a str,
    pub(super) version: &'a str,
}

/// Returns the text of the file.
pub(super) fn model_description(
    about: &About<'_>,
    variables: &Variables,
    manifest: &Manifest,
) -> String {
    let mut text = String::new();
    write_model(&mut text, about, variables, manifest).expect("a text can be written to");
    text
}

fn write_model(f: &mut String, about: &About<'_>, of: &Variables, manifest: &Manifest) -> Result {
    let About { name, title, identifier, version } = about;
    writeln!(f, r#"<?xml version="1.0" encoding="UTF-8"?>"#)?;
    writeln!(
        f,
        r#"<fmiModelDescription fmiVersion="3.0" modelName="{}" instantiationToken="{}" description="{}" generationTool="coordinator {version}" variableNamingConvention="structured">"#,
        escape(name),
        manifest.token,
        escape(title.unwrap_or(name)),
    )?;
    let states = of.rewinds;
    let internal = of.window.map(|window| format!(r#" fixedInternalStepSize="{window:e}""#));
    let (serial, varies) = (of.algebraic, of.varies_step);
    let may = format!(
        r#"modelIdentifier="{identifier}" needsExecutionTool="false" canBeInstantiatedOnlyOncePerProcess="false" canGetAndSetFMUState="{states}" canSerializeFMUState="{serial}""#
    );
    if of.algebraic {
        writeln!(f, r#"  <ModelExchange {may} needsCompletedIntegratorStep="false"/>"#)?;
    }
    writeln!(
        f,
        r#"  <CoSimulation {may} canHandleVariableCommunicationStepSize="{varies}"{}/>"#,
        internal.unwrap_or_default()
    )?;
    units(f, of)?;
    let step = of.window.map(|window| format!(r#" stepSize="{window:e}""#)).unwrap_or_default();
    writeln!(f, r#"  <DefaultExperiment startTime="0"{step}/>"#)?;
    writeln!(f, "  <ModelVariables>")?;
    writeln!(
        f,
        r#"    <Float64 name="time" valueReference="{TIME}" causality="independent" variability="continuous" unit="s" description="time"/>"#
    )?;
    for (place, input) in of.inputs.iter().enumerate() {
        variable(f, input, manifest.input_reference(place))?;
    }
    for (place, output) in of.outputs.iter().enumerate() {
        variable(f, output, manifest.output_reference(place))?;
    }
    writeln!(f, "  </ModelVariables>\n  <ModelStructure>")?;
    for element in ["Output", "InitialUnknown"] {
        for place in 0..of.outputs.len() {
            writeln!(
                f,
                r#"    <{element} valueReference="{}"/>"#,
                manifest.output_reference(place)
            )?;
        }
    }
    writeln!(f, "  </ModelStructure>\n</fmiModelDescription>")
}

fn units(f: &mut String, of: &Variables) -> Result {
    let named = of.all().map(|variable| variable.unit.as_str()).filter(|unit| *unit != "1");
    let all: BTreeSet<&str> = named.chain(["s"]).collect();
    writeln!(f, "  <UnitDefinitions>")?;
    for unit in all {
        let exponents = si_exponents(unit).unwrap_or_default();
        let base: String = BASE
            .iter()
            .zip(exponents)
            .filter(|(_, exponent)| *exponent != 0)
            .map(|(name, exponent)| format!(r#" {name}="{exponent}""#))
            .collect();
        writeln!(f, r#"    <Unit name="{}"><BaseUnit{base}/></Unit>"#, escape(unit))?;
    }
    writeln!(f, "  </UnitDefinitions>")
}

fn variable(f: &mut String, of: &Variable, reference: u32) -> Result {
    let Variable { key, unit, words, input } = of;
    let unit = match unit.as_str() {
        "1" => String::new(),
        unit => format!(r#" unit="{}""#, escape(unit)),
    };
    let (name, words) = (escape(&structured(key)), escape(words));
    match input {
        Some((first, [least, most])) => writeln!(
            f,
            r#"    <Float64 name="{name}" valueReference="{reference}" causality="input" variability="continuous" start="{first:e}" min="{least:e}" max="{most:e}"{unit} description="{words}"/>"#
        ),
        None => writeln!(
            f,
            r#"    <Float64 name="{name}" valueReference="{reference}" causality="output" variability="continuous"{unit} description="{words}"/>"#
        ),
    }
}

/// Returns a dotted key as a structured name. Parts that are not identifiers are quoted.
pub(super) fn structured(key: &str) -> String {
    let part = |part: &str| {
        let begins = part.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
        match begins && part.chars().all(|c| c.is_ascii_alphanumeric() || c == '_') {
            true => part.to_owned(),
            false => format!("'{part}'"),
        }
    };
    key.split('.').map(part).collect::<Vec<_>>().join(".")
}

/// Returns a page about an FMU.
pub(super) fn page(name: &str, title: Option<&str>, variables: &Variables) -> String {
    let title = escape(title.unwrap_or(name));
    let row = |one: &Variable| {
        let limits = one
            .input
            .map(|(first, [least, most])| format!("{first} at first, from {least} to {most}"));
        format!(
            "<tr><td><code>{}</code></td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
            escape(&one.key),
            escape(&one.unit),
            escape(&one.words),
            limits.unwrap_or_default()
        )
    };
    let step = match variables.window {
        _ if variables.algebraic => "Outputs follow from the inputs by a surrogate, at any time. Outside of the limits of the inputs they are NaN, with a warning.".to_owned(),
        None => "Every step is a steady contact of its own, with the inputs that hold at its start; its length does not matter.".to_owned(),
        Some(window) => format!("Every step is one coupling window, with the inputs that hold at its start. The case has windows of {window} s; others are possible."),
    };
    let states = match variables.rewinds {
        true => "States can be kept and returned to.",
        false => "No state can be returned to.",
    };
    let source = match variables.algebraic {
        true => "The surrogate is resources/surrogate.json.",
        false => {
            "Outputs are NaN before the first step, and for what the models do not give. The case is resources/case.toml."
        }
    };
    let rows: String = variables.all().map(row).collect();
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{title}</title></head><body>\n\
         <h1>{title}</h1>\n<p>{step} {states} {source}</p>\n<table>\n\
         <tr><th>variable</th><th>unit</th><th>what</th><th>input</th></tr>\n{rows}</table>\n</body></html>\n"
    )
}

#[cfg(test)]
mod tests {
    use super::structured;

    #[test]
    fn names_are_structured() {
        assert_eq!(structured("load.normal_force"), "load.normal_force");
        assert_eq!(
            structured("temperature.left-rail.max_rise_k"),
            "temperature.'left-rail'.max_rise_k"
        );
        assert_eq!(structured("contact.2d"), "contact.'2d'");
    }
}

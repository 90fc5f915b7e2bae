//! `plan.txt`: the plan as a person reads it, and the versions of all that took part.

use crate::plan::Plan;
use std::fmt::Write as _;

/// Name of the file in a result directory.
pub const FILE: &str = "plan.txt";

/// What the versions stand under.
const VERSIONS: &str = "\nversions\n";

/// The content of the file.
#[must_use]
pub fn text(plan: &Plan) -> String {
    let mut text = format!("{plan}{VERSIONS}");
    let own = env!("CARGO_PKG_VERSION");
    let _ =
        writeln!(text, "coordinator\tcoordinator\t{own}\tprotocol {}", contract::PROTOCOL_VERSION);
    for p in &plan.participants {
        let said = &p.description;
        let model = format!("model {}", p.configuration.model);
        let _ = writeln!(text, "{}\t{}\t{}\t{model}", p.role, said.name, said.version);
    }
    text
}

/// The plan, and the rows of the versions: role, program, version, remark.
#[must_use]
pub fn parts(text: &str) -> (&str, Vec<[&str; 4]>) {
    let Some((plan, versions)) = text.split_once(VERSIONS) else { return (text, Vec::new()) };
    let row = |line| {
        let cells: Vec<&str> = str::split(line, '\t').collect();
        cells.try_into().ok()
    };
    (plan, versions.lines().filter_map(row).collect())
}

/// What the plan says of an effect: who takes part, and its law.
#[must_use]
pub fn law<'a>(plan: &'a str, effect: &str) -> Option<&'a str> {
    let mut lines = plan.lines();
    let names = |line: &str| {
        let mut words = line.split_whitespace().filter(|word| *word != "effects");
        words.next().is_some_and(|word| ["on", "off"].contains(&word))
            && words.next() == Some(effect)
    };
    lines.find(|line| names(line))?;
    lines.next().map(str::trim)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plan_versions_and_laws_are_found() {
        let text = "case\n\neffects    on  heat    named\n                   q = p v\n           \
                    off heat_more not named\n                   other\n\nversions\n\
                    coordinator\tcoordinator\t0.1.0\tprotocol 2\nmech\tmech-solver\t0.2.0\tmodel m\ncut\tof";
        let (plan, rows) = parts(text);
        assert!(plan.ends_with("other\n"), "{plan}");
        let mech = ["mech", "mech-solver", "0.2.0", "model m"];
        assert_eq!(rows, [["coordinator", "coordinator", "0.1.0", "protocol 2"], mech]);
        assert_eq!(law(plan, "heat"), Some("q = p v"));
        assert_eq!(law(plan, "heat_more"), Some("other"));
        assert_eq!(law(plan, "none"), None);
        assert_eq!(parts("an older plan"), ("an older plan", Vec::new()));
    }
}

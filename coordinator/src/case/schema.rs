//! The coordinator's own keys, declared like those of the participants.

use proto::description::KeySpec;

/// Roles that are participants by their section alone.
pub const WELL_KNOWN_ROLES: &[&str] = &["mech", "thermal"];

/// Sections that belong to the coordinator; none of them can be a role.
pub const SECTIONS: &[&str] = &["case", "time", "coupling", "output", "limits", "effects"];

/// Stands for the name of a participant's section in [`own_keys`].
pub const ROLE: &str = "ROLE";

/// Coupling schemes, as a case names them.
pub const SCHEMES: &[&str] = &["auto", "serial-explicit"];

/// How many values a key takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// One value.
    One,
    /// A list of values, not empty.
    List,
    /// One value or a list, which may be empty.
    OneOrList,
}

/// A key of the coordinator.
#[derive(Clone, Debug, PartialEq)]
pub struct OwnKey {
    /// Path, type, range and what it is for.
    pub spec: KeySpec,
    /// How many values it takes.
    pub shape: Shape,
}

/// Every key that the coordinator itself reads; [`ROLE`] in a path stands for a role.
#[must_use]
pub fn own_keys() -> Vec<OwnKey> {
    let one = |spec| OwnKey { spec, shape: Shape::One };
    vec![
        one(KeySpec::text("case.name", "short name of the case").required()),
        one(KeySpec::text("case.title", "one line for people")),
        one(KeySpec::choice("time.mode", &["steady", "transient"], "kind of answer")
            .default_value("steady")),
        one(KeySpec::quantity("time.window", "s", "coupling window of a transient case").above(0.0)),
        one(KeySpec::quantity("time.end", "s", "end of a transient case").above(0.0)),
        one(KeySpec::choice("coupling.scheme", SCHEMES, "order and iteration of the participants")
            .default_value("auto")),
        one(deadline("coupling.solve_deadline", "longest wait for one solve", 3600.0)),
        one(deadline("coupling.start_deadline", "longest wait for a participant to start", 30.0)),
        one(deadline("coupling.heartbeat_deadline", "longest silence of a participant", 30.0)),
        OwnKey {
            spec: KeySpec::text("output.fields", "\"all\", \"none\" or a list of field names")
                .default_value("all"),
            shape: Shape::OneOrList,
        },
        one(KeySpec::integer("output.every", "windows between outputs; absent: the last only")
            .at_least(1.0)),
        one(KeySpec::quantity("limits.shared_memory", "B", "most shared memory of a run")
            .at_least(1.0)),
        one(KeySpec::text(&format!("{ROLE}.model"), "model of the participant").required()),
        OwnKey {
            spec: KeySpec::text(&format!("{ROLE}.command"), "program and arguments that start it"),
            shape: Shape::List,
        },
        one(KeySpec::flag(&format!("{ROLE}.attach"), "it is started by hand and waited for")
            .default_value(false)),
    ]
}

fn deadline(path: &str, help: &str, seconds: f64) -> KeySpec {
    KeySpec::quantity(path, "s", help).above(0.0).at_most(1e7).default_value(seconds)
}

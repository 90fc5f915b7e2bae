//! The coordinator's own keys, declared like those of the participants.

use super::settings::{Beyond, Coupling, Lengths, OnFailure, OutputWord, Time, TimeMode};
use contract::description::KeySpec;
use contract::message::Interpolation;
use coupling::map::{Basis, Method};
use coupling::settings::{Acceleration, Preconditioner, Predictor, Scheme, Tolerances};
use std::sync::LazyLock;

/// Roles whose section alone makes them participants.
pub const WELL_KNOWN_ROLES: &[&str] = &["mech", "thermal"];

/// Sections of the coordinator; a role cannot have such a name.
pub const SECTIONS: &[&str] =
    &["case", "time", "coupling", "mapping", "output", "limits", "effects"];

/// Placeholder for the name of a participant's section in [`own_keys`].
pub const ROLE: &str = "ROLE";

/// Key of the column of times.
pub(super) const TIME: &str = "time.history";
/// Key of the column of distances, which the speed converts to times.
pub(super) const DISTANCE: &str = "time.distance";
/// Key for values outside the times of a table.
pub(super) const BEYOND: &str = "time.beyond";
/// Key for the treatment of a sequence row without a result.
pub(super) const ON_FAILURE: &str = "time.on_failure";

/// Returns the words of the mapping methods in a case.
fn methods() -> Vec<&'static str> {
    std::iter::once(Method::AUTO).chain(Method::WORDS.iter().copied()).collect()
}

/// Number of values that a key takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// One value.
    One,
    /// A list of values, not empty.
    List,
    /// One value or a list; the list may be empty.
    OneOrList,
}

/// A key of the coordinator.
#[derive(Clone, Debug, PartialEq)]
pub struct OwnKey {
    /// Path, type, range and help.
    pub spec: KeySpec,
    /// Number of values.
    pub shape: Shape,
}

/// Returns every key that the coordinator itself reads; [`ROLE`] in a path stands for a role.
#[must_use]
pub fn own_keys() -> &'static [OwnKey] {
    static KEYS: LazyLock<Vec<OwnKey>> = LazyLock::new(|| {
        [case_and_time(), coupling(), mappings(), output_and_limits(), participant()].concat()
    });
    &KEYS
}

fn one(spec: KeySpec) -> OwnKey {
    OwnKey { spec, shape: Shape::One }
}

fn case_and_time() -> Vec<OwnKey> {
    let given = Time::default();
    vec![
        one(KeySpec::text("case.name", "short name of the case").required()),
        one(KeySpec::text("case.title", "title of the case, in one line")),
        one(KeySpec::choice("time.mode", TimeMode::WORDS, "kind of case in time")
            .default_value(given.mode.word())),
        one(KeySpec::quantity(TIME, "s", "column of the times of a table").varies()),
        one(KeySpec::quantity(DISTANCE, "m", "column of the distances, instead of times").varies()),
        one(KeySpec::choice(
            BEYOND,
            Beyond::WORDS,
            "values outside the times of the table: hold keeps those of the first and the last row",
        )
        .default_value(given.beyond.word())),
        one(KeySpec::choice(
            ON_FAILURE,
            OnFailure::WORDS,
            "treatment of a sequence row without a result",
        )
        .default_value(given.on_failure.word())),
        one(KeySpec::quantity("time.window", "s", "coupling window of a transient case").above(0.0)),
        one(KeySpec::quantity("time.end", "s", "end of a transient case").above(0.0)),
        one(KeySpec::choice("time.control", Lengths::WORDS, "lengths of the windows")
            .default_value(given.control.word())),
        one(KeySpec::number("time.tolerance", "target of the relative error of adaptive windows")
            .above(0.0)
            .at_most(0.1)
            .default_value(given.tolerance)),
        one(KeySpec::quantity(
            "time.window_min",
            "s",
            "shortest adaptive window, with which a run begins; absent: a 1024th of time.window",
        )
        .above(0.0)),
        one(KeySpec::quantity("time.window_max", "s", "longest adaptive window").above(0.0)),
    ]
}

fn coupling() -> Vec<OwnKey> {
    let key = |name: &str| format!("coupling.{name}");
    let word = |name, of, default: &str, help| {
        one(KeySpec::choice(&key(name), of, help).default_value(default))
    };
    let coupling = Coupling::default();
    let given = &coupling.implicit;
    let count = |name, least: f64, default: u64, help| {
        let spec = KeySpec::integer(&key(name), help).at_least(least).at_most(1e6);
        one(spec.default_value(default))
    };
    let deadline = |name, help, seconds: f64| {
        let spec = KeySpec::quantity(&key(name), "s", help).above(0.0).at_most(1e7);
        one(spec.default_value(seconds))
    };
    let mut keys = vec![
        word(
            "scheme",
            Scheme::WORDS,
            coupling.scheme.word(),
            "order and iteration of the participants",
        ),
        word(
            "acceleration",
            Acceleration::WORDS,
            Acceleration::default().word(),
            "acceleration of the fixed-point iteration",
        ),
        word(
            "preconditioner",
            Preconditioner::WORDS,
            given.preconditioner.word(),
            "preconditioner: weights of the fields",
        ),
        word("predictor", Predictor::WORDS, given.predictor.word(), "first iterate of a window"),
        word(
            "interpolation",
            Interpolation::WORDS,
            coupling.interpolation.word(),
            "interpolation of inputs within a window",
        ),
        count(
            "min_iterations",
            1.0,
            given.min_iterations.into(),
            "minimum number of iterations per window",
        ),
        count(
            "max_iterations",
            1.0,
            given.max_iterations.into(),
            "maximum number of iterations per window",
        ),
        count(
            "reuse_windows",
            0.0,
            given.reuse_windows,
            "earlier windows whose secant columns are reused",
        ),
        one(KeySpec::integer(&key("max_columns"), "maximum number of secant columns")
            .at_least(1.0)
            .at_most(1000.0)
            .default_value(given.max_columns)),
        one(KeySpec::number(
            &key("relaxation"),
            "relaxation factor of the residual; iqn-ils and iqn-imvj use it in the first step",
        )
        .above(0.0)
        .at_most(2.0)
        .default_value(given.relaxation)),
        // Gram matrices hold the square of the independent part, to sixteen digits.
        one(KeySpec::number(
            &key("filter"),
            "filter: smallest linearly independent part of a secant column",
        )
        .at_least(1e-7)
        .at_most(0.9)
        .default_value(given.filter)),
        one(KeySpec::flag(&key("strict"), "a window that does not converge ends the run")
            .default_value(given.strict)),
        deadline("solve_deadline", "deadline of one solve", coupling.solve_deadline),
        deadline(
            "start_deadline",
            "deadline for a participant to start and to answer before a run",
            coupling.start_deadline,
        ),
        deadline("build_deadline", "deadline for a model to be built", coupling.build_deadline),
        deadline(
            "heartbeat_deadline",
            "longest time without a heartbeat of a participant",
            coupling.heartbeat_deadline,
        ),
    ];
    keys.extend(tolerances("coupling"));
    keys.extend(tolerances("coupling.fields.*"));
    keys
}

/// Returns the tolerances of all fields, or of one field.
fn tolerances(section: &str) -> impl Iterator<Item = OwnKey> {
    let relative = "largest ratio of the residual to the returned values, in two-norms";
    let default = Tolerances::FALLBACK.relative.filter(|_| section == "coupling");
    let relative = match default {
        Some(default) => format!("{relative}; {default:e} where no tolerance is given"),
        None => relative.to_owned(),
    };
    let measures = [
        ("absolute", "largest two-norm of the residual, in the field's unit"),
        ("relative", &*relative),
        (
            "residual_relative",
            "largest ratio of the residual to the first residual of the window, in two-norms",
        ),
    ];
    let why = "a residual as large as the values has not converged";
    let key = |(name, help): (&str, &str)| {
        let spec = KeySpec::number(&format!("{section}.{name}"), help).above(0.0);
        one(if name == "absolute" { spec } else { spec.expected(0.0..=1.0, why) })
    };
    measures.map(key).into_iter()
}

fn mappings() -> Vec<OwnKey> {
    let method = |path: &str, help| KeySpec::choice(path, &methods(), help);
    let all = method("mapping.method", "mapping of fields between non-matching grids");
    let own = method("mapping.fields.*.method", "mapping of one field between non-matching grids");
    let mut keys = vec![one(all.default_value(Method::AUTO)), one(own)];
    for section in ["mapping", "mapping.fields.*"] {
        keys.push(one(KeySpec::choice(
            &format!("{section}.basis"),
            Basis::WORDS,
            "radial basis function of the method radial-basis; absent: a local stencil",
        )));
        keys.push(one(KeySpec::quantity(
            &format!("{section}.radius"),
            "m",
            "distance at which the basis vanishes, or falls to 1e-9 (gaussian); length of \
             multiquadrics",
        )
        .above(0.0)));
    }
    keys
}

fn output_and_limits() -> Vec<OwnKey> {
    vec![
        OwnKey {
            spec: KeySpec::text("output.fields", "\"all\", \"none\" or a list of field names")
                .default_value(OutputWord::default().word()),
            shape: Shape::OneOrList,
        },
        one(KeySpec::integer(
            "output.every",
            "windows between outputs; absent: the last window only",
        )
        .at_least(1.0)),
        one(KeySpec::integer(
            "output.checkpoint_every",
            "windows between checkpoints; absent: none",
        )
        .at_least(1.0)),
        one(KeySpec::quantity("limits.shared_memory", "B", "largest shared memory of a run")
            .at_least(1.0)),
        one(KeySpec::integer(
            "limits.threads",
            "threads that compute at the same time; absent: the number of cores",
        )
        .at_least(1.0)
        .at_most(1024.0)),
    ]
}

fn participant() -> Vec<OwnKey> {
    vec![
        one(KeySpec::text(&format!("{ROLE}.model"), "model of the participant").required()),
        OwnKey {
            spec: KeySpec::text(&format!("{ROLE}.command"), "program and arguments that start it"),
            shape: Shape::List,
        },
        one(KeySpec::flag(
            &format!("{ROLE}.attach"),
            "started by hand; the coordinator waits for it",
        )
        .default_value(false)),
    ]
}

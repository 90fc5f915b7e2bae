//! The coordinator's own keys, declared like those of the participants.

use contract::description::KeySpec;
use coupling::map::Method;
use coupling::settings::{Acceleration, Implicit, Preconditioner, Predictor, Scheme};
use std::sync::LazyLock;

/// Roles that are participants by their section alone.
pub const WELL_KNOWN_ROLES: &[&str] = &["mech", "thermal"];

/// Sections that belong to the coordinator; none of them can be a role.
pub const SECTIONS: &[&str] =
    &["case", "time", "coupling", "mapping", "output", "limits", "effects"];

/// Stands for the name of a participant's section in [`own_keys`].
pub const ROLE: &str = "ROLE";

/// The column of times.
pub(super) const TIME: &str = "time.history";
/// The column of distances, which the speed turns into times.
pub(super) const DISTANCE: &str = "time.distance";
/// Values outside the times of a table.
pub(super) const BEYOND: &str = "time.beyond";
/// What becomes of a row of a sequence without an answer.
pub(super) const ON_FAILURE: &str = "time.on_failure";

/// How inputs vary within a window: the words of `coupling.interpolation`.
const INTERPOLATIONS: &[&str] = &["constant", "linear"];

/// The word for the method that suits the field.
const AUTO: &str = "auto";

/// The words of a method in a case.
fn methods() -> Vec<&'static str> {
    std::iter::once(AUTO).chain(Method::ALL.map(Method::name)).collect()
}

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
    vec![
        one(KeySpec::text("case.name", "short name of the case").required()),
        one(KeySpec::text("case.title", "one line for people")),
        one(KeySpec::choice("time.mode", &["steady", "sequence", "transient"], "kind of answer")
            .default_value("steady")),
        one(KeySpec::quantity(TIME, "s", "column of the times of a table").varies()),
        one(KeySpec::quantity(DISTANCE, "m", "column of the distances, instead of times").varies()),
        one(KeySpec::choice(
            BEYOND,
            &["refuse", "hold"],
            "what happens outside the times of the table: hold keeps the values of its first and its last row",
        )
        .default_value("refuse")),
        one(KeySpec::choice(
            ON_FAILURE,
            &["stop", "skip"],
            "what becomes of a row without an answer",
        )
        .default_value("stop")),
        one(KeySpec::quantity("time.window", "s", "coupling window of a transient case").above(0.0)),
        one(KeySpec::quantity("time.end", "s", "end of a transient case").above(0.0)),
        one(KeySpec::choice("time.control", &["fixed", "adaptive"], "lengths of the windows")
            .default_value("fixed")),
        one(KeySpec::number("time.tolerance", "relative error that adaptive windows aim at")
            .above(0.0)
            .at_most(0.1)
            .default_value(1e-3)),
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
    let given = Implicit::default();
    let count = |name, least: f64, default: u64, help| {
        let spec = KeySpec::integer(&key(name), help).at_least(least).at_most(1e6);
        one(spec.default_value(default))
    };
    let mut keys = vec![
        word("scheme", Scheme::WORDS, "auto", "order and iteration of the participants"),
        word(
            "acceleration",
            Acceleration::WORDS,
            "auto",
            "acceleration of the fixed-point iteration",
        ),
        word(
            "preconditioner",
            Preconditioner::WORDS,
            "residual-sum",
            "preconditioner: weights of the fields",
        ),
        word("predictor", Predictor::WORDS, given.predictor.word(), "first iterate of a window"),
        word(
            "interpolation",
            INTERPOLATIONS,
            "constant",
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
            .default_value(100)),
        one(KeySpec::number(
            &key("relaxation"),
            "relaxation factor of the residual; of iqn-ils and iqn-imvj in the first step",
        )
        .above(0.0)
        .at_most(2.0)
        .default_value(given.relaxation)),
        // Gram matrices hold the square of the new part, to sixteen digits.
        one(KeySpec::number(
            &key("filter"),
            "filter: smallest linearly independent part of a secant column",
        )
        .at_least(1e-7)
        .at_most(0.9)
        .default_value(1e-6)),
        one(KeySpec::flag(&key("strict"), "a window that does not converge ends the run")
            .default_value(given.strict)),
        one(deadline("coupling.solve_deadline", "deadline of one solve", 3600.0)),
        one(deadline("coupling.start_deadline", "deadline for a participant to start", 30.0)),
        one(deadline("coupling.build_deadline", "deadline for a model to be built", 3600.0)),
        one(deadline(
            "coupling.heartbeat_deadline",
            "longest time without a heartbeat of a participant",
            30.0,
        )),
    ];
    keys.extend(tolerances("coupling"));
    keys.extend(tolerances("coupling.fields.*"));
    keys
}

/// The measures of convergence, for all fields or for one.
fn tolerances(section: &str) -> impl Iterator<Item = OwnKey> {
    let relative = "largest residual over the values returned, in two-norms";
    let default = Implicit::default().tolerances.relative.filter(|_| section == "coupling");
    let relative = match default {
        Some(default) => format!("{relative}; {default:e} where no tolerance is given"),
        None => relative.to_owned(),
    };
    let measures = [
        ("absolute", "largest two-norm of the residual, in the field's unit"),
        ("relative", &*relative),
        ("residual_relative", "largest residual over the first one of the window, in two-norms"),
    ];
    let why = "a residual as large as the values is none that has converged";
    let key = |(name, help): (&str, &str)| {
        let spec = KeySpec::number(&format!("{section}.{name}"), help).above(0.0);
        one(if name == "absolute" { spec } else { spec.expected(0.0..=1.0, why) })
    };
    measures.map(key).into_iter()
}

fn mappings() -> Vec<OwnKey> {
    let method = |path: &str, help| KeySpec::choice(path, &methods(), help);
    let all = method("mapping.method", "mapping of fields between non-matching grids");
    let own = method("mapping.fields.*.method", "the same for one field");
    vec![one(all.default_value(AUTO)), one(own)]
}

fn output_and_limits() -> Vec<OwnKey> {
    vec![
        OwnKey {
            spec: KeySpec::text("output.fields", "\"all\", \"none\" or a list of field names")
                .default_value("all"),
            shape: Shape::OneOrList,
        },
        one(KeySpec::integer("output.every", "windows between outputs; absent: the last only")
            .at_least(1.0)),
        one(KeySpec::integer(
            "output.checkpoint_every",
            "windows between checkpoints; absent: none",
        )
        .at_least(1.0)),
        one(KeySpec::quantity("limits.shared_memory", "B", "most shared memory of a run")
            .at_least(1.0)),
        one(KeySpec::integer(
            "limits.threads",
            "threads that compute at the same time; absent: as many as there are cores",
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

fn deadline(path: &str, help: &str, seconds: f64) -> KeySpec {
    KeySpec::quantity(path, "s", help).above(0.0).at_most(1e7).default_value(seconds)
}

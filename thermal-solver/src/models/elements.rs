//! Keys of the finite elements, and checks for unsupported combinations.

use super::frame::Frame;
use crate::scene::Scene;
use crate::{LOWER, UPPER};
use heat::Material;
use heat::fe::block::{
    Back, Elements, MOST_BEHIND, MOST_LAYERS, Passages, RATIO, Sheet, Solver, TooManyElements,
};
use heat::fe::error::SolveError;
use heat::fe::scheme::Scheme;
use proto::bodies::Bodies;
use proto::configuration::{Configuration, Mode, Refusal};
use proto::description::KeySpec;
use proto::grid::Structured;
use proto::model::StepError;
use proto::params::Params;
use proto::readable::{number, quantity};

const FIRST_LAYER: &str = "thermal.first_layer";
const LAYER_RATIO: &str = "thermal.layer_ratio";
const DEPTH: &str = "thermal.depth";
/// Key of the distance behind the middle of the contact up to which temperatures are computed [m].
pub(super) const WAKE: &str = "thermal.wake";
const SCHEME: &str = "thermal.scheme";
const STEP: &str = "thermal.step";
const SOLVER: &str = "thermal.solver";
const PASSAGES: &str = "thermal.passages";
const RETURNS: &str = "return_distance";
const THICKNESS: &str = "thickness";
const BACK: &str = "back";
/// Missing share of a rise that is not worth a warning.
const NEGLIGIBLE: f64 = 0.01;
const BACKS: [&str; 2] = ["insulated", "fixed"];
const SOLVERS: [&str; 3] = ["auto", "iterative", "direct"];

/// Time integration schemes by their names in the case file.
const SCHEMES: [(&str, Scheme); 3] = [
    ("backward-euler", Scheme::BackwardEuler),
    ("bdf2", Scheme::Bdf2),
    ("crank-nicolson", Scheme::CrankNicolson),
];

/// Returns the keys of the elements.
pub(super) fn keys() -> Vec<KeySpec> {
    let first = "thickness of the first layer of elements; absent: the smaller of a twentieth of the \
                 depth that heat reaches while the contact passes and an eighth of that while an element passes \
                 or during the shortest window";
    vec![
        KeySpec::quantity(FIRST_LAYER, "m", first).above(0.0),
        KeySpec::number(LAYER_RATIO, "ratio of the thickness of a layer to that of the layer above")
            .at_least(1.0)
            .at_most(3.0)
            .default_value(RATIO),
        KeySpec::quantity(DEPTH, "m", "depth of the elements; absent: as deep as heat reaches").above(0.0),
        KeySpec::quantity(
            WAKE,
            "m",
            "extent of the elements behind the contact; absent: five times half the length of the \
             heat flux's grid",
        )
        .above(0.0),
        KeySpec::choice(SCHEME, &SCHEMES.map(|(word, _)| word), "scheme in time of transient cases")
            .default_value("crank-nicolson"),
        KeySpec::quantity(
            STEP,
            "s",
            "longest step in time; absent: the passage of an element, or the window of a body at rest",
        )
        .above(0.0),
        KeySpec::integer(
            PASSAGES,
            "number of passages through the contact of a body with a return_distance, this one included",
        )
        .at_least(1.0)
        .at_most(1e6)
        .default_value(1),
        KeySpec::quantity(
            &format!("bodies.*.{RETURNS}"),
            "m",
            "distance after which the same places of the body return to the contact",
        )
        .above(0.0),
        KeySpec::quantity(
            &format!("bodies.*.{THICKNESS}"),
            "m",
            "thickness of the body; absent: as deep as heat reaches",
        )
        .above(0.0),
        KeySpec::choice(
            &format!("bodies.*.{BACK}"),
            &BACKS,
            "back of a body of finite thickness: insulated, or fixed at the initial temperature; absent: \
             insulated",
        ),
        KeySpec::choice(SOLVER, &SOLVERS, "solver of the equations of the elements")
            .default_value("auto"),
    ]
}

/// Reads the elements of the upper and the lower body.
///
/// # Errors
/// A value that is out of range; a word that is not one of the choices.
pub(super) fn read(given: &Configuration, scene: &Scene) -> Result<[Elements; 2], Refusal> {
    let case = &given.case;
    let window = given.windows.map_or(f64::INFINITY, |windows| windows.shortest);
    let common = Elements { window, ..read_common(case)? };
    let of = |body| {
        let [_, fastest] = scene.speed_range(given, body);
        of_body(Elements { fastest, ..common }, case, &scene.names, body)
    };
    Ok([of(UPPER)?, of(LOWER)?])
}

/// Reads the settings that both bodies share.
///
/// # Errors
/// An unknown scheme or solver.
fn read_common(case: &Params) -> Result<Elements, Refusal> {
    let scheme = if case.has(SCHEME) { case.text(SCHEME)? } else { "crank-nicolson" };
    let known = SCHEMES.iter().find(|(word, _)| *word == scheme);
    let &(_, scheme) = known.ok_or_else(|| {
        let fix = format!("write one of {}", SCHEMES.map(|(word, _)| word).join(", "));
        Refusal::new(SCHEME, format!("`{scheme}` is not a scheme"), fix)
    })?;
    let solver = if case.has(SOLVER) { case.text(SOLVER)? } else { "auto" };
    let solver = match solver {
        "auto" => Solver::Auto,
        "iterative" => Solver::Iterative,
        "direct" => Solver::Direct,
        other => {
            let fix = format!("write one of {}", SOLVERS.join(", "));
            return Err(Refusal::new(SOLVER, format!("`{other}` is not a solver"), fix));
        }
    };
    Ok(Elements {
        solver,
        first_layer: case.maybe_number(FIRST_LAYER)?,
        ratio: case.maybe_number(LAYER_RATIO)?.unwrap_or(RATIO),
        depth: case.maybe_number(DEPTH)?,
        wake: case.maybe_number(WAKE)?,
        scheme,
        step: case.maybe_number(STEP)?.unwrap_or(f64::INFINITY),
        ..Elements::default()
    })
}

/// Adds the settings of one body.
///
/// # Errors
/// A `back` without a `thickness`; an unknown `back`.
fn of_body(
    common: Elements,
    case: &Params,
    names: &Bodies,
    body: usize,
) -> Result<Elements, Refusal> {
    let count = if case.has(PASSAGES) { case.integer(PASSAGES)? as usize } else { 1 };
    let distance = case.maybe_number(&names.key(body, RETURNS))?;
    let passages = distance.filter(|_| count > 1).map(|distance| Passages { count, distance });
    Ok(Elements { passages, sheet: sheet(case, names, body)?, ..common })
}

fn sheet(case: &Params, names: &Bodies, body: usize) -> Result<Option<Sheet>, Refusal> {
    let [key, back_key] = [THICKNESS, BACK].map(|name| names.key(body, name));
    let back = if case.has(&back_key) { case.text(&back_key)? } else { BACKS[0] };
    let back = match back {
        "insulated" => Back::Insulated,
        "fixed" => Back::Fixed,
        other => {
            let fix = format!("write one of {}", BACKS.join(", "));
            return Err(Refusal::new(&back_key, format!("`{other}` is not a back of a body"), fix));
        }
    };
    let Some(thickness) = case.maybe_number(&key)? else {
        if case.has(&back_key) {
            let reason = "a body without a thickness has no back: it is as deep as heat reaches";
            return Err(Refusal::new(&back_key, reason, format!("write {key}, or leave it out")));
        }
        return Ok(None);
    };
    Ok(Some(Sheet { thickness, back }))
}

/// Warns of a first layer that is thicker than the depth of the shortest heating of a body's
/// surface.
pub(super) fn thick_layer(frame: &Frame, body: usize, speed: f64) -> Option<Refusal> {
    let elements = frame.elements?[body];
    let (grid, material) = (&frame.grid, &frame.scene.materials[body]);
    let missing = elements.missing_share(grid, material, speed);
    let first = elements.first_layer.filter(|_| missing > NEGLIGIBLE)?;
    let heated = elements.shortest_heating(grid, speed);
    let depth = (material.diffusivity() * heated).sqrt();
    Some(Refusal::new(
        FIRST_LAYER,
        format!(
            "the first layer of `{}` is {first} thick, and heat reaches {depth} in the {heated} \
             of a window or the passage of an element: then {:.0} % of the rise are missing",
            frame.scene.names.0[body],
            1e2 * missing,
            first = quantity(first, "m", 2),
            depth = quantity(depth, "m", 2),
            heated = quantity(heated, "s", 2)
        ),
        format!("write at most {}, or leave it out", quantity(0.25 * depth, "m", 2)),
    ))
}

/// Refuses more elements than fit into memory, before anything is allocated.
///
/// # Errors
/// Too many columns behind the contact; too many layers in depth.
pub(super) fn check_size(
    elements: &Elements,
    grid: &Structured,
    material: &Material,
    speed: f64,
) -> Result<(), Refusal> {
    elements.check_size(grid, material, speed).map_err(|error| match error {
        TooManyElements::Behind { most_wake, .. } => {
            let fix = format!("write at most {most_wake}, which are {MOST_BEHIND} columns", most_wake = quantity(most_wake, "m", 4), MOST_BEHIND = number(MOST_BEHIND, 1));
            Refusal::new(WAKE, error.to_string(), fix)
        }
        TooManyElements::InDepth { .. } => {
            let key = match (elements.first_layer, elements.depth) {
                (Some(_), _) => FIRST_LAYER,
                (None, Some(_)) => DEPTH,
                (None, None) => LAYER_RATIO,
            };
            let fix = format!(
                "raise {FIRST_LAYER} or {LAYER_RATIO}, or lower {DEPTH}, until there are at most {MOST_LAYERS} layers"
            );
            Refusal::new(key, error.to_string(), fix)
        }
    })
}

/// Turns a failed solve into an error that names the setting to change.
pub(super) fn no_solution(error: SolveError, mode: Mode) -> StepError {
    let fix = match error {
        SolveError::NotSolved { gradients_stopped: true, .. } => {
            "write thermal.solver = \"direct\""
        }
        SolveError::NotSolved { .. } if mode == Mode::Steady => {
            "write a larger thermal.first_layer"
        }
        SolveError::NotSolved { .. } => {
            "write a larger thermal.first_layer or a smaller thermal.step"
        }
        SolveError::BeyondProperties { .. } => {
            "extend it, or write effects.temperature_material.beyond = \"hold\""
        }
        SolveError::TooSlow { .. } => {
            "write a higher speed, a smaller thermal.resolution, or time.mode = \"transient\""
        }
        SolveError::Unsettled { .. } => "write a higher speed or time.mode = \"transient\"",
    };
    StepError::NoSolution(format!("{error}; {fix}"))
}

/// Refuses settings of the elements that the solver does not support.
///
/// # Errors
/// Earlier passages in a transient or nodal case; a stationary insulated sheet in a steady case.
pub(super) fn check(frame: &Frame) -> Result<(), Refusal> {
    check_passages(frame)?;
    check_sheets(frame)
}

/// Refuses earlier passages where the solver does not support them.
fn check_passages(frame: &Frame) -> Result<(), Refusal> {
    let length = frame.grid.ni as f64 * frame.grid.dx();
    for (body, elements) in frame.elements.iter().flatten().enumerate() {
        let Some(passages) = elements.passages else { continue };
        let key = frame.scene.names.key(body, "return_distance");
        if passages.distance < length {
            let reason =
                format!("{} m is shorter than the contact's grid, {length} m", passages.distance);
            return Err(Refusal::new(
                &key,
                reason,
                "write the distance of a turn, or to the next contact",
            ));
        }
        let in_modes = frame.body_properties[body].is_constant() && elements.solver == Solver::Auto;
        if frame.mode == Mode::Transient || !in_modes {
            return Err(Refusal::new(
                "thermal.passages",
                "earlier passages are supported only in steady cases with constant properties",
                "write time.mode = \"steady\" without temperature_material, convection and radiation, \
                 or 1 passage",
            ));
        }
    }
    Ok(())
}

/// Refuses a steady case with a stationary insulated sheet.
fn check_sheets(frame: &Frame) -> Result<(), Refusal> {
    for (body, elements) in frame.elements.iter().flatten().enumerate() {
        let insulated = elements.sheet.is_some_and(|sheet| sheet.back == Back::Insulated);
        if insulated && frame.mode == Mode::Steady && frame.scene.at_rest[body] {
            return Err(Refusal::new(
                &frame.scene.names.key(body, "back"),
                "an insulated sheet at rest has no steady state",
                "write \"fixed\", or time.mode = \"transient\"",
            ));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sizes are checked before anything is allocated, and the message names the key.
    #[test]
    fn too_many_elements_are_refused() {
        let steel = Material { density: 7850.0, specific_heat: 450.0, conductivity: 50.0 };
        let grid = Structured::contact_plane(0.0, 0.0, 1e-4, 1e-4, 41, 41);
        let check = |elements: Elements| check_size(&elements, &grid, &steel, 30.0);
        assert!(check(Elements::default()).is_ok());
        let plain = Elements::default;
        for (elements, key) in [
            (Elements { wake: Some(1e9), ..plain() }, WAKE),
            (Elements { wake: Some(1e300), ..plain() }, WAKE),
            (Elements { first_layer: Some(1e-300), ..plain() }, FIRST_LAYER),
            (Elements { first_layer: Some(1e-9), ratio: 1.0, ..plain() }, FIRST_LAYER),
            (Elements { depth: Some(1e9), ratio: 1.0, ..plain() }, DEPTH),
            (Elements { depth: Some(1e300), ..plain() }, DEPTH),
        ] {
            let refused = check(elements).unwrap_err();
            assert_eq!(refused.key, key, "{refused}");
        }
        let refused = check(Elements { wake: Some(1e9), ..plain() }).unwrap_err();
        assert!(refused.fix.starts_with("write at most 100.0 m"), "{refused}");
        let most = Elements { wake: Some(100.0), ..plain() };
        assert!(check(most).is_ok(), "what the message says is accepted");
    }

    #[test]
    fn advice_is_for_what_has_failed() {
        let not_solved = |gradients_stopped| SolveError::NotSolved {
            residual: 1e-3,
            newton: 40,
            gradients_stopped,
        };
        for (error, mode, fix) in [
            (not_solved(true), Mode::Transient, "write thermal.solver = \"direct\""),
            (not_solved(false), Mode::Steady, "write a larger thermal.first_layer"),
            (not_solved(false), Mode::Transient, "first_layer or a smaller thermal.step"),
        ] {
            let said = no_solution(error, mode).to_string();
            assert!(said.starts_with("the equations") && said.ends_with(fix), "{said}");
        }
    }
}

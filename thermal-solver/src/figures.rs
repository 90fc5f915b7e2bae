//! Figures of the summary: the section `temperature`, with one output line per body, and the
//! difference of the surfaces.

use proto::figure::contact::{FRICTION_POWER, PATCHES, SEMI_AXIS_A};
use proto::figure::{FigureSpec, Style};

/// Key of the largest rises of the heated strips [K]; a patch is assigned that of its own strip.
const STRIPS: &str = "temperature.*.each_strip.#.max_rise_k";

/// Largest plausible difference of the surface temperatures over the largest rise.
const MOST_APART: f64 = 0.5;

/// Returns all figures, in reading order. The heat into a body is known where the surfaces exchange
/// heat; otherwise it is a fixed share of the friction heat.
pub(crate) fn figures() -> Vec<FigureSpec> {
    let figure = |name: &str, unit, words, short| {
        FigureSpec::new(&format!("temperature.*.{name}"), unit, words)
            .on("*", short)
            .driven_by(FRICTION_POWER)
    };
    let in_patch = FigureSpec::new("contact.each_patch.#.*_max_rise_k", "K", "temperature rise")
        .on("patch", "*")
        .style(Style::Signed)
        .within(STRIPS, ["y_from_m", "y_to_m"], "y_m", PATCHES);
    vec![
        figure("max_rise_k", "K", "temperature rise", "")
            .expected_below(700.0, "steel transforms at about 1000 K, and its properties have changed by then (effects.temperature_material)")
            .style(Style::Signed)
            .rank(1)
            .headline(),
        figure("min_rise_k", "K", "lowest temperature rise", "down to").style(Style::Signed),
        figure("x_over_a", "1", "place x/a", "at x/a")
            .ratio(&["temperature.*.x_m"], SEMI_AXIS_A)
            .digits(4)
            .absolute()
            .rank(2),
        FigureSpec::new("temperature.*.x_m", "m", "place x").style(Style::Place).absolute(),
        figure("y_m", "m", "place y", "y").style(Style::Place).absolute(),
        figure("penetration_depth_m", "m", "depth to 1/e", "1/e at depth").digits(3).rank(3),
        FigureSpec::new("temperature.*.heat_w", "W", "heat into the body").style(Style::Signed),
        figure("heat_share", "1", "heat into the body, over the friction power", "takes")
            .ratio(&["temperature.*.heat_w"], FRICTION_POWER)
            .style(Style::Percent)
            .digits(3)
            .absolute(),
        in_patch,
        FigureSpec::new("surfaces.relative_difference", "1", "temperature difference of surfaces under friction, over the largest rise; only if no heat flows between them")
            .style(Style::Percent)
            .absolute()
            .expected_below(MOST_APART, "surfaces that touch even out: write effects.friction_heat.partition = \"continuity\" and thermal.model = \"moving-source\", or give effects.contact_conductance"),
    ]
}

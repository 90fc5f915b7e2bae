//! The quantities of the summary: the few that matter first, all of them last.

use crate::report::page::{Block, Headline, Section};
use crate::report::source::Results;
use crate::report::table::Table;
use run::format::{Scale, counted, number, of_key, stem_and_unit, words};
use serde_json::Value;

/// Contact, friction, temperature and energy at a glance.
pub(super) fn section(results: &Results) -> Option<Section> {
    let mut all = contact(results);
    all.extend(friction(results));
    all.extend(["rail", "wheel"].into_iter().filter_map(|body| temperature(results, body)));
    all.extend(coupling(results));
    if all.is_empty() {
        return None;
    }
    let patches = patches(results).map(|table| Block::Card("Patches".to_owned(), table));
    Section::of("Results", std::iter::once(Block::Headlines(all)).chain(patches).collect())
}

/// A row for each patch, if there are several.
fn patches(results: &Results) -> Option<Table> {
    let patches = results.summary.pointer("/contact/each_patch")?.as_array()?;
    let columns = [
        ("y", "y_m"),
        ("load", "normal_force_n"),
        ("a", "semi_axis_a_m"),
        ("b", "semi_axis_b_m"),
        ("p0", "max_pressure_pa"),
        ("rail rise", "rail_max_rise_k"),
        ("wheel rise", "wheel_max_rise_k"),
    ];
    let mut table = Table::new(columns.map(|(name, _)| name), 0);
    for patch in patches {
        let shown = |key: &str| {
            let value = patch.get(key)?.as_f64()?;
            Some(of_key(key, value).show(value, 4))
        };
        table.row(columns.map(|(_, key)| shown(key).unwrap_or_default()));
    }
    Some(table)
}

fn headline(name: &str, value: String, more: String) -> Headline {
    Headline { name: name.to_owned(), value, more }
}

/// A quantity of the summary with its unit.
fn shown(results: &Results, pointer: &str, si: &str, digits: usize) -> Option<String> {
    results.quantity(pointer).map(|value| Scale::of(si, value).show(value, digits))
}

fn percent(value: f64) -> String {
    format!("{}\u{a0}%", number(100.0 * value, 4))
}

fn contact(results: &Results) -> Vec<Headline> {
    let of = |key: &str, si: &str| shown(results, &format!("/contact/{key}"), si, 4);
    let with = |word: &str, value: Option<String>| value.map(|v| format!("{word} {v}"));
    let pressure = of("max_pressure_pa", "Pa").map(|value| {
        let more = with("under", of("normal_force_n", "N")).unwrap_or_default();
        headline("Maximum pressure", value, more)
    });
    let axis = of("semi_axis_a_m", "m").map(|a| {
        let more = [with("b", of("semi_axis_b_m", "m")), with("area", of("area_m2", "m2"))];
        headline("Semi-axis a", a, more.into_iter().flatten().collect::<Vec<_>>().join(", "))
    });
    let approach = of("approach_m", "m").map(|v| headline("Approach", v, String::new()));
    [pressure, axis, approach].into_iter().flatten().collect()
}

fn friction(results: &Results) -> Vec<Headline> {
    let of = |key: &str| results.quantity(&format!("/contact/{key}"));
    let with_unit = |key: &str, si: &str| shown(results, &format!("/contact/{key}"), si, 4);
    let forces = ["creep_force_x_n", "creep_force_y_n"].map(|key| of(key).unwrap_or(0.0));
    let normal = of("normal_force_n").filter(|force| *force > 0.0);
    let ratio = normal.map(|normal| forces[0].hypot(forces[1]) / normal);
    let coefficient = of("traction_coefficient").map(|value| {
        let parts = [("x", "creep_force_x_n"), ("y", "creep_force_y_n")];
        let part = |(axis, key): &(&str, &str)| {
            let force = of(key).filter(|force| force.abs() > 1e-6 * normal.unwrap_or(0.0))?;
            Some(format!("{} along {axis}", of_key(key, force).show(force, 4)))
        };
        let parts: Vec<String> = parts.iter().filter_map(part).collect();
        let value = number(ratio.unwrap_or(value.abs()), 4);
        headline("Traction coefficient |F|/N", value, parts.join(", "))
    });
    let creepage = of("creepage_xi").map(|value| {
        let across = of("creepage_eta").filter(|eta| *eta != 0.0);
        let spin = of("creepage_phi_per_m").filter(|phi| *phi != 0.0);
        let slip =
            of("slip_area_ratio").map(|ratio| format!("{} of the area slips", percent(ratio)));
        let more = [
            across.map(|eta| format!("along y {}", percent(eta))),
            spin.map(|phi| format!("spin {}\u{a0}rad/m", number(phi, 4))),
            slip,
        ];
        let more: Vec<String> = more.into_iter().flatten().collect();
        headline("Creepage along x", percent(value), more.join(", "))
    });
    let power = with_unit("friction_power_w", "W").map(|value| {
        let slip = with_unit("max_slip_velocity_m_per_s", "m/s").map(|v| format!("slip up to {v}"));
        headline("Friction power", value, slip.unwrap_or_default())
    });
    [coefficient, creepage, power].into_iter().flatten().collect()
}

fn temperature(results: &Results, body: &str) -> Option<Headline> {
    let of = |key: &str| format!("/temperature/{body}/{key}");
    let rise = results.quantity(&of("max_rise_k"))?;
    let place = results.quantity(&of("x_over_a")).map(|x| format!("at x/a {}", number(x, 3)));
    let depth = shown(results, &of("penetration_depth_m"), "m", 3).map(|d| format!("1/e at {d}"));
    let more: Vec<String> = [place, depth].into_iter().flatten().collect();
    let name = format!("{} temperature rise", if body == "rail" { "Rail" } else { "Wheel" });
    Some(headline(&name, format!("{}\u{a0}K", number(rise, 4)), more.join(", ")))
}

fn coupling(results: &Results) -> Vec<Headline> {
    let balance = results.quantity("/coupling/energy_imbalance").map(|value| {
        let text = if value == 0.0 { "exact".to_owned() } else { number(value, 2) };
        headline("Heat imbalance", text, "received against sent, worst window".to_owned())
    });
    let iterations = results.quantity("/coupling/iterations").map(|value| {
        let windows = results.quantity("/coupling/windows").unwrap_or(0.0);
        let windows = counted(windows as u64, "window");
        let more = format!("in {windows}, {}", results.word("/coupling/scheme"));
        headline("Iterations", format!("{value}"), more)
    });
    let wall = shown(results, "/cost/wall_s", "s", 3).map(|value| {
        let bytes = shown(results, "/cost/bytes_exchanged", "byte", 3);
        let more = bytes.map(|b| format!("{b} exchanged")).unwrap_or_default();
        headline("Wall time", value, more)
    });
    [balance, iterations, wall].into_iter().flatten().collect()
}

/// Every quantity of the summary, as it stands there and with a unit.
pub(super) fn everything(results: &Results) -> Option<Section> {
    let mut table = Table::new(["quantity", "value", "in summary.json"], 1);
    list(&results.summary, "", &mut table);
    if table.rows.is_empty() {
        return None;
    }
    let title = format!("All {} quantities of summary.json", table.rows.len());
    Section::of("Every quantity", vec![Block::Folded(title, table)])
}

fn list(value: &Value, path: &str, table: &mut Table) {
    let inner = |key: &str| match path {
        "" => key.to_owned(),
        path => format!("{path}.{key}"),
    };
    match value {
        Value::Object(entries) => {
            entries.iter().for_each(|(key, value)| list(value, &inner(key), table));
        }
        Value::Number(raw) => {
            let value = raw.as_f64().unwrap_or(f64::NAN);
            let (stem, si) = stem_and_unit(path);
            let name = words(stem).replace('.', " · ");
            table.row([name, Scale::of(si, value).show(value, 6), raw.to_string()]);
        }
        _ => {}
    }
}

//! Accuracy of the fast models relative to half-spaces: the table of docs/theory/fastsim.md.

use crate::common::*;
use elastic::kalker;
use serde_json::{Value, json};

const B: f64 = 1e-3;
const POISSON: f64 = 0.28;
const SHEAR: f64 = 82e9;
const COEFFICIENT: f64 = 0.3;
/// Chosen such that f N/(G a b) = 1e-3, with N = ⅔ π a b p₀.
const PEAK: f64 = 1e-3 * SHEAR * 1.5 / (std::f64::consts::PI * COEFFICIENT);

/// Directions of (ξ, η, φ), each relative to the value that saturates the linear theory alone.
const DIRECTIONS: [[f64; 3]; 9] = [
    [1.0, 0.0, 0.0],
    [0.0, 1.0, 0.0],
    [0.8, 0.6, 0.0],
    [0.5, -0.87, 0.0],
    [0.0, 0.0, 1.0],
    [0.7, 0.0, 0.7],
    [0.0, 0.7, 0.7],
    [0.0, 0.7, -0.7],
    [0.6, 0.5, 0.6],
];
const SIZES: [f64; 5] = [0.15, 0.5, 1.0, 2.0, 3.5];

fn contact(ratio: f64, [xi, eta, phi]: [f64; 3], mech: &Value) -> Run {
    run(&json!({
        "bodies": {"wheel": {"position": "upper", "radius_x": 0.5, "material": "steel"},
            "rail": {"position": "lower", "radius_y": 0.3, "material": "steel"}},
        "materials": {"steel":
            {"youngs_modulus": 2.0 * SHEAR * (1.0 + POISSON), "poisson_ratio": POISSON}},
        "contact": {"semi_axis_a": ratio * B, "semi_axis_b": B, "max_pressure": PEAK},
        "motion": {"speed": 10.0, "creepage": {"xi": xi, "eta": eta, "phi": phi}},
        "load": {"normal_force": 1.0},
        "friction": {"coefficient": COEFFICIENT},
        "effects": {"partial_slip": {}},
        "mech": mech,
    }))
}

/// Traction of the element that holds a place; zero outside of the grid.
fn traction(run: &Run, [x, y]: [f64; 2]) -> [f64; 2] {
    let grid = run.grid().as_structured().expect("a plane");
    let place = [(x - grid.x(0)) / grid.dx(), (y - grid.y(0)) / grid.dy()].map(f64::round);
    let outside = place.iter().zip([grid.ni, grid.nj]).any(|(at, n)| *at < 0.0 || *at >= n as f64);
    let index = place[1] as usize * grid.ni + place[0] as usize;
    let (px, py) = run.fields["traction"].split_at(grid.points());
    if outside { [0.0; 2] } else { [px[index], py[index]] }
}

/// Differences from half-spaces: force over f N, and root mean square of the tractions over f p₀ at
/// the elements of the half-spaces, which are shorter where the slip zone is.
fn off(fast: &Run, exact: &Run) -> [f64; 2] {
    let forces = ["creep_force_x_n", "creep_force_y_n"];
    let [x, y] = forces.map(|key| fast.number(key) - exact.number(key));
    let grid = exact.grid().as_structured().expect("a plane");
    let (px, py) = exact.fields["traction"].split_at(grid.points());
    let [mut sum, mut count] = [0.0; 2];
    for (index, own) in px.iter().zip(py).map(|(px, py)| [*px, *py]).enumerate() {
        let other = traction(fast, [grid.x(index % grid.ni), grid.y(index / grid.ni)]);
        if own != [0.0; 2] || other != [0.0; 2] {
            sum += (own[0] - other[0]).powi(2) + (own[1] - other[1]).powi(2);
            count += 1.0;
        }
    }
    let bound = COEFFICIENT * exact.number("normal_force_n");
    [x.hypot(y) / bound, f64::sqrt(sum / count) / (COEFFICIENT * PEAK)]
}

/// Model errors, bounded slightly above the worst shape: mean force and mean traction, without and
/// with spin.
#[test]
fn fast_models_beside_half_spaces() {
    let models = [
        ("parabolic, single", json!({"model": "fastsim"}), [0.035, 0.055, 0.13, 0.15]),
        (
            "parabolic, blended",
            json!({"model": "fastsim", "flexibility": "blended"}),
            [0.02, 0.035, 0.13, 0.15],
        ),
        (
            "elliptic, blended",
            json!({"model": "fastsim", "flexibility": "blended", "traction_bound": "elliptic"}),
            [0.025, 0.031, 0.075, 0.085],
        ),
        (
            "FASTRIP, blended",
            json!({"model": "fastsim", "flexibility": "blended", "traction_bound": "elliptic", "stick_zone": "strips"}),
            [0.01, 0.03, 0.035, 0.065],
        ),
    ];
    for ratio in [2.0, 1.0, 0.5] {
        let c = kalker::creep_coefficients(ratio, POISSON);
        let saturates = [1e-3 / c.c11, 1e-3 / c.c22, 1e-3 / (c.c23 * ratio.sqrt() * B)];
        let mut found = [[[0.0_f64; 4]; 2]; 4];
        for direction in DIRECTIONS {
            let spins = usize::from(direction[2] != 0.0);
            let count = if spins == 1 { 5.0 } else { 4.0 } * SIZES.len() as f64;
            for size in SIZES {
                let creepage: [f64; 3] =
                    std::array::from_fn(|k| size * direction[k] * saturates[k]);
                let with = |mech: &Value| {
                    let mut mech = mech.clone();
                    // Square elements, at least twenty in the shorter semi-axis.
                    mech["resolution"] = json!((20.0 * ratio.max(1.0)) as u32);
                    contact(ratio, creepage, &mech)
                };
                let exact = with(&json!({"model": "half-space"}));
                for ((_, mech, _), found) in models.iter().zip(&mut found) {
                    let [force, traction] = off(&with(mech), &exact);
                    let found = &mut found[spins];
                    found[0] += force / count;
                    found[1] = found[1].max(force);
                    found[2] += traction / count;
                    found[3] = found[3].max(traction);
                }
            }
        }
        for ((name, _, bounds), found) in models.iter().zip(found) {
            for (spins, [force, most, traction, worst]) in found.iter().enumerate() {
                let [force, most, traction, worst] =
                    [force, most, traction, worst].map(|x| 100.0 * x);
                println!(
                    "a/b {ratio} {name}, spin {spins}: force {force:.1}, {most:.1}; traction {traction:.1}, {worst:.1}"
                );
            }
            for spins in 0..2 {
                assert!(found[spins][0] < bounds[spins], "{name} {ratio} {spins}");
                assert!(found[spins][2] < bounds[2 + spins], "{name} {ratio} {spins}");
            }
        }
    }
}

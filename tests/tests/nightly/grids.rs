//! Errors of steadily rolling half-spaces over motions, shapes, grids and their positions.

use serde_json::Value;
use tests::harness::{Place, case, number};

/// An elliptic contact of cases/wheel-rail.toml.
struct Shape {
    /// Crown radius of the rail \[m\].
    crown: f64,
    /// Ratio b/a of the semi-axes.
    ratio: f64,
    /// Factors of the creepages and of the spin, in proportion to f p₀/G and f p₀/(G √(ab)).
    sizes: [f64; 2],
    /// Limit of the largest error of the forces at a/20 [% of f N], as on the page. That of the
    /// narrow ellipse is the error of its ten rows per semi-axis under spin.
    forces: f64,
    /// Limit of the largest error of the rise at a/20 [%], as on the page.
    rise: f64,
}

const SHAPES: [Shape; 3] = [
    Shape { crown: 0.0395, ratio: 0.2, sizes: [2.264, 3.404], forces: 0.27, rise: 2.5 },
    Shape { crown: 0.3, ratio: 0.75, sizes: [1.0, 1.0], forces: 0.07, rise: 0.65 },
    Shape { crown: 2.35, ratio: 3.0, sizes: [0.536, 0.393], forces: 0.04, rise: 1.7 },
];
/// Creepages ξ, η [-] and φ [1/m] at b/a = 0.75.
const CREEPAGES: [[f64; 3]; 6] = [
    [-4e-3, 0.0, 0.0],
    [0.0, -2e-3, 0.0],
    [0.0, 0.0, 0.3],
    [2e-3, 2e-3, 0.3],
    [2e-3, -2e-3, 0.3],
    [1e-3, 1e-3, 0.2],
];
const TRACTIONS: [f64; 3] = [0.02, 0.05, 0.1];
const RESOLUTIONS: [u32; 5] = [5, 10, 20, 40, 80];
const REFERENCE: u32 = 160;
/// f N of cases/wheel-rail.toml \[N\].
const MOST: f64 = 0.6 * 134e3;

/// Figures of a run: F_x and F_y over f N, M_z over f N √(ab), slip area over that of the contact,
/// friction power [W] and rise of the rail [K].
struct Run {
    forces: [f64; 3],
    slip_area: f64,
    power: f64,
    rise: f64,
}

impl Run {
    fn new(crown: f64, motion: &[String], resolution: u32, rows: Option<u32>) -> Self {
        let mut settings = vec![
            format!("bodies.rail.radius_y={crown}"),
            format!("mech.resolution={resolution}"),
            "output.fields=none".to_owned(),
        ];
        settings.extend(rows.map(|rows| format!("mech.lateral_resolution={rows}")));
        let settings = settings.iter().flat_map(|setting| ["--set", setting]);
        let arguments: Vec<&str> = motion.iter().map(String::as_str).chain(settings).collect();
        let summary: Value = Place::new().summary(&case("wheel-rail.toml"), &arguments);
        let contact = |name: &str| number(&summary, &format!("/contact/{name}"));
        let length = (contact("semi_axis_a_m") * contact("semi_axis_b_m")).sqrt();
        let [x, y, moment] =
            ["creep_force_x_n", "creep_force_y_n", "spin_moment_nm"].map(|name| contact(name));
        Self {
            forces: [x / MOST, y / MOST, moment / MOST / length],
            slip_area: contact("slip_area_ratio"),
            power: contact("friction_power_w"),
            rise: number(&summary, "/temperature/rail/max_rise_k"),
        }
    }

    /// Largest error of the forces, and errors of slip area, power and rise [%].
    fn errors(&self, truth: &Self) -> [f64; 4] {
        let forces = self.forces.iter().zip(truth.forces);
        let force = forces.map(|(force, truth)| (force - truth).abs()).fold(0.0, f64::max);
        let area = (self.slip_area - truth.slip_area).abs();
        let [power, rise] = [self.power / truth.power, self.rise / truth.rise];
        [force, area, (power - 1.0).abs(), (rise - 1.0).abs()].map(|error| 100.0 * error)
    }
}

/// Motions with their names: creepages of this size, and tractions.
fn motions([size, spin]: [f64; 2]) -> Vec<(String, Vec<String>)> {
    let creepages = CREEPAGES.map(|[xi, eta, phi]| {
        let [xi, eta, phi] = [xi * size, eta * size, phi * spin];
        let value = format!("motion.creepage={{xi={xi:e}, eta={eta:e}, phi={phi:e}}}");
        ["--set", &value, "--unset", "motion.traction_coefficient"].map(str::to_owned).to_vec()
    });
    let tractions = TRACTIONS.map(|traction| {
        vec!["--set".to_owned(), format!("motion.traction_coefficient={traction}")]
    });
    let named = |motion: Vec<String>| (motion[1].replace("motion.", ""), motion);
    creepages.into_iter().chain(tractions).map(named).collect()
}

/// Largest errors over five grids whose rows lie differently. The table of
/// docs/theory/half-space.md: `cargo test --release --workspace --test nightly -- grids
/// --nocapture`. Limits are those of the page.
#[test]
fn errors_fall_with_the_grid_wherever_it_lies() {
    for Shape { crown, ratio, sizes, forces, rise } in SHAPES {
        for (name, motion) in motions(sizes) {
            let truth = Run::new(crown, &motion, REFERENCE, None);
            for resolution in RESOLUTIONS {
                let least = (ratio.max(0.5) * f64::from(resolution)).round().max(5.0) as u32;
                let mut largest = [0.0_f64; 4];
                for rows in least..least + 5 {
                    let run = Run::new(crown, &motion, resolution, Some(rows));
                    let errors = run.errors(&truth);
                    largest
                        .iter_mut()
                        .zip(errors)
                        .for_each(|(most, error)| *most = most.max(error));
                }
                println!("b/a = {ratio}, {name}, a/{resolution}: {largest:.2?}");
                let met = resolution != 20 || (largest[0] < forces && largest[3] < rise);
                assert!(met, "b/a = {ratio}, {name}: {largest:.2?}");
            }
        }
    }
}

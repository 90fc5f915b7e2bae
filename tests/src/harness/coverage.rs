//! Stated errors of random rolling contacts against the true ones, found on finer grids.

use super::{Place, case, number};
use serde_json::Value;

/// Key of the largest rise of the rail.
const RISE: &str = "/temperature/rail/max_rise_k";
/// Ratio of a stated error to the true one above which it is too large to be useful.
const TOO_LARGE: f64 = 10.0;

/// Stated errors on one grid: those that cover the true ones, and those ten times too large.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coverage {
    /// Elements per semi-axis.
    pub resolution: u32,
    /// Number of contacts.
    pub cases: usize,
    /// Number of stated errors that are at least the true one.
    pub covered: usize,
    /// Number of stated errors above ten times the true one.
    pub too_large: usize,
}

/// States the errors of the first `count` random contacts on grids of these resolutions (by
/// `run --extrapolate`), and compares them with grids of a/`reference`.
#[expect(clippy::print_stdout, reason = "the nightly test prints its table")]
pub fn cover(count: u64, resolutions: &[u32], reference: u32) -> Vec<Coverage> {
    let new = |&resolution: &u32| Coverage { resolution, cases: 0, covered: 0, too_large: 0 };
    let mut coverage: Vec<Coverage> = resolutions.iter().map(new).collect();
    for seed in 0..count {
        let settings = contact(seed);
        let summary = |resolution: u32, more: &[&str]| -> Value {
            let resolution = format!("mech.resolution={resolution}");
            let mut arguments: Vec<&str> = settings.iter().map(String::as_str).collect();
            arguments.extend(["--set", &resolution]);
            Place::new().summary(&case("wheel-rail.toml"), &[&arguments[..], more].concat())
        };
        let truth = number(&summary(reference, &[]), RISE);
        for one in &mut coverage {
            let stated = summary(one.resolution, &["--extrapolate"]);
            let error = (number(&stated, "/accuracy/value") / truth - 1.0).abs();
            let bound = number(&stated, "/accuracy/estimated_error");
            one.cases += 1;
            one.covered += usize::from(error <= bound);
            one.too_large += usize::from(bound > TOO_LARGE * error);
            let [error, bound] = [error, bound].map(|error| 100.0 * error);
            println!("{seed}, a/{}: error {error:.3} %, stated {bound:.3} %", one.resolution);
        }
    }
    coverage
}

/// Settings of a random contact: load, radii, friction, speed, stiffness and conductivity, under a
/// longitudinal force or three creepages.
fn contact(seed: u64) -> Vec<String> {
    let mut state = seed;
    // Splitmix64.
    let mut uniform = move |low: f64, high: f64| {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        low + (high - low) * ((mixed ^ (mixed >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    };
    let mut settings = Vec::new();
    let mut set = |setting: String| settings.extend(["--set".to_owned(), setting]);
    let friction = uniform(0.1, 0.6);
    let radius = uniform(0.3, 1.0);
    let load = uniform(20e3, 150e3);
    let modulus = uniform(70e9, 210e9);
    set(format!("friction.coefficient={friction:.4}"));
    set(format!("bodies.wheel.radius_x={radius:.4}"));
    set(format!("bodies.rail.radius_y={:.4}", uniform(0.1, 1.0)));
    set(format!("load.normal_force={load:.0}"));
    set(format!("materials.steel.youngs_modulus={modulus:.4e}"));
    set(format!("materials.steel.conductivity={:.1}", uniform(10.0, 200.0)));
    set(format!("motion.speed={:.1}", uniform(5.0, 80.0)));
    if uniform(0.0, 1.0) < 0.5 {
        set(format!("motion.traction_coefficient={:.5}", friction * uniform(0.03, 0.97)));
        return settings;
    }
    // Creepages of about the size with which the contact slides.
    let size = friction * (load / (0.5 * modulus * radius * radius)).cbrt() * uniform(0.25, 4.0);
    let [xi, eta, phi] = [(); 3].map(|()| size * uniform(-1.0, 1.0));
    let phi = phi / 5e-3;
    set(format!("motion.creepage={{xi={xi:.4e}, eta={eta:.4e}, phi={phi:.4e}}}"));
    settings.extend(["--unset", "motion.traction_coefficient"].map(str::to_owned));
    settings
}

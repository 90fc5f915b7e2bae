//! Measures of convergence on residuals that are known.

use super::*;
use crate::accelerate::tests::settings;
use crate::part::parts;
use crate::settings::Acceleration;

/// The verdict on the second iteration of a window, in which two fields of two values each go from
/// a first residual of norm 1 to these residuals, with ‖x̃‖ = 10.
fn second(change: impl Fn(&mut Implicit), residuals: [f64; 2]) -> Verdict {
    let mut settings = settings(Acceleration::None);
    settings.tolerances = Tolerances::default();
    change(&mut settings);
    let mut within = Within::new(&settings, &parts([("u", 2), ("v", 2)]), 100);
    let returned = [6.0, 8.0, 6.0, 8.0];
    within.begin_window();
    within.judge(1, &[7.0, 8.0, 6.0, 9.0], &returned);
    let [u, v] = residuals;
    within.judge(2, &[6.0 - u, 8.0, 6.0 - 0.6 * v, 8.0 - 0.8 * v], &returned)
}

#[test]
fn each_measure_bounds_what_it_says() {
    let absolute = |bound| move |s: &mut Implicit| s.tolerances.absolute = Some(bound);
    assert_eq!(second(absolute(1e-3), [0.9e-3, 0.9e-3]), Verdict::Done);
    assert_eq!(second(absolute(1e-3), [0.9e-3, 1.1e-3]), Verdict::Continue);
    let relative = |bound| move |s: &mut Implicit| s.tolerances.relative = Some(bound);
    assert_eq!(second(relative(1e-3), [9e-3, 9e-3]), Verdict::Done);
    assert_eq!(second(relative(1e-3), [11e-3, 0.0]), Verdict::Continue);
    let to_first = |bound| move |s: &mut Implicit| s.tolerances.residual_relative = Some(bound);
    assert_eq!(second(to_first(0.1), [0.09, 0.09]), Verdict::Done);
    assert_eq!(second(to_first(0.1), [0.0, 0.11]), Verdict::Continue);
}

#[test]
fn all_measures_have_to_hold_and_a_field_can_have_its_own() {
    let both = |s: &mut Implicit| {
        (s.tolerances.relative, s.tolerances.absolute) = (Some(1e-2), Some(1e-3));
    };
    assert_eq!(second(both, [0.9e-3, 0.9e-3]), Verdict::Done);
    assert_eq!(second(both, [0.9e-2, 0.0]), Verdict::Continue);
    let own = |s: &mut Implicit| {
        s.tolerances.absolute = Some(1e-9);
        s.fields.insert("v".to_owned(), Tolerances { relative: Some(0.1), ..Default::default() });
    };
    assert_eq!(second(own, [0.0, 0.9]), Verdict::Done);
    assert_eq!(second(own, [1e-8, 0.9]), Verdict::Continue);
}

#[test]
fn iterations_have_a_least_and_a_most() {
    let least = |s: &mut Implicit| s.min_iterations = 3;
    assert_eq!(second(least, [0.0, 0.0]), Verdict::Continue);
    let most = |s: &mut Implicit| {
        (s.max_iterations, s.tolerances.absolute) = (2, Some(1e-9));
    };
    assert_eq!(second(most, [1e-3, 0.0]), Verdict::NotConverged(Why::OutOfIterations));
    assert_eq!(second(most, [0.0, 0.0]), Verdict::Done, "the last iteration counts");
}

/// Iterations that are made because the case wants them are no stagnation.
#[test]
fn a_window_within_its_tolerances_is_not_given_up() {
    let settings = Implicit { min_iterations: 300, ..settings(Acceleration::None) };
    let mut within = Within::new(&settings, &parts([("u", 1)]), 100);
    within.begin_window();
    let ends = (1..).find(|&k| within.judge(k, &[1.0], &[1.0 + 1e-9]) != Verdict::Continue);
    assert_eq!(ends, Some(300));
    assert_eq!(within.judge(301, &[1.0], &[1.0 + 1e-9]), Verdict::Done);
}

#[test]
fn norms_that_are_no_numbers_are_divergence_whatever_the_bounds() {
    let loose = |s: &mut Implicit| s.tolerances.absolute = Some(f64::INFINITY);
    for bad in [f64::NAN, f64::INFINITY, 1e300] {
        assert_eq!(second(loose, [0.0, bad]), Verdict::NotConverged(Why::Diverged), "{bad}");
    }
}

#[test]
fn a_field_that_stays_zero_has_converged() {
    let settings = settings(Acceleration::None);
    let mut within = Within::new(&settings, &parts([("u", 2)]), 100);
    within.begin_window();
    assert_eq!(within.judge(1, &[0.0; 2], &[0.0; 2]), Verdict::Done);
    assert_eq!(within.residuals(), [0.0]);
}

/// Norms over several blocks equal a plain sum but for its rounding.
#[test]
fn norms_of_long_vectors() {
    let returned: Vec<f64> = (0..5000).map(|i| f64::from(i % 17) - 3.0).collect();
    let sent: Vec<f64> = (0..5000).map(|i| f64::from(i % 5)).collect();
    let plain = |of: &dyn Fn(usize) -> f64| (0..5000).map(of).map(|v| v * v).sum::<f64>().sqrt();
    let norms = Norms::of(&sent, &returned);
    assert_eq!(norms.returned, plain(&|i| returned[i]), "whole numbers have no rounding");
    assert_eq!(norms.residual, plain(&|i| returned[i] - sent[i]));
}

//! Accelerators against closed forms and independent linear algebra.

use super::*;
use crate::settings::{Implicit, Preconditioner};
use crate::vector::parts;

/// Returns the settings of a case with default values.
pub(crate) fn settings(acceleration: Acceleration) -> Implicit {
    Implicit { acceleration, ..Implicit::default() }
}

/// Returns a pseudo-random number in [-1, 1).
fn random(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// The map x̃ = Ax + b of size n.
struct Affine {
    matrix: Vec<f64>,
    right: Vec<f64>,
}

impl Affine {
    fn new(n: usize, scale: f64) -> Self {
        let mut seed = 7;
        let matrix = (0..n * n).map(|_| scale * random(&mut seed)).collect();
        Self { matrix, right: (0..n).map(|_| random(&mut seed)).collect() }
    }

    fn apply(&self, x: &[f64]) -> Vec<f64> {
        let n = x.len();
        let row = |i: usize| -> f64 { (0..n).map(|j| self.matrix[i * n + j] * x[j]).sum() };
        (0..n).map(|i| row(i) + self.right[i]).collect()
    }
}

fn norm(v: &[f64]) -> f64 {
    v.iter().map(|v| v * v).sum::<f64>().sqrt()
}

fn minus(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// Returns the pairs (sent, returned) of one window, the last iteration included.
fn window(
    accelerator: &mut dyn Accelerator,
    problem: impl Fn(&[f64]) -> Vec<f64>,
    start: &[f64],
    iterations: usize,
) -> Vec<(Vec<f64>, Vec<f64>)> {
    let mut sent = start.to_vec();
    accelerator.begin_window();
    let mut all = Vec::new();
    for iteration in 0..iterations {
        let returned = problem(&sent);
        all.push((sent.clone(), returned.clone()));
        if iteration + 1 < iterations {
            accelerator.next(&mut sent, &returned);
        } else {
            accelerator.accept_window(&sent, &returned);
        }
    }
    all
}

/// Returns the coefficients that minimise ‖r + Vc‖, by QR with Gram-Schmidt orthogonalisation done
/// twice.
fn least_squares(columns: &[Vec<f64>], r: &[f64]) -> Vec<f64> {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let k = columns.len();
    let (mut q, mut upper) = (Vec::<Vec<f64>>::new(), vec![vec![0.0; k]; k]);
    for (j, column) in columns.iter().enumerate() {
        let mut v = column.clone();
        for _ in 0..2 {
            for (i, q) in q.iter().enumerate() {
                let part = dot(q, &v);
                upper[i][j] += part;
                v.iter_mut().zip(q).for_each(|(v, q)| *v -= part * q);
            }
        }
        upper[j][j] = norm(&v);
        q.push(v.iter().map(|v| v / upper[j][j]).collect());
    }
    let mut c: Vec<f64> = q.iter().map(|q| -dot(q, r)).collect();
    for i in (0..k).rev() {
        let rest: f64 = (i + 1..k).map(|j| upper[i][j] * c[j]).sum();
        c[i] = (c[i] - rest) / upper[i][i];
    }
    c
}

/// Returns x̃ + Wc for the columns between these iterations, the newest first.
fn by_qr(all: &[(Vec<f64>, Vec<f64>)], most: usize) -> Vec<f64> {
    let residual = |i: usize| minus(&all[i].1, &all[i].0);
    let last = all.len() - 1;
    let ages = 0..last.min(most);
    let v: Vec<_> =
        ages.clone().map(|a| minus(&residual(last - a), &residual(last - a - 1))).collect();
    let w: Vec<_> = ages.map(|a| minus(&all[last - a].1, &all[last - a - 1].1)).collect();
    let c = least_squares(&v, &residual(last));
    let mut next = all[last].1.clone();
    for (c, w) in c.iter().zip(&w) {
        next.iter_mut().zip(w).for_each(|(next, w)| *next += c * w);
    }
    next
}

#[test]
fn the_gram_matrix_gives_the_least_squares_of_a_qr_factorisation() {
    let problem = Affine::new(40, 0.3);
    for most in [3, 100] {
        let settings = Implicit { max_columns: most, ..settings(Acceleration::IqnIls) };
        let mut accelerator = build(&settings, &parts([("x", 40)]));
        let all = window(&mut *accelerator, |x| problem.apply(x), &[0.0; 40], 16);
        for k in 2..all.len() {
            let expected = by_qr(&all[..k], most);
            let error = norm(&minus(&all[k].0, &expected)) / norm(&expected);
            // Tolerance: 10⁻¹⁶ times the condition number of the columns, here some thousands.
            assert!(error < 1e-11, "{most} columns, iteration {k}: {error:e}");
        }
    }
}

#[test]
fn a_linear_problem_of_n_unknowns_ends_after_n_plus_two_iterations() {
    let n = 12;
    let problem = Affine::new(n, 1.0);
    for acceleration in [Acceleration::IqnIls, Acceleration::IqnImvj, Acceleration::Anderson] {
        let mut accelerator = build(&settings(acceleration), &parts([("x", n)]));
        let all = window(&mut *accelerator, |x| problem.apply(x), &vec![0.0; n], n + 2);
        let (sent, returned) = all.last().unwrap();
        let residual = norm(&minus(returned, sent)) / norm(returned);
        // Tolerance: rounding after n steps.
        assert!(residual < 1e-9, "{acceleration:?}: {residual:e}");
    }
}

/// The second window has another problem, with the opposite sign of the feedback. Its columns alone
/// are used after the step of the reused ones has increased the residual.
#[test]
fn columns_of_earlier_windows_are_removed_if_they_mislead() {
    let n = 12;
    let [problem, other] = [Affine::new(n, 0.5), Affine::new(n, -2.0)];
    let mut accelerator = build(&settings(Acceleration::IqnIls), &parts([("x", n)]));
    window(&mut *accelerator, |x| problem.apply(x), &vec![0.0; n], 6);
    accelerator.begin_window();
    let mut sent = vec![0.0; n];
    let mut residuals = Vec::new();
    let counts = [0; 3].map(|_| {
        let returned = other.apply(&sent);
        residuals.push(norm(&minus(&returned, &sent)));
        accelerator.next(&mut sent, &returned).columns.unwrap()
    });
    assert!(residuals[1] > residuals[0], "{residuals:?}");
    assert_eq!(counts, [5, 1, 2]);
}

#[test]
fn anderson_with_mixing_one_is_quasi_newton_without_reuse() {
    let problem = Affine::new(20, 0.4);
    let of = |acceleration, relaxation, reuse_windows| {
        let settings = Implicit { relaxation, reuse_windows, ..settings(acceleration) };
        let mut accelerator = build(&settings, &parts([("x", 20)]));
        let mut all = window(&mut *accelerator, |x| problem.apply(x), &[0.0; 20], 6);
        all.extend(window(&mut *accelerator, |x| problem.apply(x), &[1.0; 20], 6));
        all
    };
    let quasi_newton = of(Acceleration::IqnIls, 1.0, 0);
    assert_eq!(of(Acceleration::Anderson, 1.0, 10), quasi_newton);
    let mixed = of(Acceleration::Anderson, 0.5, 10);
    // x + βr + (ΔX + βΔR)c of the third iteration.
    let c = {
        let residual = |i: usize| minus(&mixed[i].1, &mixed[i].0);
        least_squares(&[minus(&residual(1), &residual(0))], &residual(1))[0]
    };
    for i in 0..20 {
        let half = |k: usize| f64::midpoint(mixed[k].0[i], mixed[k].1[i]);
        let expected = half(1) + c * (half(1) - half(0));
        assert!((mixed[2].0[i] - expected).abs() < 1e-14, "rounding");
    }
}

/// Reference: the inverse Jacobian as a full matrix, as published.
#[test]
fn multi_vector_updates_equal_the_stored_jacobian() {
    let n = 10;
    let problem = Affine::new(n, 0.6);
    let settings = settings(Acceleration::IqnImvj);
    let mut accelerator = build(&settings, &parts([("x", n)]));
    let mut jacobian = vec![vec![0.0; n]; n];
    let times = |j: &[Vec<f64>], v: &[f64]| -> Vec<f64> {
        j.iter().map(|row| row.iter().zip(v).map(|(a, b)| a * b).sum()).collect()
    };
    for (start, iterations) in [(0.0, 4), (1.0, 3), (-2.0, 5)] {
        let all = window(&mut *accelerator, |x| problem.apply(x), &vec![start; n], iterations);
        let residual = |i: usize| minus(&all[i].1, &all[i].0);
        let updated = |k: usize| -> Vec<Vec<f64>> {
            let v: Vec<_> = (0..k).rev().map(|i| minus(&residual(i + 1), &residual(i))).collect();
            let w: Vec<_> = (0..k).rev().map(|i| minus(&all[i + 1].1, &all[i].1)).collect();
            let rest: Vec<_> =
                v.iter().zip(&w).map(|(v, w)| minus(w, &times(&jacobian, v))).collect();
            let mut new = jacobian.clone();
            for column in 0..n {
                let mut unit = vec![0.0; n];
                unit[column] = -1.0;
                for (c, rest) in least_squares(&v, &unit).iter().zip(&rest) {
                    (0..n).for_each(|row| new[row][column] += c * rest[row]);
                }
            }
            new
        };
        for k in 1..iterations {
            // The very first step has no columns.
            if start == 0.0 && k == 1 {
                continue;
            }
            let step = times(&updated(k - 1), &residual(k - 1));
            let expected = minus(&all[k - 1].1, &step);
            let error = norm(&minus(&all[k].0, &expected)) / norm(&expected);
            assert!(error < 1e-10, "from {start}, iteration {k}: {error:e}, rounding");
        }
        jacobian = updated(iterations - 1);
    }
}

#[test]
fn a_column_that_holds_nothing_new_is_dropped_and_counted() {
    let mut accelerator = build(&settings(Acceleration::IqnIls), &parts([("x", 3)]));
    accelerator.begin_window();
    let mut take = |x: [f64; 3], r: [f64; 3]| {
        let mut sent = x;
        let returned: Vec<f64> = x.iter().zip(r).map(|(x, r)| x + r).collect();
        accelerator.next(&mut sent, &returned)
    };
    take([0.0; 3], [1.0, 0.0, 0.0]);
    assert_eq!(take([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]).columns, Some(1));
    // The second Δr is minus the first; the third adds a direction; the fourth is zero.
    let back = take([0.0; 3], [1.0, 0.0, 0.0]);
    assert_eq!((back.columns, back.dropped), (Some(1), 1));
    let new = take([0.0, 0.0, 1.0], [1.0, 0.0, 5.0]);
    assert_eq!((new.columns, new.dropped), (Some(2), 0));
    let same = take([0.0, 0.0, 2.0], [1.0, 0.0, 5.0]);
    assert_eq!((same.columns, same.dropped), (Some(2), 1));
}

#[test]
fn aitken_is_the_secant_of_one_unknown_and_the_formula_of_many() {
    let mut accelerator = build(&settings(Acceleration::Aitken), &parts([("x", 1)]));
    let scalar = |x: &[f64]| vec![-3.0 * x[0] + 8.0];
    let all = window(&mut *accelerator, scalar, &[0.0], 3);
    assert_eq!(all[1].0, [4.0], "half of the residual 8");
    assert_eq!(all[2].0, [2.0], "the secant of a line is exact");
    let problem = Affine::new(30, 0.3);
    let mut accelerator = build(&settings(Acceleration::Aitken), &parts([("x", 30)]));
    let all = window(&mut *accelerator, |x| problem.apply(x), &[0.0; 30], 8);
    let residual = |k: usize| minus(&all[k].1, &all[k].0);
    let mut relaxation = 0.5;
    for k in 1..7 {
        let change = minus(&residual(k), &residual(k - 1));
        let across: f64 = residual(k - 1).iter().zip(&change).map(|(a, b)| a * b).sum();
        relaxation *= -across / norm(&change).powi(2);
        for i in 0..30 {
            let expected = all[k].0[i] + relaxation * residual(k)[i];
            assert!((all[k + 1].0[i] - expected).abs() < 1e-12 * norm(&all[k].0), "rounding");
        }
    }
}

/// A change of unit, metre to micrometre, leaves the iterates unchanged. `residual-sum` is left
/// out: its shares add up fields of different units.
#[test]
fn units_of_the_fields_do_not_matter() {
    let problem = Affine::new(16, 0.4);
    for preconditioner in [Preconditioner::Value, Preconditioner::Residual] {
        for acceleration in [Acceleration::Aitken, Acceleration::IqnIls, Acceleration::IqnImvj] {
            let run = |unit: f64| {
                let settings = Implicit { preconditioner, ..settings(acceleration) };
                let mut accelerator = build(&settings, &parts([("u", 6), ("v", 10)]));
                let scaled = |x: &[f64], by: f64| -> Vec<f64> {
                    x.iter().enumerate().map(|(i, x)| if i < 6 { by * x } else { *x }).collect()
                };
                let answer = |x: &[f64]| scaled(&problem.apply(&scaled(x, 1.0 / unit)), unit);
                let all = window(&mut *accelerator, answer, &[0.0; 16], 7);
                scaled(&all[6].0, 1.0 / unit)
            };
            let error = norm(&minus(&run(1.0), &run(2.0_f64.powi(20)))) / norm(&run(1.0));
            // Powers of two scale without rounding. The weights round, amplified by the condition
            // number.
            assert!(error < 1e-9, "{preconditioner:?} {acceleration:?}: {error:e}");
        }
    }
}

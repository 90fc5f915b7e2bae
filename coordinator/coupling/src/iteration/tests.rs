//! Coupling of participants implemented in the test.

use super::*;
use crate::accelerate::tests::settings;
use crate::settings::{Acceleration, Tolerances};

/// Response of one participant to the other.
type Answer = fn(f64) -> f64;

/// Two participants with one number each: a = f(b), b = g(a).
struct Pair {
    f: Answer,
    g: Answer,
    values: [f64; 2],
    received: [f64; 2],
    coupling_data: Vec<Part>,
    measured_data: Vec<Part>,
    solves: u32,
}

impl Pair {
    /// Creates a pair. The coupling data are b alone in a serial scheme, a and b in a parallel one.
    fn new(f: Answer, g: Answer, fields: &[&str]) -> Self {
        let coupling_data = parts(fields.iter().map(|name| (*name, 1)));
        let (measured_data, values) = (Vec::new(), [0.0; 2]);
        Self { f, g, values, received: [0.0; 2], coupling_data, measured_data, solves: 0 }
    }

    /// Creates a serial pair whose field a, which goes forward, is tested too.
    fn measured(f: Answer, g: Answer) -> Self {
        let a = Part { name: "a".to_owned(), range: 1..2 };
        Self { measured_data: vec![a], ..Self::new(f, g, &["b"]) }
    }

    fn is_serial(&self) -> bool {
        self.coupling_data.len() < 2
    }
}

impl Exchange for Pair {
    type Error = Infallible;

    fn participants(&self) -> usize {
        2
    }

    fn solve(&mut self, participants: &[ParticipantIndex], _step: &Step) -> Result<(), Infallible> {
        let [a, b] = self.values;
        // No feedback: a receives the last value of b.
        let inputs = match self.coupling_data.as_slice() {
            [] => [b, a],
            [_] => [self.received[0], a],
            _ => [self.received[1], self.received[0]],
        };
        for one in participants.iter().map(|&one| usize::from(one)) {
            self.values[one] = if one == 0 { (self.f)(inputs[0]) } else { (self.g)(inputs[1]) };
            self.solves += 1;
        }
        Ok(())
    }

    fn coupling_data(&self) -> &[Part] {
        &self.coupling_data
    }

    fn measured_data(&self) -> &[Part] {
        &self.measured_data
    }

    fn send(&mut self, iterate: &[f64], _step: &Step) -> Result<(), Infallible> {
        self.received[..iterate.len()].copy_from_slice(iterate);
        Ok(())
    }

    fn returned(&self, returned: &mut [f64]) {
        let [a, b] = self.values;
        let all = if self.is_serial() { [b, a] } else { [a, b] };
        returned.copy_from_slice(&all[..returned.len()]);
    }
}

fn window(index: u64) -> Step {
    Step { window: index, iteration: 0, start: index as f64, end: index as f64 + 1.0 }
}

#[test]
fn serial_and_parallel_find_the_fixed_point_of_a_loop_that_diverges_by_itself() {
    // The map a = cos b, b = 1 - 3a has a loop gain of about 2.6.
    let (f, g): (Answer, Answer) = (f64::cos, |a| 1.0 - 3.0 * a);
    for acceleration in [Acceleration::Aitken, Acceleration::IqnIls, Acceleration::IqnImvj] {
        for fields in [&["b"][..], &["a", "b"]] {
            if acceleration == Acceleration::Aitken && fields.len() == 2 {
                continue; // A single factor cannot converge two fields that rotate into each other.
            }
            let mut pair = Pair::new(f, g, fields);
            let mut settings = settings(acceleration);
            settings.tolerances.relative = Some(1e-12);
            let mut coupling = Coupling::implicit(&settings, fields.len() == 2, &pair);
            let outcome = coupling.solve_window(&mut pair, &window(0)).unwrap();
            assert_eq!(outcome.not_converged, None, "{acceleration:?} {fields:?}");
            let [a, b] = pair.values;
            assert!((a - b.cos()).abs() < 1e-10 && (b - (1.0 - 3.0 * a)).abs() < 1e-10);
            assert_eq!(pair.solves, 2 * outcome.iterations);
        }
    }
}

#[test]
fn explicit_schemes_pass_once_with_what_they_have() {
    let (f, g): (Answer, Answer) = (|b| b + 1.0, |a| 10.0 * a);
    let mut pair = Pair::new(f, g, &[]);
    let mut serial = Coupling::explicit();
    for index in 0..2 {
        let outcome = serial.solve_window(&mut pair, &window(index)).unwrap();
        assert_eq!((outcome.iterations, outcome.residual), (1, None));
    }
    assert_eq!(pair.values, [11.0, 110.0]);
    let mut pair = Pair::new(f, g, &[]);
    let mut parallel = Coupling::explicit_parallel();
    for index in 0..3 {
        parallel.solve_window(&mut pair, &window(index)).unwrap();
    }
    assert_eq!(
        pair.values,
        [11.0, 10.0],
        "each receives the values before the pass: 1,0 then 1,10"
    );
}

#[test]
fn what_does_not_converge_is_named_and_ends_the_window() {
    let run = |g: Answer, most: u32| {
        let mut pair = Pair::new(|b| b, g, &["b"]);
        let settings = Implicit { max_iterations: most, ..settings(Acceleration::None) };
        let mut coupling = Coupling::implicit(&settings, false, &pair);
        coupling.solve_window(&mut pair, &window(4)).unwrap().not_converged.unwrap()
    };
    let growing = run(|a| -2.0 * a + 1.0, 1000);
    assert_eq!((growing.why, growing.window, growing.iteration), (NonConvergence::Diverged, 4, 21));
    let slow = run(|a| 0.999 * a + 1.0, 7);
    assert_eq!((slow.why, slow.iteration), (NonConvergence::OutOfIterations, 7));
    let noisy = run(|a| if a == 0.0 { 1.0 } else { 1.0 + 1e-3 * (1e9 * a).sin() }, 1000);
    assert_eq!(noisy.why, NonConvergence::Stagnated);
    let text = noisy.to_string();
    assert!(text.starts_with("the coupling stagnated in window 4, iteration "), "{text}");
}

#[test]
fn nothing_that_is_no_number_converges() {
    for value in [f64::NAN, f64::INFINITY, 1e200] {
        let mut pair = Pair::new(|b| b, |_| 0.0, &["b"]);
        pair.values[1] = value;
        let mut coupling = Coupling::implicit(&settings(Acceleration::None), false, &pair);
        coupling.begin_window(&window(0));
        let verdict = coupling.iterate(&mut pair).unwrap();
        assert_eq!(verdict, Verdict::NotConverged(NonConvergence::Diverged), "{value} went in");
    }
}

#[test]
fn a_window_can_be_tried_again_as_if_it_had_not_been_tried() {
    let (f, g): (Answer, Answer) = (|b| 0.5 * b, |a| 1.0 - 3.0 * a);
    for acceleration in [Acceleration::Aitken, Acceleration::IqnIls, Acceleration::IqnImvj] {
        let settings = settings(acceleration);
        let mut ends = Vec::new();
        for attempts in [1, 3] {
            let mut pair = Pair::new(f, g, &["b"]);
            let mut coupling = Coupling::implicit(&settings, false, &pair);
            coupling.solve_window(&mut pair, &window(0)).unwrap();
            for _ in 1..attempts {
                coupling.begin_window(&window(1));
                coupling.iterate(&mut pair).unwrap();
            }
            coupling.solve_window(&mut pair, &window(1)).unwrap();
            ends.push(pair.values.map(f64::to_bits));
        }
        assert_eq!(ends[0], ends[1], "{acceleration:?}");
    }
}

/// With a_k = f(b_{k-1}), the residual of a is its change since the last iteration, and since the
/// last window in the first one. The iterates are those without the measure.
#[test]
fn a_field_that_goes_forward_is_tested() {
    let (f, g): (Answer, Answer) = (|b| 0.5 * b, |a| 1.0 - a);
    let mut settings = settings(Acceleration::None);
    let loose = Tolerances { relative: Some(0.9), ..Tolerances::default() };
    settings.fields.insert("b".to_owned(), loose);
    settings.tolerances = Tolerances { absolute: Some(0.1), ..Tolerances::default() };
    let (mut pair, mut plain) = (Pair::measured(f, g), Pair::new(f, g, &["b"]));
    let mut coupling = Coupling::implicit(&settings, false, &pair);
    let mut without = Coupling::implicit(&settings, false, &plain);
    coupling.begin_window(&window(0));
    without.begin_window(&window(0));
    // b = 0, 1, 1/2, 3/4, ... is within its tolerance in the third iteration, a in the fifth.
    let mut last = 0.0_f64;
    for (k, a) in [0.0, 0.5, 0.25, 0.375, 0.3125].into_iter().enumerate() {
        let verdict = coupling.iterate(&mut pair).unwrap();
        let residual = if a == last { 0.0 } else { (a - last).abs() / a };
        assert_eq!(coupling.residuals()[1], residual);
        assert_eq!(verdict, if k < 4 { Verdict::Continue } else { Verdict::Done }, "{a}");
        last = a;
        if k < 2 {
            without.iterate(&mut plain).unwrap();
            assert_eq!(coupling.sent(), without.sent());
        }
    }
}

#[test]
fn a_restored_coupling_continues_bit_identically() {
    let (f, g): (Answer, Answer) = (f64::cos, |a| 1.0 - 3.0 * a);
    for word in Acceleration::WORDS.iter().filter(|word| !["none", "constant"].contains(word)) {
        let mut settings = settings(Acceleration::from_word(word).unwrap());
        settings.predictor = crate::settings::Predictor::Linear;
        let mut pair = Pair::measured(f, g);
        let mut whole = Coupling::implicit(&settings, false, &pair);
        let mut state = Vec::new();
        for index in 0..3 {
            whole.solve_window(&mut pair, &window(index)).unwrap();
        }
        whole.save(&mut state);
        let mut other = Pair::measured(f, g);
        let mut resumed = Coupling::implicit(&settings, false, &other);
        resumed.restore(&mut StateReader(&state)).unwrap();
        assert_eq!(
            whole.solve_window(&mut pair, &window(3)).unwrap(),
            resumed.solve_window(&mut other, &window(3)).unwrap(),
            "{word}"
        );
        assert_eq!(pair.values.map(f64::to_bits), other.values.map(f64::to_bits), "{word}");
        let mut wrong = Coupling::implicit(&settings, true, &Pair::new(f, g, &["a", "b"]));
        assert!(wrong.restore(&mut StateReader(&state)).is_err(), "{word}");
        assert!(resumed.restore(&mut StateReader(&state[..state.len() - 1])).is_err(), "{word}");
    }
}

//! Control of the window length.
//!
//! A window is accepted if it has converged, if no participant requests a shorter one, and if its
//! local error e ([`super::LocalError`]) is at most 4ε² with ε the tolerance. A first-order method
//! whose windows have a local error of order ε² has a global error of order ε, so that the error is
//! proportional to the tolerance (G. Söderlind & L. Wang, *J. Comput. Appl. Math.* 185 (2006), on
//! tolerance proportionality). The factor is that of the step response 1 − e^{−t}. With the local
//! error δ² in every window of length √2 δ e^{t/2} the global error is √2 δ(e^{−t/2} − e^{−t}), at
//! most δ/√8, which is 0.7ε for δ = 2ε.
//!
//! A rejected window is solved again from its start: half as long if it has not converged, at most
//! half as long if its error was too large, or as long as a participant requests. The shortest
//! window is accepted with any error: a jump must lie within, and the estimate starts again. The
//! beginning of a run is such a jump, from nothing to all exchanged values. It gives no estimate of
//! a length, so the run begins with the shortest window.
//!
//! After a window of length Δt the next one has the length
//!
//! Δt · 0.9 (4ε²/eₙ)^(0.7/2) (eₙ₋₁/4ε²)^(0.4/2), between 0.2 and 4 times Δt,
//!
//! the PI controller of K. Gustafsson, *ACM Trans. Math. Softw.* 17 (1991) 533, with the exponents
//! of E. Hairer & G. Wanner, *Solving Ordinary Differential Equations II*, section IV.2. The length
//! is at most Δt after a repeated window, and at most the length that a participant requests.

use super::{LocalError, ROUNDING, Windows};
use contract::readable::number;
use contract::step::Step;
use serde::{Deserialize, Serialize};

/// Fraction of the estimated length that is used.
const SAFETY: f64 = 0.9;
/// Exponents of the controller, over the order 2 of the local error.
const INTEGRAL: f64 = 0.7 / 2.0;
const PROPORTIONAL: f64 = 0.4 / 2.0;
/// Bounds on the change from one window to the next.
const CHANGE: (f64, f64) = (0.2, 4.0);
/// Bounds on the change when a window is repeated because of its error.
const REPEAT: (f64, f64) = (0.1, 0.5);

/// Decision on a solved window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Acceptance {
    /// The window is accepted.
    Accept,
    /// The window is solved again, with the length that [`Controller::window`] now gives.
    Repeat(Cause),
}

/// Reason why a window is solved again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cause {
    /// The window has not converged.
    NotConverged,
    /// The relative local error \[-\] is too large.
    Error(f64),
    /// A participant requests a window of this length \[s\].
    Wanted(f64),
}

impl std::fmt::Display for Cause {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NotConverged => f.write_str("it has not converged"),
            Self::Error(error) => {
                write!(f, "its local error is {error}", error = number(*error, 4))
            }
            Self::Wanted(length) => write!(f, "a participant wants {length:e} s"),
        }
    }
}

/// Position of a run in time, and the data that determine the next window.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WindowState {
    /// Number of the next window, from 0.
    pub index: u64,
    /// Start of the next window [s].
    pub start: f64,
    /// Number of repetitions of windows.
    pub repeated: u64,
    /// Shortest and longest accepted window [s].
    pub lengths: Option<(f64, f64)>,
    length: f64,
    /// Whether the next window is a repetition.
    again: bool,
    /// Error of the last window over its bound.
    last_error: Option<f64>,
    local: LocalError,
}

/// Controls the windows of a run.
#[derive(Clone, Debug)]
pub struct Controller {
    windows: Windows,
    state: WindowState,
}

impl Controller {
    /// Creates a controller at time 0.
    #[must_use]
    pub fn new(windows: Windows) -> Self {
        let length = match &windows {
            Windows::Steady | Windows::Sequence(_) => 0.0,
            Windows::Fixed { window, .. } => *window,
            Windows::Open { window } => window.unwrap_or(0.0),
            Windows::Adaptive { shortest, .. } => *shortest,
        };
        let state = WindowState {
            index: 0,
            start: 0.0,
            repeated: 0,
            lengths: None,
            length,
            again: false,
            last_error: None,
            local: LocalError::default(),
        };
        Self { windows, state }
    }

    /// Continues from a state given by [`Controller::state`] of the same windows.
    #[must_use]
    pub fn resume(windows: Windows, state: WindowState) -> Self {
        Self { windows, state }
    }

    /// Returns the data that determine the next window.
    #[must_use]
    pub fn state(&self) -> &WindowState {
        &self.state
    }

    /// Returns whether the windows are adaptive.
    #[must_use]
    pub fn is_adaptive(&self) -> bool {
        matches!(self.windows, Windows::Adaptive { .. })
    }

    /// Returns the next window; `None` at the end of the run.
    #[must_use]
    pub fn window(&self) -> Option<Step> {
        let WindowState { index, start, length, .. } = self.state;
        let over = match &self.windows {
            Windows::Adaptive { end, .. } => start >= *end,
            Windows::Open { .. } => false,
            Windows::Steady | Windows::Sequence(_) | Windows::Fixed { .. } => {
                Some(index) == self.windows.count()
            }
        };
        let (start, end) = self.windows.interval(index, start, length);
        (!over).then_some(Step { window: index, iteration: 0, start, end })
    }

    /// Skips the window `step`, which has no result.
    pub fn pass_over(&mut self, step: &Step) {
        self.state.index += 1;
        self.state.start = step.end;
    }

    /// Judges the solved window `step` and moves on if it is accepted. `wanted` is a shorter length
    /// \[s\] that a participant requests; `fields` are the exchanged values at the end of the
    /// window.
    pub fn judge<'a>(
        &mut self,
        step: &Step,
        converged: bool,
        wanted: Option<f64>,
        fields: impl IntoIterator<Item = &'a [f64]> + Clone,
    ) -> Acceptance {
        let duration = step.duration();
        if let Windows::Adaptive { tolerance, shortest, longest, .. } = self.windows {
            let bound = 4.0 * tolerance * tolerance;
            let error = self.state.local.estimate(duration, fields.clone());
            let error = error.map(|error| error / bound);
            let shorter = shorter(duration, converged, wanted, error);
            let can_shorten = duration > shortest * (1.0 + ROUNDING);
            if let Some((cause, length)) = shorter.filter(|_| can_shorten) {
                let cause = match cause {
                    Cause::Error(error) => Cause::Error(error * bound),
                    other => other,
                };
                self.state.length = length.clamp(shortest, longest);
                self.state.again = true;
                self.state.repeated += 1;
                return Acceptance::Repeat(cause);
            }
            self.plan_next(duration, wanted, error);
            self.state.length = self.state.length.clamp(shortest, longest);
            self.state.local.accept(duration, fields);
        }
        let (least, most) = self.state.lengths.unwrap_or((duration, duration));
        self.state.lengths = Some((least.min(duration), most.max(duration)));
        self.state.index += 1;
        self.state.start = step.end;
        self.state.again = false;
        Acceptance::Accept
    }

    /// Sets the next length, after a window of this duration with this error over its bound.
    fn plan_next(&mut self, duration: f64, wanted: Option<f64>, error: Option<f64>) {
        let state = &mut self.state;
        let jumped = error.is_some_and(is_too_large);
        let next = match error {
            _ if jumped => duration,
            None => duration,
            Some(error) => {
                let last = state.last_error.unwrap_or(error).max(f64::MIN_POSITIVE);
                let change = SAFETY * error.powf(-INTEGRAL) * last.powf(PROPORTIONAL);
                let most = if state.again { 1.0 } else { CHANGE.1 };
                duration * change.clamp(CHANGE.0, most)
            }
        };
        if jumped {
            state.local.forget();
        }
        state.last_error = error.filter(|error| !jumped && *error > 0.0);
        state.length = wanted.map_or(next, |wanted| next.min(wanted));
    }
}

/// Returns whether an error over its bound is too large; NaN counts as too large.
fn is_too_large(error: f64) -> bool {
    error > 1.0 || error.is_nan()
}

/// Returns why and to which length a window must be shortened, if so; `error` is over its bound.
fn shorter(
    duration: f64,
    converged: bool,
    wanted: Option<f64>,
    error: Option<f64>,
) -> Option<(Cause, f64)> {
    let wanted = wanted.filter(|wanted| *wanted < duration * (1.0 - ROUNDING));
    let wanted = wanted.map(|wanted| (Cause::Wanted(wanted), wanted));
    let halved = (!converged).then_some((Cause::NotConverged, 0.5 * duration));
    let error = error.filter(|error| is_too_large(*error)).map(|error| {
        let change = (SAFETY * error.powf(-0.5)).clamp(REPEAT.0, REPEAT.1);
        let change = if change.is_nan() { REPEAT.0 } else { change };
        (Cause::Error(error), change * duration)
    });
    let causes = [halved, wanted, error].into_iter().flatten();
    causes.min_by(|(_, a), (_, b)| a.total_cmp(b))
}

#[cfg(test)]
mod tests {
    use super::*;

    const SETTINGS: Windows =
        Windows::Adaptive { tolerance: 1e-2, shortest: 1e-5, longest: 2.0, end: 10.0 };

    /// Solves y′ = f(t) − y from y = 0 by backward Euler, window by window. Returns the accepted
    /// ends and the number of solves.
    fn march(windows: Windows, f: impl Fn(f64) -> f64) -> (Vec<(f64, f64)>, u64) {
        let mut controller = Controller::new(windows);
        let (mut y, mut ends, mut solves) = (0.0, vec![(0.0, 0.0)], 0);
        while let Some(step) = controller.window() {
            let h = step.duration();
            assert!(h > 0.0 && solves < 1_000_000);
            let next = (y + h * f(step.end)) / (1.0 + h);
            solves += 1;
            if controller.judge(&step, true, None, [[next].as_slice()]) == Acceptance::Accept {
                y = next;
                ends.push((step.end, y));
            }
        }
        (ends, solves)
    }

    fn worst(ends: &[(f64, f64)], exact: impl Fn(f64) -> f64) -> f64 {
        ends.iter().map(|(t, y)| (y - exact(*t)).abs()).fold(0.0, f64::max)
    }

    /// The error of a step response is within the tolerance and proportional to it.
    #[test]
    fn the_error_follows_the_tolerance_and_the_windows_grow() {
        let exact = |t: f64| 1.0 - (-t).exp();
        let errors: Vec<(f64, u64)> = [1e-2, 5e-3, 2.5e-3]
            .map(|tolerance| {
                let Windows::Adaptive { shortest, longest, end, .. } = SETTINGS else {
                    unreachable!("adaptive")
                };
                let windows = Windows::Adaptive { tolerance, shortest, longest, end };
                let (ends, solves) = march(windows, |_| 1.0);
                assert_eq!(ends.last().unwrap().0, 10.0, "the end is met exactly");
                let error = worst(&ends, exact);
                assert!(error < tolerance, "{tolerance}: {error}");
                (error, solves)
            })
            .into();
        for pair in errors.windows(2) {
            let order = (pair[0].0 / pair[1].0).log2();
            assert!((0.7..1.3).contains(&order), "{errors:?}");
        }
    }

    /// A cold half-space heated from t = 0 by a flux q that falls with its temperature: T(t) = ∫ q
    /// ds/(2√(t − s)), q = 1 − cT, so that q = e^{γ²t} erfc(γ√t) with γ = c√π/2 by Laplace's
    /// transform. Within a window q is the flux at the temperature of its end. The work up to the
    /// end keeps the tolerance and its error falls with it, though q falls by a fifth within one
    /// window of the case.
    #[test]
    fn the_first_windows_keep_the_tolerance() {
        const FALLS: f64 = 1.3;
        let gamma = 0.5 * FALLS * std::f64::consts::PI.sqrt();
        // ∫ q dt = Σ (−γ)ⁿ/Γ(n/2 + 2) up to the time 1.
        let mut halves = [1.0, 0.75 * std::f64::consts::PI.sqrt()];
        let mut exact = 0.0;
        for n in 0..80 {
            exact += (-gamma).powi(n) / halves[0];
            halves = [halves[1], halves[0] * (f64::from(n) / 2.0 + 2.0)];
        }
        let off = |tolerance: f64| {
            let window = 1.0 / 30.0;
            let (shortest, longest, end) = (window / 1024.0, 1.0, 1.0);
            let windows = Windows::Adaptive { tolerance, shortest, longest, end };
            let mut controller = Controller::new(windows);
            let (mut ends, mut heats, mut work) = (vec![0.0], Vec::new(), 0.0);
            while let Some(step) = controller.window() {
                let past = ends.windows(2).zip(&heats).map(|(of, heat): (&[f64], &f64)| {
                    heat * ((step.end - of[0]).sqrt() - (step.end - of[1]).sqrt())
                });
                let own = step.duration().sqrt();
                let temperature = (past.sum::<f64>() + own) / (1.0 + FALLS * own);
                let heat = 1.0 - FALLS * temperature;
                let fields = [[temperature], [heat]];
                let verdict =
                    controller.judge(&step, true, None, fields.each_ref().map(|f| f.as_slice()));
                if verdict == Acceptance::Accept {
                    work += heat * step.duration();
                    ends.push(step.end);
                    heats.push(heat);
                }
            }
            println!("{tolerance}: {} windows, {:e}", heats.len(), work / exact - 1.0);
            (work / exact - 1.0).abs()
        };
        let tolerances = [1e-2, 1e-3, 1e-4];
        let errors = tolerances.map(off);
        for (error, tolerance) in errors.iter().zip(tolerances) {
            assert!(*error < 0.7 * tolerance, "{errors:?}");
        }
        assert!(errors.windows(2).all(|pair| pair[1] < 0.2 * pair[0]), "{errors:?}");
    }

    /// At a step in the middle, windows shrink to the shortest and grow again behind it.
    #[test]
    fn a_jump_is_found_and_left_behind() {
        let jump = |t: f64| if t > std::f64::consts::PI { 2.0 } else { 1.0 };
        let exact = |t: f64| {
            let after = (t - std::f64::consts::PI).max(0.0);
            1.0 - (-t).exp() + (1.0 - (-after).exp())
        };
        let (ends, solves) = march(SETTINGS, jump);
        assert!(worst(&ends, exact) < 1e-2, "{}", worst(&ends, exact));
        let lengths: Vec<f64> = ends.windows(2).map(|pair| pair[1].0 - pair[0].0).collect();
        let at = ends.iter().position(|(t, _)| *t > std::f64::consts::PI).unwrap();
        let before = lengths[..at - 1].iter().copied().fold(0.0, f64::max);
        assert!(lengths[at - 1] < 0.1 * before, "{} after {before}", lengths[at - 1]);
        assert!(*lengths.last().unwrap() > 0.1, "windows are long at the end");
        assert!(solves < 400, "{solves}");
    }

    /// Returns a controller that has accepted windows without an error until the next one has at
    /// least this length.
    fn grown(length: f64) -> Controller {
        let mut controller = Controller::new(SETTINGS);
        while let Some(step) = controller.window().filter(|step| step.duration() < length) {
            let verdict = controller.judge(&step, true, None, [[0.0].as_slice()]);
            assert_eq!(verdict, Acceptance::Accept);
        }
        controller
    }

    #[test]
    fn what_does_not_converge_is_halved_down_to_the_shortest() {
        let mut controller = grown(0.01);
        let first = controller.window().unwrap();
        let repeated = controller.state().repeated;
        let mut lengths = Vec::new();
        loop {
            let step = controller.window().unwrap();
            lengths.push(step.duration());
            let verdict = controller.judge(&step, false, None, [[0.0].as_slice()]);
            assert_eq!((step.window, step.start), (first.window, first.start));
            match verdict {
                Acceptance::Repeat(cause) => assert_eq!(cause, Cause::NotConverged),
                Acceptance::Accept => break,
            }
        }
        for pair in lengths[..lengths.len() - 1].windows(2) {
            // The end of a window is rounded.
            assert!((pair[1] / pair[0] - 0.5).abs() < ROUNDING, "{lengths:?}");
        }
        assert!((lengths.last().unwrap() / 1e-5 - 1.0).abs() < ROUNDING, "{lengths:?}");
        assert_eq!(controller.state().repeated - repeated, lengths.len() as u64 - 1);
    }

    #[test]
    fn a_wish_is_obeyed_exactly_and_bounds_the_next_window() {
        let mut controller = grown(0.01);
        let step = controller.window().unwrap();
        let verdict = controller.judge(&step, true, Some(0.004), [[0.0].as_slice()]);
        assert_eq!(verdict, Acceptance::Repeat(Cause::Wanted(0.004)));
        let step = controller.window().unwrap();
        assert_eq!(step.end, step.start + 0.004);
        for _ in 0..5 {
            let step = controller.window().unwrap();
            assert!(step.duration() <= 0.004 * (1.0 + ROUNDING));
            let verdict = controller.judge(&step, true, Some(0.004), [[0.0].as_slice()]);
            assert_eq!(verdict, Acceptance::Accept);
        }
        // No request and no error: windows grow by at most a factor of four.
        let step = controller.window().unwrap();
        controller.judge(&step, true, None, [[0.0].as_slice()]);
        let next = controller.window().unwrap();
        assert!((next.duration() / step.duration() - 4.0).abs() < 1e-9);
    }

    #[test]
    fn fixed_windows_are_always_accepted() {
        let mut controller = Controller::new(Windows::Fixed { window: 0.4, end: 1.0 });
        let mut ends = Vec::new();
        while let Some(step) = controller.window() {
            ends.push(step.end);
            let none: [&[f64]; 0] = [];
            assert_eq!(controller.judge(&step, false, Some(0.1), none), Acceptance::Accept);
        }
        assert_eq!(ends, [0.4, 0.8, 1.0]);
        assert_eq!(controller.state().repeated, 0);
    }
}

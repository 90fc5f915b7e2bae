//! Steps through the iterations and windows of a run.

use crate::index::Step;

contract::words! {
    /// Step to go to, relative to the given one.
    #[derive(Default)]
    pub(crate) enum Move {
        /// The given step.
        #[default]
        Stay = "stay",
        /// The next iteration.
        Next = "next",
        /// The iteration before.
        Previous = "previous",
        /// The last iteration of the next window.
        NextWindow = "next-window",
        /// The last iteration of the window before.
        PreviousWindow = "previous-window",
        /// The first step.
        First = "first",
        /// The newest step.
        Last = "last",
    }
}

/// Returns the step to show; `None` if there is none.
pub(crate) fn arrive(steps: &[Step], from: usize, go: Move) -> Option<usize> {
    let last = steps.len().checked_sub(1)?;
    let from = from.min(last);
    let window = steps[from].window;
    let starts = |step: &usize| *step == 0 || steps[step - 1].window != steps[*step].window;
    let end = |step: usize| {
        let window = steps[step].window;
        (step..=last).take_while(|step| steps[*step].window == window).last().unwrap_or(step)
    };
    Some(match go {
        Move::Stay => from,
        Move::Next => (from + 1).min(last),
        Move::Previous => from.saturating_sub(1),
        Move::NextWindow => {
            let next = (from..=last).find(|step| steps[*step].window != window);
            next.map_or(last, end)
        }
        Move::PreviousWindow => {
            let first = (0..=from).rev().find(starts).unwrap_or(0);
            first.saturating_sub(1)
        }
        Move::First => 0,
        Move::Last => last,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn steps(windows: &[u64]) -> Vec<Step> {
        let step = |(n, window): (usize, &u64)| Step {
            window: *window,
            iteration: 1,
            interval: [0.0; 2],
            residual: None,
            nanoseconds: n as u64,
        };
        windows.iter().enumerate().map(step).collect()
    }

    #[test]
    fn windows_are_entered_at_their_last_iteration() {
        let steps = steps(&[0, 0, 1, 1, 1, 2]);
        let go = |from, go| arrive(&steps, from, go).unwrap();
        assert_eq!(go(0, Move::NextWindow), 4);
        assert_eq!(go(4, Move::NextWindow), 5);
        assert_eq!(go(5, Move::NextWindow), 5);
        assert_eq!(go(3, Move::PreviousWindow), 1);
        assert_eq!(go(1, Move::PreviousWindow), 0);
        assert_eq!((go(2, Move::Next), go(2, Move::Previous)), (3, 1));
        assert_eq!((go(9, Move::Stay), go(0, Move::Last), go(3, Move::First)), (5, 5, 0));
        assert_eq!(arrive(&[], 0, Move::Last), None);
    }
}

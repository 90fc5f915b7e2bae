//! Root of a function that is expensive to evaluate: secant iteration, kept within a bracket once
//! one is known.

/// Most evaluations of the function.
const MOST: usize = 60;
/// Largest ratio of a step to the previous one while there is no bracket.
const GROWTH: f64 = 4.0;

/// Start and range of a search for a root.
#[derive(Clone, Copy, Debug)]
pub(super) struct RootSearch {
    /// First abscissa.
    pub(super) first: f64,
    /// Approximate slope at the first abscissa.
    pub(super) slope: f64,
    /// Length limit of the first step.
    pub(super) reach: f64,
    /// Lower and upper limit of the abscissa.
    pub(super) range: [f64; 2],
}

/// Result of a search for a root.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Found {
    /// Abscissa of the result.
    pub(super) place: f64,
    /// Function value there.
    pub(super) value: f64,
    /// Last estimate of the slope.
    pub(super) slope: f64,
    /// True if the value is within its tolerance; the result is then the last abscissa. Otherwise
    /// the result is the nearest to a root.
    pub(super) met: bool,
}

impl RootSearch {
    /// Finds an abscissa whose value is within the tolerance that the function returns with it.
    ///
    /// # Errors
    /// Passes on errors of the function.
    pub(super) fn root<E>(
        &self,
        mut function: impl FnMut(f64) -> Result<(f64, f64), E>,
    ) -> Result<Found, E> {
        let [least, most] = self.range;
        let mut ends: [Option<f64>; 2] = [None, None];
        let mut last: Option<Found> = None;
        let (mut place, mut longest) = (self.first, self.reach);
        let mut nearest = Found { place, value: f64::INFINITY, slope: self.slope, met: false };
        for _ in 0..MOST {
            let (value, tolerance) = function(place)?;
            let secant = |last: &Found| (value - last.value) / (place - last.place);
            let slope = last.as_ref().map_or(self.slope, secant);
            let found = Found { place, value, slope, met: value.abs() <= tolerance };
            if found.met {
                return Ok(found);
            }
            if value.abs() < nearest.value.abs() {
                nearest = found;
            }
            ends[usize::from(value > 0.0)] = Some(place);
            let wanted = place - value / slope;
            let next = if let [Some(one), Some(other)] = ends {
                let [low, high] = [one.min(other), one.max(other)];
                if wanted > low && wanted < high { wanted } else { 0.5 * (low + high) }
            } else {
                // Direction given by the first slope.
                let towards = -value.signum() * self.slope.signum();
                let step = wanted - place;
                let step = if step * towards > 0.0 { step.abs().min(longest) } else { longest };
                longest = GROWTH * step;
                (place + towards * step).clamp(least, most)
            };
            if next == place {
                break;
            }
            last = Some(found);
            place = next;
        }
        Ok(nearest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn search(first: f64, slope: f64) -> RootSearch {
        RootSearch { first, slope, reach: 1e-3, range: [-2.0, 2.0] }
    }

    fn root(search: &RootSearch, function: impl Fn(f64) -> f64) -> (Found, usize) {
        let mut count = 0;
        let found = search.root(|place| {
            count += 1;
            Ok::<_, ()>((function(place), 1e-9))
        });
        (found.unwrap(), count)
    }

    /// A line, a curve with flat ends, a jump, and a function without root.
    #[test]
    fn roots_are_found_or_are_not_there() {
        let (line, count) = root(&search(0.1, -1.5), |x| 0.3 - 1.4 * x);
        assert!(
            line.met && (line.place - 0.3 / 1.4).abs() < 1e-9 && (line.slope + 1.4).abs() < 1e-6
        );
        assert!(count < 9, "{count}");
        let (flat, count) = root(&search(0.0, -1.0), |x| -(300.0 * (x - 0.02)).tanh());
        assert!(flat.met && (flat.place - 0.02).abs() < 1e-11 && count < 25, "{flat:?} {count}");
        let (jump, _) = root(&search(0.0, -1.0), |x| if x < 0.7 { 1.0 } else { -1.0 });
        assert!(!jump.met);
        let (none, _) = root(&search(0.0, -1.0), |x| 1.0 + (-x).exp());
        assert!(!none.met && none.place == 2.0);
        assert_eq!(root(&search(0.25, 1.0), |x| x - 0.25).1, 1);
    }
}

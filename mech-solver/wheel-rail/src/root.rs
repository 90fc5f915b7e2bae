//! The root of a function that is dear to evaluate: by secants, which stay within a bracket as soon as there is one.

/// Values of the function that are taken at most.
const MOST: usize = 60;
/// A step without a bracket is no more than this over the one before.
const GROWTH: f64 = 4.0;

/// Range of a search for a root, and its start.
#[derive(Clone, Copy, Debug)]
pub(super) struct RootSearch {
    /// The first place.
    pub(super) first: f64,
    /// Slope there, about.
    pub(super) slope: f64,
    /// The first step is no longer than this.
    pub(super) reach: f64,
    /// Places lie between these.
    pub(super) range: [f64; 2],
}

/// A place and its value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Found {
    /// The place.
    pub(super) place: f64,
    /// The value there.
    pub(super) value: f64,
    /// Slope at last.
    pub(super) slope: f64,
    /// The value is within its tolerance, and the place was the last one; else it is the nearest to a root.
    pub(super) met: bool,
}

impl RootSearch {
    /// Looks for a place whose value is within the tolerance that the function gives with it.
    ///
    /// # Errors
    /// Errors of the function.
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
                // The way that the first slope says.
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

    /// A line, a curve that is flat at its ends, a jump, and none.
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

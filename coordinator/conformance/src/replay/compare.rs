//! What the participant sends now against what it sent then.

use contract::message::FieldHeader;
use contract::step::Step;
use serde::Serialize;

/// What was compared, and how it differs.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(crate) struct Comparison {
    /// Samples compared.
    pub samples: u64,
    /// Values compared.
    pub values: u64,
    /// Samples in which some value differs by a bit or more.
    pub unequal_samples: u64,
    /// Samples that differ by more than the tolerance.
    pub different_samples: u64,
    /// The first of those.
    pub first: Option<Difference>,
    /// What differs besides fields: a layout, a summary, the way it fails.
    pub other: Option<String>,
    /// Largest difference of all, relative to the largest value of its sample.
    pub largest: f64,
    /// Largest difference of each step from the first difference on.
    pub growth: Growth,
}

/// The first value that differs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Difference {
    /// Number of the window.
    pub window: u64,
    /// Iteration within it.
    pub iteration: u32,
    /// Name of the field.
    pub field: String,
    /// SI unit.
    pub unit: String,
    /// Index of the value, component-major.
    pub index: usize,
    /// Its component.
    pub component: usize,
    /// As recorded.
    pub recorded: f64,
    /// As it is now.
    pub now: f64,
    /// Difference relative to the largest value of the sample.
    pub relative: f64,
}

/// Differences over time; long ones thinned out to every second step again and again.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(crate) struct Growth {
    /// From the first difference on.
    pub steps: Vec<StepDifference>,
    #[serde(skip)]
    stride: u64,
    #[serde(skip)]
    seen: u64,
}

/// Largest difference in a step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct StepDifference {
    /// Number of the window.
    pub window: u64,
    /// Iteration within it.
    pub iteration: u32,
    /// Relative to the largest value of its sample.
    pub relative: f64,
}

/// Steps of [`Growth`] that are kept at most.
const KEPT: usize = 64;

impl Comparison {
    /// Something differs by more than the tolerance.
    #[must_use]
    pub(crate) fn differs(&self) -> bool {
        self.first.is_some() || self.other.is_some()
    }

    /// Compares a sample with the recorded one; `tolerance` as in [`super::Request`].
    pub(super) fn sample(
        &mut self,
        recorded: (&FieldHeader, &[f64]),
        now: &[f64],
        tolerance: Option<f64>,
    ) {
        let (header, then) = recorded;
        self.samples += 1;
        self.values += then.len() as u64;
        if then.len() != now.len() {
            let name = header.name.as_str();
            let (a, b) = (now.len(), then.len());
            self.other.get_or_insert(format!("`{name}` has {a} values, the recording has {b}"));
            return;
        }
        let same = |(a, b): (&f64, &f64)| a.to_bits() == b.to_bits();
        if then.iter().zip(now).all(same) {
            self.step(header, 0.0);
            return;
        }
        self.unequal_samples += 1;
        let scale = then.iter().copied().filter(|v| v.is_finite()).fold(0.0, |m, v| v.abs().max(m));
        let relative = |a: f64, b: f64| match (a - b).abs() {
            _ if a.to_bits() == b.to_bits() => 0.0,
            difference if difference.is_finite() && scale > 0.0 => difference / scale,
            difference if difference.is_finite() => difference,
            _ => f64::INFINITY,
        };
        let pairs = || then.iter().zip(now);
        let worst = pairs().map(|(a, b)| relative(*a, *b)).fold(0.0, f64::max);
        self.largest = self.largest.max(worst);
        let passes = |a: f64, b: f64| match tolerance {
            None => a.to_bits() == b.to_bits(),
            Some(tolerance) => relative(a, b) <= tolerance,
        };
        if let Some(index) = pairs().position(|(a, b)| !passes(*a, *b)) {
            self.different_samples += 1;
            self.first.get_or_insert_with(|| Difference {
                window: header.window,
                iteration: header.iteration,
                field: header.name.as_str().to_owned(),
                unit: header.unit.as_str().to_owned(),
                index,
                component: index / (then.len() / header.components.max(1) as usize).max(1),
                recorded: then[index],
                now: now[index],
                relative: relative(then[index], now[index]),
            });
        }
        self.step(header, worst);
    }

    /// The largest difference of a step, from the first difference on.
    fn step(&mut self, header: &FieldHeader, relative: f64) {
        if self.first.is_some() {
            self.growth.add(header.window, header.iteration, relative);
        }
    }

    /// A step whose reply differs in what is no field.
    pub(super) fn other(&mut self, step: &Step, what: &str) {
        let (window, iteration) = (step.window, step.iteration);
        let place = || format!("in window {window}, iteration {iteration}: {what}");
        self.other.get_or_insert_with(place);
    }
}

impl Growth {
    fn add(&mut self, window: u64, iteration: u32, relative: f64) {
        if let Some(last) = self.steps.last_mut()
            && (last.window, last.iteration) == (window, iteration)
        {
            last.relative = last.relative.max(relative);
            return;
        }
        self.seen += 1;
        if !self.seen.is_multiple_of(self.stride.max(1)) && !self.steps.is_empty() {
            return;
        }
        self.steps.push(StepDifference { window, iteration, relative });
        if self.steps.len() >= KEPT {
            let mut index = 0;
            self.steps.retain(|_| {
                index += 1;
                index % 2 == 1
            });
            self.stride = self.stride.max(1) * 2;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use contract::message::Label;

    fn header(window: u64, components: u32) -> FieldHeader {
        let (name, unit) = (Label::new("lower_temperature"), Label::new("K"));
        FieldHeader { window, iteration: 1, components, name, unit, ..FieldHeader::default() }
    }

    #[test]
    fn a_bit_is_a_difference_unless_it_is_tolerated() {
        let then = [1.0, -4.0, 2.0, 0.0];
        let now = [1.0, -4.0, 2.0 + 4e-12, 0.0];
        let mut strict = Comparison::default();
        strict.sample((&header(3, 2), &then), &now, None);
        let first = strict.first.clone().unwrap();
        assert_eq!((first.window, first.index, first.component), (3, 2, 1));
        assert!((first.relative - 1e-12).abs() < 1e-15 && strict.differs());
        let mut loose = Comparison::default();
        loose.sample((&header(3, 2), &then), &now, Some(1e-11));
        assert!(!loose.differs());
        assert_eq!((loose.unequal_samples, loose.different_samples, loose.values), (1, 0, 4));
    }

    #[test]
    fn nan_equals_itself_and_nothing_else() {
        let mut comparison = Comparison::default();
        comparison.sample((&header(0, 1), &[f64::NAN]), &[f64::NAN], None);
        assert!(!comparison.differs());
        comparison.sample((&header(0, 1), &[1.0]), &[f64::NAN], Some(1e300));
        assert!(comparison.differs());
        comparison.sample((&header(0, 1), &[1.0]), &[1.0, 2.0], Some(1.0));
        assert!(comparison.other.unwrap().contains("has 2 values, the recording has 1"));
    }

    #[test]
    fn growth_is_reported_from_the_first_difference_on_and_stays_short() {
        let mut comparison = Comparison::default();
        comparison.sample((&header(0, 1), &[1.0]), &[1.0], None);
        for window in 1..10_000 {
            let off = 1.0 + window as f64 * 1e-6;
            comparison.sample((&header(window, 1), &[1.0]), &[off], None);
        }
        let steps = &comparison.growth.steps;
        assert_eq!(steps[0].window, 1);
        assert!(steps.len() < KEPT && steps.len() > KEPT / 4, "{}", steps.len());
        assert!(steps.is_sorted_by(|a, b| a.window < b.window && a.relative < b.relative));
    }
}

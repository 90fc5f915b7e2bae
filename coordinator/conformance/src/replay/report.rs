//! Report of a replay: compares everything the participant sends with the recording, as data and as
//! text.

use super::configuration::Request;
use contract::message::{FieldHeader, Reply};
use contract::step::Step;
use contract::text::one_line;
use run::format::{counted, number, seconds};
use serde::Serialize;
use serde_json::Value;
use std::fmt::Write as _;

/// Report of a replay.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(crate) struct Replay {
    /// Role of the driven participant.
    pub role: String,
    /// Driven program, with its version.
    pub program: String,
    /// Recorded program, with its version.
    pub recorded_program: String,
    /// Number of solves.
    pub solves: u64,
    /// First solved window, if not 0.
    pub from_window: u64,
    /// Last solved window.
    pub last_window: u64,
    /// Comparison with the recording.
    pub comparison: Comparison,
    /// Remarks, one line each.
    pub remarks: Vec<String>,
    /// Time in the model as recorded, for the replayed solves [s].
    pub recorded_model_s: f64,
    /// Time in the model in the replay [s].
    pub model_s: f64,
    /// Duration of the whole replay [s].
    pub wall_s: f64,
    /// Whether the recording, and thus the replay, is truncated.
    pub cut: bool,
    /// Damage of the recording, at which the replay ends.
    pub damage: Option<String>,
}

/// Comparison with the recording.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(crate) struct Comparison {
    /// Number of compared samples.
    pub samples: u64,
    /// Number of compared values.
    pub values: u64,
    /// Number of samples in which at least one value differs in any bit.
    pub unequal_samples: u64,
    /// Number of samples that differ by more than the tolerance.
    pub different_samples: u64,
    /// First difference above the tolerance.
    pub first: Option<Difference>,
    /// First difference outside of the fields: in a layout, a summary, a failure.
    pub other: Option<String>,
    /// Largest difference, relative to the largest value of its sample.
    pub largest: f64,
    /// Largest difference in each step, from the first difference on.
    pub growth: Growth,
}

/// First sample that differs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Difference {
    /// Number of the window.
    pub window: u64,
    /// Iteration within the window.
    pub iteration: u32,
    /// Name of the field.
    pub field: String,
    /// SI unit.
    pub unit: String,
    /// First value that differs.
    #[serde(flatten)]
    pub value: ValueDifference,
    /// Value of the same sample that differs most.
    pub largest: ValueDifference,
}

/// A value that differs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct ValueDifference {
    /// Index of the value, component-major.
    pub index: usize,
    /// Component of the value.
    pub component: usize,
    /// Recorded value.
    pub recorded: f64,
    /// Value in the replay.
    pub now: f64,
    /// Difference, relative to the largest value of the sample.
    pub relative: f64,
}

/// Differences over time. A long list is thinned repeatedly to every second step.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(crate) struct Growth {
    /// Differences from the first one on.
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
    /// Iteration within the window.
    pub iteration: u32,
    /// Largest difference, relative to the largest value of its sample.
    pub relative: f64,
}

/// Largest number of steps in [`Growth`].
const KEPT: usize = 64;

impl Comparison {
    /// Returns whether any difference exceeds the tolerance.
    #[must_use]
    pub(crate) fn differs(&self) -> bool {
        self.first.is_some() || self.other.is_some()
    }

    /// Compares a sample with the recorded one; `tolerance` as in [`Request`].
    pub(crate) fn sample(
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
        let value = |index: usize| ValueDifference {
            index,
            component: index / (then.len() / header.components.max(1) as usize).max(1),
            recorded: then[index],
            now: now[index],
            relative: relative(then[index], now[index]),
        };
        let larger = |a: ValueDifference, b: ValueDifference| {
            if b.relative > a.relative { b } else { a }
        };
        let most = (0..then.len()).map(value).reduce(larger);
        let worst = most.map_or(0.0, |most| most.relative);
        self.largest = self.largest.max(worst);
        let passes = |a: f64, b: f64| match tolerance {
            None => a.to_bits() == b.to_bits(),
            Some(tolerance) => relative(a, b) <= tolerance,
        };
        if let Some(first) = pairs().position(|(a, b)| !passes(*a, *b)) {
            self.different_samples += 1;
            self.first.get_or_insert_with(|| Difference {
                window: header.window,
                iteration: header.iteration,
                field: header.name.as_str().to_owned(),
                unit: header.unit.as_str().to_owned(),
                value: value(first),
                largest: most.unwrap_or_else(|| value(first)),
            });
        }
        self.step(header, worst);
    }

    /// Notes the largest difference of a step, from the first difference on.
    fn step(&mut self, header: &FieldHeader, relative: f64) {
        if self.first.is_some() {
            self.growth.add(header.window, header.iteration, relative);
        }
    }

    /// Notes a difference of a step outside of the fields.
    pub(crate) fn other(&mut self, step: &Step, what: &str) {
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

/// Returns the first difference between two replies, except in times.
pub(super) fn unequal(now: &Reply, then: &Reply, tolerance: Option<f64>) -> Option<String> {
    let floats = [
        ("the power it receives", now.received_power(), then.received_power()),
        ("the window it wants", now.wanted_window(), then.wanted_window()),
    ];
    let within = |a: Option<f64>, b: Option<f64>| match (a, b, tolerance) {
        (Some(a), Some(b), _) if a.to_bits() == b.to_bits() => true,
        (Some(a), Some(b), Some(tolerance)) => (a - b).abs() <= tolerance * b.abs(),
        _ => a.is_none() && b.is_none(),
    };
    if let Some((what, a, b)) = floats.into_iter().find(|(_, a, b)| !within(*a, *b)) {
        let text = |value: Option<f64>| value.map_or("absent".to_owned(), |v| format!("{v:e}"));
        return Some(format!("{what} is {}, recorded {}", text(a), text(b)));
    }
    let counts = [
        ("its work", now.work, then.work),
        ("substeps", now.substeps.into(), then.substeps.into()),
        ("inner iterations", now.inner_iterations.into(), then.inner_iterations.into()),
    ];
    let differs = counts.into_iter().find(|(_, a, b)| a != b && tolerance.is_none());
    differs.map(|(what, a, b)| format!("{what}: {a}, recorded {b}"))
}

/// Returns the difference between the labels of two samples, except in sequence number and
/// protocol.
pub(crate) fn mislabelled(now: &FieldHeader, then: &FieldHeader) -> Option<String> {
    let now = FieldHeader { sequence: then.sequence, protocol: then.protocol, ..*now };
    (now != *then).then(|| {
        let name = then.name.as_str();
        format!("`{name}` is labelled {now:?}, recorded {then:?}")
    })
}

/// Returns the first key in which two trees differ, with both values.
pub(crate) fn first_unequal(
    now: &Value,
    then: &Value,
    key: String,
) -> Option<(String, Value, Value)> {
    match (now, then) {
        (Value::Object(a), Value::Object(b)) => {
            let names = a.keys().chain(b.keys().filter(|name| !a.contains_key(*name)));
            names.into_iter().find_map(|name| {
                let of = |table: &serde_json::Map<String, Value>| {
                    table.get(name).cloned().unwrap_or(Value::Null)
                };
                let key = if key.is_empty() { name.clone() } else { format!("{key}.{name}") };
                first_unequal(&of(a), &of(b), key)
            })
        }
        (a, b) if a == b => None,
        (a, b) => Some((key, a.clone(), b.clone())),
    }
}

/// Describes the replay in a few lines: program, extent, first difference and its growth.
pub(super) fn text(replay: &Replay, request: &Request) -> String {
    let mut out = format!(
        "replay of {} by {} from {}\n",
        replay.role,
        one_line(&replay.program),
        request.recording.display()
    );
    if replay.program != replay.recorded_program {
        let _ = writeln!(out, "  recorded was {}", one_line(&replay.recorded_program));
    }
    for remark in &replay.remarks {
        let _ = writeln!(out, "  {}", one_line(remark));
    }
    let compared = &replay.comparison;
    let _ = writeln!(
        out,
        "  windows {} to {}: {}, {} of {} compared{}",
        replay.from_window,
        replay.last_window,
        counted(replay.solves, "solve"),
        counted(compared.samples, "sample"),
        counted(compared.values, "value"),
        if replay.cut { "; the recording is truncated here" } else { "" }
    );
    let verdict = match (compared.differs(), request.tolerance) {
        (false, _) if compared.samples == 0 => "  nothing to compare".to_owned(),
        (false, None) => "  bit-identical".to_owned(),
        (false, Some(tolerance)) => format!(
            "  within {tolerance:e} of the recording except for {}, by {} at most",
            counted(compared.unequal_samples, "sample"),
            number(compared.largest, 3)
        ),
        (true, _) if compared.first.is_none() => "  DIFFERS, though not in its fields".to_owned(),
        (true, _) => format!("  DIFFERS in {}", counted(compared.different_samples, "sample")),
    };
    let _ = writeln!(out, "{verdict}");
    if let Some(first) = &compared.first {
        let _ = writeln!(out, "  first     {}", difference(first));
        let growth = growth_lines(&compared.growth).join("\n            ");
        let _ = writeln!(out, "  growth    {growth}");
    }
    if let Some(other) = &compared.other {
        let word = if compared.first.is_some() { "also" } else { "what" };
        let _ = writeln!(out, "  {word}      {}", one_line(other));
    }
    if let Some(damage) = &replay.damage {
        let _ =
            writeln!(out, "  the recording cannot be read beyond this point: {}", one_line(damage));
    }
    let _ = writeln!(
        out,
        "  time      {} in the model, {} when recorded; {} in all",
        seconds(replay.model_s),
        seconds(replay.recorded_model_s),
        seconds(replay.wall_s)
    );
    out
}

/// Describes the first difference in one line: the first value that differs, and the one of the
/// sample that differs most. The first value may differ by rounding only.
pub(crate) fn difference(first: &Difference) -> String {
    let Difference { window, iteration, field, unit, value, largest } = first;
    let told = |of: &ValueDifference| {
        let ValueDifference { index, now, recorded, relative, .. } = of;
        format!(
            "{field}[{index}] is {now:e} {unit}, recorded {recorded:e} {unit} (off by \
             {relative} of the largest value)",
            relative = number(*relative, 4)
        )
    };
    let most = match value.index == largest.index {
        true => String::new(),
        false => format!("; largest difference of the sample: {}", told(largest)),
    };
    format!("window {window}, iteration {iteration}: {}{most}", told(value))
}

/// Returns at most nine steps of the growth, including the last.
pub(crate) fn growth_lines(growth: &Growth) -> Vec<String> {
    let steps = &growth.steps;
    let stride = steps.len().div_ceil(8).max(1);
    let last = steps.len().saturating_sub(1);
    let chosen = move |(n, _): &(usize, _)| n.is_multiple_of(stride) || *n == last;
    let line = |step: &StepDifference| {
        format!(
            "window {}, iteration {}: {}",
            step.window,
            step.iteration,
            number(step.relative, 4)
        )
    };
    steps.iter().enumerate().filter(chosen).map(|(_, step)| line(step)).collect()
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
        assert_eq!((first.window, first.value.index, first.value.component), (3, 2, 1));
        assert!((first.value.relative - 1e-12).abs() < 1e-15 && strict.differs());
        assert_eq!(first.largest, first.value);
        let mut loose = Comparison::default();
        loose.sample((&header(3, 2), &then), &now, Some(1e-11));
        assert!(!loose.differs());
        assert_eq!((loose.unequal_samples, loose.different_samples, loose.values), (1, 0, 4));
    }

    /// The first value that differs may do so by rounding only, beside one that is wrong.
    #[test]
    fn the_largest_difference_of_the_sample_is_told() {
        let mut comparison = Comparison::default();
        let then = [1.0, 2.0, 4.0];
        comparison.sample((&header(3, 1), &then), &[1.0 + f64::EPSILON, 2.5, 4.0], None);
        let told = difference(&comparison.first.unwrap());
        assert!(
            told.contains("lower_temperature[0] is") && told.contains(" × 10⁻¹⁷ of the"),
            "{told}"
        );
        let most = "; largest difference of the sample: lower_temperature[1] is 2.5e0 K, recorded \
                    2e0 K (off by 0.1250 of the largest value)";
        assert!(told.ends_with(most), "{told}");
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

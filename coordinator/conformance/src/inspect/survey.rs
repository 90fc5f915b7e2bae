//! One pass over a recording: its content, and the range of every field.

use contract::bodies::Bodies;
use contract::configuration::Configuration;
use contract::grid::{Shape, Structured};
use contract::message::{CommandKind, FieldHeader};
use proto::recording::{End, Event, Item, Iteration, Recording};
use serde::Serialize;
use std::collections::BTreeMap;
use std::io::Read;

/// Parts of a recording to list one by one.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ListFilter {
    /// Only samples of this field: its name, or the end of the name of its topic.
    pub field: Option<String>,
    /// Only this window.
    pub window: Option<u64>,
    /// All iterations. Samples are only listed if a field or window is given too.
    pub iterations: bool,
}

impl ListFilter {
    /// Returns whether iterations or samples are to be listed.
    #[must_use]
    pub fn anything(&self) -> bool {
        self.samples() || self.iterations
    }

    fn samples(&self) -> bool {
        self.field.is_some() || self.window.is_some()
    }

    fn has_window(&self, window: u64) -> bool {
        self.window.is_none_or(|wanted| wanted == window)
    }

    /// Returns whether a sample belongs to the wanted field, named as in the contract or in the
    /// case.
    fn has_field(&self, service: &str, header: &FieldHeader, bodies: Option<&Bodies>) -> bool {
        self.field.as_deref().is_none_or(|wanted| {
            let named = bodies.map(|bodies| bodies.named(wanted));
            let name = header.name.as_str();
            name == wanted || named.as_deref() == Some(name) || service.ends_with(wanted)
        })
    }
}

/// Summary of a recording.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct RecordingSummary {
    /// Short name of the case.
    pub case: String,
    /// Name and version of the program that wrote the recording.
    pub writer: String,
    /// Names of the upper and the lower body, from the first configuration that has bodies.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bodies: Option<Bodies>,
    /// Coupling scheme.
    pub scheme: String,
    /// Acceleration method.
    pub acceleration: String,
    /// Whether the recording has its index and footer; otherwise it is truncated.
    pub complete: bool,
    /// Reason why the recording could not be read to its end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub damage: Option<String>,
    /// Number of bytes read.
    pub bytes: u64,
    /// Time from the first to the last message [s].
    pub duration_s: f64,
    /// Error that ended the run; also absent if the recording does not state it.
    pub error: Option<String>,
    /// Participants.
    pub participants: Vec<ParticipantSurvey>,
    /// Number of windows with an iteration.
    pub windows: u64,
    /// Number of iterations.
    pub iterations: u64,
    /// Largest number of iterations in a window.
    pub max_iterations_in_window: u32,
    /// Number of windows that were solved again with another end.
    pub repeated_windows: u64,
    /// Simulated time at the last iteration [s].
    pub end_s: f64,
    /// Residuals of the last iteration, by field.
    pub final_residuals: Vec<(String, f64)>,
    /// Largest relative difference between heat sent and received.
    pub energy_imbalance: Option<f64>,
    /// Time in which no model computed [s].
    pub coupling_s: f64,
    /// Topics.
    pub fields: Vec<FieldSurvey>,
    /// Requested iterations and samples.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub details: Option<Details>,
}

/// A participant in a recording.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ParticipantSurvey {
    /// Role of the participant.
    pub role: String,
    /// Program, with its version.
    pub program: String,
    /// Configured model.
    pub model: String,
    /// Number of solves.
    pub solves: u64,
    /// Number of states written or read.
    pub states: u64,
    /// Time spent in the model [s].
    pub model_s: f64,
}

/// A topic in a recording.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FieldSurvey {
    /// Name of the service.
    pub topic: String,
    /// SI unit.
    pub unit: String,
    /// Name of the grid.
    pub grid: String,
    /// Grid at the start of the run, if it has equal elements.
    pub geometry: Option<Structured>,
    /// Number of values in the newest sample.
    pub values: u64,
    /// Number of samples.
    pub samples: u64,
    /// Size of all values [byte].
    pub bytes: u64,
    /// Range over all samples.
    #[serde(flatten)]
    pub range: Range,
    /// Window and iteration of the first value that is not finite.
    pub non_finite_at: Option<(u64, u32)>,
}

/// Requested iterations and samples.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Details {
    /// Iterations of the requested windows.
    pub iterations: Vec<IterationSurvey>,
    /// Requested samples.
    pub samples: Vec<SampleSurvey>,
    /// Whether the lists end before the recording does.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub cut: bool,
    /// Number of listed values.
    #[serde(skip)]
    listed: usize,
}

/// Maximum number of listed values. A compressed recording of less than a megabyte can hold any
/// number of iterations.
const MOST_LISTED: usize = 1_000_000;

impl Details {
    /// Counts an entry of so many values. Returns whether there is room for it.
    fn takes(&mut self, values: usize) -> bool {
        self.listed += values;
        self.cut |= self.listed > MOST_LISTED;
        !self.cut
    }
}

/// An iteration.
pub(super) type IterationSurvey = Iteration;

/// A sample.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SampleSurvey {
    /// Name of the service.
    pub topic: String,
    /// Number of the window.
    pub window: u64,
    /// Iteration within the window.
    pub iteration: u32,
    /// Sequence number on the topic.
    pub sequence: u64,
    /// Time since the start of the recording [s].
    pub at_s: f64,
    /// Range of the values.
    #[serde(flatten)]
    pub range: Range,
}

/// Reads a recording to its end, or to the first damage.
pub fn survey<R: Read>(recording: &mut Recording<R>, wanted: &ListFilter) -> RecordingSummary {
    let mut taken = SurveyBuilder::of(recording, wanted);
    loop {
        let entry = match recording.read() {
            Ok(Some(entry)) => entry,
            Ok(None) => break,
            Err(error) => {
                taken.survey.damage = Some(error.to_string());
                break;
            }
        };
        taken.survey.duration_s = entry.nanoseconds as f64 * 1e-9;
        match entry.item {
            Item::Event(event) => {
                taken.grids(&event);
                taken.event(event);
            }
            Item::Sample { service, header, values } => {
                taken.sample(service, &header, values, entry.nanoseconds);
            }
            Item::State { role, .. } => taken.state(role),
        }
    }
    let mut survey = taken.survey;
    survey.complete = recording.end() == End::Complete;
    survey.bytes = recording.bytes_read();
    survey
}

/// Builder of a survey.
struct SurveyBuilder<'a> {
    survey: RecordingSummary,
    wanted: &'a ListFilter,
    /// Index of each topic.
    topics: BTreeMap<String, usize>,
    /// Grids of equal elements, by topic.
    grids: BTreeMap<String, Structured>,
    window: Option<u64>,
}

impl<'a> SurveyBuilder<'a> {
    fn of<R: Read>(recording: &Recording<R>, wanted: &'a ListFilter) -> Self {
        let head = recording.head();
        let participants = head.participants.iter().map(|p| ParticipantSurvey {
            role: p.role.clone(),
            program: format!("{} {}", p.description.name, p.description.version),
            ..ParticipantSurvey::default()
        });
        let survey = RecordingSummary {
            case: head.case.clone(),
            writer: head.writer.clone(),
            scheme: head.scheme.clone(),
            acceleration: head.acceleration.clone(),
            participants: participants.collect(),
            details: wanted.anything().then(Details::default),
            ..RecordingSummary::default()
        };
        Self { survey, wanted, topics: BTreeMap::new(), grids: BTreeMap::new(), window: None }
    }

    fn grids(&mut self, event: &Event) {
        // The reader reports damaged topics itself.
        let Ok(Some((_, topics))) = event.topics() else { return };
        for topic in topics.inputs.into_iter().chain(topics.outputs) {
            if let Shape::Structured(plane) = topic.grid.shape {
                self.grids.insert(topic.service, plane);
            }
        }
    }

    fn event(&mut self, event: Event) {
        match event {
            Event::Command { participant, command, body } => {
                let one = &mut self.survey.participants[usize::from(participant)];
                match CommandKind::from_number(command.kind) {
                    Some(CommandKind::Solve) => one.solves += 1,
                    Some(CommandKind::Configure) => {
                        // The reader reports a damaged configuration itself.
                        if let Ok(given) = serde_json::from_slice::<Configuration>(&body) {
                            one.model = given.model;
                            let bodies = || Bodies::read(&given.case).ok();
                            self.survey.bodies = self.survey.bodies.take().or_else(bodies);
                        }
                    }
                    _ => {}
                }
            }
            Event::Reply { participant, reply, .. } if reply.model_seconds.is_finite() => {
                let one = &mut self.survey.participants[usize::from(participant)];
                one.model_s += reply.model_seconds;
            }
            Event::Reply { .. } => {}
            Event::Iteration(iteration) => self.iteration(iteration),
            Event::Repeated { .. } => self.survey.repeated_windows += 1,
            Event::Ended { error } => self.survey.error = error,
        }
    }

    fn iteration(&mut self, iteration: Iteration) {
        let survey = &mut self.survey;
        survey.iterations += 1;
        survey.windows += u64::from(self.window != Some(iteration.window));
        self.window = Some(iteration.window);
        survey.max_iterations_in_window = survey.max_iterations_in_window.max(iteration.iteration);
        survey.end_s = iteration.end;
        survey.coupling_s += iteration.coupling_seconds;
        survey.final_residuals.clone_from(&iteration.residuals);
        if let (Some(sent), Some(received)) = (iteration.sent, iteration.received) {
            let scale = sent.abs().max(received.abs());
            let imbalance = if scale == 0.0 { 0.0 } else { (sent - received).abs() / scale };
            let worst = survey.energy_imbalance.get_or_insert(0.0);
            *worst = worst.max(imbalance);
        }
        if let Some(details) = &mut survey.details
            && self.wanted.has_window(iteration.window)
            && details.takes(1 + iteration.residuals.len() + iteration.model_seconds.len())
        {
            details.iterations.push(iteration);
        }
    }

    fn sample(&mut self, service: &str, header: &FieldHeader, values: &[f64], nanoseconds: u64) {
        let range = Range::of(values);
        let index = match self.topics.get(service) {
            Some(index) => *index,
            None => {
                self.survey.fields.push(FieldSurvey {
                    topic: service.to_owned(),
                    unit: header.unit.as_str().to_owned(),
                    grid: header.grid.as_str().to_owned(),
                    geometry: self.grids.get(service).cloned(),
                    values: 0,
                    samples: 0,
                    bytes: 0,
                    range: Range::default(),
                    non_finite_at: None,
                });
                self.topics.insert(service.to_owned(), self.survey.fields.len() - 1);
                self.survey.fields.len() - 1
            }
        };
        let field = &mut self.survey.fields[index];
        if field.range.first_non_finite.is_none() && range.first_non_finite.is_some() {
            field.non_finite_at = Some((header.window, header.iteration));
        }
        field.range = field.range.and(range, field.samples);
        field.values = values.len() as u64;
        field.samples += 1;
        field.bytes += size_of_val(values) as u64;
        if let Some(details) = &mut self.survey.details
            && self.wanted.has_window(header.window)
            && self.wanted.has_field(service, header, self.survey.bodies.as_ref())
            && self.wanted.samples()
            && details.takes(1)
        {
            details.samples.push(SampleSurvey {
                topic: service.to_owned(),
                window: header.window,
                iteration: header.iteration,
                sequence: header.sequence,
                at_s: nanoseconds as f64 * 1e-9,
                range,
            });
        }
    }

    fn state(&mut self, role: &str) {
        if let Some(one) = self.survey.participants.iter_mut().find(|p| p.role == role) {
            one.states += 1;
        }
    }
}

/// Smallest, largest and mean value, and the index of the first one that is not finite.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Range {
    /// Smallest finite value.
    pub min: Option<f64>,
    /// Largest finite value.
    pub max: Option<f64>,
    /// Mean of the finite values.
    pub mean: Option<f64>,
    /// Index of the first value that is not finite.
    pub first_non_finite: Option<usize>,
}

impl Range {
    /// Returns the range of a sample. Works in lanes, so that the compiler can vectorise it.
    #[must_use]
    pub fn of(values: &[f64]) -> Self {
        let first_non_finite = proto::model::first_non_finite(values);
        let finite: Vec<f64>;
        let values = match first_non_finite {
            None => values,
            Some(_) => {
                finite = values.iter().copied().filter(|v| v.is_finite()).collect();
                &finite
            }
        };
        if values.is_empty() {
            return Self { first_non_finite, ..Self::default() };
        }
        let (mut low, mut high) = ([f64::INFINITY; 8], [f64::NEG_INFINITY; 8]);
        let chunks = values.chunks_exact(8);
        let rest = chunks.remainder();
        for chunk in chunks.chain(std::iter::once(rest)) {
            for ((low, high), value) in low.iter_mut().zip(&mut high).zip(chunk) {
                *low = if *value < *low { *value } else { *low };
                *high = if *value > *high { *value } else { *high };
            }
        }
        let sum = contract::grid::blocked_sum(values);
        Self {
            min: low.into_iter().reduce(f64::min),
            max: high.into_iter().reduce(f64::max),
            mean: Some(sum / values.len() as f64),
            first_non_finite,
        }
    }

    /// Returns the range with 0 for a value that is rounding relative to the larger bound.
    #[must_use]
    pub fn without_rounding(self) -> Self {
        let size = |value: Option<f64>| value.unwrap_or(0.0).abs();
        let least = f64::EPSILON * size(self.min).max(size(self.max));
        let whole = |value: f64| if value.abs() < least { 0.0 } else { value };
        Self {
            min: self.min.map(whole),
            max: self.max.map(whole),
            mean: self.mean.map(whole),
            ..self
        }
    }

    /// Joins two ranges. The mean assumes equally many values in each sample.
    #[must_use]
    pub fn and(self, other: Self, samples_so_far: u64) -> Self {
        let join = |a: Option<f64>, b: Option<f64>, of: fn(f64, f64) -> f64| match (a, b) {
            (Some(a), Some(b)) => Some(of(a, b)),
            (one, None) | (None, one) => one,
        };
        let n = samples_so_far as f64;
        let mean = match (self.mean, other.mean) {
            (Some(a), Some(b)) => Some(a + (b - a) / (n + 1.0)),
            (one, None) | (None, one) => one,
        };
        Self {
            min: join(self.min, other.min, f64::min),
            max: join(self.max, other.max, f64::max),
            mean,
            first_non_finite: self.first_non_finite.or(other.first_non_finite),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_many_and_few_values() {
        let values: Vec<f64> = (0..21).map(f64::from).collect();
        let range = Range::of(&values);
        assert_eq!((range.min, range.max, range.mean), (Some(0.0), Some(20.0), Some(10.0)));
        assert_eq!(Range::of(&[]), Range::default());
        let rise = Range::of(&[8.4948e-289, 1e-3, 226.0]).without_rounding();
        assert_eq!((rise.min, rise.max), (Some(0.0), Some(226.0)));
        let broken = Range::of(&[1.0, f64::NAN, -3.0]);
        assert_eq!((broken.min, broken.max, broken.mean), (Some(-3.0), Some(1.0), Some(-1.0)));
        assert_eq!(broken.first_non_finite, Some(1));
    }

    #[test]
    fn a_list_of_any_number_of_iterations_is_cut() {
        let mut details = Details::default();
        let listed = (0..2 * MOST_LISTED).filter(|_| details.takes(1)).count();
        assert!(details.cut && listed == MOST_LISTED);
        assert!(!Details::default().cut);
    }

    #[test]
    fn joined_ranges_are_those_of_all_values() {
        let parts = [[1.0, 5.0], [-2.0, 0.0], [3.0, 11.0]];
        let joined = parts
            .iter()
            .enumerate()
            .fold(Range::default(), |all, (n, part)| all.and(Range::of(part), n as u64));
        let whole = Range::of(parts.as_flattened());
        assert_eq!((joined.min, joined.max), (whole.min, whole.max));
        assert!((joined.mean.unwrap() - whole.mean.unwrap()).abs() < 1e-15);
    }
}

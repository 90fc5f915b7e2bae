//! One pass over a recording.

use super::range::Range;
use contract::bodies::Bodies;
use contract::configuration::Configuration;
use contract::grid::{Shape, Structured};
use contract::message::{CommandKind, FieldHeader};
use proto::recording::{End, Event, Item, Iteration, Recording};
use serde::Serialize;
use std::collections::BTreeMap;
use std::io::Read;

/// What is looked at sample by sample.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Wanted {
    /// Only samples of this field; a name, or the end of a topic's.
    pub field: Option<String>,
    /// Only this window.
    pub window: Option<u64>,
    /// All iterations, without samples unless those are asked for too.
    pub iterations: bool,
}

impl Wanted {
    /// Samples and iterations are to be listed at all.
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

    /// A field is named as the contract or as the case has it.
    fn has_field(&self, service: &str, header: &FieldHeader, bodies: Option<&Bodies>) -> bool {
        self.field.as_deref().is_none_or(|wanted| {
            let named = bodies.map(|bodies| bodies.named(wanted));
            let name = header.name.as_str();
            name == wanted || named.as_deref() == Some(name) || service.ends_with(wanted)
        })
    }
}

/// A recording in short.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Survey {
    /// Short name of the case.
    pub case: String,
    /// Name and version of the program that wrote it.
    pub writer: String,
    /// Names of the upper and the lower body, as soon as a participant is given a case that has them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bodies: Option<Bodies>,
    /// Coupling scheme.
    pub scheme: String,
    /// How iterates were chosen.
    pub acceleration: String,
    /// It has its index and footer; otherwise it was cut.
    pub complete: bool,
    /// Why it could not be read to its end.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub damage: Option<String>,
    /// Bytes read.
    pub bytes: u64,
    /// From the first to the last message [s].
    pub duration_s: f64,
    /// What ended the run, if that was no success; absent too if the recording does not say.
    pub error: Option<String>,
    /// The participants.
    pub participants: Vec<ParticipantSurvey>,
    /// Windows with an iteration.
    pub windows: u64,
    /// Iterations.
    pub iterations: u64,
    /// Iterations of the window that took most.
    pub max_iterations_in_window: u32,
    /// Windows that were solved again with another end.
    pub repeated_windows: u64,
    /// Coupling time at the last iteration [s].
    pub end_s: f64,
    /// Residuals of the last iteration, by field.
    pub final_residuals: Vec<(String, f64)>,
    /// Largest relative difference of heat sent and received.
    pub energy_imbalance: Option<f64>,
    /// Seconds in which no model computed.
    pub coupling_s: f64,
    /// The topics.
    pub fields: Vec<FieldSurvey>,
    /// What was asked to be listed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub details: Option<Details>,
}

/// A participant in a recording.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ParticipantSurvey {
    /// Role.
    pub role: String,
    /// Program and its version.
    pub program: String,
    /// Model, as it was configured.
    pub model: String,
    /// Solves asked for.
    pub solves: u64,
    /// States written or read.
    pub states: u64,
    /// Seconds in its model.
    pub model_s: f64,
}

/// A topic in a recording.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FieldSurvey {
    /// Name of the service that it travelled on.
    pub topic: String,
    /// SI unit.
    pub unit: String,
    /// Name of the grid.
    pub grid: String,
    /// The grid at the start of the run, where it is made of equal elements.
    pub geometry: Option<Structured>,
    /// Values of the newest sample.
    pub values: u64,
    /// Samples.
    pub samples: u64,
    /// Bytes of values.
    pub bytes: u64,
    /// Range over all samples.
    #[serde(flatten)]
    pub range: Range,
    /// Window and iteration of the first value that is not finite.
    pub non_finite_at: Option<(u64, u32)>,
}

/// Iterations and samples one by one.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Details {
    /// Iterations of the windows asked for.
    pub iterations: Vec<IterationSurvey>,
    /// Samples asked for.
    pub samples: Vec<SampleSurvey>,
}

/// An iteration.
pub(super) type IterationSurvey = Iteration;

/// A sample.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SampleSurvey {
    /// Name of the service that it travelled on.
    pub topic: String,
    /// Number of the window.
    pub window: u64,
    /// Iteration within it.
    pub iteration: u32,
    /// Sequence number on its topic.
    pub sequence: u64,
    /// Since the start of the recording [s].
    pub at_s: f64,
    /// Range of its values.
    #[serde(flatten)]
    pub range: Range,
}

/// Reads a recording to its end, or to where it is damaged.
pub fn survey<R: Read>(recording: &mut Recording<R>, wanted: &Wanted) -> Survey {
    let mut taken = Taken::of(recording, wanted);
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

/// A survey being made.
struct Taken<'a> {
    survey: Survey,
    wanted: &'a Wanted,
    /// Index of each topic.
    topics: BTreeMap<String, usize>,
    /// Grids of equal elements, by topic.
    grids: BTreeMap<String, Structured>,
    window: Option<u64>,
}

impl<'a> Taken<'a> {
    fn of<R: Read>(recording: &Recording<R>, wanted: &'a Wanted) -> Self {
        let head = recording.head();
        let participants = head.participants.iter().map(|p| ParticipantSurvey {
            role: p.role.clone(),
            program: format!("{} {}", p.description.name, p.description.version),
            ..ParticipantSurvey::default()
        });
        let survey = Survey {
            case: head.case.clone(),
            writer: head.writer.clone(),
            scheme: head.scheme.clone(),
            acceleration: head.acceleration.clone(),
            participants: participants.collect(),
            details: wanted.anything().then(Details::default),
            ..Survey::default()
        };
        Self { survey, wanted, topics: BTreeMap::new(), grids: BTreeMap::new(), window: None }
    }

    fn grids(&mut self, event: &Event) {
        // Damage there is an error of the reader.
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
                        // What is damaged there is an error of the reader.
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
        if let (Some(sent), Some(received)) = (iteration.heat_sent, iteration.heat_received) {
            let scale = sent.abs().max(received.abs());
            let imbalance = if scale == 0.0 { 0.0 } else { (sent - received).abs() / scale };
            let worst = survey.energy_imbalance.get_or_insert(0.0);
            *worst = worst.max(imbalance);
        }
        if let Some(details) = &mut survey.details
            && self.wanted.has_window(iteration.window)
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

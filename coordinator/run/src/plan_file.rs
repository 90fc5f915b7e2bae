//! Plan in a result directory: `plan.txt` for readers, `plan.json` for programs.

use crate::error::RunError;
use crate::identity::checksum;
use crate::plan::{Effect, Field, Participant, Plan};
use crate::results::{ResultFolder, read_file};
use crate::warnings::Warning;
use contract::configuration::Layout;
use contract::diagram::Diagram;
use contract::figure::FigureSpec;
use contract::text::json;
use coupling::ParticipantIndex;
use serde::{Deserialize, Serialize};
use std::fmt::Write as _;

/// Plan as text.
const TEXT: &str = "plan.txt";
/// Plan as JSON.
pub const FILE: &str = "plan.json";
/// Version of the layout of [`FILE`].
const SCHEMA: u32 = 1;

/// Content of `plan.json`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PlanFile {
    /// Version of this layout.
    pub schema: u32,
    /// Name of the case.
    pub case: String,
    /// Title of the case.
    pub title: Option<String>,
    /// Version of the coordinator.
    pub coordinator: String,
    /// Version of the protocol.
    pub protocol: u32,
    /// Coupling scheme.
    pub scheme: String,
    /// Reason for the choice.
    pub scheme_reason: String,
    /// Method that chooses the iterates of an implicit scheme.
    pub acceleration: String,
    /// Number of windows, if it is known before the run.
    pub windows: Option<u64>,
    /// The participants, in the order in which data flows.
    pub participants: Vec<ParticipantPlan>,
    /// Roles of the case that take no part, with the reason.
    pub idle: Vec<(String, String)>,
    /// Every effect that some participant offers.
    pub effects: Vec<EffectPlan>,
    /// Fields that exist at run time.
    pub fields: Vec<FieldPlan>,
    /// Figures of the summary, with the names of the bodies.
    #[serde(default)]
    pub figures: Vec<FigureSpec>,
    /// Diagrams of the figures.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub diagrams: Vec<Diagram>,
    /// Warnings about the case and its plan.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<Warning>,
    /// The plan as `coordinator plan` prints it.
    pub text: String,
}

/// A participant of the run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ParticipantPlan {
    /// Role that the participant plays.
    pub role: String,
    /// Name of the program.
    pub program: String,
    /// Version of the program.
    pub version: String,
    /// CRC-64 of the description, which changes with the build that the program states.
    #[serde(default)]
    pub checksum: String,
    /// Model of the program.
    pub model: String,
    /// Number of threads for computing; 0 in a plan of an earlier version.
    #[serde(default)]
    pub threads: usize,
    /// Estimate of the run, if the participant gives one.
    pub estimate: Option<Estimate>,
}

/// Estimate of a run by a participant.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// Name and number of points of each grid.
    pub grids: Vec<(String, usize)>,
    /// Processor seconds of building the model.
    pub build_seconds: f64,
    /// Processor seconds of one solve.
    pub solve_seconds: f64,
    /// Further processor seconds of a solve, for each second of its window [s/s].
    #[serde(default)]
    pub seconds_per_second: f64,
    /// Memory of the arrays \[byte\].
    pub memory_bytes: u64,
    /// Remarks of the model on the case.
    pub remarks: Vec<String>,
}

/// An effect.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EffectPlan {
    /// Name in the case file.
    pub name: String,
    /// Whether the effect is active.
    pub active: bool,
    /// Reason why the effect is active or not.
    pub reason: String,
    /// Roles of its participants.
    pub roles: Vec<String>,
    /// Law of the effect.
    pub law: String,
}

/// A field that exists at run time.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FieldPlan {
    /// Name of the field.
    pub name: String,
    /// SI unit.
    pub unit: String,
    /// Role of the participant that sends the field.
    pub producer: String,
    /// Roles of the consumers; empty for a field that is only written.
    pub consumers: Vec<String>,
    /// Roles of the consumers that receive the coordinator's iterate of the field.
    pub fed_back: Vec<String>,
    /// Size of a sample [byte], if the grid is known.
    pub sample_bytes: Option<u64>,
}

/// Writes the plan into the folder of a run.
///
/// # Errors
/// A file cannot be written.
pub fn write(plan: &Plan, folder: &ResultFolder) -> Result<(), RunError> {
    let file = PlanFile::of(plan);
    folder.write(TEXT, text(&file).as_bytes())?;
    folder.write(FILE, json(&file).as_bytes())
}

/// Returns the warnings of the stored plan of a resumed run, if the plan can be read. The stored
/// case already contains the values of the options, so a new plan would no longer warn about
/// replaced keys.
pub(crate) fn first_warnings(folder: &ResultFolder) -> Vec<Warning> {
    let text = read_file(&folder.file(FILE)).unwrap_or_default();
    serde_json::from_slice(&text).map_or_else(|_| Vec::new(), |plan: PlanFile| plan.warnings)
}

/// Returns the text of the plan, with the versions of all participants.
fn text(plan: &PlanFile) -> String {
    let PlanFile { coordinator, protocol, participants, text, .. } = plan;
    let mut text = text.clone();
    let _ =
        writeln!(text, "\nversions\ncoordinator\tcoordinator\t{coordinator}\tprotocol {protocol}");
    for ParticipantPlan { role, program, version, model, .. } in participants {
        let _ = writeln!(text, "{role}\t{program}\t{version}\tmodel {model}");
    }
    text
}

impl PlanFile {
    /// Returns the content of the file for a plan.
    #[must_use]
    pub fn of(plan: &Plan) -> Self {
        Self {
            schema: SCHEMA,
            case: plan.name.clone(),
            title: plan.title.clone(),
            coordinator: env!("CARGO_PKG_VERSION").to_owned(),
            protocol: contract::PROTOCOL_VERSION,
            scheme: plan.scheme.scheme.word().to_owned(),
            scheme_reason: plan.scheme.reason.clone(),
            acceleration: plan.acceleration().word().to_owned(),
            windows: plan.windows.count(),
            participants: plan.participants.iter().map(ParticipantPlan::of).collect(),
            idle: plan.idle.clone(),
            effects: plan.effects.iter().map(EffectPlan::of).collect(),
            fields: plan.fields.iter().map(|field| FieldPlan::of(field, plan)).collect(),
            figures: plan.figures.clone(),
            diagrams: plan.diagrams.clone(),
            warnings: plan.warnings.clone(),
            text: plan.to_string(),
        }
    }
}

impl ParticipantPlan {
    fn of(of: &Participant) -> Self {
        Self {
            role: of.role.clone(),
            program: of.description.name.clone(),
            version: of.description.version.clone(),
            checksum: checksum(of),
            model: of.configuration.model.clone(),
            threads: of.configuration.threads,
            estimate: of.estimate.as_ref().map(Estimate::of),
        }
    }
}

impl Estimate {
    fn of(layout: &Layout) -> Self {
        let grids = layout.grids.iter().map(|grid| (grid.name.clone(), grid.points()));
        Self {
            grids: grids.collect(),
            build_seconds: layout.build_seconds,
            solve_seconds: layout.solve_seconds,
            seconds_per_second: layout.seconds_per_second,
            memory_bytes: layout.memory_bytes,
            remarks: layout.remarks.clone(),
        }
    }
}

impl EffectPlan {
    fn of(effect: &Effect) -> Self {
        let Effect { name, active, roles, law } = effect.clone();
        let reason = if active { "named in the case" } else { "not named in the case" };
        Self { name, active, reason: reason.to_owned(), roles, law }
    }
}

impl FieldPlan {
    fn of(field: &Field, plan: &Plan) -> Self {
        let role = |&index: &ParticipantIndex| plan.participants[index].role.clone();
        Self {
            name: field.kind.name.clone(),
            unit: field.kind.unit.clone(),
            producer: role(&field.producer),
            consumers: field.consumers.iter().map(role).collect(),
            fed_back: field.fed_back.iter().map(role).collect(),
            sample_bytes: plan.sample_bytes(field),
        }
    }
}

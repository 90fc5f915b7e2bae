//! Planning: describes, validates, routes and estimates.

use super::contents::{Field, LiveValue, Participant, Plan, Planned, SchemeChoice};
use super::expected;
use super::figures;
use super::layouts::layouts;
use super::live;
use super::mapping;
use super::route::{self, Candidate};
use super::route::{cannot_rewind, cannot_vary};
use super::sampling;
use super::threads;
use super::volume;
use crate::deadlines::Deadlines;
use crate::error::RunError;
use crate::fleet::{Fleet, QUESTIONS};
use crate::format::number;
use crate::peers::ParticipantSlot;
use crate::program::Program;
use crate::warnings::Warning;
use case::schema::WELL_KNOWN_ROLES;
use case::{
    Case, Control, Problem, RawCase, RawParticipant, Timing, check_without_participants, validate,
};
use contract::configuration::{Configuration, Input};
use contract::description::Description;
use contract::grid::check_name;
use contract::history::Histories;
use contract::message::{MAX_INPUTS, MOST_PARTICIPANTS};
use coupling::ParticipantIndex;
use coupling::settings::{Implicit, Scheme};
use coupling::windows::Windows;
use std::sync::Arc;
use std::time::Duration;
use typed_index_collections::{TiSlice, TiVec};

/// Keys in the cost section of the summary that `ROLE_s` must not equal, and the coordinator's own
/// name.
const RESERVED_ROLES: &[&str] =
    &["coordinator", "wall", "coupling", "output", "plan", "start", "finish"];
/// Largest number of windows; more are taken for an error of input.
const MOST_WINDOWS: f64 = 1e9;

/// Plans a case for a fleet. Errors of the case are collected and reported together.
///
/// # Errors
/// The case is invalid, a program fails, or a participant refuses the case.
pub fn plan(raw: RawCase, fleet: &mut Fleet) -> Result<Planned, RunError> {
    let sections = raw.participants();
    let own = own(&raw, &sections, fleet)?;
    let (absent, replaced) = (absent(&sections, fleet), replaced(&sections));
    fleet.describe(&own, &[&absent[..], &replaced].concat(), of_questions(&raw))?;
    let mut described = known(&own, fleet);
    refuse_misplaced(&raw, &sections, &described)?;
    described.extend(known(&absent, fleet));
    let case = validate(&raw, &described, &known(&replaced, fleet))?;
    let mut plan = route_case(&case, &described, fleet)?;
    estimate(&case, &mut plan, fleet)?;
    plan.mappings = mapping::planned(&plan);
    let estimated = expected::estimated(&case, plan.participants.iter());
    let mapped = plan.warn_of_mappings(&case);
    plan.warnings.extend(estimated.into_iter().chain(mapped));
    Ok(Planned { case, plan })
}

/// Returns the deadlines of the questions of a plan.
fn of_questions(raw: &RawCase) -> Deadlines {
    check_without_participants(raw).map_or(QUESTIONS, |own| Deadlines {
        start: Duration::from_secs_f64(own.coupling.start_deadline),
        heartbeat: Duration::from_secs_f64(own.coupling.heartbeat_deadline),
        ..QUESTIONS
    })
}

/// Returns the seat of a program that is asked.
fn seat(role: &str, program: Program) -> ParticipantSlot {
    ParticipantSlot { role: role.to_owned(), program, attach: false }
}

/// Returns the programs of a case. Their roles become names of services, files and keys of the
/// summary. A section without a program may be a table that a participant reads.
fn own(
    raw: &RawCase,
    sections: &[RawParticipant],
    fleet: &Fleet,
) -> Result<Vec<ParticipantSlot>, RunError> {
    let (mut own, mut problems) = (Vec::new(), Vec::new());
    for RawParticipant { role, command, place, .. } in sections {
        let problem = |key: &str, reason: String, fix: &str| {
            Problem::new(place.clone(), key.to_owned(), reason, fix)
        };
        let program = fleet.program(role, command.as_deref());
        if !program.exists() {
            if command.is_some() || WELL_KNOWN_ROLES.contains(&role.as_str()) {
                problems.push(problem(
                    &format!("{role}.command"),
                    format!("there is no program `{}`", program.path.display()),
                    "correct the command, or build the program: `cargo build --release --workspace` \
                     builds all of this project",
                ));
            }
            continue;
        }
        if let Err(reason) = check_name("role", role) {
            problems.push(problem(role, reason, "choose another name for this section"));
        }
        if RESERVED_ROLES.contains(&role.as_str()) {
            let reason = format!("`{role}` is reserved for the summary");
            problems.push(problem(role, reason, "choose another name"));
        }
        if own.len() == MOST_PARTICIPANTS {
            let reason = format!("more than {MOST_PARTICIPANTS} participants");
            problems.push(problem(role, reason, "use fewer"));
        }
        own.push(seat(role, program));
    }
    raw.report(problems).map_or(Ok(own), |problems| Err(problems.into()))
}

/// Returns the well-known programs for which the case has no section. The case may hold keys for
/// them, so that removing a section is enough to take a participant out of a case.
fn absent(sections: &[RawParticipant], fleet: &Fleet) -> Vec<ParticipantSlot> {
    let is_absent = |role: &&&str| sections.iter().all(|section| section.role != ***role);
    let seats = WELL_KNOWN_ROLES.iter().filter(is_absent);
    let seats = seats.map(|role| seat(role, fleet.program(role, None)));
    seats.filter(|seat| seat.program.exists()).collect()
}

/// Returns the default programs of roles that a `command` gives to another program. Their keys are
/// known, but not used.
fn replaced(sections: &[RawParticipant]) -> Vec<ParticipantSlot> {
    let replaced = sections.iter().filter_map(|RawParticipant { role, command, .. }| {
        let usual = Program::of_role(role, None);
        let own = Program::of_role(role, command.as_deref());
        (usual.path != own.path && usual.exists()).then(|| seat(role, usual))
    });
    replaced.collect()
}

/// Returns the descriptions that exist, by role.
fn known(seats: &[ParticipantSlot], fleet: &Fleet) -> Vec<(String, Arc<Description>)> {
    let description = |seat: &ParticipantSlot| {
        Some((seat.role.clone(), fleet.description(&seat.program)?.clone()))
    };
    seats.iter().filter_map(description).collect()
}

/// Refuses programs that cannot take their place in a case.
fn refuse_misplaced(
    raw: &RawCase,
    sections: &[RawParticipant],
    described: &[(String, Arc<Description>)],
) -> Result<(), RunError> {
    let misplaced = described.iter().filter_map(|(role, description)| {
        misplaced(sections.iter().find(|section| section.role == *role)?, description)
    });
    raw.report(misplaced.collect()).map_or(Ok(()), |problems| Err(problems.into()))
}

/// Returns the problem of a program that cannot take this place in a case. Its keys say nothing
/// about the case, which therefore is not judged any further.
fn misplaced(section: &RawParticipant, description: &Description) -> Option<Problem> {
    let RawParticipant { role, place, .. } = section;
    let Description { name, protocol, role: played, .. } = description;
    let problem = |reason: String, fix: &str| {
        Some(Problem::new(place.clone(), format!("{role}.command"), reason, fix))
    };
    if *protocol != contract::PROTOCOL_VERSION {
        let own = contract::PROTOCOL_VERSION;
        let reason =
            format!("`{name}` speaks protocol {protocol}, this coordinator protocol {own}");
        return problem(reason, "install compatible versions");
    }
    if played != role {
        let reason = format!("its program plays the role `{played}`");
        let fix = format!("name the section [{played}], or give a program that plays `{role}`");
        return problem(reason, &fix);
    }
    None
}

/// Returns an error if there are problems.
fn refuse(case: &Case, problems: Vec<Problem>) -> Result<(), RunError> {
    case.report(problems).map_or(Ok(()), |problems| Err(problems.into()))
}

/// Checks the number of windows.
fn check_windows(case: &Case) -> Result<(), RunError> {
    let mut problems = Vec::new();
    if let Timing::Transient { window, end, control } = case.timing {
        let (least, key) = match control {
            Control::Fixed => (window, "time.window"),
            Control::Adaptive { shortest, .. } => (shortest, "time.window_min"),
        };
        if end / least > MOST_WINDOWS {
            let most = format!("{MOST_WINDOWS} at most", MOST_WINDOWS = number(MOST_WINDOWS, 1));
            let reason = format!("{} windows up to time.end, {most}", number(end / least, 2));
            problems.push(case.problem_at(key, reason, "choose longer windows"));
        }
    }
    refuse(case, problems)
}

fn route_case(
    case: &Case,
    described: &[(String, Arc<Description>)],
    fleet: &Fleet,
) -> Result<Plan, RunError> {
    let candidates = case.participants.iter().filter_map(|p| {
        let description = &described.iter().find(|(role, _)| *role == p.role)?.1;
        let model = description.models.iter().find(|m| m.name == p.model)?;
        let live = case.live_of(description, &p.model);
        let by_keys = case.consumed_by_keys(description, &p.model);
        Some(Candidate { role: &p.role, model, description, live, by_keys })
    });
    let running = TiVec::from(route::order(candidates.collect(), case));
    check_windows(case)?;
    let twice = route::provided_twice(&running, case).into_iter().map(|(field, first, second)| {
        let reason = format!("`{first}` and `{second}` both provide the field `{field}`");
        case.problem_at(&second, reason, "keep one of the two")
    });
    refuse(case, twice.collect())?;
    let mut fields = route::fields(&running, case).map_err(|unprovided| {
        let problems = unprovided.iter().map(|u| {
            let reason = format!(
                "{} needs the field `{}` for `{}`, which no participant provides",
                u.because, u.field, u.consumer
            );
            case.problem_at(&u.key, reason, route::provider(described, &u.field))
        });
        case.report(problems.collect()).expect("there is at least one problem")
    })?;
    refuse(case, live::misfits(case, &fields))?;
    let live = live::values(case, &running, &fields);
    let scheme = scheme(case, &fields, &running);
    route::feed_back(&mut fields, scheme.scheme);
    refuse(case, unused_tolerances(case, &fields, scheme.scheme))?;
    refuse(case, cannot_go_back(case, &fields, scheme.scheme))?;
    refuse(case, cannot_rewind(case, running.iter(), scheme.scheme))?;
    let windows = windows(case.timing, case.histories.as_ref());
    refuse(case, cannot_vary(case, running.iter(), &windows))?;
    let idle = case.idle.iter().map(|role| {
        let description = described.iter().find(|(r, _)| r == role).map(|(_, d)| d);
        let effects = description.into_iter().flat_map(|d| &d.effects);
        let offers: Vec<_> = effects.map(|e| e.name.as_str()).collect();
        (role.clone(), format!("no active effect needs it (it serves {})", offers.join(", ")))
    });
    let offers: Vec<_> = described.iter().map(|(role, d)| (role.as_str(), &**d)).collect();
    let mut participants = participants(case, &running, &fields, &live, scheme.scheme, fleet)?;
    let figures = figures::gather(participants.iter_mut(), case.bodies.as_ref());
    let diagrams = participants.iter().flat_map(|p| p.description.diagrams.clone()).collect();
    let sampled = sampling::warnings(case, participants.iter(), &windows);
    Ok(Plan {
        name: case.name.clone(),
        bodies: case.bodies.clone(),
        skips: case.timing == (Timing::Sequence { skip: true }),
        title: case.title.clone(),
        mode: case.timing.mode(),
        windows,
        scheme,
        implicit: Implicit {
            threads: threads::of_coordinator(case.limits.threads),
            ..case.coupling.implicit.clone()
        },
        interpolation: case.coupling.interpolation,
        warnings: expected::replaced(case)
            .chain(expected::unread(case))
            .chain(expected::warnings(case, participants.iter()))
            .chain(expected::ignored(case, participants.iter()))
            .chain(sampled)
            .collect(),
        mappings: Vec::new(),
        participants,
        figures,
        diagrams,
        idle: idle.collect(),
        effects: route::effects(&offers, case),
        fields,
        live,
        output_every: case.output.every,
        checkpoint_every: case.output.checkpoint_every,
        deadlines: Deadlines {
            start: Duration::from_secs_f64(case.coupling.start_deadline),
            build: Duration::from_secs_f64(case.coupling.build_deadline),
            solve: Duration::from_secs_f64(case.coupling.solve_deadline),
            heartbeat: Duration::from_secs_f64(case.coupling.heartbeat_deadline),
        },
        shared_memory_limit: case.limits.shared_memory,
    })
}

fn scheme(
    case: &Case,
    fields: &[Field],
    running: &TiSlice<ParticipantIndex, Candidate>,
) -> SchemeChoice {
    let feedback = route::feedback(fields);
    let (scheme, reason) = match (case.coupling.scheme, feedback.first()) {
        (Scheme::Auto, None) if running.len() == 1 => {
            (Scheme::SerialExplicit, "only one participant runs".to_owned())
        }
        (Scheme::Auto, None) => {
            let reason = "one-way coupling: no active effect acts back";
            (Scheme::SerialExplicit, reason.to_owned())
        }
        (Scheme::Auto, Some(field)) => {
            let name = case
                .bodies
                .as_ref()
                .map_or_else(|| field.kind.name.clone(), |bodies| bodies.shown(&field.kind.name));
            let producer = running[field.producer].role;
            (Scheme::SerialImplicit, format!("`{name}` from `{producer}` closes a loop"))
        }
        (Scheme::SerialImplicit, None) => {
            (Scheme::SerialExplicit, "no field closes a loop: one pass is enough".to_owned())
        }
        (Scheme::ParallelImplicit, _) if fields.iter().all(Field::observed_only) => {
            (Scheme::SerialExplicit, "no field is exchanged: one pass is enough".to_owned())
        }
        (asked, _) => (asked, "the case asks for it".to_owned()),
    };
    SchemeChoice { scheme, reason }
}

pub(super) fn windows(timing: Timing, histories: Option<&Histories>) -> Windows {
    match timing {
        Timing::Steady => Windows::Steady,
        Timing::Sequence { .. } => {
            let times = histories.map(|histories| histories.times.as_slice());
            Windows::Sequence(times.unwrap_or_default().into())
        }
        Timing::Transient { window, end, control: Control::Fixed } => {
            Windows::Fixed { window, end }
        }
        Timing::Transient {
            end,
            control: Control::Adaptive { tolerance, shortest, longest },
            ..
        } => Windows::Adaptive { tolerance, shortest, longest, end },
    }
}

/// Finds adaptive windows in a scheme whose participants receive a field one window late. A
/// repeated window would start with the values that its first attempt has sent.
fn cannot_go_back(case: &Case, fields: &[Field], scheme: Scheme) -> Vec<Problem> {
    let adaptive =
        matches!(case.timing, Timing::Transient { control: Control::Adaptive { .. }, .. });
    let late = |field: &&Field| {
        let before = |consumer: &ParticipantIndex| *consumer <= field.producer;
        scheme.is_parallel() || field.consumers.iter().any(before)
    };
    let late = fields.iter().filter(|f| !f.observed_only()).find(late);
    let problem = late.filter(|_| adaptive && !scheme.is_implicit()).map(|field| {
        let (name, word) = (&field.kind.name, scheme.word());
        let reason =
            format!("with {word} `{name}` lags by one window, and no window can be repeated");
        let fix = "set coupling.scheme to \"serial-implicit\", or remove time.control";
        case.problem_at("time.control", reason, fix)
    });
    problem.into_iter().collect()
}

/// Finds tolerances of fields that are not exchanged.
fn unused_tolerances(case: &Case, fields: &[Field], scheme: Scheme) -> Vec<Problem> {
    let exchanged = |name: &str| fields.iter().any(|f| f.kind.name == name && !f.observed_only());
    let names = case.coupling.implicit.fields.keys().filter(|_| scheme.is_implicit());
    let unused = names.filter(|name| !exchanged(name)).map(|name| {
        let reason = format!("`{name}` is not exchanged, so it has no residual");
        case.problem_at(&format!("coupling.fields.{name}"), reason, "remove it")
    });
    unused.collect()
}

fn participants(
    case: &Case,
    running: &TiSlice<ParticipantIndex, Candidate>,
    fields: &[Field],
    live: &[LiveValue],
    scheme: Scheme,
    fleet: &Fleet,
) -> Result<TiVec<ParticipantIndex, Participant>, RunError> {
    let threads = threads::of_participants(case.limits.threads, scheme, running.len());
    let mut participants = TiVec::new();
    for (index, one) in running.iter_enumerated() {
        let settings = case.participants.iter().find(|p| p.role == one.role);
        let command = settings.and_then(|p| p.command.as_deref());
        let inputs: Vec<Input> = fields
            .iter()
            .filter(|f| f.consumers.contains(&index))
            .map(|f| Input {
                field: f.kind.clone(),
                producer: running[f.producer].role.to_owned(),
                grid: None,
                moves: false,
                peak: None,
                extent: None,
            })
            .chain(live::inputs(live, index))
            .collect();
        if inputs.len() > MAX_INPUTS {
            let reason = format!("it would have {} inputs, {MAX_INPUTS} at most", inputs.len());
            let problem = case.problem_at(one.role, reason, "use fewer effects");
            return Err(case.fail(problem).into());
        }
        let own = |observed: bool| {
            let sent = fields.iter().filter(move |f| f.producer == index);
            sent.filter(move |f| f.observed_only() == observed)
                .map(|f| f.kind.name.clone())
                .collect()
        };
        let values = case.values_for(one.description, &one.model.name);
        participants.push(Participant {
            role: one.role.to_owned(),
            program: fleet.program(one.role, command),
            attach: settings.is_some_and(|p| p.attach),
            description: Arc::clone(one.description),
            configuration: Configuration {
                role: one.role.to_owned(),
                model: one.model.name.clone(),
                mode: case.timing.mode(),
                windows: case.timing.windows(),
                histories: case.histories_of(&values),
                case: values,
                inputs,
                outputs: own(false),
                observed: own(true),
                threads: threads[usize::from(index)],
            },
            figures: Vec::new(),
            estimate: None,
        });
    }
    Ok(participants)
}

/// Asks the participants that can tell for their layouts.
fn estimate(case: &Case, plan: &mut Plan, fleet: &mut Fleet) -> Result<(), RunError> {
    let configurations = plan.participants.iter().map(|one| one.configuration.clone());
    let mut configurations: TiVec<ParticipantIndex, Configuration> = configurations.collect();
    let layouts = layouts(&mut configurations, |one, configuration| {
        let Participant { program, description, .. } = &plan.participants[one];
        if !description.estimates {
            return Ok(None);
        }
        let layout = fleet.layout(program, configuration);
        let layout = layout.map_err(|error| refusal_of_case(error, case, plan))?;
        // Before its consumer is asked for a layout.
        refuse(case, volume::consumed(case, plan, one, &layout))?;
        Ok::<_, RunError>(Some(layout))
    })?;
    let answers = configurations.into_iter().zip(layouts);
    for (one, (configuration, layout)) in plan.participants.iter_mut().zip(answers) {
        (one.configuration, one.estimate) = (configuration, layout);
    }
    Ok(())
}

/// Returns the refusal of a participant as an error of the case.
fn refusal_of_case(error: RunError, case: &Case, plan: &Plan) -> RunError {
    let RunError::Refused { refusal, .. } = error else { return error };
    // An implausible value may be the reason why the case is impossible.
    let unexpected = plan.warnings.iter().filter_map(|warning| match warning {
        Warning::Value(implausible) => Some(implausible.to_string()),
        Warning::Remark(_) => None,
    });
    let fix = std::iter::once(refusal.fix).chain(unexpected).collect::<Vec<_>>().join("; ");
    let problem = case.problem_at(&refusal.key, refusal.reason, fix);
    case.fail(problem).into()
}

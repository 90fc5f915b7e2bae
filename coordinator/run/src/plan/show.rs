//! Text of a plan, and of a case that was checked without starting a program.

use super::contents::{Effect, LiveValue, Participant, Plan, geometry_bytes};
use super::make::windows;
use crate::format::{bytes, counted, duration, seconds};
use crate::program::Program;
use crate::wrap;
use case::{RawParticipant, StandaloneCheck};
use coupling::ParticipantIndex;
use coupling::settings::Implicit;
use coupling::windows::Windows;
use std::fmt::{Display, Formatter, Result, Write};

/// Smallest relative error of a model that is listed.
const SHOWN: f64 = 5e-5;

/// The alternate form, `{:#}`, has the laws of the effects that are off, too.
impl Display for Plan {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let mut text = String::new();
        self.write(&mut text, f.alternate())?;
        f.write_str(&wrap::columns(&text))
    }
}

impl Plan {
    fn write(&self, f: &mut String, all_laws: bool) -> Result {
        write!(f, "{}", self.name)?;
        if let Some(title) = &self.title {
            write!(f, " · {title}")?;
        }
        writeln!(f)?;
        for warning in &self.warnings {
            writeln!(f, "\nwarning    {warning}")?;
        }
        self.show_time(f)?;
        self.show_processes(f)?;
        self.show_effects(f, all_laws)?;
        self.show_fields(f)?;
        self.show_live(f)?;
        self.show_mappings(f)?;
        self.show_cost(f)
    }

    fn show_time(&self, f: &mut String) -> Result {
        writeln!(f, "\ntime       {}", in_time(&self.windows))?;
        let scheme = self.scheme.scheme;
        writeln!(f, "scheme     {}: {}", scheme.word(), self.scheme.reason)?;
        if scheme.is_implicit() {
            let Implicit { max_iterations, reuse_windows, .. } = self.implicit;
            writeln!(
                f,
                "           {}, at most {max_iterations} iterations a window, secant columns of \
                 {reuse_windows} windows reused",
                self.implicit.acceleration.word()
            )?;
            if let Some(history) = self.accelerator_history() {
                writeln!(
                    f,
                    "           keeps up to {} secant columns of {} values: {}",
                    history.columns,
                    history.length,
                    bytes(history.bytes())
                )?;
            }
        }
        Ok(())
    }

    fn show_processes(&self, f: &mut String) -> Result {
        writeln!(f, "\nprocesses  coordinator")?;
        for p in &self.participants {
            let how = if p.attach { "started by hand" } else { "started" };
            let model = &p.configuration.model;
            let threads = counted(p.configuration.threads as u64, "thread");
            let name = p.program.name();
            writeln!(f, "           {:10} {model:14} {how}: {name}, {threads}", p.role)?;
            for remark in p.estimate.iter().flat_map(|e| &e.remarks) {
                writeln!(f, "           {:10} note: {remark}", "")?;
            }
            self.show_left_out(p, f)?;
        }
        for (role, why) in &self.idle {
            writeln!(f, "           {role:10} not started: {why}")?;
        }
        Ok(())
    }

    /// Writes the simplifications of a model in this case, with their errors.
    fn show_left_out(&self, p: &Participant, f: &mut String) -> Result {
        let active = |name: &str| self.effects.iter().any(|e| e.active && e.name == name);
        let models = p.description.models.iter();
        let model = models.filter(|model| model.name == p.configuration.model);
        let always = model.flat_map(|model| &model.accuracy.simplifications);
        let here = p.estimate.iter().flat_map(|layout| &layout.left_out);
        let all = always.filter(|one| one.applies(&active)).chain(here);
        for one in all.filter(|one| one.error >= SHOWN) {
            let (what, percent, source) = (&one.what, 100.0 * one.error, &one.source);
            writeln!(f, "           {:10} leaves out: {what}, {percent:.2} %: {source}", "")?;
        }
        Ok(())
    }

    fn show_effects(&self, f: &mut String, all_laws: bool) -> Result {
        let mut head = "effects";
        writeln!(f)?;
        let (on, off): (Vec<&Effect>, Vec<_>) = self.effects.iter().partition(|e| e.active);
        for effect in on {
            let roles = effect.roles.join(", ");
            writeln!(f, "{head:10} on  {:22} named in the case; {roles}", effect.name)?;
            writeln!(f, "{:10}     {:22} {}", "", "", effect.law)?;
            head = "";
        }
        let names: Vec<&str> = off.iter().map(|effect| effect.name.as_str()).collect();
        if names.is_empty() {
            return Ok(());
        }
        if !all_laws {
            let count = counted(names.len() as u64, "effect");
            return writeln!(f, "{head:10} off {count}  {}", names.join(", "));
        }
        for effect in off {
            writeln!(f, "{head:10} off {:22} {}", effect.name, effect.law)?;
            head = "";
        }
        Ok(())
    }

    fn show_fields(&self, f: &mut String) -> Result {
        let role = |index: ParticipantIndex| self.participants[index].role.as_str();
        let mut head = "fields";
        writeln!(f)?;
        for field in &self.fields {
            let to = match field.observed_only() {
                true => "output only".to_owned(),
                false => field.consumers.iter().map(|&c| role(c)).collect::<Vec<_>>().join(", "),
            };
            let size = self.sample_bytes(field).map_or_else(|| "size unknown".to_owned(), bytes);
            let through = if field.fed_back.is_empty() { "->" } else { "-> (iterate) ->" };
            let route = format!("{} {through} {to}", role(field.producer));
            writeln!(f, "{head:10} {:30} {route:24} {size:>12}", self.shown(&field.kind.name))?;
            head = "";
        }
        self.show_grids(f)?;
        let exchanged = self.fields.iter().enumerate().filter(|(_, f)| !f.observed_only());
        let bytes_of = |(index, field)| Some(self.sample_bytes(field)? + self.mapped_bytes(index));
        match exchanged.map(bytes_of).sum::<Option<u64>>() {
            Some(total) => writeln!(f, "{:10} exchanged per iteration: {}", "", bytes(total)),
            None => writeln!(f, "{:10} exchanged per iteration: not known before the run", ""),
        }
    }

    /// Writes the values that are given during the run.
    fn show_live(&self, f: &mut String) -> Result {
        let role = |index: ParticipantIndex| self.participants[index].role.as_str();
        let mut head = "live";
        for LiveValue { kind, first, limits: [least, most], provider, readers } in &self.live {
            let to: Vec<&str> = readers.iter().map(|&one| role(one)).collect();
            let from = provider.map_or("coordinator", role);
            let held = match provider {
                Some(_) => String::new(),
                None => format!(", {} unless the run is driven", si(*first, &kind.unit)),
            };
            writeln!(
                f,
                "{head:10} {:30} {from} -> {}; from {} to {}{held}",
                kind.name,
                to.join(", "),
                si(*least, &kind.unit),
                si(*most, &kind.unit)
            )?;
            head = "";
        }
        Ok(())
    }

    /// Writes the grids that move, and the volumes.
    fn show_grids(&self, f: &mut String) -> Result {
        for (one, p) in self.participants.iter_enumerated() {
            let Some(layout) = &p.estimate else { continue };
            for name in &layout.moving {
                let name = self.shown(name);
                writeln!(f, "{:10} grid `{name}` of {} may move between windows", "", p.role)?;
            }
            for grid in self.travelling(one, layout).filter(|grid| grid.is_volume()) {
                let (name, elements) = (&grid.name, grid.points());
                let geometry = bytes(geometry_bytes(grid));
                writeln!(
                    f,
                    "{:10} volume `{name}` of {}: {elements} elements, {geometry} of geometry once",
                    "", p.role
                )?;
            }
        }
        Ok(())
    }

    fn show_cost(&self, f: &mut String) -> Result {
        let mut head = "cost";
        writeln!(f)?;
        for p in &self.participants {
            if let Some(e) = &p.estimate {
                let once = match e.build_seconds {
                    0.0 => String::new(),
                    once => format!("about {} once, ", seconds(once)),
                };
                let known = self.windows.count().filter(|count| *count > 0);
                let all = p.expected_seconds(&self.windows, 1.0);
                let total = known.map(|_| format!(", {} in all", seconds(all)));
                let windows = known.unwrap_or(1) as f64;
                writeln!(
                    f,
                    "{head:10} {:10} {once}about {} a window{}, {} of arrays",
                    p.role,
                    seconds((all - e.build_seconds) / windows),
                    total.unwrap_or_default(),
                    bytes(e.memory_bytes)
                )?;
                head = "";
            }
        }
        Ok(())
    }
}

/// Formats a value with its SI unit.
fn si(value: f64, unit: &str) -> String {
    if unit == "1" { format!("{value}") } else { format!("{value} {unit}") }
}

/// Describes the windows of a run.
pub(super) fn in_time(windows: &Windows) -> String {
    match windows {
        Windows::Steady => "steady: one window without duration".to_owned(),
        Windows::Sequence(times) if times.is_empty() => "sequence: the rows of a table".to_owned(),
        Windows::Sequence(times) => {
            format!("sequence: {}, each a steady contact", counted(times.len() as u64, "row"))
        }
        Windows::Fixed { window, end } => {
            let count = windows.count().unwrap_or(0);
            format!("transient: {count} windows of {} to {}", duration(*window), duration(*end))
        }
        Windows::Open { window: None } => {
            "steady: one row for each window that is requested".to_owned()
        }
        Windows::Open { window: Some(window) } => {
            format!("transient: windows of {}, as requested", duration(*window))
        }
        Windows::Adaptive { tolerance, shortest, longest, end } => format!(
            "transient: adaptive windows of {} to {}, the shortest first, to {}; tolerance \
             {tolerance:e}",
            duration(*shortest),
            duration(*longest),
            duration(*end)
        ),
    }
}

/// Text of a case that was checked without starting a program.
#[derive(Clone, Copy, Debug)]
pub struct CaseOverview<'a>(pub &'a StandaloneCheck);

impl Display for CaseOverview<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let Self(alone) = self;
        let title = alone.title.as_ref().map(|title| format!(" · {title}")).unwrap_or_default();
        writeln!(f, "{}{title}", alone.name)?;
        writeln!(f, "\ntime       {}", in_time(&windows(alone.timing, None)))?;
        writeln!(f, "scheme     {}", alone.coupling.scheme.word())?;
        writeln!(f, "\nprocesses  coordinator")?;
        for one in &alone.participants {
            let model = one.model.as_deref().unwrap_or("?");
            writeln!(f, "           {:10} {model:14} {}", one.role, how(one))?;
        }
        write!(f, "\n{}", alone.not_judged_text())
    }
}

/// Describes how a participant would join the run.
fn how(one: &RawParticipant) -> String {
    let program = Program::of_role(&one.role, one.command.as_deref());
    let line = match &one.command {
        Some(words) => words.join(" "),
        None => program.name(),
    };
    match (one.attach, &one.command) {
        (true, _) => "would be started by hand".to_owned(),
        (false, Some(_)) => format!("would start, as the case says: {line}"),
        (false, None) => format!("would start: {line}"),
    }
}

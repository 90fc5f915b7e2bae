//! `coordinator export`: writes the fields of a recording for other tools.
//!
//! Fields are written as VTK series, as a run writes them, or as CSV: one file for each topic and
//! instant, with a row for each point. By default there is one instant for each accepted window;
//! windows that were passed over, or in which the run failed, are left out. With every iteration,
//! instants are numbered in the order of the recording.
//!
//! Fields without a consumer are sent only when a window is accepted. Therefore an accepted window
//! is written when the next one begins.

use crate::recording_file::{self, failed};
use clap::Args;
use console::command::{self, Context, Group};
use console::output::print;
use contract::bodies::Bodies;
use contract::configuration::Configuration;
use contract::field::{FieldKind, GEOMETRY};
use contract::grid::Grid;
use contract::message::{Command, CommandKind, FieldHeader, Status};
use contract::step::Step;
use proto::recording::{End, Event, Head, Item, Recording, RecordingError};
use run::error::{RunError, file_failure};
use run::format::counted;
use run::results::vtk::{FieldOutput, FieldWriter};
use run::results::write::create;
use run::signals;
use std::collections::BTreeMap;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

/// Options of `coordinator export`.
#[derive(Debug, Args)]
#[command(group = clap::ArgGroup::new("form").required(true).multiple(true).args(["vtk", "csv"]))]
pub struct ExportCommand {
    /// Recording to export, or a result directory with one.
    recording: PathBuf,
    /// Folder for VTK series (`.pvd`, with a file for each instant).
    #[arg(long, value_name = "DIR")]
    vtk: Option<PathBuf>,
    /// Folder for CSV, one file for each topic and instant.
    #[arg(long, value_name = "DIR")]
    csv: Option<PathBuf>,
    /// Export every iteration, not only accepted windows.
    #[arg(long)]
    iterations: bool,
}

impl command::Command for ExportCommand {
    const NAME: &'static str = "export";
    const GROUP: Group = Group::Look;
    const ABOUT: &'static str = "Write fields of a recording for ParaView or as CSV";
    const EXAMPLES: &'static [&'static str] =
        &["coordinator export results/latest/recording.mcap --vtk fields"];

    fn run(&self, context: &Context<'_>) -> Result<(), RunError> {
        let ExportCommand { recording: path, vtk, csv, iterations } = self;
        let reading = signals::end_at_once();
        let path = &recording_file::find(path)?;
        let mut recording = recording_file::open(path)?;
        drop(reading);
        let target = Target { vtk: vtk.clone(), csv: csv.clone(), every_iteration: *iterations };
        let Exported { instants, rejected } = export(path, &mut recording, &target)?;
        let mut text = counted(instants, "instant");
        if rejected > 0 && !iterations {
            let windows = counted(rejected, "window");
            text += &format!(", without {windows} that the run did not accept");
        }
        for folder in [vtk, csv].into_iter().flatten() {
            text += &format!(" -> {}", folder.display());
        }
        if let End::Cut(bytes) = recording.end() {
            text += &format!(" (the recording is truncated after {bytes} bytes)");
        }
        if context.quiet { Ok(()) } else { print(&(text + "\n")) }
    }
}

/// Formats to write, with their folders.
#[derive(Clone, Debug, Default)]
pub(crate) struct Target {
    /// Folder for VTK series.
    pub vtk: Option<PathBuf>,
    /// Folder for CSV.
    pub csv: Option<PathBuf>,
    /// Whether to export every iteration, not only accepted windows.
    pub every_iteration: bool,
}

/// Current grid of a topic.
struct TopicGrid {
    grid: Grid,
    /// Service of the geometry, if the grid moves.
    geometry: Option<String>,
    /// Number of topics before this one. A participant has its topics in the order of the arrays in
    /// the files of a run.
    position: usize,
}

/// Newest sample of a topic.
struct NewestSample {
    kind: FieldKind,
    producer: String,
    grid: Option<Grid>,
    values: Vec<f64>,
    /// Whether the sample is still to be written.
    fresh: bool,
}

/// Extent of an export.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Exported {
    /// Number of instants written.
    pub(crate) instants: u64,
    /// Number of windows that were begun and not accepted.
    pub(crate) rejected: u64,
}

/// Writes the requested files.
///
/// # Errors
/// The recording is damaged, or a file cannot be written.
pub(crate) fn export<R: Read>(
    path: &Path,
    recording: &mut Recording<R>,
    target: &Target,
) -> Result<Exported, RunError> {
    let damaged = |what: String| failed(path, &RecordingError::Content(what));
    let mut export = Export {
        target,
        vtk: target.vtk.as_ref().map(|folder| FieldWriter::new(folder.clone())),
        head: recording.head().clone(),
        grids: BTreeMap::new(),
        newest: BTreeMap::new(),
        bodies: None,
        solving: None,
        accepted: None,
        exported: Exported { instants: 0, rejected: 0 },
    };
    loop {
        // An interrupt may end the program between two files, but not within one.
        let reading = signals::end_at_once();
        let entry = recording.read().map_err(|error| failed(path, &error))?;
        drop(reading);
        let Some(entry) = entry else { break };
        match entry.item {
            Item::Event(event) => {
                export.topics(&event).map_err(|error| failed(path, &error))?;
                export.event(&event)?;
            }
            Item::Sample { service, header, values } => {
                export.sample(service, &header, values).map_err(damaged)?;
            }
            Item::State { .. } => {}
        }
    }
    export.end_window()?;
    Ok(export.exported)
}

struct Export<'a> {
    target: &'a Target,
    vtk: Option<FieldWriter>,
    /// Head of the recording, which describes the fields.
    head: Head,
    grids: BTreeMap<String, TopicGrid>,
    newest: BTreeMap<String, NewestSample>,
    /// Bodies in the first configuration.
    bodies: Option<Bodies>,
    /// Window of the last Solve.
    solving: Option<u64>,
    /// Step of the window that was accepted last, until it is written.
    accepted: Option<Step>,
    exported: Exported,
}

impl Export<'_> {
    fn event(&mut self, event: &Event) -> Result<(), RunError> {
        match event {
            Event::Command { command, body, .. } => self.command(command, body),
            Event::Reply { reply, .. } if reply.status != Status::Done as u32 => {
                self.accepted = None;
                Ok(())
            }
            Event::Iteration(iteration) if self.target.every_iteration => {
                self.write(self.exported.instants, iteration.end)
            }
            _ => Ok(()),
        }
    }

    /// Notes the grids of the topics in a Connect.
    fn topics(&mut self, event: &Event) -> Result<(), RecordingError> {
        let Some((_, topics)) = event.topics()? else { return Ok(()) };
        for topic in topics.outputs.into_iter().chain(topics.inputs) {
            let (grid, geometry, next) = (topic.grid, topic.geometry, self.grids.len());
            let position = self.grids.get(&topic.service).map_or(next, |known| known.position);
            self.grids.insert(topic.service, TopicGrid { grid, geometry, position });
        }
        Ok(())
    }

    fn command(&mut self, command: &Command, body: &[u8]) -> Result<(), RunError> {
        match CommandKind::from_number(command.kind) {
            Some(CommandKind::Configure) if self.bodies.is_none() => {
                let given = serde_json::from_slice::<Configuration>(body).ok();
                self.bodies = given.and_then(|given| Bodies::read(&given.case).ok());
            }
            Some(CommandKind::Solve) => {
                if self.accepted.is_some() || self.solving.is_some_and(|now| now != command.window)
                {
                    self.end_window()?;
                }
                self.solving = Some(command.window);
            }
            Some(CommandKind::Accept) => self.accepted = Some(command.step()),
            _ => {}
        }
        Ok(())
    }

    /// Writes the window if it was accepted. Otherwise its samples are no results.
    fn end_window(&mut self) -> Result<(), RunError> {
        let begun = self.solving.take().is_some();
        match self.accepted.take() {
            Some(step) if self.target.every_iteration => {
                self.write(self.exported.instants, step.end)
            }
            Some(step) => self.write(step.window, step.end),
            None => {
                self.exported.rejected += u64::from(begun);
                if begun {
                    self.forget();
                }
                Ok(())
            }
        }
    }

    /// Marks all samples as written.
    fn forget(&mut self) {
        self.newest.values_mut().for_each(|newest| newest.fresh = false);
    }

    /// Takes the newest sample of a topic, or the geometry of a grid.
    fn sample(
        &mut self,
        service: &str,
        header: &FieldHeader,
        values: &[f64],
    ) -> Result<(), String> {
        if header.name.as_str() == GEOMETRY.name {
            return self.geometry(service, header, values);
        }
        let grid = self.grids.get(service).map(|topic| &topic.grid);
        let newest = self.newest.entry(service.to_owned()).or_insert_with(|| NewestSample {
            kind: self.head.field_kind(header),
            producer: header.producer.as_str().to_owned(),
            grid: None,
            values: Vec::new(),
            fresh: false,
        });
        if let Some(grid) = grid {
            fits(newest.kind.components, grid, header)?;
        }
        values.clone_into(&mut newest.values);
        newest.fresh = true;
        if newest.grid.as_ref() != grid {
            newest.grid = grid.cloned();
        }
        Ok(())
    }

    fn geometry(
        &mut self,
        service: &str,
        header: &FieldHeader,
        values: &[f64],
    ) -> Result<(), String> {
        for TopicGrid { grid, geometry, .. } in self.grids.values_mut() {
            if geometry.as_deref() == Some(service) && grid.revision < header.grid_revision {
                *grid = grid.with_geometry(values, header.grid_revision)?;
            }
        }
        Ok(())
    }

    /// Returns the name of the files of a topic.
    fn file_name(&self, service: &str) -> String {
        let shown = |part: &str| match &self.bodies {
            Some(bodies) => bodies.shown(part),
            None => part.to_owned(),
        };
        let parts = service.trim_start_matches("field/").split('/').map(shown);
        parts.collect::<Vec<_>>().join("_")
    }

    fn write(&mut self, number: u64, time: f64) -> Result<(), RunError> {
        let mut fresh: Vec<_> = self.newest.iter().filter(|(_, newest)| newest.fresh).collect();
        fresh.sort_by_key(|(service, _)| self.grids.get(*service).map(|topic| topic.position));
        let shown: Vec<(&str, FieldOutput)> = fresh
            .into_iter()
            .filter_map(|(service, newest)| {
                let NewestSample { kind, producer, values, grid, .. } = newest;
                let grid = grid.as_ref()?;
                let bodies = self.bodies.as_ref();
                Some((service.as_str(), FieldOutput::new(producer, grid, kind, values, bodies)))
            })
            .collect();
        if shown.is_empty() {
            return Ok(());
        }
        if let Some(vtk) = &mut self.vtk {
            let fields: Vec<FieldOutput> = shown.iter().map(|(_, shown)| shown.clone()).collect();
            vtk.write(&fields, number, time)?;
        }
        if let Some(folder) = &self.target.csv {
            for (service, shown) in &shown {
                write_csv(folder, &self.file_name(service), shown, number)?;
            }
        }
        self.forget();
        self.exported.instants += 1;
        Ok(())
    }
}

/// Checks that a sample has the components of its field and the points of its grid.
fn fits(components: u32, grid: &Grid, header: &FieldHeader) -> Result<(), String> {
    if grid.is_announced() {
        let (name, on) = (header.name.as_str(), &grid.name);
        return Err(format!("`{name}` is sent before the geometry of its volume `{on}`"));
    }
    let (points, expected) = (header.points, grid.points() as u64);
    if (header.components, points) == (components, expected) {
        return Ok(());
    }
    let (name, on, found) = (header.name.as_str(), &grid.name, header.components);
    Err(format!(
        "`{name}` has {found} component(s) at {points} point(s); its grid `{on}` has {expected}, and \
         the field {components} component(s)"
    ))
}

/// Writes one row for each point: index, coordinates, and components.
fn write_csv(folder: &Path, name: &str, shown: &FieldOutput, number: u64) -> Result<(), RunError> {
    std::fs::create_dir_all(folder).map_err(|error| file_failure(folder, &error))?;
    let path = folder.join(format!("{name}_{number:06}.csv"));
    create(&path, |out| {
        let FieldOutput { grid, kind, values, .. } = shown;
        write!(out, "index,x [m],y [m],z [m]")?;
        for component in 0..kind.components {
            match kind.components {
                1 => write!(out, ",{} [{}]", kind.name, kind.unit)?,
                _ => write!(out, ",{}_{component} [{}]", kind.name, kind.unit)?,
            }
        }
        writeln!(out)?;
        let points = values.len() / kind.components.max(1) as usize;
        for point in 0..points {
            let [x, y, z] = grid.centre(point);
            write!(out, "{point},{x:e},{y:e},{z:e}")?;
            for component in 0..kind.components as usize {
                write!(out, ",{:e}", values[component * points + point])?;
            }
            writeln!(out)?;
        }
        Ok(())
    })
}

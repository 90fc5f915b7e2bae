//! Coupling schemes: order of the participants, windows, exchanges and convergence measures.

use crate::acceleration::Acceleration;
use crate::element::{Element, Strangers};
use crate::error::ConfigError;
use crate::participant::MeshData;
use crate::words::{Words, words};

pub use crate::element::Setting;

words! {
    /// Kind of a coupling scheme.
    SchemeKind {
        /// One after the other, each window once.
        SerialExplicit = "serial-explicit",
        /// At the same time, each window once.
        ParallelExplicit = "parallel-explicit",
        /// One after the other, each window until it converges.
        SerialImplicit = "serial-implicit",
        /// At the same time, each window until it converges.
        ParallelImplicit = "parallel-implicit",
        /// Any number of participants at the same time, each window until it converges.
        Multi = "multi",
    }
}

impl SchemeKind {
    /// Returns whether windows are iterated.
    #[must_use]
    pub fn is_implicit(self) -> bool {
        matches!(self, Self::SerialImplicit | Self::ParallelImplicit | Self::Multi)
    }

    /// Returns whether the participants run one after the other.
    #[must_use]
    pub fn is_serial(self) -> bool {
        matches!(self, Self::SerialExplicit | Self::SerialImplicit)
    }
}

/// A coupling scheme.
#[derive(Clone, Debug, PartialEq)]
pub struct CouplingScheme {
    /// Kind.
    pub kind: SchemeKind,
    /// Participants: the first and the second one, or all of a multi scheme.
    pub participants: Vec<String>,
    /// Participant that does the acceleration of a multi scheme.
    pub controller: Option<String>,
    /// Time at which the run ends \[s\].
    pub max_time: Option<Setting<f64>>,
    /// Number of windows after which the run ends.
    pub max_time_windows: Option<Setting<u64>>,
    /// Length of the windows.
    pub window: Setting<Window>,
    /// Smallest number of iterations of a window.
    pub min_iterations: Option<Setting<u64>>,
    /// Largest number of iterations of a window; `None` for no limit.
    pub max_iterations: Option<Setting<u64>>,
    /// Data that are exchanged.
    pub exchanges: Vec<Exchange>,
    /// Conditions of convergence.
    pub measures: Vec<ConvergenceMeasure>,
    /// Acceleration of the iteration.
    pub acceleration: Option<Acceleration>,
    /// Line of the element.
    pub line: usize,
}

/// Length of the windows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Window {
    /// The same for all windows \[s\].
    Fixed(f64),
    /// The time step of the first participant.
    FirstParticipant,
}

/// Data that one participant sends to another.
#[derive(Clone, Debug, PartialEq)]
pub struct Exchange {
    /// Name of the data.
    pub data: String,
    /// Mesh on which they are sent.
    pub mesh: String,
    /// Participant that sends.
    pub from: String,
    /// Participant that receives.
    pub to: String,
    /// Values are sent before the first window.
    pub initialize: bool,
    /// Values at all time steps within a window are sent; `None` for the default of the library.
    pub substeps: Option<bool>,
    /// Line of the element.
    pub line: usize,
}

/// Limits of a convergence measure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Limit {
    /// Norm of the residual.
    Absolute(f64),
    /// Norm of the residual over that of the values.
    Relative(f64),
    /// Norm of the residual over that of the first iteration.
    ResidualRelative(f64),
    /// Either of two norms.
    AbsoluteOrRelative {
        /// Norm of the residual.
        absolute: f64,
        /// Norm of the residual over that of the values.
        relative: f64,
    },
}

/// A condition of convergence.
#[derive(Clone, Debug, PartialEq)]
pub struct ConvergenceMeasure {
    /// Data and mesh, with the line of the element.
    pub of: MeshData,
    /// Limit.
    pub limit: Limit,
    /// Convergence of this data is enough for convergence of the window.
    pub suffices: bool,
    /// A window without convergence ends the run.
    pub strict: bool,
}

impl Exchange {
    /// Returns data and mesh.
    #[must_use]
    pub fn carried(&self) -> MeshData {
        MeshData { mesh: self.mesh.clone(), data: self.data.clone(), line: self.line }
    }

    fn read(element: &Element<'_>, strangers: &mut Strangers) -> Result<Self, ConfigError> {
        strangers.attributes(element, &["data", "mesh", "from", "to", "initialize", "substeps"]);
        let substeps = element.optional("substeps").map(|_| element.flag("substeps"));
        Ok(Self {
            data: element.text("data")?,
            mesh: element.text("mesh")?,
            from: element.text("from")?,
            to: element.text("to")?,
            initialize: element.flag("initialize")?,
            substeps: substeps.transpose()?,
            line: element.line,
        })
    }
}

impl ConvergenceMeasure {
    fn read(
        element: &Element<'_>,
        limit: Limit,
        strangers: &mut Strangers,
    ) -> Result<Self, ConfigError> {
        strangers.attributes(
            element,
            &["data", "mesh", "limit", "abs-limit", "rel-limit", "suffices", "strict"],
        );
        Ok(Self {
            of: MeshData {
                mesh: element.text("mesh")?,
                data: element.text("data")?,
                line: element.line,
            },
            limit,
            suffices: element.flag("suffices")?,
            strict: element.flag("strict")?,
        })
    }
}

/// Returns the limit of a convergence measure; `None` for another element.
fn limit(element: &Element<'_>) -> Result<Option<Limit>, ConfigError> {
    let value = |attribute| element.required(attribute, element.number(attribute)?);
    Ok(Some(match element.name {
        "absolute-convergence-measure" => Limit::Absolute(value("limit")?),
        "relative-convergence-measure" => Limit::Relative(value("limit")?),
        "residual-relative-convergence-measure" => Limit::ResidualRelative(value("limit")?),
        "absolute-or-relative-convergence-measure" => Limit::AbsoluteOrRelative {
            absolute: value("abs-limit")?,
            relative: value("rel-limit")?,
        },
        _ => return Ok(None),
    }))
}

words! {
    /// Choice of the length of the windows.
    WindowMethod {
        /// By the configuration.
        Fixed = "fixed",
        /// By the first participant of a serial scheme.
        FirstParticipant = "first-participant",
    }
}

impl Window {
    fn read(element: &Element<'_>, kind: SchemeKind) -> Result<Setting<Self>, ConfigError> {
        let undefined = element.number("value")?.is_none_or(|value| value == -1.0);
        let first = element.choice("method")? == Some(WindowMethod::FirstParticipant);
        if first && !kind.is_serial() {
            let expected = "fixed, the only choice of a parallel scheme".to_owned();
            return Err(element.refused("method", expected));
        }
        let value = match first || undefined {
            true => Self::FirstParticipant,
            false => Self::Fixed(element.positive()?.value),
        };
        Ok(Setting { value, line: element.line })
    }
}

impl CouplingScheme {
    /// Elements that a scheme has once.
    const SINGLE: [&'static str; 7] = [
        "participants",
        "max-time",
        "max-time-windows",
        "time-window-size",
        "min-iterations",
        "max-iterations",
        "acceleration:",
    ];

    /// Reads a scheme; `None` for a kind that is unknown.
    pub(crate) fn read(
        element: &Element<'_>,
        strangers: &mut Strangers,
    ) -> Result<Option<Self>, ConfigError> {
        let Some(kind) = SchemeKind::from_word(element.split().1) else {
            strangers.element(element);
            return Ok(None);
        };
        strangers.attributes(element, &[]);
        element.at_most_once(&Self::SINGLE)?;
        let mut window = None;
        let mut scheme = Self {
            kind,
            participants: Vec::new(),
            controller: None,
            max_time: None,
            max_time_windows: None,
            window: Setting { value: Window::FirstParticipant, line: element.line },
            min_iterations: None,
            max_iterations: None,
            exchanges: Vec::new(),
            measures: Vec::new(),
            acceleration: None,
            line: element.line,
        };
        for child in element.children() {
            if child.name == "time-window-size" {
                strangers.attributes(&child, &["value", "method"]);
                window = Some(Window::read(&child, kind)?);
            } else {
                scheme.add(&child, strangers)?;
            }
        }
        let absent = |child| ConfigError::Element {
            line: element.line,
            element: element.name.to_owned(),
            child,
        };
        scheme.window = window.ok_or_else(|| absent("time-window-size"))?;
        if scheme.participants.len() < 2 {
            let multi = kind == SchemeKind::Multi;
            return Err(absent(if multi { "participant" } else { "participants" }));
        }
        if scheme.max_time.is_none() && scheme.max_time_windows.is_none() {
            return Err(absent("max-time"));
        }
        Ok(Some(scheme))
    }

    fn add(&mut self, element: &Element<'_>, strangers: &mut Strangers) -> Result<(), ConfigError> {
        match element.split() {
            ("", "participants") => {
                strangers.attributes(element, &["first", "second"]);
                self.participants = vec![element.text("first")?, element.text("second")?];
            }
            ("", "participant") => {
                strangers.attributes(element, &["name", "control"]);
                let name = element.text("name")?;
                if element.flag("control")? {
                    self.controller = Some(name.clone());
                }
                self.participants.push(name);
            }
            ("", "max-time") => self.max_time = Some(element.positive()?),
            ("", "max-time-windows") => self.max_time_windows = Some(element.count_from(1)?),
            ("", "min-iterations") => self.min_iterations = Some(element.count_from(1)?),
            ("", "max-iterations") => self.max_iterations = Some(element.count_from(1)?),
            ("", "exchange") => self.exchanges.push(Exchange::read(element, strangers)?),
            ("acceleration", _) => {
                self.acceleration = Acceleration::read(element, strangers)?;
            }
            _ => match limit(element)? {
                Some(limit) => {
                    self.measures.push(ConvergenceMeasure::read(element, limit, strangers)?);
                }
                None => strangers.element(element),
            },
        }
        Ok(())
    }
}

//! Acceleration of the iteration within a window.

use crate::element::{Element, Setting, Strangers};
use crate::error::ConfigError;
use crate::participant::MeshData;
use crate::words::{Words, words};

words! {
    /// Method of acceleration.
    AccelerationKind {
        /// Constant relaxation.
        Constant = "constant",
        /// Aitken's relaxation.
        Aitken = "aitken",
        /// Quasi-Newton method, least squares.
        IqnIls = "IQN-ILS",
        /// Quasi-Newton method, Jacobian of earlier windows.
        IqnImvj = "IQN-IMVJ",
    }
}

words! {
    /// Filter of the secant columns.
    FilterKind {
        /// Diagonal of R relative to the norm of R.
        Qr1 = "QR1",
        /// Diagonal of R, absolute.
        Qr1Absolute = "QR1-absolute",
        /// New part of a column relative to its norm.
        Qr2 = "QR2",
        /// As `QR2`, tested only when the weights have changed.
        Qr3 = "QR3",
    }
}

words! {
    /// Weights of the data in the least-squares problem.
    PreconditionerKind {
        /// Given numbers.
        Constant = "constant",
        /// Norm of the values.
        Value = "value",
        /// Norm of the residual.
        Residual = "residual",
        /// Sum of the norms of the residuals.
        ResidualSum = "residual-sum",
    }
}

/// Acceleration of the iteration.
#[derive(Clone, Debug, PartialEq)]
pub struct Acceleration {
    /// Method.
    pub kind: AccelerationKind,
    /// Relaxation factor, of all iterations or of the first one.
    pub relaxation: Option<Setting<f64>>,
    /// Every window begins with a relaxation.
    pub enforce_initial: bool,
    /// Largest number of secant columns.
    pub max_used_iterations: Option<Setting<u64>>,
    /// Number of earlier windows whose secant columns are used.
    pub time_windows_reused: Option<Setting<u64>>,
    /// Data from which the method builds its columns.
    pub data: Vec<AcceleratedData>,
    /// Filter.
    pub filter: Option<Filter>,
    /// Preconditioner.
    pub preconditioner: Option<Preconditioner>,
    /// Restart of the Jacobian.
    pub restart: Option<Restart>,
    /// Options of the element, with their values.
    pub options: Vec<(String, String)>,
    /// Line of the element.
    pub line: usize,
}

/// Data that enter the acceleration.
#[derive(Clone, Debug, PartialEq)]
pub struct AcceleratedData {
    /// Data and mesh, with the line of the element.
    pub of: MeshData,
    /// Weight of a constant preconditioner.
    pub scaling: f64,
}

/// Filter of the secant columns.
#[derive(Clone, Debug, PartialEq)]
pub struct Filter {
    /// Kind.
    pub kind: FilterKind,
    /// Limit below which a column is dropped.
    pub limit: f64,
    /// Line of the element.
    pub line: usize,
}

/// Preconditioner of the least-squares problem.
#[derive(Clone, Debug, PartialEq)]
pub struct Preconditioner {
    /// Kind.
    pub kind: PreconditionerKind,
    /// Number of windows after which the weights stay constant; -1 for never.
    pub freeze_after: i64,
    /// Weights change only when the residuals change much.
    pub update_on_threshold: bool,
    /// Line of the element.
    pub line: usize,
}

/// Restart of the Jacobian of `IQN-IMVJ`.
#[derive(Clone, Debug, PartialEq)]
pub struct Restart {
    /// Kind.
    pub kind: String,
    /// Number of windows between restarts.
    pub chunk_size: i64,
    /// Line of the element.
    pub line: usize,
}

impl Acceleration {
    const OPTIONS: [&'static str; 3] =
        ["always-build-jacobian", "reduced-time-grid", "on-bound-violation"];
    /// Elements that an acceleration has once.
    const SINGLE: [&'static str; 7] = [
        "relaxation",
        "initial-relaxation",
        "max-used-iterations",
        "time-windows-reused",
        "filter",
        "preconditioner",
        "imvj-restart-mode",
    ];

    /// Reads an acceleration; `None` for a method that is unknown.
    pub(crate) fn read(
        element: &Element<'_>,
        strangers: &mut Strangers,
    ) -> Result<Option<Self>, ConfigError> {
        let Some(kind) = AccelerationKind::from_word(element.split().1) else {
            strangers.element(element);
            return Ok(None);
        };
        strangers.attributes(element, &Self::OPTIONS);
        element.at_most_once(&Self::SINGLE)?;
        let options = Self::OPTIONS
            .iter()
            .filter_map(|name| Some(((*name).to_owned(), element.optional(name)?.to_owned())));
        let mut acceleration = Self {
            kind,
            relaxation: None,
            enforce_initial: false,
            max_used_iterations: None,
            time_windows_reused: None,
            data: Vec::new(),
            filter: None,
            preconditioner: None,
            restart: None,
            options: options.collect(),
            line: element.line,
        };
        for child in element.children() {
            acceleration.add(&child, strangers)?;
        }
        Ok(Some(acceleration))
    }

    fn add(&mut self, element: &Element<'_>, strangers: &mut Strangers) -> Result<(), ConfigError> {
        let line = element.line;
        match element.name {
            "relaxation" => self.relaxation = Some(element.positive()?),
            "initial-relaxation" => {
                strangers.attributes(element, &["value", "enforce"]);
                self.relaxation = Some(element.positive()?);
                self.enforce_initial = element.flag("enforce")?;
            }
            "max-used-iterations" => self.max_used_iterations = Some(element.count_from(1)?),
            "time-windows-reused" => self.time_windows_reused = Some(element.count_from(0)?),
            "data" => {
                strangers.attributes(element, &["name", "mesh", "scaling"]);
                self.data.push(AcceleratedData {
                    of: MeshData { mesh: element.text("mesh")?, data: element.text("name")?, line },
                    scaling: element.number("scaling")?.unwrap_or(1.0),
                });
            }
            "filter" => {
                strangers.attributes(element, &["type", "limit"]);
                self.filter = Some(Filter {
                    kind: element.choice("type")?.unwrap_or(FilterKind::Qr3),
                    limit: element.number("limit")?.unwrap_or(1e-16),
                    line,
                });
            }
            "preconditioner" => {
                strangers.attributes(element, &["type", "freeze-after", "update-on-threshold"]);
                self.preconditioner = Some(Preconditioner {
                    kind: element.required("type", element.choice("type")?)?,
                    freeze_after: element.integer("freeze-after")?.unwrap_or(-1),
                    update_on_threshold: element.flag_or("update-on-threshold", true)?,
                    line,
                });
            }
            "imvj-restart-mode" => {
                strangers.attributes(
                    element,
                    &[
                        "type",
                        "chunk-size",
                        "reused-time-windows-at-restart",
                        "truncation-threshold",
                    ],
                );
                self.restart = Some(Restart {
                    kind: element.optional("type").unwrap_or("RS-SVD").to_owned(),
                    chunk_size: element.integer("chunk-size")?.unwrap_or(8),
                    line,
                });
            }
            _ => strangers.element(element),
        }
        Ok(())
    }
}

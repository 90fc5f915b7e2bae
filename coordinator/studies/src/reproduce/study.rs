//! The file of a study: its runs, and the tables, figures and text to make from them.
//!
//! A study is data: `study.toml` names cases and their changes, and a template beside it holds the
//! text. A *family* is one `[[run]]` entry. With `over` a family has one run for each value of an
//! axis, named `FAMILY/VALUE`, and `{AXIS}` stands for the value in its changes. A
//! `[[measurement]]` has runs of its own, and a plot under its name.

use super::measurement::Measurement;
use console::case_arguments::Changes;
use contract::input_file::{self, InputFileError};
use run::error::{RunError, input_failure};
use serde::Deserialize;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Size above which a file is refused [byte].
const MOST_BYTES: u64 = 1 << 24;

/// Contents of a study file.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Study {
    /// Name, a single word.
    pub name: String,
    /// Title of the study.
    pub title: String,
    /// Template of the text, relative to the study.
    pub text: PathBuf,
    /// Named lists of values.
    #[serde(default)]
    pub axes: BTreeMap<String, Vec<String>>,
    /// Runs and families of runs.
    #[serde(default, rename = "run")]
    pub families: Vec<Family>,
    /// Measured values, each with the runs that are compared with them.
    #[serde(default, rename = "measurement")]
    pub measurements: Vec<Measurement>,
    /// Quantities extrapolated from runs.
    #[serde(default, rename = "limit")]
    pub limits: Vec<Limit>,
    #[serde(default, rename = "table")]
    pub tables: Vec<TableSpec>,
    #[serde(default, rename = "figure")]
    pub figures: Vec<FigureSpec>,
}

/// One run, or one for each value of an axis.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Family {
    /// Name for references.
    pub name: String,
    /// Title in tables.
    #[serde(default)]
    pub title: String,
    /// Group of table rows that the family belongs to.
    #[serde(default)]
    pub group: String,
    /// Case file, relative to the study.
    pub case: PathBuf,
    /// Axis of the family.
    pub over: Option<String>,
    /// Selection of the axis values; all values if absent.
    pub at: Option<Vec<String>>,
    /// Keys to set.
    #[serde(default)]
    pub set: Vec<String>,
    /// Keys to remove.
    #[serde(default)]
    pub unset: Vec<String>,
    /// Fineness of the grid in elements per length, needed for limits.
    pub fineness: Option<f64>,
}

/// Results of several families extrapolated to an infinitely fine grid.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limit {
    /// Name for references.
    pub name: String,
    /// Title in tables.
    #[serde(default)]
    pub title: String,
    /// Group of table rows that the limit belongs to.
    #[serde(default)]
    pub group: String,
    /// Families used for the extrapolation, coarsest first.
    pub of: Vec<String>,
    /// Expected order of convergence of the error.
    pub order: f64,
}

/// A table.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct TableSpec {
    /// Name for references.
    pub id: String,
    /// Title of the table.
    pub title: String,
    /// Heading of the first column.
    pub head: String,
    /// The other columns.
    pub columns: Vec<Column>,
    pub rows: Vec<RowSpec>,
}

/// A column, or one for each value of an axis.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Column {
    /// Heading.
    pub head: String,
    /// Axis of the column.
    pub over: Option<String>,
    /// Single value of the row's family to show.
    pub at: Option<String>,
    /// Template of the cells: `get(key)` is a quantity of the row's run, `printed` the list of the
    /// row.
    pub cell: String,
}

/// A row, or one for each family of a group.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RowSpec {
    /// Group whose families give one row each.
    pub group: Option<String>,
    /// Family of the row, or a single run of a family.
    pub run: Option<String>,
    /// Name of the row; the family's title if absent.
    pub name: Option<String>,
    /// Printed values of the publication, for the templates of the columns.
    #[serde(default)]
    pub printed: Vec<String>,
    /// Literal contents of the cells.
    pub cells: Option<Vec<String>>,
}

/// A figure: plots and maps.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct FigureSpec {
    /// Name for references.
    pub id: String,
    /// Title of the figure.
    pub title: String,
    #[serde(default, rename = "plot")]
    pub plots: Vec<PlotSpec>,
    #[serde(default, rename = "map")]
    pub maps: Vec<MapSpec>,
}

/// A plot of lines over an axis.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PlotSpec {
    /// Title of the plot.
    pub title: String,
    /// Label of the horizontal axis, with its unit.
    pub x_label: String,
    /// Label of the vertical axis, with its unit.
    pub y_label: String,
    pub lines: Vec<LineSpec>,
}

/// Divisor of values.
#[derive(Clone, Debug, Deserialize)]
#[serde(untagged)]
pub(crate) enum Divisor {
    Number(f64),
    /// `max` stands for the largest magnitude; any other text is a dotted key of the run's summary.
    Key(String),
}

impl Default for Divisor {
    fn default() -> Self {
        Self::Number(1.0)
    }
}

/// A line, or one line for each run of a family. In the name, `{AXIS}` stands for the value.
#[derive(Clone, Debug, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) enum LineSpec {
    /// A field along the centre line of a grid.
    Along {
        /// Name in the legend.
        name: String,
        /// Run or family.
        run: String,
        /// Participant and grid, as in the names of the field files.
        grid: String,
        /// Column of the centre line.
        y: String,
        /// Divisor of the positions.
        #[serde(default)]
        x_per: Divisor,
        /// Divisor of the values.
        #[serde(default)]
        y_per: Divisor,
    },
    /// A field of a section over the distance from the surface, through the point of its largest
    /// value.
    Depth {
        /// Name in the legend.
        name: String,
        /// Run or family.
        run: String,
        /// Participant and grid.
        grid: String,
        field: String,
        /// Divisor of the distances.
        #[serde(default)]
        x_per: Divisor,
        /// Divisor of the values.
        #[serde(default)]
        y_per: Divisor,
    },
    /// A field of a section along its surface, including the wake behind the contact where a model
    /// has one.
    Surface {
        /// Name in the legend.
        name: String,
        /// Run or family.
        run: String,
        /// Participant and grid.
        grid: String,
        field: String,
        /// Divisor of the positions.
        #[serde(default)]
        x_per: Divisor,
        /// Divisor of the values.
        #[serde(default)]
        y_per: Divisor,
    },
    /// One point for each run of a family.
    Curve {
        /// Name in the legend.
        name: String,
        run: String,
        /// Dotted key in the summary for the horizontal axis.
        x: String,
        /// Dotted key in the summary for the vertical axis.
        y: String,
        /// Divisor of x.
        #[serde(default)]
        x_per: Divisor,
        /// Divisor of y.
        #[serde(default)]
        y_per: Divisor,
    },
    /// Measured values with their scatter, and the values computed without and with a fit and
    /// within the ranges of the inputs.
    Measured {
        /// Name of the measurement.
        measurement: String,
    },
    /// Printed values of a publication.
    Printed {
        /// Name in the legend.
        name: String,
        points: Vec<[f64; 2]>,
        /// Whether to draw a line through the points instead of marks.
        #[serde(default)]
        joined: bool,
    },
}

impl LineSpec {
    /// Run or family that the line shows.
    #[must_use]
    pub(crate) fn run(&self) -> Option<&str> {
        match self {
            Self::Along { run, .. }
            | Self::Depth { run, .. }
            | Self::Surface { run, .. }
            | Self::Curve { run, .. } => Some(run),
            Self::Measured { .. } | Self::Printed { .. } => None,
        }
    }
}

impl From<&Measurement> for FigureSpec {
    fn from(measurement: &Measurement) -> Self {
        let plot = PlotSpec {
            title: measurement.title.clone(),
            x_label: measurement.x.label.clone(),
            y_label: measurement.y.label.clone(),
            lines: vec![LineSpec::Measured { measurement: measurement.name.clone() }],
        };
        Self {
            id: measurement.name.clone(),
            title: "Measured and computed values".to_owned(),
            plots: vec![plot],
            maps: Vec::new(),
        }
    }
}

/// A map of a field over a plane, or one map for each run of a family.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct MapSpec {
    /// Title of the map; `{AXIS}` stands for the value.
    pub title: String,
    /// Run or family.
    pub run: String,
    /// Participant and grid.
    pub grid: String,
    pub field: String,
    /// Label of the colour scale, with its unit.
    pub label: String,
    /// Label of the horizontal axis.
    pub x_label: String,
    /// Label of the vertical axis.
    pub y_label: String,
    /// Divisor of the values.
    #[serde(default)]
    pub per: Divisor,
    /// Divisor of x.
    #[serde(default)]
    pub x_per: Divisor,
    /// Divisor of y.
    #[serde(default)]
    pub y_per: Divisor,
}

/// One run of a study.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Run {
    /// `FAMILY` or `FAMILY/VALUE`.
    pub name: String,
    /// The case file.
    pub case: PathBuf,
    /// Changes of the case.
    pub variant: Changes,
}

/// A run that a table or figure refers to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Member {
    /// Axis and value, for names in the legend.
    pub value: Option<(String, String)>,
    /// Name of the run.
    pub run: String,
}

impl Member {
    /// Replaces `{AXIS}` in a text by the value.
    #[must_use]
    pub(crate) fn filled(&self, text: &str) -> String {
        let fill = |(axis, value): &(String, String)| text.replace(&format!("{{{axis}}}"), value);
        self.value.as_ref().map_or_else(|| text.to_owned(), fill)
    }
}

impl Family {
    /// Runs of the family, in the order of the values.
    #[must_use]
    pub(crate) fn members(&self, axes: &BTreeMap<String, Vec<String>>) -> Vec<Member> {
        let Some(axis) = &self.over else {
            return vec![Member { value: None, run: self.name.clone() }];
        };
        let values = self.at.as_ref().or(axes.get(axis));
        let member = |value: &String| Member {
            value: Some((axis.clone(), value.clone())),
            run: format!("{}/{value}", self.name),
        };
        values.into_iter().flatten().map(member).collect()
    }
}

impl Study {
    /// Reads a study.
    ///
    /// # Errors
    /// [`RunError::Usage`] with the place if the file is missing, is not TOML or has an unknown
    /// key.
    pub(crate) fn read(path: &Path) -> Result<Self, RunError> {
        let shown = path.display();
        let text = input_file::read_text(path, MOST_BYTES).map_err(|error| match error {
            InputFileError::System(error) if error.kind() == std::io::ErrorKind::NotFound => {
                RunError::Usage(format!(
                    "there is no study {shown}; name a study file: coordinator reproduce STUDY"
                ))
            }
            error => input_failure(path, &error),
        })?;
        let study: Result<Self, _> = toml::from_str(&text);
        let mut study = study.map_err(|error| RunError::Usage(format!("{shown}: {error}")))?;
        study.figures.extend(study.measurements.iter().map(FigureSpec::from));
        Ok(study)
    }

    /// Lists all runs. Case files are relative to `folder`.
    #[must_use]
    pub(crate) fn runs(&self, folder: &Path) -> Vec<Run> {
        let of = |family: &Family| {
            let filled = |member: &Member, texts: &[String]| -> Vec<String> {
                texts.iter().map(|text| member.filled(text)).collect()
            };
            let run = |member: Member| Run {
                variant: Changes {
                    set: filled(&member, &family.set),
                    unset: filled(&member, &family.unset),
                },
                case: folder.join(&family.case),
                name: member.run,
            };
            family.members(&self.axes).into_iter().map(run).collect::<Vec<Run>>()
        };
        let measured = |measurement: &Measurement| {
            let run = |(name, set): (String, Vec<String>)| Run {
                name,
                case: folder.join(&measurement.case),
                variant: Changes { set, unset: Vec::new() },
            };
            measurement.runs().into_iter().map(run).collect::<Vec<Run>>()
        };
        let families = self.families.iter().flat_map(of);
        families.chain(self.measurements.iter().flat_map(measured)).collect()
    }

    /// Runs that a name refers to: all of a family, or a single one; `None` for an unknown name.
    #[must_use]
    pub(crate) fn members(&self, name: &str) -> Option<Vec<Member>> {
        let all = |family: &Family| family.members(&self.axes);
        match self.families.iter().find(|family| family.name == name) {
            Some(family) => Some(all(family)),
            None => {
                let one = self.families.iter().flat_map(all).find(|member| member.run == name);
                one.map(|member| vec![member])
            }
        }
    }

    /// Names and titles of the families and limits in a group, or of all.
    pub(crate) fn titles<'a>(
        &'a self,
        group: Option<&'a str>,
    ) -> impl Iterator<Item = (&'a str, &'a str)> + 'a {
        let families = self.families.iter().map(|f| (&f.name, &f.title, &f.group));
        let limits = self.limits.iter().map(|l| (&l.name, &l.title, &l.group));
        let wanted = move |(_, _, of): &(&String, &String, &String)| group.is_none_or(|g| g == *of);
        families.chain(limits).filter(wanted).map(|(name, title, _)| (&**name, &**title))
    }

    /// Names of everything that has results: runs, limits at each value, and measurements.
    #[must_use]
    pub(crate) fn names(&self) -> BTreeSet<String> {
        let runs = self.families.iter().flat_map(|family| family.members(&self.axes));
        let runs = runs.map(|member| member.run);
        let family = |name: &String| self.families.iter().find(|family| family.name == *name);
        let values = |limit: &Limit| {
            let members = limit.of.iter().filter_map(family).flat_map(|f| f.members(&self.axes));
            let name = |member: Member| match member.value {
                Some((_, value)) => format!("{}/{value}", limit.name),
                None => limit.name.clone(),
            };
            members.map(name).collect::<Vec<String>>()
        };
        let measured = self.measurements.iter().flat_map(|measurement| {
            let runs = measurement.runs().into_iter().map(|(name, _)| name);
            runs.chain([measurement.name.clone()]).collect::<Vec<String>>()
        });
        runs.chain(self.limits.iter().flat_map(values)).chain(measured).collect()
    }
}

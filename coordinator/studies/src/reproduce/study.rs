//! What a study says: its runs, and the tables, figures and text that are made of them.
//!
//! A study is data: `study.toml` names cases and what is changed in them, and a template beside it
//! holds the text. A *family* is one `[[run]]` entry; with `over` it is one run for each value of an
//! axis, named `FAMILY/VALUE`, and `{AXIS}` stands for the value in what it sets.

use crate::study::Variant;
use contract::input_file::{self, InputFileError};
use run::error::{RunError, input_failure};
use serde::Deserialize;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Larger files are refused [byte].
const MOST_BYTES: u64 = 1 << 24;

/// A study as its file has it.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Study {
    /// Name in one word.
    pub name: String,
    /// What it is about.
    pub title: String,
    /// The template of the text, beside the study.
    pub text: PathBuf,
    /// Named lists of values.
    #[serde(default)]
    pub axes: BTreeMap<String, Vec<String>>,
    /// What is run.
    #[serde(rename = "run")]
    pub families: Vec<Family>,
    /// What is extrapolated from runs.
    #[serde(default, rename = "limit")]
    pub limits: Vec<Limit>,
    /// Tables.
    #[serde(default, rename = "table")]
    pub tables: Vec<TableSpec>,
    /// Figures.
    #[serde(default, rename = "figure")]
    pub figures: Vec<FigureSpec>,
}

/// One run, or one for each value of an axis.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Family {
    /// Name that everything else refers to.
    pub name: String,
    /// What it is, as tables say it.
    #[serde(default)]
    pub title: String,
    /// The group whose rows it joins.
    #[serde(default)]
    pub group: String,
    /// The case file, as seen from the study.
    pub case: PathBuf,
    /// The axis whose values it takes.
    pub over: Option<String>,
    /// Some values of that axis in place of all.
    pub at: Option<Vec<String>>,
    /// Keys that are set.
    #[serde(default)]
    pub set: Vec<String>,
    /// Keys that are removed.
    #[serde(default)]
    pub unset: Vec<String>,
    /// How fine its grid is: elements along a length. Limits need it.
    pub fineness: Option<f64>,
}

/// A family of figures that no run gives: those of other families on an infinitely fine grid.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Limit {
    /// Name that everything else refers to.
    pub name: String,
    /// What it is, as tables say it.
    #[serde(default)]
    pub title: String,
    /// The group whose rows it joins.
    #[serde(default)]
    pub group: String,
    /// The families that it is taken from, coarsest first.
    pub of: Vec<String>,
    /// Order with which the error is expected to fall.
    pub order: f64,
}

/// A table.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct TableSpec {
    /// What the text calls it.
    pub id: String,
    /// What is shown.
    pub title: String,
    /// Name of the first column.
    pub head: String,
    /// The other columns.
    pub columns: Vec<Column>,
    /// The rows.
    pub rows: Vec<RowSpec>,
}

/// A column, or one for each value of an axis.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Column {
    /// Its name.
    pub head: String,
    /// The axis whose values it takes.
    pub over: Option<String>,
    /// The one value of a row's family that it shows.
    pub at: Option<String>,
    /// The template of its cells: `get(key)` is the figure of the row's run, `printed` the row's list.
    pub cell: String,
}

/// A row, or one for each family of a group.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct RowSpec {
    /// The group whose families make a row each.
    pub group: Option<String>,
    /// The family of this row, or one run of it.
    pub run: Option<String>,
    /// Its name, if it is not the family's title.
    pub name: Option<String>,
    /// What others have printed for it, for the columns' templates.
    #[serde(default)]
    pub printed: Vec<String>,
    /// Its cells as they are.
    pub cells: Option<Vec<String>>,
}

/// A figure: plots and maps.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct FigureSpec {
    /// What the text calls it.
    pub id: String,
    /// What is shown.
    pub title: String,
    /// Plots of lines.
    #[serde(default, rename = "plot")]
    pub plots: Vec<PlotSpec>,
    /// Maps.
    #[serde(default, rename = "map")]
    pub maps: Vec<MapSpec>,
}

/// Lines over an axis.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PlotSpec {
    /// What is shown.
    pub title: String,
    /// What is to the right, with its unit.
    pub x_label: String,
    /// What is upward, with its unit.
    pub y_label: String,
    /// The lines.
    pub lines: Vec<LineSpec>,
}

/// What values are divided by.
#[derive(Clone, Debug, Deserialize)]
#[serde(untagged)]
pub(crate) enum Divisor {
    /// A number.
    Number(f64),
    /// `max` is the largest magnitude of all; anything else a dotted key of the run's summary.
    Key(String),
}

impl Default for Divisor {
    fn default() -> Self {
        Self::Number(1.0)
    }
}

/// A line, or one for each run of a family. In its name `{AXIS}` stands for the value.
#[derive(Clone, Debug, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub(crate) enum LineSpec {
    /// A field along the centre line of a grid.
    Along {
        /// What it is.
        name: String,
        /// Run or family.
        run: String,
        /// Participant and grid, as the files of fields are named.
        grid: String,
        /// Column of the centre line.
        y: String,
        /// What the places are divided by.
        #[serde(default)]
        x_per: Divisor,
        /// What the values are divided by.
        #[serde(default)]
        y_per: Divisor,
    },
    /// A field of a section over the distance from the surface, through its largest value.
    Depth {
        /// What it is.
        name: String,
        /// Run or family.
        run: String,
        /// Participant and grid.
        grid: String,
        /// The field.
        field: String,
        /// What the distances are divided by.
        #[serde(default)]
        x_per: Divisor,
        /// What the values are divided by.
        #[serde(default)]
        y_per: Divisor,
    },
    /// A field of a section along its surface, which goes on behind the contact where a model has a wake.
    Surface {
        /// What it is.
        name: String,
        /// Run or family.
        run: String,
        /// Participant and grid.
        grid: String,
        /// The field.
        field: String,
        /// What the places are divided by.
        #[serde(default)]
        x_per: Divisor,
        /// What the values are divided by.
        #[serde(default)]
        y_per: Divisor,
    },
    /// One point for each run of a family.
    Curve {
        /// What it is.
        name: String,
        /// The family.
        run: String,
        /// Dotted key of the summary to the right.
        x: String,
        /// And upward.
        y: String,
        /// What x is divided by.
        #[serde(default)]
        x_per: Divisor,
        /// What y is divided by.
        #[serde(default)]
        y_per: Divisor,
    },
    /// What others have printed.
    Printed {
        /// What it is.
        name: String,
        /// Points.
        points: Vec<[f64; 2]>,
        /// A line through them in place of marks.
        #[serde(default)]
        joined: bool,
    },
}

impl LineSpec {
    /// The run or family that it shows.
    #[must_use]
    pub(crate) fn run(&self) -> Option<&str> {
        match self {
            Self::Along { run, .. }
            | Self::Depth { run, .. }
            | Self::Surface { run, .. }
            | Self::Curve { run, .. } => Some(run),
            Self::Printed { .. } => None,
        }
    }
}

/// A field over a plane, or one map for each run of a family.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct MapSpec {
    /// What is shown; `{AXIS}` stands for the value.
    pub title: String,
    /// Run or family.
    pub run: String,
    /// Participant and grid.
    pub grid: String,
    /// The field.
    pub field: String,
    /// What the colours are, with their unit.
    pub label: String,
    /// What is to the right.
    pub x_label: String,
    /// What is upward.
    pub y_label: String,
    /// What the values are divided by.
    #[serde(default)]
    pub per: Divisor,
    /// What x is divided by.
    #[serde(default)]
    pub x_per: Divisor,
    /// What y is divided by.
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
    /// What is changed in it.
    pub variant: Variant,
}

/// A run that something refers to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Member {
    /// Axis and value, for the names of lines.
    pub value: Option<(String, String)>,
    /// Name of the run.
    pub run: String,
}

impl Member {
    /// A text in which the value stands for `{AXIS}`.
    #[must_use]
    pub(crate) fn filled(&self, text: &str) -> String {
        let fill = |(axis, value): &(String, String)| text.replace(&format!("{{{axis}}}"), value);
        self.value.as_ref().map_or_else(|| text.to_owned(), fill)
    }
}

impl Family {
    /// Its runs, in the order of its values.
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
    /// [`RunError::Usage`] with the place in the file: it is no TOML, has a key that nothing reads,
    /// or refers to what it does not have.
    pub(crate) fn read(path: &Path) -> Result<Self, RunError> {
        let shown = path.display();
        let text = input_file::read_text(path, MOST_BYTES).map_err(|error| match error {
            InputFileError::System(error) if error.kind() == std::io::ErrorKind::NotFound => {
                RunError::Usage(format!("there is no study {shown}; name one: reproduce STUDY"))
            }
            error => input_failure(path, &error),
        })?;
        toml::from_str(&text).map_err(|error| RunError::Usage(format!("{shown}: {error}")))
    }

    /// Every run, the folder of the study being `folder`.
    #[must_use]
    pub(crate) fn runs(&self, folder: &Path) -> Vec<Run> {
        let of = |family: &Family| {
            let filled = |member: &Member, texts: &[String]| -> Vec<String> {
                texts.iter().map(|text| member.filled(text)).collect()
            };
            let run = |member: Member| Run {
                variant: Variant {
                    set: filled(&member, &family.set),
                    unset: filled(&member, &family.unset),
                },
                case: folder.join(&family.case),
                name: member.run,
            };
            family.members(&self.axes).into_iter().map(run).collect::<Vec<Run>>()
        };
        self.families.iter().flat_map(of).collect()
    }

    /// The runs that a name stands for: those of a family, or one; `None` for an unknown name.
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

    /// Names and titles of families and limits: of a group, or all.
    pub(crate) fn titles<'a>(
        &'a self,
        group: Option<&'a str>,
    ) -> impl Iterator<Item = (&'a str, &'a str)> + 'a {
        let families = self.families.iter().map(|f| (&f.name, &f.title, &f.group));
        let limits = self.limits.iter().map(|l| (&l.name, &l.title, &l.group));
        let wanted = move |(_, _, of): &(&String, &String, &String)| group.is_none_or(|g| g == *of);
        families.chain(limits).filter(wanted).map(|(name, title, _)| (&**name, &**title))
    }

    /// The names of everything that has figures: runs, and limits at each value.
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
        runs.chain(self.limits.iter().flat_map(values)).collect()
    }
}

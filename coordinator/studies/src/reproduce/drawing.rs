//! Draws the figures of a study from the fields and summaries of its runs.

use super::study::{Divisor, FigureSpec, LineSpec, MapSpec, Member, PlotSpec, Study};
use super::values::Values;
use pages::image::Palette;
use pages::map::Heatmap;
use pages::page::Block;
use pages::plot::Figure;
use pages::source::{Field, GridSeries, Image, Results};
use run::error::RunError;
use std::path::{Path, PathBuf};

/// A plot or a map.
#[derive(Clone, Debug)]
pub(super) enum Drawing {
    /// Lines over an axis.
    Plot(Figure),
    /// Colours over a plane.
    Map(Heatmap),
}

impl Drawing {
    /// The drawing as an SVG file of its own.
    #[must_use]
    pub(super) fn standalone(&self) -> String {
        match self {
            Self::Plot(figure) => figure.standalone(),
            Self::Map(map) => map.standalone(),
        }
    }

    /// Title of the drawing.
    #[must_use]
    pub(super) fn title(&self) -> &str {
        match self {
            Self::Plot(figure) => &figure.title,
            Self::Map(map) => &map.title,
        }
    }

    /// The drawing as part of a page.
    #[must_use]
    pub(super) fn block(&self) -> Block {
        match self {
            Self::Plot(figure) => Block::Figure(figure.clone()),
            Self::Map(map) => Block::Heatmap(map.clone()),
        }
    }
}

/// Data for the drawings.
pub(super) struct Sources<'a> {
    /// The study.
    pub(super) study: &'a Study,
    /// Results of the runs.
    pub(super) values: &'a Values,
    /// Returns the result folder of a run.
    pub(super) folder: &'a dyn Fn(&str) -> PathBuf,
}

type Points = Vec<[f64; 2]>;

impl Sources<'_> {
    /// Draws all plots and maps of a figure.
    ///
    /// # Errors
    /// [`RunError::Usage`] with the name of the figure and the missing item.
    pub(super) fn drawings(&self, figure: &FigureSpec) -> Result<Vec<Drawing>, RunError> {
        let wrong = |reason| RunError::Usage(format!("figure `{}`: {reason}", figure.id));
        let mut drawings = Vec::new();
        for plot in &figure.plots {
            drawings.push(Drawing::Plot(self.plot(plot).map_err(wrong)?));
        }
        for map in &figure.maps {
            for member in self.members(&map.run) {
                drawings.push(Drawing::Map(self.map(map, &member).map_err(wrong)?));
            }
        }
        Ok(drawings)
    }

    fn members(&self, run: &str) -> Vec<Member> {
        self.study.members(run).unwrap_or_default()
    }

    fn plot(&self, spec: &PlotSpec) -> Result<Figure, String> {
        let mut figure = Figure::new(&spec.title, &spec.x_label, &spec.y_label);
        for line in &spec.lines {
            if let LineSpec::Measured { measurement } = line {
                figure = self.measured(figure, measurement)?;
            }
            for (name, points, style) in self.lines(line)? {
                figure = match style {
                    Style::Marks => figure.with_marks(name, points),
                    Style::Line | Style::Dots => figure.with(name, points),
                };
                if let Some(line) = figure.lines.last_mut() {
                    line.dots = style == Style::Dots;
                }
            }
        }
        Ok(figure)
    }

    /// Adds a measurement: values with their scatter, computed values, and the band of the inputs.
    fn measured(&self, figure: Figure, name: &str) -> Result<Figure, String> {
        let found = self.study.measurements.iter().find(|measurement| measurement.name == name);
        let spec = found.ok_or_else(|| format!("there is no measurement `{name}`"))?;
        let comparison = self.values.comparison(name)?;
        let points = |values: &[f64]| -> Points {
            let pairs = comparison.x.iter().zip(values);
            pairs.map(|(x, y)| [x / spec.x.per, y / spec.y.per]).collect()
        };
        let spreads = comparison.scatter.iter().flatten().map(|spread| spread / spec.y.per.abs());
        let mut figure = figure.with("computed, without a fit", points(&comparison.stated));
        for (fit, fitted) in spec.fits.iter().zip(comparison.fitted()) {
            let second = fit.second.as_ref().map(|second| format!(" and {}", second.label));
            let name = format!("computed, {}{} fitted", fit.label, second.unwrap_or_default());
            figure = figure.with(name, points(&fitted));
        }
        if let Some([low, high]) = comparison.band() {
            figure = figure.with("lowest, within the inputs", points(&low));
            figure = figure.with("highest, within the inputs", points(&high));
        }
        for line in &mut figure.lines {
            line.dots = false;
        }
        Ok(figure.with_spread("measured", points(&comparison.measured), spreads.collect()))
    }

    fn lines(&self, spec: &LineSpec) -> Result<Vec<(String, Points, Style)>, String> {
        match spec {
            LineSpec::Along { name, run, .. }
            | LineSpec::Depth { name, run, .. }
            | LineSpec::Surface { name, run, .. } => self
                .members(run)
                .iter()
                .map(|member| Ok((member.filled(name), self.field(spec, member)?, Style::Line)))
                .collect(),
            LineSpec::Curve { name, run, x, y, x_per, y_per } => {
                let members = self.members(run);
                let point =
                    |m: &Member| Ok([self.values.get(&m.run, x)?, self.values.get(&m.run, y)?]);
                let points = members.iter().map(point).collect::<Result<Points, String>>()?;
                let points = self.divided(points, x_per, y_per, run)?;
                Ok(vec![(name.clone(), points, Style::Dots)])
            }
            LineSpec::Measured { .. } => Ok(Vec::new()),
            LineSpec::Printed { name, points, joined } => {
                let style = if *joined { Style::Line } else { Style::Marks };
                Ok(vec![(name.clone(), points.clone(), style)])
            }
        }
    }

    /// Reads a field of one run, along the centre line or over the depth.
    fn field(&self, spec: &LineSpec, member: &Member) -> Result<Points, String> {
        let (points, x_per, y_per) = match spec {
            LineSpec::Along { grid, y, x_per, y_per, .. } => {
                let series = self.series(&member.run, grid)?;
                let column = |name: &str| {
                    let found = series.line.as_ref().and_then(|line| line.column(name));
                    found.ok_or_else(|| format!("{grid} of `{}` has no `{name}`", member.run))
                };
                let (places, values) = (column("x [m]")?, column(y)?);
                (places.into_iter().zip(values).map(|(x, y)| [x, y]).collect(), x_per, y_per)
            }
            LineSpec::Depth { grid, field, x_per, y_per, .. } => {
                let (image, field) = self.image(&member.run, grid, field)?;
                let column = image.through_largest(&field);
                let (_, points) = column.ok_or_else(|| format!("{grid} is not a section"))?;
                (points, x_per, y_per)
            }
            LineSpec::Surface { grid, field, x_per, y_per, .. } => {
                let (image, field) = self.image(&member.run, grid, field)?;
                let points = image.along_surface(&field);
                (points.ok_or_else(|| format!("{grid} is not a section"))?, x_per, y_per)
            }
            LineSpec::Curve { .. } | LineSpec::Measured { .. } | LineSpec::Printed { .. } => {
                return Ok(Vec::new());
            }
        };
        self.divided(points, x_per, y_per, &member.run)
    }

    fn divided(
        &self,
        points: Points,
        x_per: &Divisor,
        y_per: &Divisor,
        run: &str,
    ) -> Result<Points, String> {
        let x = self.divisor(x_per, points.iter().map(|p| p[0]), run)?;
        let y = self.divisor(y_per, points.iter().map(|p| p[1]), run)?;
        Ok(points.iter().map(|p| [p[0] / x, p[1] / y]).collect())
    }

    fn divisor(
        &self,
        divisor: &Divisor,
        values: impl Iterator<Item = f64>,
        run: &str,
    ) -> Result<f64, String> {
        match divisor {
            Divisor::Number(number) => Ok(*number),
            Divisor::Key(key) if key == "max" => {
                let largest =
                    values.filter(|v| v.is_finite()).fold(0.0, |l: f64, v| l.max(v.abs()));
                Ok(if largest > 0.0 { largest } else { 1.0 })
            }
            Divisor::Key(key) => self.values.get(run, key),
        }
    }

    fn map(&self, spec: &MapSpec, member: &Member) -> Result<Heatmap, String> {
        let (image, field) = self.image(&member.run, &spec.grid, &spec.field)?;
        let plane = image.plane().ok_or_else(|| format!("{} is not a plane", spec.grid))?;
        let mut values = field.magnitudes();
        let per = self.divisor(&spec.per, values.iter().copied(), &member.run)?;
        for value in &mut values {
            *value = if *value == 0.0 { f64::NAN } else { *value / per };
        }
        let borders = |axis: usize, per: &Divisor| {
            let per = self.divisor(per, image.borders(axis).into_iter(), &member.run)?;
            Ok::<_, String>(image.borders(axis).map(|border| border / per))
        };
        Ok(Heatmap {
            title: member.filled(&spec.title),
            x_label: spec.x_label.clone(),
            y_label: spec.y_label.clone(),
            value_label: spec.label.clone(),
            x: borders(plane[0], &spec.x_per)?,
            y: borders(plane[1], &spec.y_per)?,
            columns: image.cells[plane[0]],
            values,
            from_zero: true,
            palette: Palette::Sequential,
            true_shape: true,
            arrows: None,
            edges: Vec::new(),
            note: String::new(),
        })
    }

    fn series(&self, run: &str, grid: &str) -> Result<GridSeries, String> {
        let folder = (self.folder)(run);
        let results = Results::read(&folder).map_err(|error| error.to_string())?;
        let all: Vec<&str> = results.series.iter().map(|series| series.name.as_str()).collect();
        let missing = format!("`{run}` has no fields on {grid}; known grids: {}", all.join(", "));
        results.series.into_iter().find(|series| series.name == grid).ok_or(missing)
    }

    fn image(&self, run: &str, grid: &str, name: &str) -> Result<(Image, Field), String> {
        let image = self.series(run, grid)?.image;
        let image = image.ok_or_else(|| format!("{grid} of `{run}` is not an image"))?;
        let field = image.field(name).cloned();
        let field = field.ok_or_else(|| format!("{grid} of `{run}` has no field `{name}`"))?;
        Ok((image, field))
    }
}

/// Style of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Style {
    Line,
    Dots,
    Marks,
}

/// File name of the n-th drawing of a figure.
#[must_use]
pub(super) fn file_name(figure: &FigureSpec, n: usize) -> PathBuf {
    Path::new(&format!("fig-{}-{}.svg", figure.id, n + 1)).to_owned()
}

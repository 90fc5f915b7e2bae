//! Fits all figures of a sweep in parallel, and prints the result.

use super::held::HeldOut;
use super::samples::{Quotient, Samples};
use super::scales::{Axes, fit};
use crate::study::table::{Cell, Column, Table};
use crate::sweep::Study;
use run::error::RunError;
use run::format::{counted, number, of_key};
use std::sync::atomic::{AtomicUsize, Ordering};
use surrogate::{Document, FittedFigure, Key, Measure, Origin, SCHEMA, Scale, Surrogate};

/// A fitted surrogate and the data for its report.
pub(super) struct Made {
    /// The surrogate.
    pub document: Document,
    /// Samples used for the fit.
    pub samples: Samples,
    /// Keys of figures that could not be fitted, with the reason.
    pub left_out: Vec<(String, String)>,
}

impl Made {
    /// Fits a surrogate to a sweep.
    ///
    /// # Errors
    /// [`RunError::Usage`] if the samples are unsuitable or no figure can be fitted.
    pub(super) fn of(study: &Study, per: &[Quotient]) -> Result<Self, RunError> {
        let samples = Samples::of(study, per)?;
        let (figures, left_out) = fitted(&samples);
        if figures.is_empty() {
            return Err(RunError::Usage(format!(
                "no figure of the sweep can be fitted ({}); use more points or smaller ranges",
                left_out.first().map_or("the sweep has no figures", |(_, why)| why)
            )));
        }
        let options = study.options.iter().cloned();
        let fixed = samples.fixed.iter().flat_map(|one| ["--set".to_owned(), one.clone()]);
        let origin = Origin {
            case: study.case.clone(),
            file: study.file.clone(),
            options: options.chain(fixed).collect(),
            identity: study.identity.digest(),
            points: samples.points,
            left_out: samples.failed + samples.cut,
        };
        let (keys, coordinates) = (samples.keys.clone(), samples.coordinates.clone());
        let document = Document { schema: SCHEMA, origin, keys, coordinates, figures };
        // What is written can be read.
        Surrogate::new(&document).map_err(|fault| {
            let fix = "vary fewer keys";
            RunError::Usage(format!("the surrogate could not be used: {fault}; {fix}"))
        })?;
        Ok(Self { document, samples, left_out })
    }

    /// Contents of the file of the surrogate.
    #[must_use]
    pub(super) fn file(&self) -> Vec<u8> {
        let mut text = serde_json::to_vec(&self.document).expect("plain data");
        text.push(b'\n');
        text
    }
}

/// Fits the figures in parallel and returns them in order, followed by the figures that cannot be
/// fitted, with the reason.
pub(super) fn fitted(samples: &Samples) -> (Vec<FittedFigure>, Vec<(String, String)>) {
    let (axes, held) = (Axes::of(samples), HeldOut::of(&samples.key_values));
    let next = AtomicUsize::new(0);
    let take = || {
        let n = next.fetch_add(1, Ordering::Relaxed);
        Some((n, samples.figures.get(n)?))
    };
    let work = || {
        let mut done = Vec::new();
        while let Some((n, (quantity, values))) = take() {
            let found = fit(quantity, values, &axes, &held);
            done.push((n, found.map_err(|why| (quantity.key.clone(), why))));
        }
        done
    };
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let mut done = std::thread::scope(|scope| {
        let all: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        all.into_iter()
            .flat_map(|one| one.join().expect("fitting does not panic"))
            .collect::<Vec<_>>()
    });
    done.sort_by_key(|(n, _)| *n);
    let (mut figures, mut left_out) = (Vec::new(), Vec::new());
    for (_, one) in done {
        match one {
            Ok(figure) => figures.push(figure),
            Err(told) => left_out.push(told),
        }
    }
    (figures, left_out)
}

/// Relative errors below this are rounding errors.
const ROUNDING: f64 = 1e-10;

/// Report: the box, the figures with their errors, and the points left out.
pub(super) fn text(made: &Made) -> String {
    let document = &made.document;
    let keys: String =
        document.keys.iter().map(|one| format!("  {:40}  {}\n", one.key, interval(one))).collect();
    let quotients = document.coordinates.iter().filter_map(|one| {
        let name = format!("{}/{}", one.key, one.per.as_ref()?);
        Some(format!("  {name:40}  {} to {}\n", one.from, one.to))
    });
    let figures: Vec<&FittedFigure> = document.figures.iter().collect();
    let left_out = made.left_out.iter().map(|(key, why)| format!("  not fitted: {key}: {why}\n"));
    format!(
        "surrogate of {}, {}\n{keys}{}{}{}{}",
        document.origin.case,
        counted(made.samples.points as u64, "point"),
        quotients.collect::<String>(),
        without_answer(made),
        table().terminal(&figures),
        left_out.collect::<String>()
    )
}

fn interval(one: &Key) -> String {
    let unit = if matches!(one.unit.as_str(), "" | "1") { "" } else { &one.unit };
    format!("{} to {} {unit}", one.from, one.to).trim_end().to_owned()
}

/// Describes the points that were left out because some have no result.
fn without_answer(made: &Made) -> String {
    let [failed, cut] = [made.samples.failed, made.samples.cut].map(|count| count as u64);
    match (failed, cut) {
        (0, _) => String::new(),
        (_, 0) => format!("  {} without a result, outside the box\n", counted(failed, "point")),
        _ => format!(
            "  {} without a result; the box was reduced to exclude them, which leaves out {} with \
             results\n",
            counted(failed, "point"),
            counted(cut, "point")
        ),
    }
}

fn table<'a>() -> Table<'a, FittedFigure> {
    let error = |one: &FittedFigure, error: f64| match one.held.measure {
        Measure::Relative if error < ROUNDING => Cell::text("rounding"),
        Measure::Relative => Cell::text(format!("{} %", number(100.0 * error, 2))),
        Measure::Absolute => Cell::text(of_key(&one.key, error).show(error, 2)),
    };
    Table::new(vec![
        Column::text("figure", |one: &FittedFigure| one.key.clone()).naming(),
        Column::quantity("largest error", move |one: &FittedFigure| error(one, one.held.largest)),
        Column::quantity("rms", move |one: &FittedFigure| error(one, one.held.rms)),
        Column::quantity("terms", |one: &FittedFigure| Cell::text(one.degrees.len())),
        Column::text("scales", |one: &FittedFigure| {
            let word = |scale: &Scale| if *scale == Scale::Log { "log" } else { "lin" };
            let of: Vec<&str> = one.scales.iter().map(word).collect();
            format!("{}({})", word(&one.scale), of.join(","))
        }),
    ])
}

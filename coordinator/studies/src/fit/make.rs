//! A surrogate made of samples, some figures at a time.

use super::held::HeldOut;
use super::samples::{Quotient, Samples};
use super::scales::{Axes, fit};
use crate::sweep::Study;
use run::error::RunError;
use std::sync::atomic::{AtomicUsize, Ordering};
use surrogate::{Document, FittedFigure, Origin, SCHEMA};

/// A surrogate, and what there is to say of it.
pub(super) struct Made {
    /// The surrogate.
    pub document: Document,
    /// What it was made of.
    pub samples: Samples,
    /// Keys of figures that it has not, and why.
    pub left_out: Vec<(String, String)>,
}

impl Made {
    /// Makes one of a sweep.
    ///
    /// # Errors
    /// [`RunError::Usage`]: none can be made of it.
    pub(super) fn of(study: &Study, per: &[Quotient]) -> Result<Self, RunError> {
        let samples = Samples::of(study, per)?;
        let (figures, left_out) = fitted(&samples);
        if figures.is_empty() {
            return Err(RunError::Usage(format!(
                "no figure of the sweep can be fitted; more points, or a smaller range: {}",
                left_out.first().map_or("it has none", |(_, why)| why)
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
        Ok(Self { document, samples, left_out })
    }

    /// The surrogate as a file.
    #[must_use]
    pub(super) fn file(&self) -> Vec<u8> {
        let mut text = serde_json::to_vec(&self.document).expect("plain data");
        text.push(b'\n');
        text
    }
}

/// The figures, some at a time, in their order; those that cannot be fitted apart.
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
            .flat_map(|one| one.join().expect("numbers do not panic"))
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

//! The runs of a sweep, one after the other; what has been run is never run again.

use super::study::{Row, Study};
use crate::study::axis::points;
use crate::study::folder::StudyFolder;
use crate::study::levels::reason;
use crate::study::output::Kept;
use crate::study::progress::Steps;
use crate::study::quantity::{Quantities, Quantity};
use crate::study::{Variant, ends_study, run};
use run::error::RunError;
use std::collections::BTreeMap;
use std::path::Path;
use std::time::{Duration, Instant};

/// Time after which what has been found is written.
const WRITTEN: Duration = Duration::from_secs(1);

/// Runs every point that `study` lacks.
///
/// # Errors
/// The user has stopped it, the file system.
pub(super) fn fill(
    study: &mut Study,
    case: &Path,
    base: &Variant,
    quantities: &Quantities,
    folder: &StudyFolder,
    (quiet, scratch): (bool, &Path),
) -> Result<(), RunError> {
    let missing: Vec<Vec<usize>> =
        points(&study.vary).filter(|at| study.rows.iter().all(|row| row.at != *at)).collect();
    let mut steps = Steps::new(quiet, missing.len());
    let mut written = Instant::now();
    for at in missing {
        let set = study.vary.iter().zip(&at).map(|(one, at)| (&one.key, &one.values[*at]));
        let told: Vec<String> =
            set.clone().map(|(key, value)| format!("{key} = {value}")).collect();
        steps.step(&told.join(", "));
        let variant = set.fold(base.clone(), |all, (key, value)| all.with(key, value));
        let since = Instant::now();
        let ended = run(case, &variant.with("output.fields", "none"), scratch);
        let mut row = Row {
            at,
            values: BTreeMap::new(),
            failed: None,
            wall_s: since.elapsed().as_secs_f64(),
        };
        match ended {
            Ok(summary) => {
                let all = quantities.all(&summary);
                let of_run = all.iter().filter(|one| !one.key.starts_with("coupling."));
                for one in of_run {
                    let Some(value) = one.value(&summary) else { continue };
                    row.values.insert(one.key.clone(), value);
                    learn(&mut study.quantities, one);
                }
            }
            Err(error) if ends_study(&error) => {
                study.write(folder)?;
                return Err(error);
            }
            Err(error) => row.failed = Some(reason(&error)),
        }
        study.wall_s += row.wall_s;
        study.rows.push(row);
        if written.elapsed() > WRITTEN {
            study.write(folder)?;
            written = Instant::now();
        }
    }
    steps.finish();
    study.rows.sort_by(|a, b| a.at.cmp(&b.at));
    study.complete = true;
    Ok(())
}

fn learn(known: &mut Vec<Quantity>, one: &Quantity) {
    if known.iter().all(|other| other.key != one.key) {
        known.push(one.clone());
    }
}

//! The runs as a table for other programs.

use super::{Run, Study};
use std::collections::BTreeSet;

/// One row a run: its level and settings, cost, values and errors.
pub(super) fn text(study: &Study) -> String {
    let runs = &study.runs;
    let settings: BTreeSet<&str> = all(runs, |run| run.settings.iter().map(|(key, _)| key));
    let roles: BTreeSet<&str> = all(runs, |run| run.cost.cpu_s.keys());
    let resident: BTreeSet<&str> = all(runs, |run| run.cost.peak_rss_bytes.keys());
    let keys: Vec<&str> = study.quantities.iter().map(|one| one.key.as_str()).collect();
    let mut out = csv::Writer::from_writer(Vec::new());
    let mut head: Vec<String> = vec!["models".to_owned()];
    head.extend(settings.iter().map(|key| (*key).to_owned()));
    head.extend(["wall_s", "solve_s"].map(str::to_owned));
    head.extend(roles.iter().map(|role| format!("{role}_cpu_s")));
    head.extend(resident.iter().map(|role| format!("{role}_peak_rss_bytes")));
    head.push("iterations".to_owned());
    head.extend(keys.iter().map(|key| (*key).to_owned()));
    head.extend(keys.iter().map(|key| format!("error of {key}")));
    head.extend(["pareto", "failed"].map(str::to_owned));
    let written = out.write_record(&head).and_then(|()| {
        runs.iter().try_for_each(|run| {
            let mut row = vec![study.levels[run.level].name.clone()];
            let setting = |key: &&str| run.settings.iter().find(|(own, _)| own == *key);
            row.extend(
                settings.iter().map(|key| setting(key).map_or_else(String::new, |s| s.1.clone())),
            );
            row.extend([run.cost.wall_s, run.cost.solve_s].map(|v| v.to_string()));
            row.extend(roles.iter().map(|role| shown(run.cost.cpu_s.get(*role))));
            row.extend(resident.iter().map(|role| shown(run.cost.peak_rss_bytes.get(*role))));
            row.push(run.cost.iterations.to_string());
            row.extend(keys.iter().map(|key| shown(run.values.get(*key))));
            row.extend(keys.iter().map(|key| shown(run.errors.get(*key))));
            row.extend([run.pareto.to_string(), run.failed.clone().unwrap_or_default()]);
            out.write_record(&row)
        })
    });
    written.expect("a vector takes all that is written");
    let bytes = out.into_inner().expect("a vector takes all that is written");
    String::from_utf8(bytes).expect("only text was written")
}

fn all<'a, I: Iterator<Item = &'a String>>(
    runs: &'a [Run],
    of: impl Fn(&'a Run) -> I,
) -> BTreeSet<&'a str> {
    runs.iter().flat_map(of).map(String::as_str).collect()
}

fn shown(value: Option<&impl ToString>) -> String {
    value.map(ToString::to_string).unwrap_or_default()
}

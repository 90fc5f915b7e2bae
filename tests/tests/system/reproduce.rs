//! The paper reproduced: the page that is kept is fresh, its figures are right, and a study that is
//! wrong is refused before anything of it runs.

use crate::harness::{Ended, Place, case, root};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

fn reproduce(place: &Place, study: &Path, more: &[&str]) -> Ended {
    let (study, out) = (study.display().to_string(), place.out().display().to_string());
    let mut arguments = vec!["reproduce", &study, "--out", &out, "--replace"];
    arguments.extend(more);
    place.start(&arguments).wait()
}

/// A figure of one run of a reproduction.
fn figure(record: &Value, run: &str, pointer: &str) -> f64 {
    let runs = record["runs"].as_array().unwrap();
    let found = runs.iter().find(|one| one["name"] == run);
    let found = found.unwrap_or_else(|| panic!("there is no run {run}"));
    found["summary"].pointer(pointer).and_then(Value::as_f64).unwrap()
}

fn assert_close(found: f64, expected: f64, tolerance: f64, what: &str) {
    let off = (found - expected).abs();
    assert!(off <= tolerance, "{what}: {found}, expected {expected} ± {tolerance}");
}

const RISE: &str = "/temperature/rail/max_rise_k";

/// Everything is run once more; the page says the same, and its figures are those that theory and
/// CONTACT give.
#[test]
fn the_paper_that_is_kept_is_fresh_and_right() {
    let place = Place::new();
    let study = root().join("cases/paper/study.toml");
    let kept = root().join("docs/paper.md").display().to_string();
    let ended = reproduce(&place, &study, &["--check", &kept]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    place.assert_nothing_left();
    let record = fs::read_to_string(place.out().join("reproduce.json")).unwrap();
    let record: Value = serde_json::from_str(&record).unwrap();
    assert_carter_strips(&record);
    assert_half_spaces(&record);
    assert_methods(&record);
    assert_shown(&place);
    // One drawing for each file.
    let drawings = fs::read_dir(place.out().join("img")).unwrap().count();
    crate::report::assert_study_is_shown(&place.out().join("report.html"), drawings);
}

/// Carter strips on the patch of Table 2; the tolerances are the last digits of the reference
/// figures and the grid's error, 0.2 %, together.
fn assert_carter_strips(record: &Value) {
    let rows = [
        ("0.58", 298.2, -0.829, -0.01149),
        ("0.50", 209.0, -0.857, -0.00832),
        ("0.40", 137.8, -0.886, -0.00594),
        ("0.20", 44.3, -0.943, -0.00258),
    ];
    for (mu, rise, x_over_a, creepage) in rows {
        let of = |pointer: &str| figure(record, &format!("carter-table-2/{mu}"), pointer);
        assert_close(of(RISE), rise, 2e-3 * rise, mu);
        assert_close(of("/temperature/rail/x_over_a"), x_over_a, 5e-3, mu);
        assert_close(of("/contact/creepage_xi"), creepage, 5e-6, mu);
    }
}

/// Half-spaces extrapolated to first order from a/40 and a/80, against CONTACT's own limits. The
/// tolerance covers what a/40 leaves at first order, more at μ = 0.2 with its narrow slip zone.
fn assert_half_spaces(record: &Value) {
    let rows = [
        ("0.58", 226.9, 0.004),
        ("0.50", 152.1, 0.004),
        ("0.40", 98.6, 0.004),
        ("0.30", 60.3, 0.004),
        ("0.20", 31.5, 0.009),
    ];
    for (mu, limit, tolerance) in rows {
        let [coarse, fine] =
            [40, 80].map(|n| figure(record, &format!("half-space-{n}/{mu}"), RISE));
        assert_close(2.0 * fine - coarse, limit, tolerance * limit, mu);
    }
}

/// The paper's closed forms with its own inputs, to the last digit of the reference figures.
fn assert_methods(record: &Value) {
    for (run, rise, x_over_a) in [("knothe-liebelt", 260.9, -0.652), ("ertz-knothe", 261.9, -0.647)]
    {
        assert_close(figure(record, run, RISE), rise, 0.06, run);
        assert_close(figure(record, run, "/temperature/rail/x_over_a"), x_over_a, 1e-3, run);
    }
}

/// The page of the folder can be written again, and shows every drawing that lies there as a file.
fn assert_shown(place: &Place) {
    let page = place.out().join("report.html");
    let first = fs::read_to_string(&page).unwrap();
    fs::remove_file(&page).unwrap();
    let out = place.out().display().to_string();
    assert_eq!(place.start(&["report", &out]).wait().code, Some(0));
    assert_eq!(fs::read_to_string(&page).unwrap(), first);
    let images = fs::read_dir(place.out().join("img")).unwrap().flatten();
    let images: Vec<String> =
        images.map(|image| fs::read_to_string(image.path()).unwrap()).collect();
    assert!(images.len() > 10, "{}", images.len());
    assert_eq!(first.matches("<svg class=\"plot\"").count(), images.len());
    for image in images {
        assert!(image.starts_with("<svg") && image.contains("<style>"), "{image:.200}");
        assert!(image.contains("class=\"line") || image.contains("class=\"map\""), "{image:.200}");
        assert!(!image.contains("NaN") && !image.contains("inf\""), "{image:.200}");
    }
}

/// A small study in a folder of its own.
struct Small {
    folder: TempDir,
}

impl Small {
    /// The study with each text of `changes` replaced by another.
    fn new(changes: &[(&str, &str)]) -> Self {
        let small = Self { folder: tempfile::tempdir().unwrap() };
        small.write(changes);
        small
    }

    fn write(&self, changes: &[(&str, &str)]) {
        let [mut study, mut text] = [STUDY.replace("CASE", &case("wheel-rail.toml")), TEXT.into()];
        for (old, new) in changes {
            assert!(study.contains(old) || text.contains(old), "nothing says {old}");
            study = study.replace(old, new);
            text = text.replace(old, new);
        }
        fs::write(self.study(), study).unwrap();
        fs::write(self.folder.path().join("text.md.j2"), text).unwrap();
    }

    fn study(&self) -> PathBuf {
        self.folder.path().join("study.toml")
    }
}

const STUDY: &str = r#"
name = "small"
title = "two runs"
text = "text.md.j2"
[axes]
mu = ["0.58", "0.2"]
[[run]]
name = "strips"
title = "strips"
group = "all"
case = "CASE"
over = "mu"
set = ["mech.model=hertz-carter", "motion.traction_coefficient={mu}", "materials.steel.conductivity=50"]
[[table]]
id = "t"
title = "rises"
head = "from"
columns = [{ head = "μ = {mu}", over = "mu", cell = "{{ get('temperature.rail.max_rise_k') | fixed(1) }}" }]
rows = [{ name = "printed", cells = ["311", "50"] }, { group = "all" }]
[[figure]]
id = "f"
title = "lines"
[[figure.plot]]
title = "lines"
x_label = "x"
y_label = "K"
lines = [{ kind = "along", name = "{mu}", run = "strips", grid = "thermal_contact", y = "rail_temperature [K]" }]
"#;

const TEXT: &str = "# Small\n\n{{ table('t') }}\n\n{{ figure('f') }}\n\n\
                    {{ value('strips/0.2', 'contact.creepage_xi') | digits(3) }}\n";

/// Exit code 2, the place and the reason; and nothing has been run.
#[test]
fn a_study_that_is_wrong_is_refused_before_anything_runs() {
    let wrong: [(&str, &str, &[&str]); 9] = [
        ("over = \"mu\"\nset", "colour = 1\nset", &["study.toml", "line 12", "colour"]),
        ("run = \"strips\"", "run = \"stripes\"", &["figure `f`", "`stripes`", "there is strips"]),
        ("wheel-rail.toml", "no-such.toml", &["run `strips`", "no-such.toml"]),
        ("over = \"mu\"\nset", "over = \"nu\"\nset", &["run `strips`", "no axis `nu`"]),
        ("hertz-carter", "hertz-cater", &["run `strips/0.58`", "mech.model", "hertz-cater"]),
        ("\"311\", \"50\"", "\"311\"", &["table `t`, row `printed`", "1 cells for 2 columns"]),
        ("{{ table('t') }}", "{{ table('t') }", &["text.md.j2:3:"]),
        ("{{ figure('f') }}", "{{ figure('g') }}", &["text.md.j2:5:", "no figure `g`", "is f"]),
        ("strips/0.2'", "strips/0.3'", &["text.md.j2:7:", "no run `strips/0.3`"]),
    ];
    for (old, new, told) in wrong {
        let (place, small) = (Place::new(), Small::new(&[(old, new)]));
        let ended = reproduce(&place, &small.study(), &[]);
        assert_eq!(ended.code, Some(2), "{new}: {}", ended.stderr);
        for part in told {
            assert!(ended.stderr.contains(part), "`{part}` is missing: {}", ended.stderr);
        }
        assert!(!place.out().exists(), "{new}: something was written");
    }
}

/// A folder that holds something else is left alone.
#[test]
fn a_folder_with_other_files_is_refused() {
    let (place, small) = (Place::new(), Small::new(&[]));
    fs::create_dir(place.out()).unwrap();
    fs::write(place.out().join("notes.txt"), "mine").unwrap();
    let ended = reproduce(&place, &small.study(), &[]);
    assert_eq!(ended.code, Some(2), "{}", ended.stderr);
    assert!(
        ended.stderr.contains("holds files but no results of `coordinator reproduce`"),
        "{}",
        ended.stderr
    );
    assert_eq!(fs::read_dir(place.out()).unwrap().count(), 1);
}

/// The comparison passes what has not changed, and finds a printed value and a material that have.
#[test]
fn a_page_that_is_stale_is_found() {
    let (place, small) = (Place::new(), Small::new(&[]));
    let kept = small.folder.path().join("kept.md");
    let path = kept.display().to_string();
    let ended = reproduce(&place, &small.study(), &["--write", &path]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let page = fs::read_to_string(&kept).unwrap();
    assert!(page.contains("| printed | 311 | 50 |"), "{page}");
    assert!(page.contains("](img/kept/fig-f-1.svg)"), "{page}");
    let check = |changes: &[(&str, &str)]| {
        small.write(changes);
        let ended = reproduce(&place, &small.study(), &["--check", &path]);
        (ended.code, ended.stderr)
    };
    let (code, told) = check(&[]);
    assert_eq!(code, Some(0), "{told}");
    let (code, told) = check(&[("\"311\"", "\"313\"")]);
    assert_eq!(code, Some(4), "{told}");
    assert!(told.contains("kept.md:7") && told.contains("| printed | 313 | 50 |"), "{told}");
    let (code, told) = check(&[("conductivity=50", "conductivity=45")]);
    assert_eq!(code, Some(4), "{told}");
    assert!(told.contains("kept.md:8") && told.contains("strips"), "{told}");
    // A plot of which the text says nothing.
    let svg = small.folder.path().join("img/kept/fig-f-1.svg");
    let drawn = fs::read_to_string(&svg).unwrap();
    fs::write(&svg, drawn.replace("[K]", "[F]").replace(">K<", ">F<")).unwrap();
    let (code, told) = check(&[]);
    assert_eq!(code, Some(4), "{told}");
    assert!(told.contains("fig-f-1.svg"), "{told}");
    place.assert_nothing_left();
}

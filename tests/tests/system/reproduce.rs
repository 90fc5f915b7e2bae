//! Reproduction of studies: rejection of an invalid study before any run, and detection of an
//! outdated page.

use crate::harness::{Place, case};
use std::fs;
use std::path::PathBuf;
use tempfile::TempDir;
use tests::harness::paper::reproduce;

/// Small study in a folder of its own.
struct Small {
    folder: TempDir,
}

impl Small {
    /// Creates the study with replacements of text.
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

/// Exit code 2, with place and reason; nothing has run.
#[test]
fn a_study_that_is_wrong_is_refused_before_anything_runs() {
    let wrong: [(&str, &str, &[&str]); 9] = [
        ("over = \"mu\"\nset", "colour = 1\nset", &["study.toml", "line 12", "colour"]),
        ("run = \"strips\"", "run = \"stripes\"", &["figure `f`", "`stripes`", "known: strips"]),
        ("wheel-rail.toml", "no-such.toml", &["run `strips`", "no-such.toml"]),
        ("over = \"mu\"\nset", "over = \"nu\"\nset", &["run `strips`", "no axis `nu`"]),
        ("hertz-carter", "hertz-cater", &["run `strips/0.58`", "mech.model", "hertz-cater"]),
        ("\"311\", \"50\"", "\"311\"", &["table `t`, row `printed`", "1 cells for 2 columns"]),
        ("{{ table('t') }}", "{{ table('t') }", &["text.md.j2:3:"]),
        ("{{ figure('f') }}", "{{ figure('g') }}", &["text.md.j2:5:", "no figure `g`", "known: f"]),
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

/// A folder with foreign files is left unchanged.
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

/// The comparison accepts an unchanged page, whatever the number of jobs, and detects a changed
/// value and a changed material.
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
        let ended = reproduce(&place, &small.study(), &["--check", &path, "--jobs", "2"]);
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
    // A plot not mentioned in the text.
    let svg = small.folder.path().join("img/kept/fig-f-1.svg");
    let drawn = fs::read_to_string(&svg).unwrap();
    fs::write(&svg, drawn.replace("[K]", "[F]").replace(">K<", ">F<")).unwrap();
    let (code, told) = check(&[]);
    assert_eq!(code, Some(4), "{told}");
    assert!(told.contains("fig-f-1.svg"), "{told}");
    place.assert_nothing_left();
}

/// A study with one measurement on a rig that does not exist: f = 0.4 with a noise of 10 N, and a
/// row of units.
struct Rig(Small);

impl Rig {
    fn new(changes: &[(&str, &str)]) -> Self {
        let rig = Self(Small { folder: tempfile::tempdir().unwrap() });
        let template = fs::read_to_string(case("measured/measured.md.j2")).unwrap();
        let files = [
            ("study.toml", RIG_STUDY.to_owned()),
            ("rig.csv", RIG_VALUES.to_owned()),
            ("rig.toml", RIG_CASE.to_owned()),
            ("measured.md.j2", template),
        ];
        for (name, mut text) in files {
            for (old, new) in changes {
                text = text.replace(old, new);
            }
            fs::write(rig.0.folder.path().join(name), text).unwrap();
        }
        rig
    }
}

const RIG_STUDY: &str = r#"
name = "rig"
title = "a rig of one's own"
text = "measured.md.j2"
[[measurement]]
name = "rig"
title = "Our rig"
kind = "creep curve"
source = "made up"
case = "rig.toml"
table = "rig.csv"
figure = "contact.creep_force_x_n"
value = "force"
scatter = "noise"
unit = "N"
x = { column = "creepage", unit = "1", label = "creepage [%]", per = -0.01 }
y = { label = "force [N]" }
fit = [{ key = "friction.coefficient", label = "friction", values = ["0.3", "0.5"] }]
inputs = ["load.normal_force=1.9 kN"]
"#;

/// Full slip: 800 N, and noise.
const RIG_VALUES: &str = "test;creepage;force;noise;operator\ns;%;kN;N;-\n\
                          1;-3;0,807;10;A\n2;-4;0,795;10;B\n3;-5;0,797;10;A\n4;-6;0,803;10;B\n";

const RIG_CASE: &str = r#"
[case]
name = "rig"
[bodies.upper]
position = "upper"
radius_x = 0.1
material = "steel"
[bodies.lower]
position = "lower"
radius_y = 0.1
material = "steel"
[materials.steel]
youngs_modulus = "210 GPa"
poisson_ratio = 0.3
[motion]
speed = 1
creepage = { xi = { file = "rig.csv", column = "creepage" } }
[load]
normal_force = "2 kN"
[friction]
coefficient = 0.5
[effects.partial_slip]
[mech]
model = "hertz-carter"
[time]
mode = "sequence"
history = { file = "rig.csv", column = "test" }
[output]
fields = "none"
"#;

/// The four steps of the page: a table, a case and an entry give a page with plot and fit. The
/// fitted friction is the mean of the values over the load, 0.40025, because all weights are equal.
#[test]
fn a_measurement_of_ones_own_gives_a_page() {
    let (place, rig) = (Place::new(), Rig::new(&[]));
    let kept = rig.0.folder.path().join("kept.md");
    let path = kept.display().to_string();
    let ended = reproduce(&place, &rig.0.study(), &["--write", &path]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let page = fs::read_to_string(&kept).unwrap();
    // Root mean squares: 199.5 N of 807 N without a fit, 4.8 N with one.
    for told in [
        "| [Our rig](#rig) | creep curve | 4 | 1.2 | 25 | 0 |",
        "| [Our rig](#rig) | friction | 0.400 | 0.59 | 100 |",
        "| `load.normal_force=1.9 kN` | 6.2 |",
        "](img/kept/fig-rig-1.svg)",
    ] {
        assert!(page.contains(told), "`{told}` is missing: {page}");
    }
    let plot = fs::read_to_string(kept.with_file_name("img/kept/fig-rig-1.svg")).unwrap();
    // Four values, and the mark of the legend.
    assert_eq!(plot.matches("class=\"mark\" d").count(), 5, "{plot}");
    for name in ["without a fit", "friction fitted", "lowest", "highest", "measured"] {
        assert!(plot.contains(name), "{name} is missing: {plot}");
    }
    // The folder alone is enough to write the page again.
    let out = place.out().display().to_string();
    assert_eq!(place.start(&["report", &out]).wait().code, Some(0));
    place.assert_nothing_left();
}

/// Exit code 2, with place and reason; nothing has run.
#[test]
fn a_measurement_that_is_wrong_is_refused_before_anything_runs() {
    let wrong: [(&str, &str, &[&str]); 6] = [
        ("value = \"force\"", "value = \"farce\"", &["measurement `rig`", "rig.csv", "farce"]),
        ("table = \"rig.csv\"", "table = \"no.csv\"", &["measurement `rig`", "no.csv"]),
        ("case = \"rig.toml\"", "case = \"no.toml\"", &["no case file", "no.toml"]),
        ("\"0.3\", \"0.5\"", "\"0.5\", \"0.3\"", &["measurement `rig`", "increasing order"]),
        ("\"0.3\", \"0.5\"", "\"0.3\", \"half\"", &["measurement `rig`", "`half`"]),
        ("0,807;10", "0,807;0", &["rig.csv", "standard deviation is not positive"]),
    ];
    for (old, new, told) in wrong {
        let (place, rig) = (Place::new(), Rig::new(&[(old, new)]));
        let ended = reproduce(&place, &rig.0.study(), &[]);
        assert_eq!(ended.code, Some(2), "{new}: {}", ended.stderr);
        for part in told {
            assert!(ended.stderr.contains(part), "`{part}` is missing: {}", ended.stderr);
        }
        assert!(!place.out().exists(), "{new}: something was written");
    }
}

/// A case that has no row for each measured value cannot be compared.
#[test]
fn a_case_without_the_rows_of_its_table_is_refused() {
    let alone = "history = { file = \"rig.csv\", column = \"test\" }";
    let (place, rig) = (
        Place::new(),
        Rig::new(&[
            (alone, ""),
            ("mode = \"sequence\"", "mode = \"steady\""),
            ("{ file = \"rig.csv\", column = \"creepage\" }", "-0.03"),
        ]),
    );
    let ended = reproduce(&place, &rig.0.study(), &[]);
    assert_eq!(ended.code, Some(2), "{}", ended.stderr);
    assert!(ended.stderr.contains("1 rows for 4 measured values"), "{}", ended.stderr);
}

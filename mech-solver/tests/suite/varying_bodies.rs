//! The model `wheel-on-track` with bodies that vary along the rolling direction, as given by a
//! case: slices from files, irregularities, positions, and refusals. The contact itself is tested
//! in [`wheel_rail`].

use super::common::{Run, assert_close, configuration, fitted, paper, refusal, run};
use serde_json::{Value, json};
use std::path::PathBuf;

fn on_track() -> Value {
    let mut case = fitted(paper(), "wheel-on-track");
    case["wheelset"]["yaw"] = json!(0.0);
    case
}

fn height(run: &Run) -> f64 {
    run.model.summary()["wheelset"]["z_m"].as_f64().expect("a height")
}

/// Temporary file, removed on drop.
struct File(PathBuf);

impl File {
    fn new(name: &str, text: &str) -> Self {
        let path = std::env::temp_dir().join(format!("varying-{}-{name}", std::process::id()));
        std::fs::write(&path, text).expect("a temporary file");
        Self(path)
    }

    fn path(&self) -> Value {
        json!(self.0.to_str().expect("a name"))
    }
}

impl Drop for File {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

fn shipped(name: &str) -> String {
    format!("{}/../cases/profiles/{name}", env!("CARGO_MANIFEST_DIR"))
}

/// On a rail that is new in one place and worn in another, the contact is that of the new or the
/// worn rail at each place. A wheel with equal slices has the contact of their profile. Tolerance:
/// the weights of a patch's reference, which use the true gap.
#[test]
fn slices_are_the_profiles_that_they_name() {
    let rail = |profile: &Value, way: f64| {
        let mut case = on_track();
        case["bodies"]["rail"]["profile"] = profile.clone();
        case["wheelset"]["way"] = json!(way);
        run(&case)
    };
    // The profile at the beginning determines the placement.
    let [new, worn] = ["rail-60e1.csv", "rail-60e1-worn.csv"].map(shipped);
    let lines = [(0, &worn), (400, &worn), (800, &worn), (1800, &new), (2200, &new)];
    let lines = lines.map(|(at, profile)| format!("{at}, {profile}\n")).concat();
    let wearing = File::new("wearing.slices", &format!("position [mm], profile\n{lines}"));
    let both = [(shipped("rail-wearing.slices").into(), new), (wearing.path(), worn)];
    for (slices, profile) in both {
        let (expected, found) = (rail(&json!(profile), 0.0), rail(&slices, 0.2));
        assert!((height(&expected) - height(&found)).abs() < 2e-8, "{profile}");
        for key in ["max_pressure_pa", "creep_force_x_n"] {
            assert_close(found.number(key), expected.number(key), 2e-3);
        }
        // The other end has a different profile.
        let other = rail(&slices, 2.8);
        assert!((height(&expected) - height(&other)).abs() > 1e-4, "{profile}");
    }
    let wheel = shipped("wheel-s1002.csv");
    let contact = File::new(
        "round.slcw",
        &format!("0 0.0174533\n3\n0 0 0\n2\n-40 '{wheel}'\n0. '{wheel}'\n50 '{wheel}'\n"),
    );
    let mut case = on_track();
    let expected = run(&case);
    case["bodies"]["wheel"]["profile"] = contact.path();
    case["wheelset"]["pitch"] = json!(0.3);
    let found = run(&case);
    assert!((height(&expected) - height(&found)).abs() < 2e-8);
    assert_close(found.number("creep_force_x_n"), expected.number("creep_force_x_n"), 2e-3);
}

/// A flat lowers the axle, by at most its depth, if it is under the wheel, and nowhere else; a dip
/// of the rail acts at its position.
#[test]
fn an_irregularity_is_where_it_is() {
    let round = height(&run(&on_track()));
    let flat = |pitch: f64| {
        let mut case = on_track();
        case["bodies"]["wheel"]["irregularity"] =
            json!({"form": "flat", "depth": 0.2e-3, "length": 80e-3, "at": 0.1});
        case["wheelset"]["pitch"] = json!(pitch);
        height(&run(&case)) - round
    };
    let dip = |way: f64| {
        let mut case = on_track();
        case["bodies"]["rail"]["irregularity"] =
            json!({"form": "dip", "depth": 0.2e-3, "length": 0.5, "at": 3.0});
        case["wheelset"]["way"] = json!(way);
        height(&run(&case)) - round
    };
    assert!((-0.2e-3..-0.1e-3).contains(&flat(0.1 / 0.46)), "{}", flat(0.1 / 0.46));
    assert!(flat(0.0).abs() < 2e-8 && flat(3.0).abs() < 2e-8);
    // The dip is long: in its middle the wheel stands as on a rail that is lower by its depth.
    assert!((dip(3.0) + 0.2e-3).abs() < 2e-6 && dip(0.0).abs() < 2e-8, "{}", dip(3.0));
}

#[test]
fn what_does_not_vary_so_is_refused() {
    let refused = |change: &dyn Fn(&mut Value), key: &str, words: &str| {
        let mut case = on_track();
        change(&mut case);
        let refusal = refusal(&configuration(&case));
        assert!(refusal.key == key && refusal.to_string().contains(words), "{refusal}");
    };
    let irregularity = |body: &'static str, of: Value| {
        move |case: &mut Value| case["bodies"][body]["irregularity"] = of.clone()
    };
    let sizes = |form: &str| json!({"form": form, "depth": 1e-3, "length": 0.1, "at": 0.0});
    refused(
        &irregularity("rail", sizes("flat")),
        "bodies.rail.irregularity.form",
        "an irregularity of a wheel",
    );
    refused(
        &irregularity("wheel", sizes("dip")),
        "bodies.wheel.irregularity.form",
        "an irregularity of a rail",
    );
    refused(
        &irregularity("wheel", json!({"form": "flat", "depth": 1e-3})),
        "bodies.wheel.irregularity.length",
        "a depth, a length and a position",
    );
    refused(
        &irregularity("wheel", json!({"depth": 1e-3})),
        "bodies.wheel.irregularity.depth",
        "but no form",
    );
    let mut crowned = sizes("dip");
    crowned["crown_radius"] = json!(0.3);
    refused(
        &irregularity("rail", crowned),
        "bodies.rail.irregularity.crown_radius",
        "constant depth across",
    );
    refused(
        &|case| {
            case["bodies"]["rail"]["profile_tolerance"] = json!(1e-5);
            case["bodies"]["rail"]["smoothing_wavelength"] = json!(5e-3);
        },
        "bodies.rail.smoothing_wavelength",
        "remove one of the two",
    );
    let file = |name: &str, text: &str| {
        let file = File::new(name, text);
        let path = file.path();
        (file, move |case: &mut Value| case["bodies"]["rail"]["profile"] = path.clone())
    };
    let rail = shipped("rail-60e1.csv");
    let (_gone, change) = file("gone.slices", &format!("0 {rail}\n1 nowhere.csv\n"));
    refused(
        &change,
        "bodies.rail.profile",
        "names nowhere.csv, which cannot be read: No such file",
    );
    let (_back, change) = file("back.slices", &format!("0 {rail}\n-1 {rail}\n"));
    refused(&change, "bodies.rail.profile", "the positions of slices 1 and 2");
    let (_line, change) = file("line.slcs", "0 1\n2\n0 0 0\n1\n0 'a'\n");
    refused(&change, "bodies.rail.profile", "position and name of every slice");
    let hollow: String =
        (-20..=20).map(|k| format!("{k} {:.4}\n", 0.05 * f64::from(k * k))).collect();
    let hollow = File::new("hollow.csv", &hollow);
    let name = hollow.0.file_name().and_then(|name| name.to_str()).expect("a name").to_owned();
    let (_both, change) = file("both.slices", &format!("0 {rail}\n1 {name}\n"));
    refused(&change, "bodies.rail.profile", "which its heights point down, as its shape shows");
}

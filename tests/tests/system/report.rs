//! Report of a run: content of the file.

mod markup;

use crate::harness::{Place, case};
use markup::{Element, elements};

/// Runs a shipped case and writes its report by the command; returns the page.
fn report(place: &Place, name: &str, more: &[&str]) -> String {
    place.summary(&case(name), more);
    assert!(!place.out().join("report.html").exists(), "nobody has asked for it yet");
    let out = place.out().display().to_string();
    let ended = place.start(&["report", &out]).wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert_eq!(ended.stdout.trim_end(), place.out().join("report.html").display().to_string());
    page(place)
}

fn page(place: &Place) -> String {
    std::fs::read_to_string(place.out().join("report.html")).unwrap()
}

fn titles(page: &str) -> Vec<String> {
    let plots = elements(page).into_iter().filter(|e| e.name == "title" && e.within("svg"));
    plots.map(|e| e.text).collect()
}

fn assert_titles(page: &str, expected: &[&str]) {
    let found = titles(page);
    for title in expected {
        assert!(found.iter().any(|t| t == title), "no plot `{title}` in {found:?}");
    }
}

/// Asserts that no address leads out of the file, and that the only script is the page's own, which
/// makes no requests.
fn assert_self_contained(page: &str) {
    let namespace = "\"http://www.w3.org/2000/svg\"";
    let rest = page.replace(namespace, "");
    let scripts = elements(page).into_iter().filter(|e| e.name == "script");
    let scripts: Vec<String> = scripts.map(|script| script.text).collect();
    assert_eq!(scripts.len(), 1);
    for way in ["fetch", "XMLHttpRequest", "WebSocket", "import", "eval", "innerHTML", "sendBeacon"]
    {
        assert!(!scripts[0].contains(way), "the script has `{way}`");
    }
    for scheme in ["http:", "https:", "ftp:", "file:", "url(", "@import", "src=", "srcset="] {
        assert!(!rest.contains(scheme), "`{scheme}` stands in the page");
    }
    for element in elements(page) {
        assert!(!["iframe", "object", "embed"].contains(&element.name.as_str()));
        for (name, value) in &element.attributes {
            assert!(!name.starts_with("on"), "{name} of <{}>", element.name);
            let inside = value.starts_with("data:") || value.starts_with('#');
            assert!(!name.ends_with("href") || inside, "{name}={value:.60}");
        }
    }
}

/// Asserts that all coordinates are finite and inside the view box.
fn assert_drawn(page: &str) {
    let all = elements(page);
    let plots: Vec<&Element> = all.iter().filter(|e| e.has_class("plot")).collect();
    assert!(!plots.is_empty());
    for plot in &plots {
        let title = all.iter().find(|e| e.name == "title" && e.parent == Some(plot.index));
        let title = title.map(|e| e.text.as_str()).unwrap_or_else(|| panic!("a plot has no title"));
        let described = |e: &&Element| e.name == "desc" && e.parent == Some(plot.index);
        assert!(!all.iter().find(described).unwrap().text.is_empty(), "{title}");
        let view = plot.numbers("viewBox");
        let inside = |x: f64, y: f64| {
            let [left, top, width, height] = view[..] else { panic!("{title}: {view:?}") };
            assert!(x.is_finite() && x >= left && x <= left + width, "{title}: x {x} of {view:?}");
            assert!(y.is_finite() && y >= top && y <= top + height, "{title}: y {y} of {view:?}");
        };
        let children: Vec<&Element> = all.iter().filter(|e| e.parent == Some(plot.index)).collect();
        let mut marks = 0;
        for element in &children {
            for [x, y] in element.places() {
                inside(x, y);
            }
            let mark = ["line", "dot", "piece", "map"].iter().any(|class| element.has_class(class));
            marks += usize::from(mark && !element.places().is_empty());
        }
        assert!(marks > 0, "{title} shows nothing");
    }
    let drawings = all.iter().filter(|e| e.name == "figcaption").count();
    assert!(drawings >= plots.len());
}

fn assert_good(page: &str) {
    assert_self_contained(page);
    assert_drawn(page);
    // Quoted laws and the case may contain f_inf.
    let ours = |e: &Element| !["pre", "small", "style", "script"].contains(&e.name.as_str());
    for element in elements(page).into_iter().filter(ours) {
        for broken in ["NaN", "inf", "−inf", "null"] {
            let told = element.text.split(' ').any(|word| word == broken);
            assert!(!told, "`{broken}` stands in <{}>: {}", element.name, element.text);
        }
    }
}

const FIELDS: [&str; 5] =
    ["pressure", "traction", "slip velocity", "friction power", "rail temperature"];

#[test]
fn the_report_of_a_steady_run_shows_what_it_found() {
    let place = Place::new();
    let page = report(&place, "wheel-rail.toml", &[]);
    assert_good(&page);
    assert_titles(&page, &FIELDS);
    assert_titles(&page, &["wheel temperature", "rail section temperature", "slip velocity x"]);
    assert_titles(&page, &["pressure, traction x", "temperature rise over depth"]);
    assert_titles(&page, &["work of the processes"]);
    assert!(!page.contains("relative residuals"), "an explicit scheme has none");
    let summary = place.read_summary();
    let rise = summary["temperature"]["rail"]["max_rise_k"].as_f64().unwrap();
    let pressure = summary["contact"]["max_pressure_pa"].as_f64().unwrap() / 1e6;
    for figure in [format!("{rise:.1}\u{a0}K"), format!("{pressure:.0}\u{a0}MPa")] {
        assert!(page.contains(&figure), "`{figure}` is missing");
    }
    for (role, program) in [("mech", "mech-solver"), ("thermal", "thermal-solver")] {
        let row = format!("<th scope=\"row\">{role}</th><td>{program}</td>");
        assert!(page.contains(&row), "the version of {program} is missing");
    }
    for part in [
        "partition = &quot;equal&quot;",
        "on  friction_heat",
        "effects off, because the case does not name them</summary>",
    ] {
        assert!(page.contains(part), "`{part}` is missing");
    }
}

#[test]
fn the_report_of_an_implicit_run_shows_how_it_converged() {
    let place = Place::new();
    let page = report(&place, "falling-friction.toml", &[]);
    assert_good(&page);
    assert_titles(&page, &FIELDS);
    let all = elements(&page);
    let plot = |title: &str| {
        let found = all.iter().find(|e| e.name == "title" && e.within("svg") && e.text == title);
        found.unwrap().parent
    };
    let iterations = place.read_summary()["coupling"]["iterations"].as_u64().unwrap() as usize;
    let residuals = plot("relative residuals");
    let lines = all.iter().filter(|e| e.parent == residuals && e.has_class("line"));
    let lengths: Vec<usize> = lines.map(|e| e.places().len()).collect();
    assert_eq!(lengths, [iterations; 2], "a point an iteration, for the rail and the wheel");
    // Each piece of work is a rectangle, so that its path begins once.
    let work = plot("work of the processes");
    let pieces = all.iter().filter(|e| e.parent == work && e.has_class("piece"));
    let counts: Vec<usize> = pieces.map(|e| e.attribute("d").matches('M').count()).collect();
    assert_eq!(counts, [iterations; 3], "mech, thermal and coupling");
}

#[test]
fn the_report_of_a_transient_run_shows_its_course() {
    let place = Place::new();
    let page = report(&place, "cold-start.toml", &[]);
    assert_good(&page);
    assert_titles(&page, &["rail temperature over time", "heat sent and received"]);
    let windows = place.read_summary()["coupling"]["windows"].as_u64().unwrap() as usize;
    let all = elements(&page);
    assert!(page.contains("energy audit"));
    let heat = all.iter().find(|e| e.name == "title" && e.text == "heat sent and received");
    let heat = heat.unwrap().parent;
    let lines = all.iter().filter(|e| e.parent == heat && e.has_class("line"));
    assert_eq!(lines.map(|e| e.places().len()).collect::<Vec<_>>(), [windows; 2]);
}

#[test]
fn a_run_that_does_not_converge_gets_a_report_that_says_so() {
    let place = Place::new();
    let few = ["--report", "--set", "coupling.max_iterations=4"];
    let ended = place.run(&case("falling-friction.toml"), &few);
    assert_eq!(ended.code, Some(3), "{}", ended.stderr);
    let page = page(&place);
    assert_good(&page);
    let all = elements(&page);
    let status = all.iter().find(|e| e.has_class("status")).unwrap();
    assert!(status.has_class("bad"), "{status:?}");
    assert!(page.contains("<b>failed</b> the coupling "), "the reason is missing");
    assert!(page.contains("window 0, iteration 4"), "the place is missing");
    assert_titles(&page, &["relative residuals", "work of the processes"]);
    assert!(!page.contains("energy audit"), "no window was accepted");
    // The next run removes the report together with the other results.
    place.summary(&case("falling-friction.toml"), &[]);
    assert!(!place.out().join("report.html").exists());
    place.assert_nothing_left();
}

#[test]
fn a_run_without_an_end_gets_a_report_of_what_it_left() {
    let place = Place::new();
    place.summary(&case("cold-start.toml"), &[]);
    std::fs::remove_file(place.out().join("summary.json")).unwrap();
    // Simulates files truncated by a crash.
    let table = place.out().join("iterations.csv");
    let text = std::fs::read_to_string(&table).unwrap();
    std::fs::write(&table, &text[..text.len() - 20]).unwrap();
    let fields = place.out().join("fields/last.bin");
    let whole = std::fs::read(&fields).unwrap();
    std::fs::write(&fields, &whole[..whole.len() / 2]).unwrap();
    let out = place.out().display().to_string();
    assert_eq!(place.start(&["report", &out]).wait().code, Some(0));
    let page = page(&place);
    assert_good(&page);
    assert!(page.contains("the run was killed or is still running"));
    assert!(page.contains("last.bin: corrupt: checksum mismatch in"));
    assert_titles(&page, &["heat sent and received"]);
}

/// Earlier versions wrote fields for ParaView only.
#[test]
fn a_folder_of_an_earlier_version_gets_a_report_without_fields() {
    let place = Place::new();
    place.summary(&case("wheel-rail.toml"), &[]);
    std::fs::remove_file(place.out().join("fields/last.bin")).unwrap();
    let out = place.out().display().to_string();
    assert_eq!(place.start(&["report", &out]).wait().code, Some(0));
    let page = page(&place);
    assert_good(&page);
    assert!(page.contains("last.bin: not written by the version that ran this case"));
    assert_titles(&page, &["work of the processes"]);
}

#[test]
fn a_folder_without_results_has_no_report() {
    let place = Place::new();
    let folder = tempfile::tempdir().unwrap();
    let ended = place.start(&["report", &folder.path().display().to_string()]).wait();
    assert_eq!(ended.code, Some(2), "{}", ended.stderr);
    assert!(ended.stderr.contains("holds no results of a run"), "{}", ended.stderr);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

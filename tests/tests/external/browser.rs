//! Pages in Chromium: reports, studies, steps of a recording, the paper.

use serde_json::Value;
use std::fs;
use std::process::Command;
use tests::harness::browser::{DESK, PHONE, Scheme, View, act, assert_shown, look, opened};
use tests::harness::paper::{
    assert_carter_strips, assert_methods, assert_shown as assert_paper_shown, record, reproduce,
};
use tests::harness::watched::Server;
use tests::harness::{Place, case, root};

fn assert_run_is_shown(name: &str, views: &[View]) {
    let place = Place::new();
    place.summary(&case(name), &["--report"]);
    assert_shown(&place.out().join("report.html"), views, 6);
}

#[test]
fn a_browser_shows_every_plot_in_light_in_dark_and_on_a_phone() {
    let other = [View { scheme: Scheme::Dark, ..DESK }, View { scheme: Scheme::Light, ..PHONE }];
    assert_run_is_shown("wheel-rail.toml", &[DESK, PHONE, other[0], other[1]]);
}

#[test]
fn a_browser_shows_every_plot_of_an_implicit_run() {
    assert_run_is_shown("falling-friction.toml", &[DESK, PHONE]);
}

#[test]
fn a_browser_shows_every_plot_of_a_transient_run() {
    assert_run_is_shown("cold-start.toml", &[DESK, PHONE]);
}

/// Runs a study and checks its page in a browser.
fn assert_study_is_drawn(command: &[&str], plots: usize) {
    let place = Place::new();
    let out = place.out().display().to_string();
    let ended = place.start(&[command, &["--out", &out]].concat()).wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert_shown(&place.out().join("report.html"), &[DESK, PHONE], plots);
}

// Each kind of study has its own page; the page of the paper is checked where it is generated.

#[test]
fn a_browser_shows_the_page_of_costs() {
    let vary = ["--vary", "mech.resolution=5,10", "--longest-run", "2", "--repeat", "1"];
    assert_study_is_drawn(&[&["cost", &case("full-slip.toml")], &vary[..]].concat(), 4);
}

#[test]
fn a_browser_shows_the_page_of_effects() {
    assert_study_is_drawn(&["ablate", &case("wheel-rail.toml"), "--set", "mech.resolution=10"], 4);
}

#[test]
fn a_browser_shows_the_page_of_hard_cases() {
    assert_study_is_drawn(&["stability", "--only", "coarse-columns"], 2);
}

/// The browser checks detect plots that are not drawn, a page that is too wide, and a network
/// request.
#[test]
fn the_browser_checks_find_what_is_wrong() {
    let place = Place::new();
    place.summary(&case("cold-start.toml"), &["--report"]);
    let page = fs::read_to_string(place.out().join("report.html")).unwrap();
    let write = |page: &str, what: &str| {
        let path = place.out().join("spoilt.html");
        fs::write(&path, page.replace("</body>", &format!("{what}</body>"))).unwrap();
        path
    };
    let spoilt = |what: &str| write(&page, what);
    let (looks, _) = look(&spoilt("<style>.plot * { visibility: hidden }</style>"), &[PHONE]);
    let hidden = &looks[0];
    assert!((0..hidden.plots.len()).all(|plot| !hidden.is_drawn(plot)));
    let image = "http://report.invalid/x.png";
    let what = format!("<div style=\"width: 900px\">x</div><img src=\"{image}\"/>");
    let (_, requests) = look(&spoilt(&what), &[PHONE]);
    assert_eq!(requests, Vec::<String>::new(), "the page's policy forbids it");
    let open = page.replace("http-equiv=\"Content-Security-Policy\"", "name=\"none\"");
    let (looks, requests) = look(&write(&open, &what), &[PHONE]);
    assert!(looks[0].scroll_width >= 900, "{}", looks[0].scroll_width);
    assert_eq!(requests, [image]);
    assert_eq!(looks[0].fetched, [image]);
}

#[test]
fn a_run_is_shown_step_by_step() {
    let place = Place::new();
    place.summary(&case("falling-friction.toml"), &["--record"]);
    let server = Server::of(&place, &place.out(), &[]);
    let state = server.read();
    let iterations = place.read_summary()["coupling"]["iterations"].as_u64().unwrap();
    assert_eq!(state["steps"].as_u64(), Some(iterations));
    assert_eq!((&state["live"], &state["remark"]), (&Value::Bool(false), &Value::Null));
    let series = server.series("rail temperature (thermal)");
    let view = server.json(&format!("view?series={series}&step=3&go=next&against=iteration"));
    assert_eq!(view["step"], 4);
    let caption = view["caption"].as_str().unwrap();
    assert!(caption.starts_with("window 0, iteration 5 · residual "), "{caption}");
    let html = view["html"].as_str().unwrap();
    for title in ["rail temperature", "rail temperature minus that of the iteration before"] {
        assert!(
            html.contains(&format!("<figcaption>{title}</figcaption>")),
            "{title}: {html:.900}"
        );
    }
    // The last step shows the result of the run.
    let last = server.json(&format!("view?series={series}&go=last"));
    let rise = place.read_summary()["temperature"]["rail"]["max_rise_k"].as_f64().unwrap();
    let largest = format!("Largest {:.1}", rise);
    assert!(last["html"].as_str().unwrap().contains(&largest), "{largest}");
    assert!(server.get("").contains("falling-friction · converged"));
    // The report of the run stands below.
    assert!(server.get("report").contains("energy audit"));
    let page = opened(&format!("http://{}/{}/#{series},4,iteration", server.host, server.token));
    assert!(page.contains("window 0, iteration 5 · residual "), "{page:.400}");
    assert!(page.contains("rail temperature minus that of the iteration before"));
}

/// The page as a file: all that it needs is in it, at any width; keys and buttons move it.
#[test]
fn the_page_is_written_as_a_file() {
    let place = Place::new();
    place.summary(&case("falling-friction.toml"), &["--record"]);
    let (out, file) = (place.out().display().to_string(), place.out().join("steps.html"));
    let shown = file.display().to_string();
    let ended = place.start(&["watch", &out, "--page", &shown]).wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(ended.stdout.starts_with(&format!("{shown}: 12 steps, ")), "{}", ended.stdout);
    assert_shown(&file, &[DESK, PHONE], 10);
    let script = r##"
      const told = [];
      const caption = () => document.querySelector("#caption").textContent.split(" · ")[0];
      const rest = () => new Promise(done => setTimeout(done, 300));
      const press = key => document.body.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));
      const titles = () => [...document.querySelectorAll("#view figcaption")]
        .map(node => node.firstChild.textContent);
      addEventListener("load", async () => {
        await rest(); told.push(caption());
        press("ArrowLeft"); await rest(); told.push(caption());
        press("Home"); await rest(); told.push(caption());
        document.querySelector("[data-go=next]").click(); await rest(); told.push(caption());
        press("ArrowDown"); await rest(); told.push(caption());
        press("ArrowUp"); await rest(); told.push(caption());
        press("d"); await rest(); told.push(titles()[1]);
        press("f"); await rest(); told.push(titles()[0]);
        document.title = JSON.stringify(told);
      });"##;
    let told: Vec<String> =
        act(&file, script).iter().map(|text| text.as_str().unwrap().to_owned()).collect();
    let steps: Vec<String> =
        [12, 11, 1, 2, 1, 12].map(|n| format!("window 0, iteration {n}")).into();
    assert_eq!(told[..6], steps[..]);
    assert!(told[6].ends_with("minus that of the iteration before"), "{told:?}");
    assert_ne!(told[7], told[6], "another field is shown");
}

/// Grids of the paper, and coarser ones that replace them.
const COARSER: [(&str, &str); 4] = [
    ("mech.resolution=160", "mech.resolution=14"),
    ("mech.resolution=80", "mech.resolution=12"),
    ("mech.resolution=40", "mech.resolution=10"),
    ("mech.resolution=20", "mech.resolution=8"),
];

/// The complete study of the paper on coarse grids: every run, table, figure and sentence is
/// produced, results that do not depend on the grid agree with theory, and the page is displayed.
/// (The target `nightly` uses the grids of the paper and compares with the stored page.)
#[test]
fn the_paper_on_coarse_grids() {
    let folder = tempfile::tempdir().unwrap();
    let cases = folder.path().join("cases");
    let mut copy = Command::new("cp");
    copy.arg("-r").arg(root().join("cases")).arg(&cases);
    assert!(copy.status().unwrap().success());
    let study = cases.join("paper/study.toml");
    let mut text = fs::read_to_string(&study).unwrap();
    for (fine, coarse) in COARSER {
        assert!(text.contains(fine), "no run has {fine}");
        text = text.replace(fine, coarse);
    }
    fs::write(&study, text).unwrap();
    let place = Place::new();
    let ended = reproduce(&place, &study, &[]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    place.assert_nothing_left();
    let record = record(&place);
    assert_carter_strips(&record);
    assert_methods(&record);
    assert_paper_shown(&place);
    // One drawing for each file.
    let drawings = fs::read_dir(place.out().join("img")).unwrap().count();
    assert_shown(&place.out().join("report.html"), &[DESK, PHONE], drawings);
}

//! `coordinator picture`: the fields of a run as files, without a browser.

use crate::harness::{Place, case};
use std::fs;

#[test]
fn fields_are_drawn_as_svg() {
    let place = Place::new();
    place.summary(&case("wheel-rail.toml"), &["--set", "mech.resolution=10"]);
    let out = place.out().display().to_string();
    let file = place.out().join("t.svg").display().to_string();
    let ended = place.start(&["picture", &out, "--field", "traction", "-o", &file]).wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let svg = fs::read_to_string(ended.stdout.trim_end()).unwrap();
    for part in
        ["class=\"arrow\"", "class=\"contour\"", "edge edge1", "class=\"peak\"", ">Traction<"]
    {
        assert!(svg.contains(part), "no `{part}` in the drawing");
    }
    assert!(!svg.contains("var(") && !svg.contains("pressure"), "of one field, for any program");
}

#[test]
fn what_cannot_be_drawn_is_told() {
    let place = Place::new();
    place.summary(&case("wheel-rail.toml"), &["--set", "mech.resolution=10"]);
    let out = place.out().display().to_string();
    let told = |arguments: &[&str], text: &str| {
        let ended = place.start(&[&["picture"], arguments].concat()).wait();
        assert_eq!(ended.code, Some(2), "{arguments:?}: {}", ended.stderr);
        assert!(ended.stderr.contains(text), "{arguments:?}: {}", ended.stderr);
    };
    told(&[&out, "--field", "presure"], "has no such field; it has pressure, traction");
    let still = Place::new();
    let set = ["--set", "mech.resolution=10", "--set", "motion.creepage.xi=0"];
    still.summary(&case("wheel-rail.toml"), &set);
    let rolls = still.out().display().to_string();
    told(&[&rolls, "--field", "traction"], "--field traction: in ");
    told(&[&rolls, "--field", "traction"], "it is zero everywhere: there is nothing to draw");
    told(&[&out, "-o", "picture.jpg"], "use a name that ends in .png, .svg or .pdf");
    let empty = tempfile::tempdir().unwrap();
    told(&[&empty.path().display().to_string()], "holds no results of a run");
}

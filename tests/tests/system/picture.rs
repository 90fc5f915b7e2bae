//! `coordinator picture`: the fields of a run as files, without a browser.

use crate::harness::{Place, case};
use std::fs;
use std::path::Path;

/// Number of different colours, and width, of a PNG.
fn colours(path: &Path) -> (usize, u32) {
    let file = std::io::BufReader::new(fs::File::open(path).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let frame = reader.next_frame(&mut pixels).unwrap();
    let colours: std::collections::HashSet<&[u8]> = pixels.chunks_exact(4).collect();
    (colours.len(), frame.width)
}

#[test]
fn fields_are_drawn_as_png_svg_and_pdf() {
    let place = Place::new();
    place.summary(&case("wheel-rail.toml"), &["--set", "mech.resolution=10"]);
    let out = place.out().display().to_string();
    let draw = |more: &[&str]| {
        let ended = place.start(&[&["picture", &out], more].concat()).wait();
        assert_eq!(ended.code, Some(0), "{more:?}: {}", ended.stderr);
        std::path::PathBuf::from(ended.stdout.trim_end())
    };
    let all = draw(&[]);
    assert_eq!(all, place.out().join("picture.png"));
    let (many, width) = colours(&all);
    assert!(many > 200 && width == 1600, "{many} colours, {width} wide");
    let at = |name: &str| place.out().join(name).display().to_string();
    let dark = draw(&[
        "--field",
        "traction,rail_temperature",
        "--dark",
        "--width",
        "640",
        "-o",
        &at("d.png"),
    ]);
    assert!(colours(&dark).1 == 640 && colours(&dark).0 > 100);
    let svg = fs::read_to_string(draw(&["--field", "traction", "-o", &at("t.svg")])).unwrap();
    for part in
        ["class=\"arrow\"", "class=\"contour\"", "edge edge1", "class=\"peak\"", ">Traction<"]
    {
        assert!(svg.contains(part), "no `{part}` in the drawing");
    }
    assert!(!svg.contains("var(") && !svg.contains("pressure"), "of one field, for any program");
    let pdf = fs::read(draw(&["--field", "pressure", "-o", &at("p.pdf")])).unwrap();
    assert!(pdf.starts_with(b"%PDF-"));
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
    told(&[&out, "-o", "picture.jpg"], "end its name in .png, .svg or .pdf");
    let empty = tempfile::tempdir().unwrap();
    told(&[&empty.path().display().to_string()], "holds no results of a run");
}

//! Pictures as PNG and PDF, and tables as Parquet: available in a release, not in a default build.

use std::fs;
use std::path::Path;
use tests::harness::{Place, case};

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
fn fields_are_drawn_as_png_and_pdf() {
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
    let fields = ["--field", "traction,rail_temperature"];
    let dark = draw(&[&fields[..], &["--dark", "--width", "640", "-o", &at("d.png")]].concat());
    assert!(colours(&dark).1 == 640 && colours(&dark).0 > 100);
    let pdf = fs::read(draw(&["--field", "pressure", "-o", &at("p.pdf")])).unwrap();
    assert!(pdf.starts_with(b"%PDF-"));
}

#[test]
fn a_sweep_is_written_as_parquet_too() {
    let place = Place::new();
    let out = place.out().display().to_string();
    let case = case("wheel-rail.toml").display().to_string();
    let vary = ["--set", "mech.resolution=10", "--vary", "motion.speed=20,30", "--out", &out];
    let ended = place.start(&[&["sweep", &case], &vary[..]].concat()).wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let table = fs::read(place.out().join("sweep.parquet")).unwrap();
    assert!(table.starts_with(b"PAR1") && table.ends_with(b"PAR1"));
}

//! Fields on disk as read by VTK, and the state file that opens them in ParaView.

use proto::bodies::Bodies;
use proto::description::Description;
use proto::field::{self, FieldSpec};
use run::results::vtk::FieldLabel;
use serde::Deserialize;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::Command;
use tests::harness::python::interpreter_with_packages;
use tests::harness::{Place, Table, case, root, sets, toy};
use tests::moving::{flux, patch};
use tests::volume::{KINDS, VOLUME_PLACE, VOLUME_TEMPERATURE, block, temperature};

/// Rounding of coordinates relative to the largest one: positions are given by a corner and a
/// spacing, or by vertices.
const ROUNDING: f64 = 1e-14;

/// Content of a folder as reported by `paraview/read.py`.
#[derive(Deserialize)]
struct Seen {
    series: BTreeMap<String, Vec<Data>>,
    /// Series opened by the state, with the array that colours each.
    opened: BTreeMap<String, String>,
    /// Title and unit of the legend of each array.
    legends: BTreeMap<String, [String; 2]>,
}

/// File of a series.
#[derive(Deserialize)]
struct Data {
    time: f64,
    file: String,
    data_time: f64,
    cells: usize,
    extent: Option<[usize; 6]>,
    centres: Vec<[f64; 3]>,
    arrays: Vec<Array>,
    table: BTreeMap<String, Option<Vec<String>>>,
}

#[derive(Deserialize)]
struct Array {
    name: String,
    unit: Option<String>,
    components: usize,
    values: Vec<Vec<f64>>,
}

/// Reads a folder with VTK.
fn look(folder: &Path) -> Seen {
    let script = root().join("tests/tests/external/paraview/read.py");
    let read = Command::new(interpreter_with_packages()).arg(script).arg(folder).output().unwrap();
    let errors = String::from_utf8_lossy(&read.stderr);
    assert!(read.status.success() && errors.is_empty(), "{errors}");
    serde_json::from_slice(&read.stdout).unwrap()
}

/// Coordinates of the points of a table.
fn places(table: &Table) -> Vec<[f64; 3]> {
    table.columns(["x [m]", "y [m]", "z [m]"])
}

/// Columns of an array in a table, one for each component: `NAME [UNIT]`, or `NAME_C [UNIT]` with
/// one of these words as C.
fn columns_of(table: &Table, array: &str, words: [&str; 2]) -> Vec<usize> {
    let (name, unit) = array.split_once(' ').unwrap();
    let of = |word| table.find(&format!("{name}_{word} {unit}"));
    match table.find(array) {
        Some(column) => vec![column],
        None => words.map(|word| of(word).unwrap_or_else(|| panic!("{array}"))).to_vec(),
    }
}

impl Data {
    /// Cell with this centre.
    fn cell(&self, place: [f64; 3]) -> usize {
        let distance =
            |centre: &[f64; 3]| (0..3).map(|k| (centre[k] - place[k]).abs()).sum::<f64>();
        let nearest = |a: &usize, b: &usize| {
            distance(&self.centres[*a]).total_cmp(&distance(&self.centres[*b]))
        };
        let cell = (0..self.cells).min_by(nearest).unwrap();
        let size = self.centres.as_flattened().iter().fold(0.0_f64, |most, c| most.max(c.abs()));
        let off = distance(&self.centres[cell]);
        assert!(off <= ROUNDING * size, "{}: no cell at {place:?}: {off:e} off", self.file);
        cell
    }

    /// Asserts that every array has the right name and unit, in VTK's label and in the table, and
    /// the right size.
    fn assert_labelled(&self, kinds: &[FieldLabel]) {
        let names = |kind: &FieldLabel| format!("{} [{}]", kind.name, kind.unit);
        let found: Vec<&str> = self.arrays.iter().map(|array| array.name.as_str()).collect();
        assert_eq!(found, kinds.iter().map(names).collect::<Vec<_>>(), "{}", self.file);
        for (array, kind) in self.arrays.iter().zip(kinds) {
            assert_eq!(array.unit.as_deref(), Some(kind.unit.as_str()), "{}", array.name);
            let components = if kind.components == 2 { 3 } else { kind.components as usize };
            assert_eq!(array.components, components, "{}", array.name);
            assert_eq!(array.values.len(), self.cells, "{}", array.name);
        }
        let column = |name: &str, of: &dyn Fn(&FieldLabel) -> String| {
            let told = self.table[name].clone().unwrap_or_else(|| panic!("no column `{name}`"));
            assert_eq!(told, kinds.iter().map(of).collect::<Vec<_>>(), "{name} of {}", self.file);
        };
        column("array", &names);
        column("unit", &|kind| kind.unit.clone());
        column("body", &|kind| kind.body.clone());
        column("meaning", &|kind| kind.meaning.clone());
    }

    /// Asserts that the values equal those of a table, whose numbers are printed to read back
    /// exactly.
    fn assert_values(&self, table: &Table, words: [&str; 2]) {
        for array in &self.arrays {
            self.assert_array(array, table, &columns_of(table, &array.name, words));
        }
    }

    fn assert_array(&self, array: &Array, table: &Table, columns: &[usize]) {
        for (index, place) in places(table).into_iter().enumerate() {
            let (values, row) = (&array.values[self.cell(place)], table.row(index));
            let mut expected: Vec<f64> = columns.iter().map(|&column| row[column]).collect();
            expected.resize(array.components, 0.0);
            assert_eq!(values, &expected, "{} of {} at {row:?}", array.name, self.file);
        }
    }

    /// Asserts the number of cells along every axis: the number of distinct coordinates in a table
    /// of all points, and 0 across the plane.
    fn assert_extent(&self, table: &Table) {
        let points = places(table);
        let cells = [0, 1, 2].map(|axis| {
            let places = points.iter().map(|point| point[axis].to_bits());
            match places.collect::<BTreeSet<u64>>().len() {
                1 => 0,
                several => several,
            }
        });
        let [x, y, z] = cells;
        assert_eq!(self.extent, Some([0, x, 0, y, 0, z]), "{}", self.file);
        assert_eq!(self.cells, table.rows.len(), "{}", self.file);
    }
}

/// Fields as shown in results, with the names of the case's bodies.
fn kinds(specs: &[FieldSpec]) -> Vec<FieldLabel> {
    let bodies = Bodies(["wheel", "rail"].map(str::to_owned));
    specs.iter().map(|spec| FieldLabel::of(&spec.kind(), Some(&bodies))).collect()
}

/// Fields of each grid of the main case.
fn of_main_case() -> [(&'static str, Vec<FieldLabel>); 5] {
    [
        ("mech_contact", kinds(&[field::PRESSURE, field::TRACTION])),
        ("mech_passage", kinds(&[field::SLIP_VELOCITY, field::FRICTION_POWER])),
        ("thermal_contact", kinds(&[field::LOWER_TEMPERATURE, field::UPPER_TEMPERATURE])),
        ("thermal_rail_section", kinds(&[field::LOWER_SECTION_TEMPERATURE])),
        ("thermal_wheel_section", kinds(&[field::UPPER_SECTION_TEMPERATURE])),
    ]
}

/// Asserts that the state opens exactly the series of the folder, each with an existing array.
fn assert_opened(seen: &Seen) {
    assert!(seen.opened.keys().eq(seen.series.keys()), "{:?}", seen.opened);
    for (name, array) in &seen.opened {
        for data in &seen.series[name] {
            assert!(data.arrays.iter().any(|a| &a.name == array), "no `{array}` in {}", data.file);
        }
        // Title without underscores, and unit.
        let [words, unit] = &seen.legends[array];
        assert_eq!(&format!("{} {unit}", words.replace(' ', "_")), array);
        assert!(!words.contains('_') && unit.starts_with('['), "{words} {unit}");
    }
}

fn export(place: &Place) -> (Seen, std::path::PathBuf) {
    let (vtk, csv) = (place.out().join("vtk"), place.out().join("csv"));
    let paths = [&place.out().join("recording.mcap"), &vtk, &csv].map(|p| p.display().to_string());
    let ended = place.start(&["export", &paths[0], "--vtk", &paths[1], "--csv", &paths[2]]).wait();
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    (look(&vtk), csv)
}

#[test]
fn images_and_their_export_read_as_they_were_sent() {
    let place = Place::new();
    let mut more = sets(&["mech.resolution=6"]);
    more.push("--record");
    place.summary(&case("wheel-rail.toml"), &more);
    let fields = place.out().join("fields");
    let ((exported, csv), written) = (export(&place), look(&fields));
    for seen in [&written, &exported] {
        assert_opened(seen);
        assert_eq!(seen.series.len(), of_main_case().len(), "{:?}", seen.opened);
        for (name, kinds) in of_main_case() {
            let [data] = &seen.series[name][..] else { panic!("{name}") };
            data.assert_labelled(&kinds);
            let line = Table::read(&fields.join(format!("{name}_000000.csv")));
            data.assert_values(&line, ["x", "y"]);
            let role = name.split('_').next().unwrap();
            for (array, kind) in data.arrays.iter().zip(&kinds) {
                let all = Table::read(&csv.join(format!("{role}_{}_000000.csv", kind.name)));
                data.assert_extent(&all);
                data.assert_array(array, &all, &columns_of(&all, &array.name, ["0", "1"]));
            }
        }
    }
}

#[test]
fn surfaces_and_their_export_read_as_they_were_sent() {
    let place = Place::new();
    let mut more = sets(&["mover.motion=stretch", "output.fields=all"]);
    more.push("--record");
    place.summary(&case("moving.toml"), &more);
    let [program, name] = toy("mover");
    let described = Command::new(program).args([&name, "--describe"]).output().unwrap();
    let described: Description = serde_json::from_slice(&described.stdout).unwrap();
    let kind = |name| described.fields.iter().find(|kind| kind.name == name).unwrap().clone();
    let expected = ["moving_flux", "moving_place"].map(|name| FieldLabel::of(&kind(name), None));
    // Ten windows; the patch makes a step after each, and the last fields are on that before it.
    let grid = patch("stretch", 9);
    for seen in [look(&place.out().join("fields")), export(&place).0] {
        assert_opened(&seen);
        let data = seen.series["mover_patch"].last().unwrap();
        assert!(data.file.ends_with(".vtu"), "{}", data.file);
        assert_eq!((data.time, data.cells), (10.0, grid.points()));
        data.assert_labelled(&expected);
        for point in 0..grid.points() {
            let centre = grid.centre(point);
            let cell = data.cell(centre);
            // The terms of the law and the coordinates are rounded.
            let value = data.arrays[0].values[cell][0];
            assert!((value / flux(centre) - 1.0).abs() < ROUNDING, "{value} at {centre:?}");
            assert_eq!(data.arrays[1].values[cell], [centre[0], centre[1], 0.0]);
        }
    }
}

/// The block swells: the last fields are on the block before its last move.
#[test]
fn volumes_and_their_export_read_as_they_were_sent() {
    for (kind, ending) in KINDS.iter().zip([".vtr", ".vts", ".vtu"]) {
        let place = Place::new();
        let hexahedra = format!("volume.hexahedra={kind}");
        let mut more = sets(&[&hexahedra, "volume.swells=true", "output.every=3"]);
        more.push("--record");
        place.summary(&case("volume.toml"), &more);
        let grid = block(kind, 8, 3);
        for seen in [look(&place.out().join("fields")), export(&place).0] {
            assert_opened(&seen);
            let data = seen.series["volume_block"].last().unwrap();
            assert!(data.file.ends_with(ending), "{}", data.file);
            assert_eq!((data.time, data.cells), (4.0, grid.points()));
            let fields = [VOLUME_TEMPERATURE, VOLUME_PLACE];
            data.assert_labelled(&kinds(&fields));
            let array = |field: &FieldSpec| {
                let name = format!("{} [{}]", field.name, field.unit);
                data.arrays.iter().find(|array| array.name == name).unwrap()
            };
            for point in 0..grid.points() {
                let (centre, cell) = (grid.centre(point), data.cell(grid.centre(point)));
                assert_eq!(cell, point, "elements keep their order");
                assert_eq!(array(&VOLUME_PLACE).values[cell], centre);
                assert_eq!(array(&VOLUME_TEMPERATURE).values[cell], [temperature(centre, 4)]);
            }
        }
    }
}

/// Windows of 20 µs; every fifth one and the last are written.
#[test]
fn a_series_has_its_times() {
    let place = Place::new();
    let more = sets(&["mech.resolution=6", "time.end=0.44 ms", "output.every=5"]);
    place.summary(&case("cold-start.toml"), &more);
    let seen = look(&place.out().join("fields"));
    assert_opened(&seen);
    assert_eq!(seen.series.len(), 4);
    for (name, files) in &seen.series {
        let windows = [4, 9, 14, 19, 21];
        assert_eq!(files.len(), windows.len(), "{name}");
        for (data, window) in files.iter().zip(windows) {
            assert_eq!(data.file, format!("{name}_{window:06}.vti"));
            assert_eq!(data.data_time, data.time, "{}", data.file);
            // The sum over twenty windows rounds in each.
            let expected = 20e-6 * f64::from(window + 1);
            assert!((data.time / expected - 1.0).abs() < 20.0 * f64::EPSILON, "{}", data.time);
            let line = Table::read(&place.out().join(format!("fields/{name}_{window:06}.csv")));
            data.assert_values(&line, ["x", "y"]);
        }
    }
}

/// Files of an earlier run, including the state, are removed. Foreign files stay and are not
/// opened.
#[test]
fn the_state_follows_what_is_there() {
    let place = Place::new();
    let wheel_rail = |more: &[&str]| {
        let more = [&sets(&["mech.resolution=6"])[..], more].concat();
        place.summary(&case("wheel-rail.toml"), &more);
    };
    let fields = place.out().join("fields");
    let opened = || look(&fields).opened.into_keys().collect::<Vec<_>>();
    wheel_rail(&[]);
    assert_eq!(opened(), of_main_case().map(|(name, _)| name));
    std::fs::write(fields.join("mine.pvd"), "<VTKFile/>").unwrap();
    wheel_rail(&["--unset", "effects.friction_heat", "--unset", "thermal"]);
    assert_eq!(opened(), ["mech_contact", "mech_passage"]);
    wheel_rail(&["--set", "output.fields=none"]);
    assert!(!fields.join("open.py").exists() && fields.join("mine.pvd").exists());
    std::fs::remove_file(fields.join("mine.pvd")).unwrap();
    wheel_rail(&[]);
    wheel_rail(&["--set", "output.fields=none"]);
    assert!(!fields.exists(), "nothing of a run keeps the folder");
}

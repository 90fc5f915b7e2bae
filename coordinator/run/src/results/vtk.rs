//! Fields as VTK data with a `.pvd` series, for ParaView.
//!
//! A structured grid whose steps lie along two axes becomes an image with cell data (`.vti`), any
//! other an unstructured grid of quadrilaterals (`.vtu`). Every array carries its unit in its name
//! (`pressure [Pa]`) and as VTK's own label, and the field data tell unit, body and meaning of each;
//! two-component fields become vectors (x, y, 0). The values are appended raw, as little-endian
//! doubles. A series names only files that are complete, and is replaced as a whole, so that what is
//! on disk can be read at any time. `open.py` opens all series in ParaView.

mod image;
mod label;
mod scene;
mod unstructured;

pub(super) use scene::{FILE as SCENE, is_scene};

use super::dir::Dir;
use super::line;
use super::write::{create, replace};
use crate::error::{RunError, file_failure};
use crate::session::Tap;
use contract::field::FieldKind;
use contract::grid::{Grid, Quadrilaterals, Shape};
use image::Image;
use scene::Scene;
use serde::{Deserialize, Serialize};
use std::fmt::Write as _;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Fields and their values.
type Fields<'a> = [(&'a FieldKind, &'a [f64])];

/// One field as it is now.
#[derive(Clone, Copy, Debug)]
pub struct Shown<'a> {
    /// Role of the participant that sends it.
    pub producer: &'a str,
    /// Where it lives.
    pub grid: &'a Grid,
    /// Kind of the field.
    pub kind: &'a FieldKind,
    /// Values, component-major.
    pub values: &'a [f64],
}

impl<'a> Shown<'a> {
    fn of(tap: &'a Tap) -> Option<Self> {
        let (producer, grid, kind) = (tap.producer_role(), tap.grid(), tap.kind());
        Some(Self { producer, grid, kind, values: tap.values()? })
    }

    /// Fields of the same producer and grid share their files.
    fn series_name(&self) -> String {
        format!("{}_{}", self.producer, self.grid.name)
    }
}

/// Writes the newest samples of all fields, one file a grid and an instant.
#[derive(Debug)]
pub struct FieldWriter {
    home: Home,
    series: Vec<Series>,
    scene: Scene,
}

/// Where the files go; the folder is made when the first field is written.
#[derive(Debug)]
enum Home {
    /// A folder that the user names.
    Named(PathBuf),
    /// A folder of this name within one that is held open.
    Within(Dir, &'static str),
    /// It is there.
    Open(Dir),
}

impl Home {
    /// A path that leads to it, which is made if it is not there.
    fn path(&mut self) -> Result<PathBuf, RunError> {
        let open = match self {
            Self::Open(dir) => return Ok(dir.path()),
            Self::Named(path) => fs::create_dir_all(&*path)
                .and_then(|()| Dir::open(path))
                .map_err(|error| file_failure(path, &error))?,
            Self::Within(dir, name) => {
                dir.inner(name).map_err(|error| file_failure(&dir.path().join(*name), &error))?
            }
        };
        let path = open.path();
        *self = Self::Open(open);
        Ok(path)
    }
}

/// One grid of one participant through time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Series {
    name: String,
    /// Time [s] and name of each file.
    files: Vec<(f64, String)>,
}

impl FieldWriter {
    /// A writer into this folder, which is made when the first field is written.
    #[must_use]
    pub fn new(folder: PathBuf) -> Self {
        Self::at(Home::Named(folder))
    }

    /// A writer into the folder of this name within a result directory.
    #[must_use]
    pub fn within(results: Dir, name: &'static str) -> Self {
        Self::at(Home::Within(results, name))
    }

    fn at(home: Home) -> Self {
        Self { home, series: Vec::new(), scene: Scene::default() }
    }

    /// What has been written so far.
    #[must_use]
    pub fn series(&self) -> &[Series] {
        &self.series
    }

    /// Goes on after what was written before.
    pub fn resume(&mut self, series: Vec<Series>) {
        self.series = series;
    }

    /// Writes the fields that the case asks for as they are at `time` [s].
    pub fn write(&mut self, taps: &[Tap], window: u64, time: f64) -> Result<(), RunError> {
        let wanted = taps.iter().filter(|tap| tap.wanted());
        let shown: Vec<Shown> = wanted.filter_map(Shown::of).collect();
        self.write_fields(&shown, window, time)
    }

    /// Writes these fields as they are at `time` [s].
    pub fn write_fields(
        &mut self,
        shown: &[Shown],
        window: u64,
        time: f64,
    ) -> Result<(), RunError> {
        let mut written: Vec<String> = Vec::new();
        for one in shown {
            let name = one.series_name();
            if one.grid.points() < 2 || written.contains(&name) {
                continue;
            }
            let together: Vec<(&FieldKind, &[f64])> = shown
                .iter()
                .filter(|other| other.series_name() == name)
                .map(|other| (other.kind, other.values))
                .collect();
            self.write_grid(one.grid, &name, &together, window, time)?;
            self.scene.add(&name, &together);
            written.push(name);
        }
        if written.is_empty() { Ok(()) } else { self.scene.write(&self.home.path()?) }
    }

    fn write_grid(
        &mut self,
        grid: &Grid,
        name: &str,
        fields: &Fields,
        window: u64,
        time: f64,
    ) -> Result<(), RunError> {
        let folder = self.home.path()?;
        let image = grid.as_structured().and_then(Image::of);
        let kind = if image.is_some() { "vti" } else { "vtu" };
        let file = format!("{name}_{window:06}.{kind}");
        create(&folder.join(&file), |out| match (&image, &grid.shape) {
            (Some(image), _) => image.write(out, fields, time),
            (None, Shape::Structured(s)) => {
                unstructured::write(&Quadrilaterals::from(s), out, fields, time)
            }
            (None, Shape::Quadrilaterals(q)) => unstructured::write(q, out, fields, time),
        })?;
        if let Some(structured) = grid.as_structured() {
            let path = folder.join(format!("{name}_{window:06}.csv"));
            create(&path, |out| line::write(structured, out, fields))?;
        }
        self.list(&folder, name, time, file)
    }

    /// Adds a file to its series.
    fn list(&mut self, folder: &Path, name: &str, time: f64, file: String) -> Result<(), RunError> {
        let index = self.series.iter().position(|series| series.name == name);
        let index = index.unwrap_or_else(|| {
            self.series.push(Series { name: name.to_owned(), files: Vec::new() });
            self.series.len() - 1
        });
        let files = &mut self.series[index].files;
        files.push((time, file));
        replace(&folder.join(format!("{name}.pvd")), collection(files).as_bytes())
    }
}

fn collection(files: &[(f64, String)]) -> String {
    let mut text = "<?xml version=\"1.0\"?>\n\
                    <VTKFile type=\"Collection\" version=\"1.0\">\n  <Collection>\n"
        .to_owned();
    for (time, file) in files {
        let _ = writeln!(text, "    <DataSet timestep=\"{time:e}\" file=\"{file}\"/>");
    }
    text + "  </Collection>\n</VTKFile>\n"
}

/// Opens a data set of this VTK type, with what is said of its fields and the time [s] of their
/// values.
fn opening(data: &str, attributes: &str, fields: &Fields, time: f64) -> String {
    let table = label::table(fields);
    format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"{data}\" version=\"1.0\" \
         byte_order=\"LittleEndian\" header_type=\"UInt64\">\n  <{data}{attributes}>\n    \
         <FieldData>\n      <DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" \
         format=\"ascii\">{time:e}</DataArray>\n{table}    </FieldData>\n"
    )
}

/// The arrays of cell data, appended from `offset` bytes on, and the end of the data set.
fn cell_data(data: &str, fields: &Fields, cells: usize, mut offset: usize) -> String {
    let mut text = "      <CellData>\n".to_owned();
    for (kind, _) in fields {
        let components = components(kind);
        let (name, unit) = (label::escape(&label::array_name(kind)), label::unit(kind));
        let _ = writeln!(
            text,
            "        <DataArray type=\"Float64\" Name=\"{name}\" \
             NumberOfComponents=\"{components}\" format=\"appended\" offset=\"{offset}\">\n          \
             {unit}\n        </DataArray>"
        );
        offset += 8 + 8 * components * cells;
    }
    text + "      </CellData>\n    </Piece>\n  </"
        + data
        + ">\n  \
            <AppendedData encoding=\"raw\">\n_"
}

/// The values of all fields, cell by cell in this order of the grid's elements, and the end of the
/// file.
fn write_values(
    out: &mut impl Write,
    fields: &Fields,
    order: impl ExactSizeIterator<Item = usize> + Clone,
) -> io::Result<()> {
    let points = order.len();
    for (kind, values) in fields {
        let components = components(kind);
        out.write_all(&(8 * (components * points) as u64).to_le_bytes())?;
        for point in order.clone() {
            for component in 0..components {
                let value = values.get(component * points + point).copied().unwrap_or(0.0);
                out.write_all(&value.to_le_bytes())?;
            }
        }
    }
    out.write_all(b"\n  </AppendedData>\n</VTKFile>\n")
}

/// Components in the file: a vector of the plane becomes one of space.
fn components(kind: &FieldKind) -> usize {
    if kind.components == 2 { 3 } else { kind.components as usize }
}

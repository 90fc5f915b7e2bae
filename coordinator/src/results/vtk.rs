//! Fields as VTK image data (`.vti`) with a `.pvd` series, for ParaView.
//!
//! A structured grid whose steps lie along two axes becomes an image with cell data. Every array
//! carries its unit in its name (`pressure [Pa]`); two-component fields become vectors (x, y, 0).
//! The values are appended raw, as little-endian doubles. A series names only files that are
//! complete, and is replaced as a whole, so that what is on disk can be read at any time.

use super::folder::replace;
use crate::error::{RunError, file_failure};
use crate::session::Tap;
use proto::field::FieldKind;
use proto::grid::{Grid, Structured};
use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::PathBuf;

/// Writes the newest samples of all fields, one file a grid and an instant.
#[derive(Debug)]
pub struct FieldWriter {
    folder: PathBuf,
    series: Vec<Series>,
}

/// One grid of one participant through time.
#[derive(Debug)]
struct Series {
    name: String,
    files: Vec<(f64, String)>,
}

impl FieldWriter {
    /// A writer into this folder, which is made when the first field is written.
    #[must_use]
    pub fn new(folder: PathBuf) -> Self {
        Self { folder, series: Vec::new() }
    }

    /// Writes the fields that the case asks for as they are at `time` [s].
    pub fn write(&mut self, taps: &[Tap], window: u64, time: f64) -> Result<(), RunError> {
        let mut written: Vec<String> = Vec::new();
        let wanted = || taps.iter().filter(|tap| tap.wanted());
        for tap in wanted() {
            let name = series_name(tap);
            if tap.grid().points() < 2 || written.contains(&name) {
                continue;
            }
            let together: Vec<(&FieldKind, &[f64])> = wanted()
                .filter(|other| series_name(other) == name)
                .filter_map(|other| Some((other.kind(), other.values()?)))
                .collect();
            self.write_grid(tap.grid(), &name, &together, window, time)?;
            written.push(name);
        }
        Ok(())
    }

    fn write_grid(
        &mut self,
        grid: &Grid,
        name: &str,
        fields: &[(&FieldKind, &[f64])],
        window: u64,
        time: f64,
    ) -> Result<(), RunError> {
        let Some(image) = grid.as_structured().and_then(Image::of) else {
            tracing::warn!(grid = name, "not an image aligned with two axes; its fields stay out");
            return Ok(());
        };
        fs::create_dir_all(&self.folder).map_err(|e| file_failure(&self.folder, &e))?;
        let file = format!("{name}_{window:06}.vti");
        let path = self.folder.join(&file);
        let out = File::create(&path).map(BufWriter::new);
        out.and_then(|mut out| image.write(&mut out, fields, time).and_then(|()| out.flush()))
            .map_err(|e| file_failure(&path, &e))?;
        self.list(name, time, file)
    }

    /// Adds a file to its series.
    fn list(&mut self, name: &str, time: f64, file: String) -> Result<(), RunError> {
        let index = self.series.iter().position(|series| series.name == name);
        let index = index.unwrap_or_else(|| {
            self.series.push(Series { name: name.to_owned(), files: Vec::new() });
            self.series.len() - 1
        });
        let files = &mut self.series[index].files;
        files.push((time, file));
        replace(&self.folder.join(format!("{name}.pvd")), collection(files).as_bytes())
    }
}

fn series_name(tap: &Tap) -> String {
    format!("{}_{}", tap.producer_role(), tap.grid().name)
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

/// A structured grid as VTK sees it: cells along x, y, z from a corner, with positive spacing.
#[derive(Clone, Debug, PartialEq)]
struct Image {
    corner: [f64; 3],
    spacing: [f64; 3],
    cells: [usize; 3],
    /// The grid's own index of the cell at VTK's `n`-th place.
    order: Vec<usize>,
}

impl Image {
    /// `None` if a step is not along one axis, or both are along the same.
    fn of(grid: &Structured) -> Option<Self> {
        let axis = |step: &[f64; 3]| {
            let mut along = (0..3).filter(|&k| step[k] != 0.0);
            along.next().filter(|_| along.next().is_none())
        };
        let (ai, aj) = (axis(&grid.step_i)?, axis(&grid.step_j)?);
        if ai == aj {
            return None;
        }
        let (si, sj) = (grid.step_i[ai], grid.step_j[aj]);
        let mut image = Self {
            corner: grid.origin,
            spacing: [si.abs().min(sj.abs()); 3],
            cells: [0; 3],
            order: Vec::with_capacity(grid.points()),
        };
        for (axis, step, count) in [(ai, si, grid.ni), (aj, sj, grid.nj)] {
            let first = if step > 0.0 { 0.0 } else { (count - 1) as f64 * step };
            image.corner[axis] += first - 0.5 * step.abs();
            image.spacing[axis] = step.abs();
            image.cells[axis] = count;
        }
        let along = |step: f64, count: usize, n: usize| if step > 0.0 { n } else { count - 1 - n };
        let index = |i: usize, j: usize| along(sj, grid.nj, j) * grid.ni + along(si, grid.ni, i);
        if ai < aj {
            image.order.extend((0..grid.nj).flat_map(|j| (0..grid.ni).map(move |i| index(i, j))));
        } else {
            image.order.extend((0..grid.ni).flat_map(|i| (0..grid.nj).map(move |j| index(i, j))));
        }
        Some(image)
    }

    fn write(
        &self,
        out: &mut impl Write,
        fields: &[(&FieldKind, &[f64])],
        time: f64,
    ) -> io::Result<()> {
        out.write_all(self.head(fields, time).as_bytes())?;
        for (kind, values) in fields {
            self.write_values(out, components(kind), values)?;
        }
        out.write_all(b"\n  </AppendedData>\n</VTKFile>\n")
    }

    fn head(&self, fields: &[(&FieldKind, &[f64])], time: f64) -> String {
        let [nx, ny, nz] = self.cells;
        let extent = format!("0 {nx} 0 {ny} 0 {nz}");
        let three = |v: &[f64; 3]| format!("{:e} {:e} {:e}", v[0], v[1], v[2]);
        let mut text = format!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"1.0\" \
             byte_order=\"LittleEndian\" header_type=\"UInt64\">\n  <ImageData \
             WholeExtent=\"{extent}\" Origin=\"{}\" Spacing=\"{}\">\n    <FieldData>\n      \
             <DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" \
             format=\"ascii\">{time:e}</DataArray>\n    </FieldData>\n    <Piece \
             Extent=\"{extent}\">\n      <CellData>\n",
            three(&self.corner),
            three(&self.spacing)
        );
        let mut offset = 0;
        for (kind, _) in fields {
            let components = components(kind);
            let _ = writeln!(
                text,
                "        <DataArray type=\"Float64\" Name=\"{} [{}]\" \
                 NumberOfComponents=\"{components}\" format=\"appended\" offset=\"{offset}\"/>",
                kind.name, kind.unit
            );
            offset += 8 + 8 * components * self.order.len();
        }
        text + "      </CellData>\n    </Piece>\n  </ImageData>\n  \
                <AppendedData encoding=\"raw\">\n_"
    }

    fn write_values(
        &self,
        out: &mut impl Write,
        components: usize,
        values: &[f64],
    ) -> io::Result<()> {
        let points = self.order.len();
        out.write_all(&(8 * (components * points) as u64).to_le_bytes())?;
        for &point in &self.order {
            for component in 0..components {
                let value = values.get(component * points + point).copied().unwrap_or(0.0);
                out.write_all(&value.to_le_bytes())?;
            }
        }
        Ok(())
    }
}

/// Components in the file: a vector of the plane becomes one of space.
fn components(kind: &FieldKind) -> usize {
    if kind.components == 2 { 3 } else { kind.components as usize }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_section_that_points_down_is_turned_over() {
        let section = Structured {
            origin: [1.0, 0.5, 0.0],
            step_i: [0.1, 0.0, 0.0],
            step_j: [0.0, 0.0, -0.2],
            ni: 2,
            nj: 3,
        };
        let image = Image::of(&section).unwrap();
        assert_eq!(image.cells, [2, 0, 3]);
        assert_eq!(image.order, [4, 5, 2, 3, 0, 1]);
        assert!((image.corner[2] - -0.5).abs() < 1e-15, "{:?}", image.corner);
    }

    #[test]
    fn oblique_grids_are_no_images() {
        let mut grid = Structured::contact_plane(0.0, 0.0, 1.0, 1.0, 2, 2);
        assert!(Image::of(&grid).is_some());
        grid.step_j = [0.1, 1.0, 0.0];
        assert!(Image::of(&grid).is_none());
        grid.step_j = [1.0, 0.0, 0.0];
        assert!(Image::of(&grid).is_none());
    }
}

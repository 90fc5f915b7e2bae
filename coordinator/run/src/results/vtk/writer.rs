//! Files of all grids at every instant, and the series that list them.

use super::data_sets::{
    points_extension, volume_extension, write_image, write_points, write_quadrilaterals,
    write_vertices, write_volume,
};
use super::scene::Scene;
use super::shown::{
    COLLECTION_END, FieldLabel, FieldOutput, Fields, FileSeries, collection, entry,
};
use crate::error::{RunError, file_failure};
use crate::results::cells::Cells;
use crate::results::dir::Dir;
use crate::results::last::LastFields;
use crate::results::line;
use crate::results::write::{create, replace};
use contract::grid::{Block, Grid, Points, Quadrilaterals, Shape};
use rustix::fs::OFlags;
use std::collections::HashMap;
use std::fs::{self, File};
use std::io;
use std::os::unix::fs::{FileExt, OpenOptionsExt};
use std::path::{Path, PathBuf};

/// Writer of fields, with one file for each grid and instant.
#[derive(Debug)]
pub struct FieldWriter {
    home: Home,
    series: Vec<FileSeries>,
    /// Number of files that each series lists on the disk.
    listed: HashMap<String, usize>,
    scene: Scene,
    /// Whether the newest fields are stored for the report.
    keeps_last: bool,
}

/// Folder of the files, created when the first field is written.
#[derive(Debug)]
enum Home {
    /// A folder that the user names.
    Named(PathBuf),
    /// A folder of this name within one that is held open.
    Within(Dir, &'static str),
    /// The folder exists and is held open.
    Open(Dir),
}

impl Home {
    /// Returns a path to the folder, which is created if it is missing.
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

impl FieldWriter {
    /// Returns a writer into this folder, which is created when the first field is written.
    #[must_use]
    pub fn new(folder: PathBuf) -> Self {
        Self::at(Home::Named(folder), false)
    }

    /// Returns a writer into the folder of this name within a result directory. It also stores the
    /// newest fields for the report ([`crate::results::last`]).
    #[must_use]
    pub fn within(results: Dir, name: &'static str) -> Self {
        Self::at(Home::Within(results, name), true)
    }

    fn at(home: Home, keeps_last: bool) -> Self {
        let (series, listed, scene) = (Vec::new(), HashMap::new(), Scene::default());
        Self { home, series, listed, scene, keeps_last }
    }

    /// Returns the series written so far.
    #[must_use]
    pub fn series(&self) -> &[FileSeries] {
        &self.series
    }

    /// Continues the series of an earlier process, or of an earlier state.
    pub fn resume(&mut self, series: Vec<FileSeries>) {
        self.series = series;
        self.listed.clear();
    }

    /// Writes the values of these fields at `time` [s].
    pub fn write(&mut self, shown: &[FieldOutput], window: u64, time: f64) -> Result<(), RunError> {
        let mut written: Vec<String> = Vec::new();
        for one in shown {
            let name = &one.series;
            let of_points = matches!(one.grid.shape, Shape::Points(_) | Shape::Vertices(_));
            if (one.grid.points() < 2 && !of_points) || written.contains(name) {
                continue;
            }
            let together: Vec<(&FieldLabel, &[f64])> = shown
                .iter()
                .filter(|other| other.series == *name)
                .map(|other| (&other.kind, other.values))
                .collect();
            match &one.grid.shape {
                Shape::Points(points) => {
                    self.write_points(points, name, &together, window, time)?
                }
                _ => {
                    self.write_grid(one.grid, name, &together, window, time)?;
                    self.scene.add(name, &together);
                }
            }
            written.push(name.clone());
        }
        if written.is_empty() {
            return Ok(());
        }
        let folder = self.home.path()?;
        self.scene.write(&folder)?;
        match self.keeps_last {
            true => LastFields::of(shown, self.names(), window, time).write(&folder),
            false => Ok(()),
        }
    }

    /// Returns the names of the series.
    fn names(&self) -> Vec<String> {
        self.series.iter().map(|series| series.name.clone()).collect()
    }

    /// Stores these fields for somebody who watches the run, without a file of their own.
    pub fn show(&mut self, shown: &[FieldOutput], window: u64, time: f64) -> Result<(), RunError> {
        if shown.is_empty() {
            return Ok(());
        }
        let mut names = self.names();
        for one in shown {
            if !names.contains(&one.series) {
                names.push(one.series.clone());
            }
        }
        LastFields::of(shown, names, window, time).write(&self.home.path()?)
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
        let cells = grid.as_structured().and_then(Cells::of);
        let kind = match (&cells, &grid.shape) {
            (Some(_), _) => "vti",
            (None, Shape::Volume(v)) => volume_extension(v),
            (None, _) => "vtu",
        };
        let file = format!("{name}_{window:06}.{kind}");
        create(&folder.join(&file), |out| match (&cells, &grid.shape) {
            (Some(cells), _) => write_image(cells, out, fields, time),
            (None, Shape::Structured(s)) => {
                write_quadrilaterals(&Quadrilaterals::from(s), out, fields, time)
            }
            (None, Shape::Quadrilaterals(q)) => write_quadrilaterals(q, out, fields, time),
            (None, Shape::Vertices(v)) => write_vertices(v, out, fields, time),
            (None, Shape::Volume(v)) => write_volume(v, out, fields, time),
            (None, Shape::Points(_)) => unreachable!("points are written block by block"),
        })?;
        if let Some(structured) = grid.as_structured() {
            let path = folder.join(format!("{name}_{window:06}.csv"));
            create(&path, |out| line::write(structured, out, fields))?;
        }
        self.list(&folder, name, time, file)
    }

    /// Writes a file and a table for every block of points, each in its own series.
    fn write_points(
        &mut self,
        points: &Points,
        name: &str,
        fields: &Fields,
        window: u64,
        time: f64,
    ) -> Result<(), RunError> {
        let folder = self.home.path()?;
        for (first, Block { name: block, places }) in points.parts() {
            let own: Vec<Vec<f64>> = fields
                .iter()
                .map(|(_, values)| {
                    let parts = values.chunks_exact(points.count());
                    parts.flat_map(|part| &part[first..first + places.count()]).copied().collect()
                })
                .collect();
            let kinds = fields.iter().map(|(kind, _)| *kind);
            let own: Vec<(&FieldLabel, &[f64])> =
                kinds.zip(own.iter().map(Vec::as_slice)).collect();
            let series = format!("{name}_{block}");
            let stem = format!("{series}_{window:06}");
            let file = format!("{stem}.{}", points_extension(places));
            create(&folder.join(&file), |out| write_points(places, out, &own, time))?;
            create(&folder.join(format!("{stem}.csv")), |out| {
                line::write_points(places, out, &own)
            })?;
            self.list(&folder, &series, time, file)?;
            self.scene.add(&series, &own);
        }
        Ok(())
    }

    /// Adds a file to its series. Rewriting the series at every output would cost the square of the
    /// number of outputs.
    fn list(&mut self, folder: &Path, name: &str, time: f64, file: String) -> Result<(), RunError> {
        let index = self.series.iter().position(|series| series.name == name);
        let index = index.unwrap_or_else(|| {
            self.series.push(FileSeries { name: name.to_owned(), files: Vec::new() });
            self.series.len() - 1
        });
        let files = &mut self.series[index].files;
        let path = folder.join(format!("{name}.pvd"));
        let listed = self.listed.insert(name.to_owned(), files.len() + 1);
        let added = listed == Some(files.len()) && add(&path, &entry(time, &file)).is_ok();
        files.push((time, file));
        match added {
            true => Ok(()),
            false => replace(&path, collection(files).as_bytes()),
        }
    }
}

/// Adds an entry to the collection of this path, by one write over its end.
///
/// # Errors
/// The file cannot be written, or does not end like a collection.
fn add(path: &Path, entry: &str) -> io::Result<()> {
    let flags = (OFlags::NOFOLLOW | OFlags::NONBLOCK).bits().cast_signed();
    let file = File::options().read(true).write(true).custom_flags(flags).open(path)?;
    let mut end = [0; COLLECTION_END.len()];
    let at = file.metadata()?.len().saturating_sub(COLLECTION_END.len() as u64);
    file.read_exact_at(&mut end, at)?;
    if end != COLLECTION_END.as_bytes() {
        return Err(io::Error::other("another end than that of a collection"));
    }
    file.write_all_at(format!("{entry}{COLLECTION_END}").as_bytes(), at)
}

#[cfg(test)]
mod tests {
    use super::*;
    use contract::field::PRESSURE;
    use contract::grid::Structured;
    use std::os::unix::fs::MetadataExt;

    fn written(writer: &mut FieldWriter, windows: std::ops::Range<u64>) {
        let grid = Grid::structured("g", Structured::contact_plane(0.0, 0.0, 1.0, 1.0, 2, 2));
        let shown = [FieldOutput::new("p", &grid, &PRESSURE.kind(), &[1.0; 4], None)];
        for window in windows {
            writer.write(&shown, window, window as f64).unwrap();
        }
    }

    /// A series is written as a whole once, and then only added to: the work is proportional to
    /// the number of outputs.
    #[test]
    fn a_series_is_added_to() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("p_g.pvd");
        let mut writer = FieldWriter::new(place.path().to_owned());
        written(&mut writer, 0..1);
        let number = |path: &Path| fs::metadata(path).unwrap().ino();
        let first = number(&path);
        written(&mut writer, 1..20);
        let text = |writer: &FieldWriter| collection(&writer.series()[0].files);
        assert_eq!((number(&path), fs::read_to_string(&path).unwrap()), (first, text(&writer)));
        // Back to an earlier state: the later files are listed no more.
        let earlier =
            FileSeries { files: writer.series[0].files[..3].to_vec(), ..writer.series[0].clone() };
        writer.resume(vec![earlier]);
        written(&mut writer, 30..32);
        assert_eq!(writer.series()[0].files.len(), 5);
        assert_eq!(fs::read_to_string(&path).unwrap(), text(&writer));
        // A file that somebody else has cut is written again.
        fs::write(&path, "cut").unwrap();
        written(&mut writer, 32..33);
        assert_eq!(fs::read_to_string(&path).unwrap(), text(&writer));
    }
}

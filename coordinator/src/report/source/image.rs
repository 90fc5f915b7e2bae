//! VTK images as `results::vtk` writes them: cell data, appended raw, little-endian doubles.

use super::xml::attribute;
use std::fs;
use std::path::Path;

/// What stands between head and data.
const DATA: &[u8] = b"<AppendedData encoding=\"raw\">\n_";

/// Cells of a box with fields on them.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Image {
    /// The corner of the box with the smallest coordinates \[m\].
    pub corner: [f64; 3],
    /// Lengths of a cell \[m\].
    pub spacing: [f64; 3],
    /// Cells along x, y, z; 0 along the axis on which the plane stands.
    pub cells: [usize; 3],
    /// The fields.
    pub fields: Vec<Field>,
}

/// A field on the cells of an image.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Field {
    /// Name of the field.
    pub name: String,
    /// Its SI unit.
    pub unit: String,
    /// Components of a vector; 1 for a scalar.
    pub components: usize,
    /// Values, cell by cell, x fastest; the components of a cell next to each other.
    pub values: Vec<f64>,
}

impl Image {
    /// Reads a file.
    ///
    /// # Errors
    /// What is wrong, for a person.
    pub(crate) fn read(path: &Path) -> Result<Self, String> {
        let shown = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let bytes = fs::read(path).map_err(|error| format!("{shown}: {error}"))?;
        Self::parse(&bytes).ok_or_else(|| format!("{shown}: not an image as runs write it"))
    }

    fn parse(bytes: &[u8]) -> Option<Self> {
        let end = bytes.windows(DATA.len()).position(|window| window == DATA)?;
        let head = std::str::from_utf8(&bytes[..end]).ok()?;
        let data = &bytes[end + DATA.len()..];
        let tag = head.lines().find(|line| line.contains("<ImageData"))?;
        let extent: Vec<usize> = numbers(attribute(tag, "WholeExtent")?)?;
        let &[0, nx, 0, ny, 0, nz] = extent.as_slice() else { return None };
        let three = |name| -> Option<[f64; 3]> { numbers(attribute(tag, name)?)?.try_into().ok() };
        let cells = [nx, ny, nz];
        let points = cells.iter().map(|n| n.max(&1)).product();
        let arrays = head.lines().filter(|line| line.contains("format=\"appended\""));
        let fields = arrays.map(|line| field(line, data, points)).collect::<Option<Vec<_>>>()?;
        Some(Self { corner: three("Origin")?, spacing: three("Spacing")?, cells, fields })
    }

    /// The two axes of the plane in which the cells lie, in the order of x, y, z.
    #[must_use]
    pub(crate) fn plane(&self) -> Option<[usize; 2]> {
        let axes: Vec<usize> = (0..3).filter(|&axis| self.cells[axis] > 0).collect();
        axes.try_into().ok()
    }

    /// Lower and upper border along an axis \[m\].
    #[must_use]
    pub(crate) fn borders(&self, axis: usize) -> [f64; 2] {
        let low = self.corner[axis];
        [low, low + self.cells[axis] as f64 * self.spacing[axis]]
    }

    /// Middle of the n-th cell along an axis \[m\].
    #[must_use]
    pub(crate) fn middle(&self, axis: usize, n: usize) -> f64 {
        self.corner[axis] + (n as f64 + 0.5) * self.spacing[axis]
    }

    /// The column of cells that holds the largest value of a field: its place along the plane's
    /// first axis \[m\], and distance from the other axis' origin \[m\] and value of each cell.
    #[must_use]
    pub(crate) fn through_largest(&self, field: &Field) -> Option<(f64, Vec<[f64; 2]>)> {
        let [along, upright] = self.plane()?;
        let columns = self.cells[along];
        let (largest, _) = field.values.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1))?;
        let column = largest % columns;
        let point = |row: usize| {
            let value = field.values[row * columns + column];
            [self.middle(upright, row).abs(), value]
        };
        let mut points: Vec<[f64; 2]> = (0..self.cells[upright]).map(point).collect();
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        Some((self.middle(along, column), points))
    }
}

impl Field {
    /// One number a cell: the value, or the length of the vector.
    #[must_use]
    pub(crate) fn magnitudes(&self) -> Vec<f64> {
        let length = |cell: &[f64]| match cell {
            [value] => *value,
            vector => vector.iter().map(|v| v * v).sum::<f64>().sqrt(),
        };
        self.values.chunks_exact(self.components).map(length).collect()
    }
}

fn field(tag: &str, data: &[u8], points: usize) -> Option<Field> {
    let (name, unit) = attribute(tag, "Name")?.strip_suffix(']')?.rsplit_once(" [")?;
    let components: usize = attribute(tag, "NumberOfComponents")?.parse().ok()?;
    let offset: usize = attribute(tag, "offset")?.parse().ok()?;
    let (length, rest) = data.get(offset..)?.split_first_chunk()?;
    let bytes = rest.get(..usize::try_from(u64::from_le_bytes(*length)).ok()?)?;
    let values: Vec<f64> = bytes.as_chunks().0.iter().map(|c| f64::from_le_bytes(*c)).collect();
    (components > 0 && values.len() == points * components).then(|| Field {
        name: name.to_owned(),
        unit: unit.to_owned(),
        components,
        values,
    })
}

fn numbers<T: std::str::FromStr>(text: &str) -> Option<Vec<T>> {
    text.split_whitespace().map(|word| word.parse().ok()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use contract::field::{PRESSURE, TRACTION};
    use contract::grid::{Grid, Structured};
    use run::results::vtk::{FieldWriter, Shown};

    /// What the writer of results writes is read back bit-identically, each value at its place.
    #[test]
    fn a_written_image_is_read_back() {
        let place = tempfile::tempdir().unwrap();
        let grid = Grid::structured("g", Structured::contact_plane(-0.25, 0.5, 0.5, 1.0, 3, 2));
        let (pressure, traction) = (PRESSURE.kind(), TRACTION.kind());
        let scalar: Vec<f64> = (0..6).map(|k| f64::from(k) / 3.0).collect();
        let vector: Vec<f64> = (0..12).map(|k| if k < 6 { 3.0 } else { f64::from(k) }).collect();
        let shown = |kind, values| Shown { producer: "p", grid: &grid, kind, values };
        let fields = [shown(&pressure, &scalar[..]), shown(&traction, &vector[..])];
        FieldWriter::new(place.path().to_owned()).write(&fields, 7, 0.0).unwrap();
        let path = place.path().join("p_g_000007.vti");
        let image = Image::read(&path).unwrap();
        assert_eq!((image.plane(), image.cells), (Some([0, 1]), [3, 2, 0]));
        assert_eq!((image.borders(0), image.borders(1)), ([-0.5, 1.0], [0.0, 2.0]));
        assert_eq!(image.middle(0, 2), 0.75);
        let [p, t] = &image.fields[..] else { panic!("{image:?}") };
        assert_eq!((p.name.as_str(), p.unit.as_str(), &p.values), ("pressure", "Pa", &scalar));
        let lengths = vector[6..].iter().map(|y| (9.0 + y * y).sqrt()).collect::<Vec<_>>();
        assert_eq!(t.magnitudes(), lengths);
        // A file that is cut off is not an image, wherever it is cut.
        let whole = fs::read(&path).unwrap();
        let data = whole.windows(DATA.len()).position(|w| w == DATA).unwrap() + DATA.len();
        for end in [0, data - 1, data, data + 8 + 47, data + 56 + 8 + 143] {
            assert_eq!(Image::parse(&whole[..end]), None, "cut after {end} bytes");
        }
    }
}

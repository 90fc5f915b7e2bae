//! VTK files of all kinds of grids. A structured grid along two axes is an image (`.vti`), any
//! other surface an unstructured grid of quadrilaterals (`.vtu`). A volume is a rectilinear
//! (`.vtr`), structured (`.vts`) or unstructured grid (`.vtu`). A block of points is a rectilinear
//! grid, or an unstructured one of vertices, with values at the points. A grid of vertices is an
//! unstructured one of its vertices, edges and triangles, with values at the points.

use super::shown::{FieldLabel, Fields, array_name, escape, table, unit};
use crate::results::cells::Cells;
use contract::grid::{Hexahedra, Places, Quadrilaterals, Vertices, Volume};
use std::fmt::Write as _;
use std::io::{self, Write};

/// VTK's number for the vertex.
const VERTEX: u8 = 1;
/// VTK's number for the straight line between two points.
const LINE: u8 = 3;
/// VTK's number for the triangle.
const TRIANGLE: u8 = 5;
/// VTK's number for the quadrilateral.
const QUAD: u8 = 9;
/// VTK's number for the hexahedron.
const HEXAHEDRON: u8 = 12;

/// Returns the extension of the file of a volume.
pub(super) fn volume_extension(volume: &Volume) -> &'static str {
    match volume.hexahedra() {
        Hexahedra::Rectilinear { .. } => "vtr",
        Hexahedra::Structured { .. } => "vts",
        Hexahedra::Unstructured { .. } => "vtu",
    }
}

/// Returns the extension of the file of a block of points.
pub(super) fn points_extension(places: &Places) -> &'static str {
    match places {
        Places::Lattice(_) => "vtr",
        Places::List(_) => "vtu",
    }
}

/// Writes the file of a structured grid along two axes.
pub(super) fn write_image(
    cells: &Cells,
    out: &mut impl Write,
    fields: &Fields,
    time: f64,
) -> io::Result<()> {
    let [nx, ny, nz] = cells.counts;
    let extent = format!("0 {nx} 0 {ny} 0 {nz}");
    let three = |v: &[f64; 3]| format!("{:e} {:e} {:e}", v[0], v[1], v[2]);
    let attributes = format!(
        " WholeExtent=\"{extent}\" Origin=\"{}\" Spacing=\"{}\"",
        three(&cells.corner),
        three(&cells.spacing)
    );
    let data = "ImageData";
    out.write_all(opening(data, &attributes, fields, time).as_bytes())?;
    writeln!(out, "    <Piece Extent=\"{extent}\">")?;
    out.write_all(Location::Cells.arrays(data, fields, cells.order.len(), 0).as_bytes())?;
    write_values(out, fields, cells.order.iter().copied())
}

/// Writes the file of a surface.
pub(super) fn write_quadrilaterals(
    surface: &Quadrilaterals,
    out: &mut impl Write,
    fields: &Fields,
    time: f64,
) -> io::Result<()> {
    let vertices = surface.points.iter().copied();
    let elements = surface.elements.iter().map(|corners| corners.map(|vertex| vertex as usize));
    let elements = vec![Elements::new(QUAD, elements)];
    write_elements(Location::Cells, vertices, elements, out, fields, time)
}

/// Writes the file of a grid of vertices.
pub(super) fn write_vertices(
    grid: &Vertices,
    out: &mut impl Write,
    fields: &Fields,
    time: f64,
) -> io::Result<()> {
    let elements = vec![
        Elements::new(VERTEX, (0..grid.points.len()).map(|point| [point])),
        Elements::new(LINE, grid.edges.iter().map(|ends| ends.map(|end| end as usize))),
        Elements::new(TRIANGLE, grid.triangles.iter().map(|t| t.map(|corner| corner as usize))),
    ];
    let points = grid.points.iter().copied();
    write_elements(Location::Points, points, elements, out, fields, time)
}

/// Writes the file of a volume.
pub(super) fn write_volume(
    volume: &Volume,
    out: &mut impl Write,
    fields: &Fields,
    time: f64,
) -> io::Result<()> {
    let hexahedra = volume.hexahedra();
    let vertices = (0..hexahedra.vertices()).map(|vertex| volume.vertex(vertex));
    let location = Location::Cells;
    match hexahedra {
        Hexahedra::Rectilinear { ni, nj, nk } => {
            let axes = volume.axes().into_iter().flatten().zip(["x", "y", "z"]);
            let arrays = axes.map(|(axis, name)| (name, 1, axis.to_vec())).collect();
            let data = "RectilinearGrid";
            let lattice = Lattice { data, place: "Coordinates", arrays, location };
            lattice.write([ni, nj, nk], out, fields, time)
        }
        Hexahedra::Structured { ni, nj, nk } => {
            let arrays = vec![("Points", 3, vertices.flatten().collect())];
            let lattice = Lattice { data: "StructuredGrid", place: "Points", arrays, location };
            lattice.write([ni, nj, nk], out, fields, time)
        }
        Hexahedra::Unstructured { .. } => {
            let elements = (0..hexahedra.elements()).map(|element| volume.corners(element));
            let elements = vec![Elements::new(HEXAHEDRON, elements)];
            write_elements(location, vertices, elements, out, fields, time)
        }
    }
}

/// Writes the file of a block of points.
pub(super) fn write_points(
    places: &Places,
    out: &mut impl Write,
    fields: &Fields,
    time: f64,
) -> io::Result<()> {
    let location = Location::Points;
    match places {
        Places::Lattice(axes) => {
            let cells = axes.each_ref().map(|axis| axis.len() - 1);
            let arrays = axes.iter().zip(["x", "y", "z"]);
            let arrays = arrays.map(|(axis, name)| (name, 1, axis.clone())).collect();
            let data = "RectilinearGrid";
            let lattice = Lattice { data, place: "Coordinates", arrays, location };
            lattice.write(cells, out, fields, time)
        }
        Places::List(points) => {
            let elements = vec![Elements::new(VERTEX, (0..points.len()).map(|point| [point]))];
            write_elements(location, points.iter().copied(), elements, out, fields, time)
        }
    }
}

/// Elements of a grid to which values belong.
#[derive(Clone, Copy, Debug)]
enum Location {
    Cells,
    Points,
}

impl Location {
    /// Returns the arrays of `count` values each, appended from `offset` bytes on, and the end tag
    /// of the data set.
    fn arrays(self, data: &str, fields: &Fields, count: usize, mut offset: usize) -> String {
        let element = match self {
            Self::Cells => "CellData",
            Self::Points => "PointData",
        };
        let mut text = format!("      <{element}>\n");
        for (kind, _) in fields {
            let components = components(kind);
            let (name, unit) = (escape(&array_name(kind)), unit(kind));
            let _ = writeln!(
                text,
                "        <DataArray type=\"Float64\" Name=\"{name}\" \
                 NumberOfComponents=\"{components}\" format=\"appended\" offset=\"{offset}\">\n          \
                 {unit}\n        </DataArray>"
            );
            offset += 8 + 8 * components * count;
        }
        text + "      </"
            + element
            + ">\n    </Piece>\n  </"
            + data
            + ">\n  \
                <AppendedData encoding=\"raw\">\n_"
    }
}

/// A grid of rows, columns and layers in VTK's form.
struct Lattice {
    /// VTK's type of the data set.
    data: &'static str,
    /// XML element with the arrays of coordinates.
    place: &'static str,
    /// Name, number of components and values of these arrays.
    arrays: Vec<(&'static str, usize, Vec<f64>)>,
    location: Location,
}

impl Lattice {
    /// Writes the file of a lattice with these numbers of cells along its axes.
    fn write(
        &self,
        cells: [usize; 3],
        out: &mut impl Write,
        fields: &Fields,
        time: f64,
    ) -> io::Result<()> {
        let Self { data, place, arrays, location } = self;
        let [ni, nj, nk] = cells;
        let count = match location {
            Location::Cells => cells.iter().product(),
            Location::Points => cells.iter().map(|cells| cells + 1).product(),
        };
        let extent = format!("0 {ni} 0 {nj} 0 {nk}");
        let attributes = format!(" WholeExtent=\"{extent}\"");
        out.write_all(opening(data, &attributes, fields, time).as_bytes())?;
        writeln!(out, "    <Piece Extent=\"{extent}\">\n      <{place}>")?;
        let mut offset = 0;
        for (name, components, values) in arrays {
            writeln!(
                out,
                "        <DataArray type=\"Float64\" Name=\"{name}\" \
                 NumberOfComponents=\"{components}\" format=\"appended\" offset=\"{offset}\"/>"
            )?;
            offset += 8 + 8 * values.len();
        }
        writeln!(out, "      </{place}>")?;
        out.write_all(location.arrays(data, fields, count, offset).as_bytes())?;
        for (.., values) in arrays {
            out.write_all(&(8 * values.len() as u64).to_le_bytes())?;
            values.iter().try_for_each(|value| out.write_all(&value.to_le_bytes()))?;
        }
        write_values(out, fields, 0..count)
    }
}

/// Elements of one kind in an unstructured grid.
struct Elements<'a> {
    /// VTK's number for the kind.
    kind: u8,
    /// Number of corners of each element.
    corners: usize,
    count: usize,
    /// Corners of all elements, one element after the other.
    vertices: Box<dyn Iterator<Item = usize> + 'a>,
}

impl<'a> Elements<'a> {
    fn new<const CORNERS: usize>(
        kind: u8,
        elements: impl ExactSizeIterator<Item = [usize; CORNERS]> + 'a,
    ) -> Self {
        Self {
            kind,
            corners: CORNERS,
            count: elements.len(),
            vertices: Box::new(elements.flatten()),
        }
    }
}

/// Writes the file of an unstructured grid.
fn write_elements(
    location: Location,
    vertices: impl ExactSizeIterator<Item = [f64; 3]>,
    elements: Vec<Elements<'_>>,
    out: &mut impl Write,
    fields: &Fields,
    time: f64,
) -> io::Result<()> {
    let (points, cells) = (vertices.len(), elements.iter().map(|e| e.count).sum::<usize>());
    let corners: usize = elements.iter().map(|e| e.corners * e.count).sum();
    let values = match location {
        Location::Cells => cells,
        Location::Points => points,
    };
    let bytes = [3 * 8 * points, 8 * corners, 8 * cells, cells];
    let offset = |array: usize| bytes[..array].iter().map(|bytes| 8 + bytes).sum::<usize>();
    out.write_all(opening("UnstructuredGrid", "", fields, time).as_bytes())?;
    let array = |data: &str, array: usize| {
        format!("        <DataArray {data} format=\"appended\" offset=\"{}\"/>", offset(array))
    };
    writeln!(out, "    <Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{cells}\">")?;
    writeln!(out, "      <Points>")?;
    let coordinates = "type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\"";
    writeln!(out, "{}", array(coordinates, 0))?;
    writeln!(out, "      </Points>\n      <Cells>")?;
    writeln!(out, "{}", array("type=\"Int64\" Name=\"connectivity\"", 1))?;
    writeln!(out, "{}", array("type=\"Int64\" Name=\"offsets\"", 2))?;
    writeln!(out, "{}", array("type=\"UInt8\" Name=\"types\"", 3))?;
    writeln!(out, "      </Cells>")?;
    let arrays = location.arrays("UnstructuredGrid", fields, values, offset(4));
    out.write_all(arrays.as_bytes())?;
    let begin =
        |array: usize, out: &mut dyn Write| out.write_all(&(bytes[array] as u64).to_le_bytes());
    begin(0, out)?;
    for coordinate in vertices.flatten() {
        out.write_all(&coordinate.to_le_bytes())?;
    }
    let kinds: Vec<(u8, usize, usize)> =
        elements.iter().map(|one| (one.kind, one.corners, one.count)).collect();
    begin(1, out)?;
    for vertex in elements.into_iter().flat_map(|one| one.vertices) {
        out.write_all(&(vertex as i64).to_le_bytes())?;
    }
    begin(2, out)?;
    let mut end = 0;
    for &(_, corners, count) in &kinds {
        for _ in 0..count {
            end += corners;
            out.write_all(&(end as i64).to_le_bytes())?;
        }
    }
    begin(3, out)?;
    for &(kind, _, count) in &kinds {
        out.write_all(&vec![kind; count])?;
    }
    write_values(out, fields, 0..values)
}

/// Opens a data set of this VTK type, with the table of its fields and the time [s] of their
/// values.
fn opening(data: &str, attributes: &str, fields: &Fields, time: f64) -> String {
    let table = table(fields);
    format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"{data}\" version=\"1.0\" \
         byte_order=\"LittleEndian\" header_type=\"UInt64\">\n  <{data}{attributes}>\n    \
         <FieldData>\n      <DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" \
         format=\"ascii\">{time:e}</DataArray>\n{table}    </FieldData>\n"
    )
}

/// Writes the values of all fields in the given order of elements, and the end of the file.
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

/// Returns the number of components in the file: a vector in the plane becomes one in space.
fn components(kind: &FieldLabel) -> usize {
    if kind.components == 2 { 3 } else { kind.components as usize }
}

#[cfg(test)]
mod tests {
    use super::*;
    use contract::field;
    use contract::grid::{Measure, Structured};

    /// Returns the bytes of the array whose tag holds `tag`. Finds them by offset, as a reader
    /// does.
    fn array<'a>(file: &'a [u8], tag: &str) -> &'a [u8] {
        let marker = b"<AppendedData encoding=\"raw\">\n_";
        let start = file.windows(marker.len()).position(|w| w == marker).unwrap();
        let head = std::str::from_utf8(&file[..start]).unwrap();
        let line = head.lines().find(|line| line.contains(tag)).unwrap();
        let (_, offset) = line.split_once("offset=\"").unwrap();
        let offset: usize = offset.split('"').next().unwrap().parse().unwrap();
        let (length, rest) = file[start + marker.len() + offset..].split_first_chunk().unwrap();
        &rest[..u64::from_le_bytes(*length) as usize]
    }

    fn doubles(bytes: &[u8]) -> Vec<f64> {
        bytes.as_chunks().0.iter().map(|chunk| f64::from_le_bytes(*chunk)).collect()
    }

    fn integers(bytes: &[u8]) -> Vec<i64> {
        bytes.as_chunks().0.iter().map(|chunk| i64::from_le_bytes(*chunk)).collect()
    }

    /// Vertices, edges and triangles are cells; values belong to the vertices.
    #[test]
    fn a_grid_of_vertices_has_cells_of_three_kinds() {
        let grid = Vertices {
            points: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]],
            edges: vec![[2, 0]],
            triangles: vec![[0, 1, 2]],
            measure: Measure::PerPoint,
        };
        let label = FieldLabel::of(&field::FRICTION_POWER.kind(), None);
        let values = [4.0, 5.0, 6.0];
        let (mut file, fields) = (Vec::new(), [(&label, values.as_slice())]);
        write_vertices(&grid, &mut file, &fields, 0.0).unwrap();
        assert_eq!(integers(array(&file, "connectivity")), [0, 1, 2, 2, 0, 0, 1, 2]);
        assert_eq!(integers(array(&file, "offsets")), [1, 2, 3, 5, 8]);
        assert_eq!(array(&file, "types"), [VERTEX, VERTEX, VERTEX, LINE, TRIANGLE]);
        let text = String::from_utf8_lossy(&file);
        assert!(text.contains("NumberOfPoints=\"3\" NumberOfCells=\"5\""), "{text}");
        assert!(text.contains("<PointData>"), "{text}");
        assert_eq!(doubles(array(&file, "Name=\"friction_power")), values);
    }

    #[test]
    fn a_file_reads_back_as_it_was() {
        let shape = Structured::contact_plane(0.5, 0.5, 1.0, 1.0, 2, 1);
        let mut surface = Quadrilaterals::from(&shape);
        surface.points[4] = [1.1, 0.9, 0.25];
        let (pressure, traction) = (
            FieldLabel::of(&field::PRESSURE.kind(), None),
            FieldLabel::of(&field::TRACTION.kind(), None),
        );
        let fields: [(_, &[f64]); 2] =
            [(&pressure, &[1e8, -0.1]), (&traction, &[1.0, 2.0, 3.0, 4.0])];
        let mut file = Vec::new();
        write_quadrilaterals(&surface, &mut file, &fields, 0.125).unwrap();
        let text = String::from_utf8_lossy(&file);
        assert!(text.contains("<VTKFile type=\"UnstructuredGrid\""), "{text}");
        assert!(text.contains("<Piece NumberOfPoints=\"6\" NumberOfCells=\"2\">"), "{text}");
        assert!(text.contains(">1.25e-1</DataArray>"), "{text}");
        assert!(text.ends_with("\n  </AppendedData>\n</VTKFile>\n"), "{text}");
        assert_eq!(doubles(array(&file, "\"Points\"")), surface.points.as_flattened());
        assert_eq!(integers(array(&file, "connectivity")), [0, 1, 4, 3, 1, 2, 5, 4]);
        assert_eq!(integers(array(&file, "offsets")), [4, 8]);
        assert_eq!(array(&file, "types"), [9, 9]);
        assert_eq!(doubles(array(&file, "pressure [Pa]")), [1e8, -0.1]);
        assert_eq!(doubles(array(&file, "traction [Pa]")), [1.0, 3.0, 0.0, 2.0, 4.0, 0.0]);
    }

    fn written(places: &Places, values: &[f64]) -> Vec<u8> {
        let kind = FieldLabel::of(&contract::field::POINT_VON_MISES.kind(), None);
        let mut out = Vec::new();
        write_points(places, &mut out, &[(&kind, values)], 0.5).unwrap();
        out
    }

    #[test]
    fn a_lattice_has_its_axes_and_values_at_its_points() {
        let places = Places::Lattice([vec![0.0, 1.5], vec![7.0], vec![-2.0, -1.0, 0.0]]);
        let file = written(&places, &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        let text = String::from_utf8_lossy(&file);
        assert!(text.contains("<Piece Extent=\"0 1 0 0 0 2\">") && text.contains("<PointData>"));
        let values = |tag| doubles(array(&file, tag));
        assert_eq!(values("\"x\""), [0.0, 1.5]);
        assert_eq!(values("\"y\""), [7.0]);
        assert_eq!(values("\"z\""), [-2.0, -1.0, 0.0]);
        assert_eq!(values("point_von_mises"), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    }

    #[test]
    fn a_list_is_of_vertices() {
        let file = written(&Places::List(vec![[1.0, 2.0, -3.0], [4.0, 5.0, -6.0]]), &[7.0, 8.0]);
        let text = String::from_utf8_lossy(&file);
        assert!(text.contains("NumberOfPoints=\"2\" NumberOfCells=\"2\""));
        assert_eq!(doubles(array(&file, "\"Points\"")), [1.0, 2.0, -3.0, 4.0, 5.0, -6.0]);
        assert_eq!(integers(array(&file, "connectivity")), [0, 1]);
        assert_eq!(integers(array(&file, "offsets")), [1, 2]);
        assert_eq!(array(&file, "types"), [1, 1]);
        assert_eq!(doubles(array(&file, "point_von_mises")), [7.0, 8.0]);
    }
}

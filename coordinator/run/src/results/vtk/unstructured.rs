//! Quadrilaterals and hexahedra as an unstructured grid.

use super::file::{cell_data, opening, write_values};
use super::shown::Fields;
use contract::grid::{Quadrilaterals, Volume};
use std::io::{self, Write};

/// VTK's number of the quadrilateral.
const QUAD: u8 = 9;
/// That of the hexahedron.
const HEXAHEDRON: u8 = 12;

/// Writes the whole file of a surface.
pub(super) fn write_quadrilaterals(
    surface: &Quadrilaterals,
    out: &mut impl Write,
    fields: &Fields,
    time: f64,
) -> io::Result<()> {
    let vertices = surface.points.iter().copied();
    let elements = surface.elements.iter().map(|corners| corners.map(|vertex| vertex as usize));
    write(QUAD, (vertices, elements), out, fields, time)
}

/// Writes the whole file of a volume.
pub(super) fn write_hexahedra(
    volume: &Volume,
    out: &mut impl Write,
    fields: &Fields,
    time: f64,
) -> io::Result<()> {
    let hexahedra = volume.hexahedra();
    let vertices = (0..hexahedra.vertices()).map(|vertex| volume.vertex(vertex));
    let elements = (0..hexahedra.elements()).map(|element| volume.corners(element));
    write(HEXAHEDRON, (vertices, elements), out, fields, time)
}

/// Elements of one kind, each of so many corners.
fn write<const CORNERS: usize>(
    kind: u8,
    (vertices, elements): (
        impl ExactSizeIterator<Item = [f64; 3]>,
        impl ExactSizeIterator<Item = [usize; CORNERS]>,
    ),
    out: &mut impl Write,
    fields: &Fields,
    time: f64,
) -> io::Result<()> {
    let (points, cells) = (vertices.len(), elements.len());
    let bytes = [3 * 8 * points, CORNERS * 8 * cells, 8 * cells, cells];
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
    out.write_all(cell_data("UnstructuredGrid", fields, cells, offset(4)).as_bytes())?;
    let begin =
        |array: usize, out: &mut dyn Write| out.write_all(&(bytes[array] as u64).to_le_bytes());
    begin(0, out)?;
    for coordinate in vertices.flatten() {
        out.write_all(&coordinate.to_le_bytes())?;
    }
    begin(1, out)?;
    for vertex in elements.flatten() {
        out.write_all(&(vertex as i64).to_le_bytes())?;
    }
    begin(2, out)?;
    for cell in 1..=cells {
        out.write_all(&((CORNERS * cell) as i64).to_le_bytes())?;
    }
    begin(3, out)?;
    out.write_all(&vec![kind; cells])?;
    write_values(out, fields, 0..cells)
}

#[cfg(test)]
mod tests {
    use super::super::shown::ShownKind;
    use super::*;
    use contract::field;
    use contract::grid::Structured;

    /// The bytes of the array whose tag holds `tag`, found as a reader would: by its offset.
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

    #[test]
    fn a_file_reads_back_as_it_was() {
        let shape = Structured::contact_plane(0.5, 0.5, 1.0, 1.0, 2, 1);
        let mut surface = Quadrilaterals::from(&shape);
        surface.points[4] = [1.1, 0.9, 0.25];
        let (pressure, traction) = (
            ShownKind::of(&field::PRESSURE.kind(), None),
            ShownKind::of(&field::TRACTION.kind(), None),
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
}

//! Blocks of points: a lattice as a rectilinear grid (`.vtr`), a list as vertices of an unstructured one (`.vtu`), with the values at the
//! points.

use super::file::{opening, point_data, write_values};
use super::shown::Fields;
use contract::grid::Places;
use std::io::{self, Write};

/// VTK's number of the vertex.
const VERTEX: u8 = 1;

/// How the name of its file ends.
pub(super) fn extension(places: &Places) -> &'static str {
    match places {
        Places::Lattice(_) => "vtr",
        Places::List(_) => "vtu",
    }
}

/// Writes the whole file.
pub(super) fn write(
    places: &Places,
    out: &mut impl Write,
    fields: &Fields,
    time: f64,
) -> io::Result<()> {
    match places {
        Places::Lattice(axes) => lattice(axes, out, fields, time),
        Places::List(points) => list(points, out, fields, time),
    }
}

fn lattice(
    axes: &[Vec<f64>; 3],
    out: &mut impl Write,
    fields: &Fields,
    time: f64,
) -> io::Result<()> {
    let data = "RectilinearGrid";
    let [nx, ny, nz] = axes.each_ref().map(|axis| axis.len() - 1);
    let extent = format!("0 {nx} 0 {ny} 0 {nz}");
    let attributes = format!(" WholeExtent=\"{extent}\"");
    out.write_all(opening(data, &attributes, fields, time).as_bytes())?;
    writeln!(out, "    <Piece Extent=\"{extent}\">\n      <Coordinates>")?;
    let mut offset = 0;
    for (name, axis) in ["x", "y", "z"].into_iter().zip(axes) {
        writeln!(
            out,
            "        <DataArray type=\"Float64\" Name=\"{name}\" NumberOfComponents=\"1\" \
             format=\"appended\" offset=\"{offset}\"/>"
        )?;
        offset += 8 + 8 * axis.len();
    }
    writeln!(out, "      </Coordinates>")?;
    let count = axes.iter().map(Vec::len).product();
    out.write_all(point_data(data, fields, count, offset).as_bytes())?;
    for axis in axes {
        out.write_all(&(8 * axis.len() as u64).to_le_bytes())?;
        axis.iter().try_for_each(|value| out.write_all(&value.to_le_bytes()))?;
    }
    write_values(out, fields, 0..count)
}

fn list(points: &[[f64; 3]], out: &mut impl Write, fields: &Fields, time: f64) -> io::Result<()> {
    let data = "UnstructuredGrid";
    let count = points.len();
    let bytes = [24 * count, 8 * count, 8 * count, count];
    let offset = |array: usize| bytes[..array].iter().map(|bytes| 8 + bytes).sum::<usize>();
    out.write_all(opening(data, "", fields, time).as_bytes())?;
    let array = |data: &str, array: usize| {
        format!("        <DataArray {data} format=\"appended\" offset=\"{}\"/>", offset(array))
    };
    writeln!(out, "    <Piece NumberOfPoints=\"{count}\" NumberOfCells=\"{count}\">")?;
    writeln!(out, "      <Points>")?;
    let coordinates = "type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\"";
    writeln!(out, "{}", array(coordinates, 0))?;
    writeln!(out, "      </Points>\n      <Cells>")?;
    writeln!(out, "{}", array("type=\"Int64\" Name=\"connectivity\"", 1))?;
    writeln!(out, "{}", array("type=\"Int64\" Name=\"offsets\"", 2))?;
    writeln!(out, "{}", array("type=\"UInt8\" Name=\"types\"", 3))?;
    writeln!(out, "      </Cells>")?;
    out.write_all(point_data(data, fields, count, offset(4)).as_bytes())?;
    let begin =
        |array: usize, out: &mut dyn Write| out.write_all(&(bytes[array] as u64).to_le_bytes());
    begin(0, out)?;
    for coordinate in points.as_flattened() {
        out.write_all(&coordinate.to_le_bytes())?;
    }
    begin(1, out)?;
    (0..count).try_for_each(|point| out.write_all(&(point as i64).to_le_bytes()))?;
    begin(2, out)?;
    (1..=count).try_for_each(|end| out.write_all(&(end as i64).to_le_bytes()))?;
    begin(3, out)?;
    out.write_all(&vec![VERTEX; count])?;
    write_values(out, fields, 0..count)
}

#[cfg(test)]
mod tests {
    use super::super::shown::ShownKind;
    use super::*;

    fn written(places: &Places, values: &[f64]) -> Vec<u8> {
        let kind = ShownKind::of(&contract::field::POINT_VON_MISES.kind(), None);
        let mut out = Vec::new();
        write(places, &mut out, &[(&kind, values)], 0.5).unwrap();
        out
    }

    /// The bytes after the mark of the data, of the array that begins at this offset.
    fn array(file: &[u8], offset: usize) -> Vec<f64> {
        let mark = b"encoding=\"raw\">\n_";
        let start = file.windows(mark.len()).position(|w| w == mark).unwrap() + mark.len() + offset;
        let bytes = u64::from_le_bytes(file[start..start + 8].try_into().unwrap()) as usize;
        let data = &file[start + 8..start + 8 + bytes];
        data.chunks_exact(8).map(|v| f64::from_le_bytes(v.try_into().unwrap())).collect()
    }

    #[test]
    fn a_lattice_has_its_axes_and_values_at_its_points() {
        let places = Places::Lattice([vec![0.0, 1.5], vec![7.0], vec![-2.0, -1.0, 0.0]]);
        let file = written(&places, &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        let text = String::from_utf8_lossy(&file);
        assert!(text.contains("<Piece Extent=\"0 1 0 0 0 2\">") && text.contains("<PointData>"));
        assert_eq!(array(&file, 0), [0.0, 1.5]);
        assert_eq!(array(&file, 24), [7.0]);
        assert_eq!(array(&file, 40), [-2.0, -1.0, 0.0]);
        assert_eq!(array(&file, 72), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    }

    #[test]
    fn a_list_is_of_vertices() {
        let file = written(&Places::List(vec![[1.0, 2.0, -3.0], [4.0, 5.0, -6.0]]), &[7.0, 8.0]);
        let text = String::from_utf8_lossy(&file);
        assert!(text.contains("NumberOfPoints=\"2\" NumberOfCells=\"2\""));
        assert_eq!(array(&file, 0), [1.0, 2.0, -3.0, 4.0, 5.0, -6.0]);
        assert_eq!(array(&file, 56 + 24 + 24 + 10), [7.0, 8.0]);
    }
}

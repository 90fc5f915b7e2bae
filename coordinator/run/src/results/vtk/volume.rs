//! Volumes: rectilinear (`.vtr`) and structured grids (`.vts`), or hexahedra of an unstructured one.

use super::file::{cell_data, opening, write_values};
use super::shown::Fields;
use super::unstructured;
use contract::grid::{Hexahedra, Volume};
use std::io::{self, Write};

/// How the name of its file ends.
pub(super) fn extension(volume: &Volume) -> &'static str {
    match volume.hexahedra() {
        Hexahedra::Rectilinear { .. } => "vtr",
        Hexahedra::Structured { .. } => "vts",
        Hexahedra::Unstructured { .. } => "vtu",
    }
}

/// Writes the whole file.
pub(super) fn write(
    volume: &Volume,
    out: &mut impl Write,
    fields: &Fields,
    time: f64,
) -> io::Result<()> {
    match volume.hexahedra() {
        Hexahedra::Rectilinear { ni, nj, nk } => {
            let axes = volume.axes().into_iter().flatten().zip(["x", "y", "z"]);
            let arrays = axes.map(|(axis, name)| (name, 1, axis.to_vec())).collect();
            let lattice = Lattice { data: "RectilinearGrid", place: "Coordinates", arrays };
            lattice.write([ni, nj, nk], out, fields, time)
        }
        Hexahedra::Structured { ni, nj, nk } => {
            let vertices = (0..volume.hexahedra().vertices()).flat_map(|n| volume.vertex(n));
            let arrays = vec![("Points", 3, vertices.collect())];
            let lattice = Lattice { data: "StructuredGrid", place: "Points", arrays };
            lattice.write([ni, nj, nk], out, fields, time)
        }
        Hexahedra::Unstructured { .. } => unstructured::write_hexahedra(volume, out, fields, time),
    }
}

/// A grid of rows, columns and layers as VTK has it.
struct Lattice {
    /// VTK's type of the data set.
    data: &'static str,
    /// The element with the arrays that say where it is.
    place: &'static str,
    /// Name, components and values of these arrays.
    arrays: Vec<(&'static str, usize, Vec<f64>)>,
}

impl Lattice {
    fn write(
        &self,
        [ni, nj, nk]: [usize; 3],
        out: &mut impl Write,
        fields: &Fields,
        time: f64,
    ) -> io::Result<()> {
        let Self { data, place, arrays } = self;
        let (extent, cells) = (format!("0 {ni} 0 {nj} 0 {nk}"), ni * nj * nk);
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
        out.write_all(cell_data(data, fields, cells, offset).as_bytes())?;
        for (.., values) in arrays {
            out.write_all(&(8 * values.len() as u64).to_le_bytes())?;
            values.iter().try_for_each(|value| out.write_all(&value.to_le_bytes()))?;
        }
        write_values(out, fields, 0..cells)
    }
}

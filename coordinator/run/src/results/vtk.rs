//! Fields as VTK data with a `.pvd` series, for ParaView.
//!
//! A structured grid whose steps lie along two axes becomes an image with cell data (`.vti`). Any
//! other surface becomes an unstructured grid of quadrilaterals (`.vtu`). A volume becomes a
//! rectilinear (`.vtr`) or structured grid (`.vts`), or an unstructured one of hexahedra. Every
//! block of points has its own file, and a table as CSV.
//!
//! Every array carries its unit in its name (`pressure [Pa]`) and as VTK's own label. The field
//! data state unit, body and meaning of each array. Fields with two components become vectors (x,
//! y, 0). Values are appended raw, as little-endian doubles. A series lists only complete files,
//! and each of them is added by one write, so that the files are readable at any time. `open.py`
//! opens all series in ParaView.

mod data_sets;
mod scene;
mod shown;
mod writer;

pub(super) use scene::{FILE as SCENE, is_scene};
pub use shown::{FieldLabel, FieldOutput, FileSeries, INTERFACE, read_collection};
pub use writer::FieldWriter;

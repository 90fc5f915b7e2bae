//! Fields as VTK data with a `.pvd` series, for ParaView.
//!
//! A structured grid whose steps lie along two axes becomes an image with cell data (`.vti`), any
//! other an unstructured grid of quadrilaterals (`.vtu`); a volume a rectilinear (`.vtr`) or structured
//! grid (`.vts`), or an unstructured one of hexahedra. Of points every block has a file of its own, and a table as CSV. Every array carries its unit in its name
//! (`pressure [Pa]`) and as VTK's own label, and the field data tell unit, body and meaning of each;
//! two-component fields become vectors (x, y, 0). The values are appended raw, as little-endian
//! doubles. A series names only files that are complete, and is replaced as a whole, so that what is
//! on disk can be read at any time. `open.py` opens all series in ParaView.

mod file;
mod image;
mod label;
mod points;
mod scene;
mod series;
mod shown;
mod unstructured;
mod volume;
mod writer;

pub(super) use scene::{FILE as SCENE, is_scene};
pub use series::FileSeries;
pub use shown::{Shown, ShownKind};
pub use writer::FieldWriter;

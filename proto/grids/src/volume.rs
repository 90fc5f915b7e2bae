//! Volumes of hexahedra, for output fields only.
//!
//! A volume is announced by the kind and counts of its elements; its JSON form holds nothing else.
//! The geometry follows as the values of a field, and is stored in the same layout. Vectors of
//! three components \[m\] are component-major, so that component c of vector n stands at
//! `c * count + n`.
//!
//! | hexahedra | count | vectors |
//! |---|---|---|
//! | rectilinear | nodes of the longest axis | n-th nodes of the axes; 0 beyond the end |
//! | structured | (ni + 1)(nj + 1)(nk + 1) | the vertices, i fastest, then j |
//! | unstructured | vertices + 3 elements | vertices, then corners of each element |
//!
//! The eight corners of an unstructured element are vertex numbers, not lengths. They fill three
//! vectors: corners (0, 1, 2), (3, 4, 5) and (6, 7, and a 0).
//!
//! Corners are in VTK's order, and elements are right-handed (`hexahedron.rs`). The value of
//! element (i, j, k) stands at `(k * nj + j) * ni + i`.

use super::hexahedron;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Number of components of a vector in space.
const COMPONENTS: usize = 3;
/// Number of vectors that hold the corners of an element.
const VECTORS_OF_CORNERS: usize = 3;
/// Maximum number of vertices and of elements: more would not fit into any machine.
const MOST: usize = 1 << 32;

/// Kind and counts of the elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "hexahedra", rename_all = "kebab-case")]
pub enum Hexahedra {
    /// Boxes between the nodes of three axes.
    Rectilinear {
        /// Number of elements along x.
        ni: usize,
        /// Number of elements along y.
        nj: usize,
        /// Number of elements along z.
        nk: usize,
    },
    /// Elements in rows, columns and layers, with vertices at any position.
    Structured {
        /// Number of elements in i.
        ni: usize,
        /// Number of elements in j.
        nj: usize,
        /// Number of elements in k.
        nk: usize,
    },
    /// Elements over shared vertices.
    Unstructured {
        /// Number of vertices.
        vertices: usize,
        /// Number of elements.
        elements: usize,
    },
}

impl Hexahedra {
    /// Returns the number of elements.
    #[must_use]
    pub fn elements(&self) -> usize {
        match *self {
            Self::Rectilinear { ni, nj, nk } | Self::Structured { ni, nj, nk } => {
                ni.saturating_mul(nj).saturating_mul(nk)
            }
            Self::Unstructured { elements, .. } => elements,
        }
    }

    /// Returns the number of vertices.
    #[must_use]
    pub fn vertices(&self) -> usize {
        match *self {
            Self::Rectilinear { ni, nj, nk } | Self::Structured { ni, nj, nk } => {
                let nodes = [ni, nj, nk].map(|count| count.saturating_add(1));
                nodes.into_iter().fold(1, usize::saturating_mul)
            }
            Self::Unstructured { vertices, .. } => vertices,
        }
    }

    /// Returns the number of vectors of the geometry, each with three values.
    #[must_use]
    pub fn vectors(&self) -> usize {
        match *self {
            Self::Rectilinear { ni, nj, nk } => ni.max(nj).max(nk).saturating_add(1),
            Self::Structured { .. } => self.vertices(),
            Self::Unstructured { vertices, elements } => {
                vertices.saturating_add(elements.saturating_mul(VECTORS_OF_CORNERS))
            }
        }
    }

    fn check(&self) -> Result<(), String> {
        let (vertices, elements) = (self.vertices(), self.elements());
        if (8..=MOST).contains(&vertices) && (1..=MOST).contains(&elements) {
            return Ok(());
        }
        Err(format!("it has {elements} elements and {vertices} vertices"))
    }
}

/// Hexahedra, with or without their geometry.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(from = "Hexahedra", into = "Hexahedra")]
pub struct Volume {
    hexahedra: Hexahedra,
    /// Geometry in the layout of the field, once known.
    geometry: Option<Arc<[f64]>>,
}

impl From<Hexahedra> for Volume {
    /// Returns a volume whose geometry is to follow.
    fn from(hexahedra: Hexahedra) -> Self {
        Self { hexahedra, geometry: None }
    }
}

impl From<Volume> for Hexahedra {
    fn from(volume: Volume) -> Self {
        volume.hexahedra
    }
}

impl PartialEq for Volume {
    /// Clones share their geometry, so identical pointers skip the comparison of values.
    fn eq(&self, other: &Self) -> bool {
        let same = match (&self.geometry, &other.geometry) {
            (Some(own), Some(other)) => Arc::ptr_eq(own, other) || own == other,
            (own, other) => own.is_none() && other.is_none(),
        };
        same && self.hexahedra == other.hexahedra
    }
}

impl Volume {
    /// Returns boxes between the nodes of the axes x, y and z \[m\], each strictly increasing.
    #[must_use]
    pub fn rectilinear(axes: [&[f64]; 3]) -> Self {
        let [ni, nj, nk] = axes.map(|axis| axis.len().saturating_sub(1));
        let hexahedra = Hexahedra::Rectilinear { ni, nj, nk };
        let mut geometry = vec![0.0; COMPONENTS * hexahedra.vectors()];
        for (values, axis) in geometry.chunks_exact_mut(hexahedra.vectors()).zip(axes) {
            values[..axis.len()].copy_from_slice(axis);
        }
        Self { hexahedra, geometry: Some(geometry.into()) }
    }

    /// Returns a volume with these numbers of elements in i, j and k; vertex (i, j, k) \[m\] stands
    /// at `(k * (nj + 1) + j) * (ni + 1) + i`.
    #[must_use]
    pub fn structured([ni, nj, nk]: [usize; 3], vertices: &[[f64; 3]]) -> Self {
        let hexahedra = Hexahedra::Structured { ni, nj, nk };
        Self { hexahedra, geometry: Some(by_component(vertices.len(), vertices.iter().copied())) }
    }

    /// Returns elements with eight corners each, given as vertex numbers from 0; vertices in \[m\].
    #[must_use]
    pub fn unstructured(vertices: &[[f64; 3]], elements: &[[u32; 8]]) -> Self {
        let hexahedra =
            Hexahedra::Unstructured { vertices: vertices.len(), elements: elements.len() };
        let corners = elements.iter().flat_map(|corners| {
            let [a, b, c, d, e, f, g, h] = corners.map(f64::from);
            [[a, b, c], [d, e, f], [g, h, 0.0]]
        });
        let vectors = vertices.iter().copied().chain(corners);
        Self { hexahedra, geometry: Some(by_component(hexahedra.vectors(), vectors)) }
    }

    /// Returns the kind and counts of the elements.
    #[must_use]
    pub fn hexahedra(&self) -> Hexahedra {
        self.hexahedra
    }

    /// Returns true if the geometry is to follow.
    #[must_use]
    pub fn is_announced(&self) -> bool {
        self.geometry.is_none()
    }

    /// Returns the geometry in the layout of the field \[m\].
    ///
    /// # Panics
    /// Panics if the geometry is to follow.
    #[must_use]
    pub fn geometry(&self) -> &[f64] {
        self.geometry.as_deref().expect("the geometry of a volume precedes whatever is on it")
    }

    /// Returns this volume with a received geometry \[m\], without checks.
    pub(super) fn with_geometry(&self, values: &[f64]) -> Self {
        Self { hexahedra: self.hexahedra, geometry: Some(values.into()) }
    }

    /// Returns the nodes of the axes x, y and z \[m\] of a rectilinear volume.
    ///
    /// # Panics
    /// Panics if the geometry is to follow.
    #[must_use]
    pub fn axes(&self) -> Option<[&[f64]; 3]> {
        let Hexahedra::Rectilinear { ni, nj, nk } = self.hexahedra else { return None };
        let count = self.hexahedra.vectors();
        let axis = |(c, elements): (usize, usize)| &self.geometry()[c * count..][..=elements];
        Some([(0, ni), (1, nj), (2, nk)].map(axis))
    }

    /// Returns a vertex \[m\].
    ///
    /// # Panics
    /// Panics if the geometry is to follow.
    #[must_use]
    pub fn vertex(&self, vertex: usize) -> [f64; 3] {
        let (values, count) = (self.geometry(), self.hexahedra.vectors());
        match self.hexahedra {
            Hexahedra::Rectilinear { ni, nj, .. } => {
                let (row, i) = (vertex / (ni + 1), vertex % (ni + 1));
                let node = [i, row % (nj + 1), row / (nj + 1)];
                std::array::from_fn(|c| values[c * count + node[c]])
            }
            _ => std::array::from_fn(|c| values[c * count + vertex]),
        }
    }

    /// Returns the vertex numbers of an element.
    ///
    /// # Panics
    /// Panics for an unstructured volume whose geometry is to follow.
    #[must_use]
    pub fn corners(&self, element: usize) -> [usize; 8] {
        match self.hexahedra {
            Hexahedra::Rectilinear { ni, nj, .. } | Hexahedra::Structured { ni, nj, .. } => {
                let (row, i) = (element / ni, element % ni);
                let (k, j) = (row / nj, row % nj);
                let (in_j, in_k) = (ni + 1, (ni + 1) * (nj + 1));
                let first = k * in_k + j * in_j + i;
                let face = [first, first + 1, first + 1 + in_j, first + in_j];
                std::array::from_fn(|c| face[c % 4] + in_k * (c / 4))
            }
            Hexahedra::Unstructured { .. } => {
                std::array::from_fn(|c| self.number_of_vertex(element, c) as usize)
            }
        }
    }

    /// Returns a value of the vectors that hold the corners of an unstructured element; the ninth
    /// is 0.
    fn number_of_vertex(&self, element: usize, corner: usize) -> f64 {
        let (vectors, vertices) = (self.hexahedra.vectors(), self.hexahedra.vertices());
        let vector = vertices + VECTORS_OF_CORNERS * element + corner / COMPONENTS;
        self.geometry()[(corner % COMPONENTS) * vectors + vector]
    }

    /// Returns the centre of an element, the mean of its corners \[m\].
    ///
    /// # Panics
    /// Panics if the geometry is to follow.
    #[must_use]
    pub fn centre(&self, element: usize) -> [f64; 3] {
        let corners = self.corners(element).map(|vertex| self.vertex(vertex));
        std::array::from_fn(|c| corners.iter().map(|corner| corner[c]).sum::<f64>() / 8.0)
    }

    /// Returns the volume of an element \[m³\].
    ///
    /// # Panics
    /// Panics if the geometry is to follow.
    #[must_use]
    pub fn volume(&self, element: usize) -> f64 {
        hexahedron::volume(&self.corners(element).map(|vertex| self.vertex(vertex)))
    }

    /// Returns true if both volumes have the same connectivity.
    pub(super) fn has_elements_of(&self, other: &Self) -> bool {
        let unstructured = matches!(self.hexahedra, Hexahedra::Unstructured { .. });
        let known = !self.is_announced() && !other.is_announced();
        let of = |volume: &Self, element| volume.corners(element);
        self.hexahedra == other.hexahedra
            && !(unstructured
                && known
                && (0..self.hexahedra.elements()).any(|n| of(self, n) != of(other, n)))
    }

    /// Checks a volume received from another process.
    ///
    /// # Errors
    /// Fails without elements or with too many. A known geometry fails for a wrong length, a value
    /// that is not finite, an axis that does not increase, a corner that is not a vertex, and an
    /// element without a positive volume.
    pub(super) fn check(&self) -> Result<(), String> {
        self.hexahedra.check()?;
        let Some(values) = &self.geometry else { return Ok(()) };
        let expected = COMPONENTS * self.hexahedra.vectors();
        if values.len() != expected {
            return Err(format!("its geometry has {} values, not {expected}", values.len()));
        }
        if let Some(at) = values.iter().position(|value| !value.is_finite()) {
            return Err(format!("value {at} of its geometry is {}", values[at]));
        }
        if let Hexahedra::Unstructured { vertices, elements } = self.hexahedra {
            (0..elements).try_for_each(|element| self.check_corners(element, vertices))?;
        }
        if self.axes().is_some() {
            return self.check_axes();
        }
        (0..self.hexahedra.elements()).try_for_each(|element| match self.volume(element) {
            volume if volume > 0.0 => Ok(()),
            volume => Err(format!(
                "element {element} has the volume {volume}: its corners are not in VTK's order, or it \
                 is turned inside out"
            )),
        })
    }

    fn check_corners(&self, element: usize, vertices: usize) -> Result<(), String> {
        let is_vertex =
            |number: f64| number.fract() == 0.0 && (0.0..vertices as f64).contains(&number);
        for corner in 0..8 {
            let number = self.number_of_vertex(element, corner);
            if !is_vertex(number) {
                return Err(format!("element {element} names vertex {number} of {vertices}"));
            }
        }
        match self.number_of_vertex(element, 8) {
            0.0 => Ok(()),
            ninth => Err(format!("element {element} has {ninth} behind its eight corners, not 0")),
        }
    }

    fn check_axes(&self) -> Result<(), String> {
        let axes = self.axes().into_iter().flatten().zip(["x", "y", "z"]);
        for ((axis, name), values) in axes.zip(self.geometry().chunks(self.hexahedra.vectors())) {
            if let Some(node) = axis.windows(2).position(|pair| pair[1] <= pair[0]) {
                return Err(format!("its nodes along {name} do not rise after node {node}"));
            }
            if values[axis.len()..].iter().any(|value| *value != 0.0) {
                return Err(format!("its nodes along {name} are more than {}", axis.len()));
            }
        }
        Ok(())
    }
}

/// Arranges vectors component-major, as in the field.
fn by_component(count: usize, vectors: impl Iterator<Item = [f64; 3]>) -> Arc<[f64]> {
    let mut values = vec![0.0; COMPONENTS * count];
    for (n, vector) in vectors.enumerate() {
        for (c, value) in vector.into_iter().enumerate() {
            values[c * count + n] = value;
        }
    }
    values.into()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 2 × 1 × 1 boxes with the sides 1 and 3, 2, 0.5.
    fn boxes() -> Volume {
        Volume::rectilinear([&[0.0, 1.0, 4.0], &[-1.0, 1.0], &[0.0, 0.5]])
    }

    fn vertices(of: &Volume) -> Vec<[f64; 3]> {
        (0..of.hexahedra().vertices()).map(|vertex| of.vertex(vertex)).collect()
    }

    fn structured() -> Volume {
        Volume::structured([2, 1, 1], &vertices(&boxes()))
    }

    fn unstructured() -> Volume {
        let elements = [0, 1].map(|n| boxes().corners(n).map(|vertex| vertex as u32));
        Volume::unstructured(&vertices(&boxes()), &elements)
    }

    #[test]
    fn three_kinds_of_the_same_elements() {
        for volume in [boxes(), structured(), unstructured()] {
            assert_eq!(volume.check(), Ok(()), "{volume:?}");
            assert_eq!((volume.hexahedra().elements(), volume.hexahedra().vertices()), (2, 12));
            assert_eq!([0, 1].map(|n| volume.volume(n)), [1.0, 3.0]);
            assert_eq!([0, 1].map(|n| volume.centre(n)), [[0.5, 0.0, 0.25], [2.5, 0.0, 0.25]]);
            assert_eq!(volume.corners(1), [1, 2, 5, 4, 7, 8, 11, 10]);
        }
    }

    /// Pins the layout, because other languages write and read it.
    #[test]
    fn golden_layout_of_the_geometry() {
        assert_eq!(boxes().geometry(), [0.0, 1.0, 4.0, -1.0, 1.0, 0.0, 0.0, 0.5, 0.0]);
        let volume = structured();
        assert_eq!(volume.geometry()[..6], [0.0, 1.0, 4.0, 0.0, 1.0, 4.0], "x");
        assert_eq!(volume.geometry()[12..18], [-1.0, -1.0, -1.0, 1.0, 1.0, 1.0], "y");
        let volume = unstructured();
        assert_eq!(volume.geometry().len(), 3 * (12 + 6));
        assert_eq!(volume.geometry()[12..18], [0.0, 3.0, 10.0, 1.0, 4.0, 11.0]);
        assert_eq!(volume.geometry()[30..36], [1.0, 6.0, 9.0, 2.0, 7.0, 10.0]);
        assert_eq!(volume.geometry()[48..54], [4.0, 7.0, 0.0, 5.0, 8.0, 0.0]);
    }

    #[test]
    fn json_has_the_counts_alone() {
        let text = serde_json::to_string(&unstructured()).unwrap();
        assert_eq!(text, r#"{"hexahedra":"unstructured","vertices":12,"elements":2}"#);
        let announced: Volume = serde_json::from_str(&text).unwrap();
        assert!(announced.is_announced() && announced != unstructured());
        assert_eq!(announced.with_geometry(unstructured().geometry()), unstructured());
        let text = serde_json::to_string(&boxes()).unwrap();
        assert_eq!(text, r#"{"hexahedra":"rectilinear","ni":2,"nj":1,"nk":1}"#);
    }

    #[test]
    fn geometries_from_outside_are_checked() {
        let with = |volume: &Volume, at: usize, value: f64| {
            let mut values = volume.geometry().to_vec();
            values[at] = value;
            volume.with_geometry(&values).check().unwrap_err()
        };
        assert!(with(&boxes(), 2, 1.0).contains("along x do not rise after node 1"));
        assert!(with(&boxes(), 5, 1.0).contains("along y are more than 2"));
        assert!(with(&boxes(), 8, f64::NAN).contains("value 8 of its geometry is NaN"));
        assert!(with(&structured(), 13, 19.0).contains("element 0 has the volume"));
        for (at, value) in [(12, 12.0), (12, -1.0), (12, 0.5)] {
            assert!(with(&unstructured(), at, value).contains("element 0 names vertex"), "{value}");
        }
        assert!(with(&unstructured(), 50, 1.0).contains("behind its eight corners"));
        let short = structured().with_geometry(&structured().geometry()[1..]).check();
        assert!(short.unwrap_err().contains("35 values, not 36"));
        assert!(structured().with_geometry(boxes().geometry()).check().is_err());
    }

    #[test]
    fn counts_are_limited_before_anything_is_allocated() {
        let most = usize::MAX;
        for hexahedra in [
            Hexahedra::Structured { ni: 0, nj: 1, nk: 1 },
            Hexahedra::Rectilinear { ni: most, nj: most, nk: 1 },
            Hexahedra::Structured { ni: 1 << 30, nj: 1 << 30, nk: 1 },
            Hexahedra::Unstructured { vertices: 7, elements: 1 },
            Hexahedra::Unstructured { vertices: 8, elements: most },
        ] {
            let fault = Volume::from(hexahedra).check().unwrap_err();
            assert!(fault.contains("elements and"), "{hexahedra:?}: {fault}");
        }
    }

    #[test]
    fn elements_keep_their_vertices() {
        let volume = unstructured();
        let announced = Volume::from(volume.hexahedra());
        assert!(announced.has_elements_of(&volume) && volume.has_elements_of(&volume));
        let mut corners = [boxes().corners(0), boxes().corners(1)];
        corners.reverse();
        let other = corners.map(|corners| corners.map(|vertex| vertex as u32));
        assert!(!volume.has_elements_of(&Volume::unstructured(&vertices(&boxes()), &other)));
        assert!(!boxes().has_elements_of(&structured()));
    }
}

//! Settings of a coupling: choices, numbers, and tolerances for single fields or all fields.
//!
//! Each choice is declared once, here: its words in a case by [`contract::words!`], its defaults by
//! `Default`. Settings are deserialised from checked values of a case, in SI units, with defaults
//! filled in.

use contract::field::{FieldKind, Mapping};
use contract::grid::{Grid, Shape};
use contract::words;
use serde::{Deserialize, Deserializer};
use std::collections::BTreeMap;

words! {
    /// Order and iteration of the participants.
    #[derive(Default)]
    pub enum Scheme {
        /// Implicit if an effect closes a loop, otherwise explicit.
        #[default]
        Auto = "auto",
        /// One after another, one pass; values that close a loop are a window late.
        SerialExplicit = "serial-explicit",
        /// One after another, repeated until the coupling data have converged.
        SerialImplicit = "serial-implicit",
        /// All at once, one pass; all values are a window late.
        ParallelExplicit = "parallel-explicit",
        /// All at once, repeated until all exchanged values have converged.
        ParallelImplicit = "parallel-implicit",
    }
}

impl Scheme {
    /// Returns whether the scheme repeats a window until it has converged.
    #[must_use]
    pub fn is_implicit(self) -> bool {
        matches!(self, Self::SerialImplicit | Self::ParallelImplicit)
    }

    /// Returns whether all participants solve at the same time.
    #[must_use]
    pub fn is_parallel(self) -> bool {
        matches!(self, Self::ParallelExplicit | Self::ParallelImplicit)
    }
}

words! {
    /// Choice of the next iterate.
    #[derive(Default)]
    pub enum Acceleration {
        /// [`Acceleration::IqnIls`].
        #[default]
        Auto = "auto",
        /// The next iterate is the vector that the participants returned.
        None = "none",
        /// Adds a constant fraction of the residual.
        Constant = "constant",
        /// Adds a fraction of the residual that is estimated from two iterations.
        Aitken = "aitken",
        /// Anderson mixing over the iterations of the window.
        Anderson = "anderson",
        /// Interface quasi-Newton, inverse Jacobian by least squares.
        IqnIls = "iqn-ils",
        /// Interface quasi-Newton, inverse Jacobian by multiple vectors, updated window by window.
        IqnImvj = "iqn-imvj",
    }
}

impl Acceleration {
    /// Returns the acceleration, with `Auto` replaced by its meaning.
    #[must_use]
    pub fn resolved(self) -> Self {
        if self == Self::Auto { Self::IqnIls } else { self }
    }

    fn read<'de, D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        Self::deserialize(from).map(Self::resolved)
    }
}

words! {
    /// Weights of several fields against each other in an accelerator.
    #[derive(Default)]
    pub enum Preconditioner {
        /// By the norm of each field.
        Value = "value",
        /// By the norm of each field's residual.
        Residual = "residual",
        /// By the sum of each field's shares of the residuals of the window so far.
        #[default]
        ResidualSum = "residual-sum",
    }
}

words! {
    /// The first iterate of a window.
    #[derive(Default)]
    pub enum Predictor {
        /// The values at the end of the last window.
        #[default]
        Last = "last",
        /// Extrapolated through the ends of the last two windows.
        Linear = "linear",
    }
}

/// Bounds on the residual of a field; all that are set must hold.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
pub struct Tolerances {
    /// Two-norm of the residual, in the field's unit.
    pub absolute: Option<f64>,
    /// Two-norm of the residual over that of the returned values \[-\].
    pub relative: Option<f64>,
    /// Two-norm of the residual over that of the window's first residual \[-\].
    pub residual_relative: Option<f64>,
}

impl Tolerances {
    /// Tolerances of a case that sets none.
    pub const FALLBACK: Self =
        Self { absolute: None, relative: Some(1e-6), residual_relative: None };

    /// Reads the bounds; [`Tolerances::FALLBACK`] if none is set.
    fn read<'de, D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let given = Self::deserialize(from)?;
        Ok(if given == Self::default() { Self::FALLBACK } else { given })
    }
}

/// Iteration of a window by an implicit scheme.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(default)]
pub struct Implicit {
    /// Choice of the next iterate; never `Auto`.
    #[serde(deserialize_with = "Acceleration::read")]
    pub acceleration: Acceleration,
    /// Relaxation ω \[-\]: the constant, the factor of the first iteration, or Anderson's mixing.
    pub relaxation: f64,
    /// Smallest number of iterations of a window.
    pub min_iterations: u32,
    /// Largest number of iterations of a window.
    pub max_iterations: u32,
    /// Tolerances of fields without their own.
    #[serde(flatten, deserialize_with = "Tolerances::read")]
    pub tolerances: Tolerances,
    /// Tolerances of single fields, by name.
    pub fields: BTreeMap<String, Tolerances>,
    /// Number of earlier windows whose secant columns are reused.
    pub reuse_windows: u64,
    /// Largest number of secant columns.
    pub max_columns: usize,
    /// Smallest part of a secant column that is linearly independent of newer ones \[-\]; a column
    /// with less is dropped.
    pub filter: f64,
    /// Weights of several fields.
    pub preconditioner: Preconditioner,
    /// The first iterate of a window.
    pub predictor: Predictor,
    /// Whether a window that does not converge ends the run.
    pub strict: bool,
    /// Largest number of threads for computing the next iterate; the result does not depend on it.
    /// Set by the run, not by a key of `coupling`.
    #[serde(skip)]
    pub threads: usize,
}

impl Default for Implicit {
    /// Settings of a case without a `coupling` table.
    fn default() -> Self {
        Self {
            acceleration: Acceleration::default().resolved(),
            relaxation: 0.5,
            min_iterations: 1,
            max_iterations: 100,
            tolerances: Tolerances::FALLBACK,
            fields: BTreeMap::new(),
            reuse_windows: 10,
            max_columns: 100,
            filter: 1e-6,
            preconditioner: Preconditioner::default(),
            predictor: Predictor::default(),
            strict: true,
            threads: 1,
        }
    }
}

impl Implicit {
    /// Returns the tolerances of a field.
    #[must_use]
    pub fn tolerances_of(&self, field: &str) -> Tolerances {
        self.fields.get(field).copied().unwrap_or(self.tolerances)
    }
}

words! {
    /// Radial basis function φ(r/a) of the distance r between two points, with a length a.
    ///
    /// `coupling::map` gives the formulas. The numbers 0 to 8 say how often a function is
    /// differentiable.
    pub enum Basis {
        /// Wendland's function, zero beyond a.
        WendlandC0 = "wendland-c0",
        /// Wendland's function, zero beyond a.
        WendlandC2 = "wendland-c2",
        /// Wendland's function, zero beyond a.
        WendlandC4 = "wendland-c4",
        /// Wendland's function, zero beyond a.
        WendlandC6 = "wendland-c6",
        /// Wendland's function, zero beyond a.
        WendlandC8 = "wendland-c8",
        /// Buhmann's function with a logarithm, zero beyond a.
        CompactThinPlateSplinesC2 = "compact-thin-plate-splines-c2",
        /// Gauss's function, 1e-9 at a.
        Gaussian = "gaussian",
        /// √(a² + r²).
        Multiquadrics = "multiquadrics",
        /// 1/√(a² + r²).
        InverseMultiquadrics = "inverse-multiquadrics",
        /// r² log r, without a length.
        ThinPlateSplines = "thin-plate-splines",
        /// r, without a length.
        VolumeSplines = "volume-splines",
    }
}

impl Basis {
    /// Returns whether the function has a length.
    #[must_use]
    pub fn has_radius(self) -> bool {
        !matches!(self, Self::ThinPlateSplines | Self::VolumeSplines)
    }

    /// Returns whether the function falls to zero with the distance.
    #[must_use]
    pub fn decays(self) -> bool {
        self.has_radius() && self != Self::Multiquadrics
    }
}

/// A radial basis function with its length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kernel {
    /// The function.
    pub basis: Basis,
    /// Length a \[m\]; `None` for functions without one.
    pub radius: Option<f64>,
}

impl std::fmt::Display for Kernel {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let word = self.basis.word();
        let Some(radius) = self.radius else { return f.write_str(word) };
        let within = match self.basis {
            Basis::Multiquadrics | Basis::InverseMultiquadrics => "of",
            _ => "within",
        };
        write!(f, "{word} {within} {}", shown_length(radius))
    }
}

/// Formats a length to six significant digits without trailing zeros, in mm below a metre.
pub(crate) fn shown_length(length: f64) -> String {
    let (factor, unit) = if length < 1.0 { (1e3, "mm") } else { (1.0, "m") };
    let rounded = format!("{:.5e}", factor * length).parse::<f64>();
    format!("{} {unit}", rounded.unwrap_or(f64::NAN))
}

/// Method that computes the value of a target element from the values of source elements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// The value of the nearest element centre or vertex; the mean if several are equally near.
    NearestNeighbour,
    /// Bilinear between the element centres around the target's foot on the surface, or linear on
    /// the triangles and edges of vertices; constant beyond the outermost ones, which avoids
    /// overshoot. On vertices without connectivity the nearest neighbour.
    NearestProjection,
    /// Wendland's C2 function with a linear polynomial on a few rings of elements or vertices.
    RadialBasis,
    /// A chosen radial basis function with a linear polynomial, on all values of the source or on
    /// overlapping clusters of them.
    Kernel(Kernel),
    /// Mean over the intersections of the elements, exact in a common plane; not for vertices.
    Intersection,
}

impl Method {
    /// The word that selects the method suited to the field.
    pub const AUTO: &str = "auto";

    /// The methods that a word alone selects: all but those with a chosen radial basis function.
    pub const ALL: [Self; 4] =
        [Self::NearestNeighbour, Self::NearestProjection, Self::RadialBasis, Self::Intersection];

    /// The words of [`Method::ALL`], as written in a case.
    pub const WORDS: &[&str] =
        &["nearest-neighbour", "nearest-projection", "radial-basis", "intersection"];

    /// Returns the word in the case file.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::NearestNeighbour => Self::WORDS[0],
            Self::NearestProjection => Self::WORDS[1],
            Self::RadialBasis | Self::Kernel(_) => Self::WORDS[2],
            Self::Intersection => Self::WORDS[3],
        }
    }

    /// Returns the method that a word alone selects.
    #[must_use]
    pub fn from_word(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|method| method.word() == word)
    }

    /// Returns the default method for a kind of field between two grids. Between elements it is of
    /// second order without overshoot for point values, and has exact areas for densities. Vertices
    /// have no areas to intersect; from vertices without connectivity point values are interpolated
    /// by radial basis functions.
    #[must_use]
    pub fn suited_to(preserves: Mapping, source: &Grid, target: &Grid) -> Self {
        let vertices = |grid: &Grid| matches!(grid.shape, Shape::Vertices(_));
        let bare = matches!(&source.shape, Shape::Vertices(v) if !v.is_connected());
        match preserves {
            Mapping::Consistent if bare => Self::RadialBasis,
            Mapping::Conservative if !vertices(source) && !vertices(target) => Self::Intersection,
            _ => Self::NearestProjection,
        }
    }

    /// Reads the method of a table; `None` for [`Method::AUTO`].
    fn read<'de, D: Deserializer<'de>>(from: D) -> Result<Option<Self>, D::Error> {
        MethodKeys::deserialize(from).map(MethodKeys::method)
    }
}

impl std::fmt::Display for Method {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.word())?;
        match self {
            Self::Kernel(kernel) => write!(f, ", {kernel}"),
            _ => Ok(()),
        }
    }
}

/// Keys that choose a method.
#[derive(Deserialize)]
struct MethodKeys {
    method: Option<String>,
    basis: Option<Basis>,
    radius: Option<f64>,
}

impl MethodKeys {
    fn method(self) -> Option<Method> {
        let method = self.method.as_deref().and_then(Method::from_word);
        match (method, self.basis) {
            (Some(Method::RadialBasis), Some(basis)) => {
                Some(Method::Kernel(Kernel { basis, radius: self.radius }))
            }
            (method, _) => method,
        }
    }
}

/// Mapping of one field to a consumer whose grid does not match.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub struct FieldMapping {
    /// The method; `None` for the default of the field.
    #[serde(flatten, deserialize_with = "Method::read")]
    pub method: Option<Method>,
}

/// Mapping of fields to consumers whose grids do not match.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default)]
pub struct Mappings {
    /// The method for every field; `None` for the default of each field.
    #[serde(flatten, deserialize_with = "Method::read")]
    pub method: Option<Method>,
    /// Single fields, by name.
    pub fields: BTreeMap<String, FieldMapping>,
}

impl Mappings {
    /// Returns the method chosen for a field; `None` for the one suited to field and grids.
    #[must_use]
    pub fn method_of(&self, field: &FieldKind) -> Option<Method> {
        self.fields.get(&field.name).map_or(self.method, |own| own.method)
    }
}

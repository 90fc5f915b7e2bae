//! The choices of a coupling: words, numbers, and tolerances for one field or for all.

use std::collections::BTreeMap;

/// A set of words in the case file, each with its meaning.
macro_rules! words {
    ($(#[$doc:meta])* $name:ident { $($(#[$of:meta])* $variant:ident = $word:literal,)* }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum $name { $($(#[$of])* $variant,)* }

        impl $name {
            /// The words, as a case has them.
            pub const WORDS: &[&str] = &[$($word),*];

            /// The word in the case file.
            #[must_use]
            pub fn word(self) -> &'static str {
                match self { $(Self::$variant => $word,)* }
            }

            /// The meaning of a word.
            #[must_use]
            pub fn from_word(word: &str) -> Option<Self> {
                match word { $($word => Some(Self::$variant),)* _ => None }
            }
        }
    };
}

words! {
    /// Order and iteration of the participants.
    Scheme {
        /// Explicit where no effect closes a loop, implicit where one does.
        Auto = "auto",
        /// One after the other, one pass; what closes a loop is a window late.
        SerialExplicit = "serial-explicit",
        /// One after the other, repeated until the coupling data no longer change.
        SerialImplicit = "serial-implicit",
        /// All at once, one pass; everything is a window late.
        ParallelExplicit = "parallel-explicit",
        /// All at once, repeated until nothing that is exchanged changes any more.
        ParallelImplicit = "parallel-implicit",
    }
}

impl Scheme {
    /// It repeats a window until it has converged.
    #[must_use]
    pub fn is_implicit(self) -> bool {
        matches!(self, Self::SerialImplicit | Self::ParallelImplicit)
    }

    /// All participants solve at the same time.
    #[must_use]
    pub fn is_parallel(self) -> bool {
        matches!(self, Self::ParallelExplicit | Self::ParallelImplicit)
    }
}

words! {
    /// How the next iterate is chosen.
    Acceleration {
        /// [`Acceleration::IqnIls`].
        Auto = "auto",
        /// What came out goes in.
        None = "none",
        /// A constant part of the residual is added.
        Constant = "constant",
        /// A part of the residual is added that is estimated from two iterations.
        Aitken = "aitken",
        /// Anderson mixing over the iterations of the window.
        Anderson = "anderson",
        /// Interface quasi-Newton, inverse Jacobian by least squares.
        IqnIls = "iqn-ils",
        /// Interface quasi-Newton, inverse Jacobian by multiple vectors, window upon window.
        IqnImvj = "iqn-imvj",
    }
}

words! {
    /// How several fields are weighed against each other in an accelerator.
    Preconditioner {
        /// By the norm of each field.
        Value = "value",
        /// By the norm of each field's residual.
        Residual = "residual",
        /// By the sum of each field's shares in the residuals of the window so far.
        ResidualSum = "residual-sum",
    }
}

words! {
    /// The first iterate of a window.
    Predictor {
        /// What the last window ended with.
        Last = "last",
        /// Extrapolated through the ends of the last two windows.
        Linear = "linear",
    }
}

/// What the residual of a field has to meet; every measure given has to hold.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tolerances {
    /// Two-norm of the residual, in the field's unit.
    pub absolute: Option<f64>,
    /// Two-norm of the residual over that of the values returned \[-\].
    pub relative: Option<f64>,
    /// Two-norm of the residual over that of the window's first residual \[-\].
    pub residual_relative: Option<f64>,
}

/// How a window is iterated by an implicit scheme.
#[derive(Clone, Debug, PartialEq)]
pub struct Implicit {
    /// How the next iterate is chosen; never `Auto`.
    pub acceleration: Acceleration,
    /// Relaxation ω \[-\]: constant, or of the first iteration, or Anderson's mixing.
    pub relaxation: f64,
    /// Fewest iterations of a window.
    pub min_iterations: u32,
    /// Most iterations of a window.
    pub max_iterations: u32,
    /// What every field has to meet that has no tolerances of its own.
    pub tolerances: Tolerances,
    /// What single fields have to meet, by name.
    pub fields: BTreeMap<String, Tolerances>,
    /// Earlier windows whose secant columns are reused.
    pub reuse_windows: u64,
    /// Most iterations that the accelerator remembers.
    pub max_columns: usize,
    /// Smallest part of a secant column that is linearly independent of newer ones \[-\]; a column
    /// with less is dropped.
    pub filter: f64,
    /// Weights of several fields.
    pub preconditioner: Preconditioner,
    /// The first iterate of a window.
    pub predictor: Predictor,
    /// A window that does not converge ends the run.
    pub strict: bool,
    /// Most threads on which the next iterate is computed; it does not depend on their number.
    pub threads: usize,
}

impl Default for Implicit {
    /// What a case has that says nothing of it.
    fn default() -> Self {
        Self {
            acceleration: Acceleration::IqnIls,
            relaxation: 0.5,
            min_iterations: 1,
            max_iterations: 100,
            tolerances: Tolerances { relative: Some(1e-6), ..Tolerances::default() },
            fields: BTreeMap::new(),
            reuse_windows: 10,
            max_columns: 100,
            filter: 1e-6,
            preconditioner: Preconditioner::ResidualSum,
            predictor: Predictor::Last,
            strict: true,
            threads: 1,
        }
    }
}

impl Implicit {
    /// The tolerances of a field.
    #[must_use]
    pub fn tolerances_of(&self, field: &str) -> Tolerances {
        self.fields.get(field).copied().unwrap_or(self.tolerances)
    }
}

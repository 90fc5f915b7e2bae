//! Friction law of a contact, to which all active effects contribute.
//!
//! |p_t| ≤ g = min(f₀ m₁ m₂ … p, τ₁, τ₂, …)
//!
//! with the friction coefficient f₀ of the case, the pressure p, the factors m on the coefficient
//! ([`FrictionFactor`]: bands, speed, temperature) and the bounds τ of the traction
//! ([`TractionBound`]: a layer that yields, a film that shears). Factors multiply. Bounds are
//! applied last: no factor changes them, and the smallest one holds. Each contribution is computed
//! from the state of the contact alone, not from other contributions. The plastic layer, whose
//! yield stress depends on its plastic shift, is a further bound of g in the tangential contact
//! ([`half_space::yielding`]).
//!
//! Source: Coulomb's law with local coefficients; Vollebregt, Wear 314 (2014) 87–95, for
//! min(f p, τ) where the third body yields.

use crate::terms::bands::{At, Over};
use elastic::slip::RigidSlip;
use half_space::aligned::AlignedGrid;
use half_space::friction::ElementFriction;
use half_space::slip_velocity::SlipStart;
use proto::grid::Structured;
use proto::model::{Inputs, StepError};
use std::fmt::Debug;

/// State of a contact on which friction laws may depend.
#[derive(Clone, Copy)]
pub(crate) struct FrictionState<'a> {
    /// Input fields; `None` before a run, when the bodies have their initial temperature.
    pub(crate) inputs: Option<&'a dyn Inputs>,
    /// Rolling speed V [m/s].
    pub(crate) speed: f64,
    /// Slip velocity of an element for rigid bodies [m/s].
    pub(crate) rigid_slip: &'a dyn Fn(usize) -> f64,
    /// Grid of the elements, whose rows may be displaced.
    pub(crate) rows: &'a AlignedGrid,
    /// Coordinate of an element, or of the patch that it belongs to; `None` where there is no
    /// contact.
    pub(crate) coordinate: &'a dyn Fn(Over, At, usize) -> Option<f64>,
    /// Pressure of the elements [Pa].
    pub(crate) pressure: &'a [f64],
    /// Slip velocity of every element including its elastic part [m/s], if a law follows it.
    pub(crate) velocity: Option<&'a [f64]>,
}

/// Returns the lateral coordinates of the elements in the case [m], for a grid with its origin at
/// `origin_y`.
pub(crate) fn lateral(
    grid: &Structured,
    origin_y: f64,
) -> impl Fn(Over, At, usize) -> Option<f64> + '_ {
    move |_, _, index| Some(origin_y + grid.y(index / grid.ni))
}

/// Factor on the friction coefficient of the case.
pub(crate) trait FrictionFactor: Debug + Send + Sync {
    /// Writes the factors of the elements, which are initialised to one. A law that yields
    /// coefficients divides them by the coefficient of the case.
    ///
    /// # Errors
    /// An input that is missing or unusable; a state for which the law has no value.
    fn write(
        &self,
        state: &FrictionState<'_>,
        coefficient: f64,
        factors: &mut [f64],
    ) -> Result<(), StepError>;

    /// Returns true if friction depends on the slip of rigid bodies. A prescribed force and its
    /// creepage are then solved together.
    fn follows_slip(&self) -> bool {
        false
    }

    /// Returns the initial slip if the factor depends on the slip velocity of each element.
    /// Friction and slip are then solved together.
    fn follows_elements(&self) -> Option<SlipStart> {
        None
    }

    /// Returns true if the factor depends on input fields.
    fn follows_inputs(&self) -> bool {
        false
    }

    /// Key of a memory of the elements' slip that acts along the rows of a steady contact, not from
    /// step to step.
    fn memory_of_rows(&self) -> Option<&'static str> {
        None
    }

    /// Explanation of a friction force below the prescribed force.
    fn shortfall(&self) -> &'static str;
}

/// Bound of the traction, independent of the pressure and of the friction coefficient.
pub(crate) trait TractionBound: Debug + Send + Sync {
    /// Bound at an element [Pa].
    fn at(&self, state: &FrictionState<'_>, index: usize) -> f64;

    /// Returns true if friction depends on the slip of rigid bodies. A prescribed force and its
    /// creepage are then solved together.
    fn follows_slip(&self) -> bool {
        false
    }

    /// Explanation of a friction force below the prescribed force.
    fn shortfall(&self) -> &'static str;
}

/// Contributions of all active effects.
#[derive(Debug, Default)]
pub(crate) struct FrictionLaw {
    pub(crate) factors: Vec<Box<dyn FrictionFactor>>,
    pub(crate) bounds: Vec<Box<dyn TractionBound>>,
}

impl FrictionLaw {
    /// Creates a law with one factor.
    pub(crate) fn of_factor(factor: impl FrictionFactor + 'static) -> Self {
        Self { factors: vec![Box::new(factor)], ..Self::default() }
    }

    /// Creates a law with one bound.
    pub(crate) fn of_bound(bound: impl TractionBound + 'static) -> Self {
        Self { bounds: vec![Box::new(bound)], ..Self::default() }
    }

    /// Adds the contributions of another effect.
    pub(crate) fn join(&mut self, more: Self) {
        self.factors.extend(more.factors);
        self.bounds.extend(more.bounds);
    }

    /// Returns true if only the friction coefficient of the case applies.
    pub(crate) fn is_constant(&self) -> bool {
        self.factors.is_empty() && self.bounds.is_empty()
    }

    /// Evaluates the law for every element of a contact in the plane whose bodies slip as rigid
    /// ones.
    ///
    /// # Errors
    /// Same errors as [`FrictionFactor::write`].
    pub(crate) fn under_rigid_slip(
        &self,
        coefficient: f64,
        slip: &RigidSlip,
        (grid, pressure): (&Structured, &[f64]),
        inputs: &dyn Inputs,
    ) -> Result<ElementFriction, StepError> {
        let state = FrictionState {
            inputs: Some(inputs),
            speed: slip.speed,
            rigid_slip: &|index| slip.at(grid, index),
            rows: &AlignedGrid::regular(*grid),
            coordinate: &lateral(grid, 0.0),
            pressure,
            velocity: None,
        };
        self.evaluate(coefficient, &state)
    }

    /// Evaluates the law for every element, from the friction coefficient of the case.
    ///
    /// # Errors
    /// Same errors as [`FrictionFactor::write`].
    pub(crate) fn evaluate(
        &self,
        coefficient: f64,
        state: &FrictionState<'_>,
    ) -> Result<ElementFriction, StepError> {
        let count = state.rows.grid().points();
        let mut coefficients = vec![coefficient; count];
        for factor in &self.factors {
            let mut factors = vec![1.0; count];
            factor.write(state, coefficient, &mut factors)?;
            coefficients.iter_mut().zip(factors).for_each(|(f, factor)| *f *= factor);
        }
        let mut largest = vec![f64::INFINITY; count];
        for bound in &self.bounds {
            for (index, largest) in largest.iter_mut().enumerate() {
                *largest = largest.min(bound.at(state, index));
            }
        }
        Ok(ElementFriction::new(coefficients, largest))
    }

    /// Returns true if friction depends on the slip of rigid bodies.
    pub(crate) fn follows_slip(&self) -> bool {
        self.factors.iter().any(|factor| factor.follows_slip())
            || self.bounds.iter().any(|bound| bound.follows_slip())
    }

    /// Returns the initial slip if friction depends on the slip velocity of each element.
    pub(crate) fn follows_elements(&self) -> Option<SlipStart> {
        self.factors.iter().find_map(|factor| factor.follows_elements())
    }

    /// Returns true if friction depends on input fields.
    pub(crate) fn follows_inputs(&self) -> bool {
        self.factors.iter().any(|factor| factor.follows_inputs())
    }

    /// Key of a memory along the rows of a steady contact.
    pub(crate) fn memory_of_rows(&self) -> Option<&'static str> {
        self.factors.iter().find_map(|factor| factor.memory_of_rows())
    }

    /// Explanation of a friction force below the prescribed force.
    pub(crate) fn shortfalls(&self) -> Vec<&'static str> {
        let factors = self.factors.iter().map(|factor| factor.shortfall());
        factors.chain(self.bounds.iter().map(|bound| bound.shortfall())).collect()
    }
}

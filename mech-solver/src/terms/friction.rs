//! The law of friction of a contact, to which all active effects contribute.
//!
//! |p_t| ≤ g = min(f₀ m₁ m₂ … p, τ₁, τ₂, …)
//!
//! with the friction coefficient f₀ of the case, the pressure p, factors m on the coefficient ([`FrictionFactor`]: bands, speed, temperature) and
//! bounds τ of the traction ([`TractionBound`]: a layer that yields, a film that shears). Factors multiply. Bounds come last: no factor changes
//! them, and the smallest holds. A contribution is computed from the state of the contact alone, not from other contributions. The plastic
//! layer, whose yield stress depends on what it has flowed, is a further bound of g in the tangential contact ([`half_space::yielding`]).
//!
//! Source: Coulomb's law with local coefficients; Vollebregt, Wear 314 (2014) 87–95, for min(f p, τ) where the third body yields.

use crate::terms::bands::{At, Over};
use half_space::friction::ElementFriction;
use half_space::slip_iteration::SlipStart;
use proto::grid::Structured;
use proto::model::{Inputs, StepError};
use std::fmt::Debug;

/// The state of a contact that laws of friction may depend on.
#[derive(Clone, Copy)]
pub(crate) struct FrictionState<'a> {
    /// Fields that come in; `None` before a run, when bodies have their initial temperature.
    pub(crate) inputs: Option<&'a dyn Inputs>,
    /// Rolling speed V [m/s].
    pub(crate) speed: f64,
    /// Slip velocity that an element would have if the bodies were rigid [m/s].
    pub(crate) rigid_slip: &'a dyn Fn(usize) -> f64,
    /// The elements.
    pub(crate) grid: &'a Structured,
    /// Coordinate of an element, or of the patch that it belongs to; `None` where there is no contact.
    pub(crate) coordinate: &'a dyn Fn(Over, At, usize) -> Option<f64>,
    /// Pressure of the elements [Pa].
    pub(crate) pressure: &'a [f64],
    /// Slip velocity of every element with its elastic part, where a law follows that [m/s].
    pub(crate) velocity: Option<&'a [f64]>,
}

/// Lateral coordinate of the elements of a grid whose origin lies at this one in the case [m].
pub(crate) fn lateral(
    grid: &Structured,
    origin_y: f64,
) -> impl Fn(Over, At, usize) -> Option<f64> + '_ {
    move |_, _, index| Some(origin_y + grid.y(index / grid.ni))
}

/// A factor on the friction coefficient of the case.
pub(crate) trait FrictionFactor: Debug + Send + Sync {
    /// Writes the factors of the elements, which enter as ones. A law that has coefficients divides them by that of the case.
    ///
    /// # Errors
    /// An input is missing or unusable, or the law has no value for it.
    fn write(
        &self,
        state: &FrictionState<'_>,
        coefficient: f64,
        factors: &mut [f64],
    ) -> Result<(), StepError>;

    /// It depends on the slip, so that a prescribed force and its creepage are found together.
    fn follows_slip(&self) -> bool {
        false
    }

    /// It depends on the slip of every element itself, looked for from here.
    fn follows_elements(&self) -> Option<SlipStart> {
        None
    }

    /// It depends on fields that come in.
    fn follows_inputs(&self) -> bool {
        false
    }

    /// Key by which the slip of elements is remembered along the rows of a steady contact, and not from step to step.
    fn memory_of_rows(&self) -> Option<&'static str> {
        None
    }

    /// Why friction may carry less than a prescribed force.
    fn shortfall(&self) -> &'static str;
}

/// A bound of the traction, whatever the pressure and the friction coefficient.
pub(crate) trait TractionBound: Debug + Send + Sync {
    /// Bound at an element [Pa].
    fn at(&self, state: &FrictionState<'_>, index: usize) -> f64;

    /// It depends on the slip, so that a prescribed force and its creepage are found together.
    fn follows_slip(&self) -> bool {
        false
    }

    /// Why friction may carry less than a prescribed force.
    fn shortfall(&self) -> &'static str;
}

/// The contributions of all active effects.
#[derive(Debug, Default)]
pub(crate) struct FrictionLaw {
    pub(crate) factors: Vec<Box<dyn FrictionFactor>>,
    pub(crate) bounds: Vec<Box<dyn TractionBound>>,
}

impl FrictionLaw {
    /// A law of one factor.
    pub(crate) fn of_factor(factor: impl FrictionFactor + 'static) -> Self {
        Self { factors: vec![Box::new(factor)], ..Self::default() }
    }

    /// A law of one bound.
    pub(crate) fn of_bound(bound: impl TractionBound + 'static) -> Self {
        Self { bounds: vec![Box::new(bound)], ..Self::default() }
    }

    /// Adds the contributions of another effect.
    pub(crate) fn join(&mut self, more: Self) {
        self.factors.extend(more.factors);
        self.bounds.extend(more.bounds);
    }

    /// Only the friction coefficient of the case holds.
    pub(crate) fn is_constant(&self) -> bool {
        self.factors.is_empty() && self.bounds.is_empty()
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
        let count = state.grid.points();
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

    /// Friction depends on the slip that it allows.
    pub(crate) fn follows_slip(&self) -> bool {
        self.factors.iter().any(|factor| factor.follows_slip())
            || self.bounds.iter().any(|bound| bound.follows_slip())
    }

    /// Friction depends on the slip of every element itself, looked for from here.
    pub(crate) fn follows_elements(&self) -> Option<SlipStart> {
        self.factors.iter().find_map(|factor| factor.follows_elements())
    }

    /// Friction depends on fields that come in.
    pub(crate) fn follows_inputs(&self) -> bool {
        self.factors.iter().any(|factor| factor.follows_inputs())
    }

    /// Key of a memory along the rows of a steady contact.
    pub(crate) fn memory_of_rows(&self) -> Option<&'static str> {
        self.factors.iter().find_map(|factor| factor.memory_of_rows())
    }

    /// Why friction may carry less than a prescribed force.
    pub(crate) fn shortfalls(&self) -> Vec<&'static str> {
        let factors = self.factors.iter().map(|factor| factor.shortfall());
        factors.chain(self.bounds.iter().map(|bound| bound.shortfall())).collect()
    }
}

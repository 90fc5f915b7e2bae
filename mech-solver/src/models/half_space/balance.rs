//! Power supplied to a contact and dissipated by friction; [`super::power`] computes both.

use crate::models::power_balance::{LARGEST_POWER_IMBALANCE, power_imbalance};
use proto::grid::Structured;
use proto::readable::{number, quantity};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

/// Error of an instant whose power balance does not hold.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "the power balance of the contact does not hold: friction dissipates {friction} where \
     {given} are supplied, which differs by {imbalance} of the exchanged power; the \
     contact is not solved: change mech.resolution", friction = quantity(*.friction, "W", 7), given = quantity(*.given, "W", 7), imbalance = number(*.imbalance, 2))]
pub(super) struct PowerError {
    pub(super) friction: f64,
    pub(super) given: f64,
    pub(super) imbalance: f64,
}

/// Power supplied and power dissipated by friction [W].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Balance {
    pub(super) friction: f64,
    pub(super) forces: f64,
    /// Power of the pressure; for bodies of different constants and for viscoelastic bodies.
    pub(super) pressure: Option<PressurePower>,
    /// Power stored as elastic energy; for contacts with history.
    pub(super) stored: Option<f64>,
    /// Power dissipated inside bodies whose compliance grows.
    pub(super) hysteresis: Option<f64>,
    /// Numerical dissipation of the difference along x, a part of the friction power.
    pub(super) numerical_dissipation: Option<f64>,
    /// Sum of the magnitudes of all parts.
    pub(super) exchanged: f64,
}

/// Power of the pressure on the normal displacement [W].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct PressurePower {
    pub(super) rolling_resistance: f64,
    pub(super) edges: f64,
    pub(super) exchanged: f64,
}

impl PressurePower {
    /// Computes the power of a pressure whose contact has the undeformed distance `undeformed`, and
    /// the gap `gap` where it is open [m]. `duration` is that of a step [s].
    pub(super) fn of(
        grid: &Structured,
        duration: f64,
        differences: [f64; 2],
        pressure: &[f64],
        undeformed: &[f64],
        gap: impl Fn(usize) -> f64,
    ) -> Self {
        let weight = grid.element_area() / duration;
        let mut power = Self::default();
        for index in 0..grid.points() {
            let change = weight * along(grid.ni, differences, pressure, index);
            power.rolling_resistance -= change * undeformed[index];
            power.exchanged += (change * undeformed[index]).abs();
            if pressure[index] <= 0.0 && change != 0.0 {
                power.edges += change * gap(index);
            }
        }
        power
    }
}

/// Power that tractions dissipate inside the bodies [W].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Hysteresis {
    pub(super) power: f64,
    pub(super) exchanged: f64,
}

impl Hysteresis {
    /// Adds the power of a traction component [Pa] on its displacement [m], the antisymmetric part
    /// of Σ p_I·(Du)_I dx dy/Δt.
    pub(super) fn take(
        &mut self,
        grid: &Structured,
        duration: f64,
        differences: [f64; 2],
        traction: &[f64],
        displacement: &[f64],
    ) {
        let weight = grid.element_area() / duration;
        for (index, displacement) in displacement.iter().enumerate() {
            let change = along(grid.ni, differences, traction, index);
            let power = weight * change * displacement;
            self.power += power;
            self.exchanged += power.abs();
        }
    }
}

/// Powers of a contact: of a step, or means over a window [W].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Powers {
    pub(super) friction: f64,
    /// Power balance, if it is known.
    pub(super) balance: Option<Balance>,
    /// Power dissipated inside creeping bodies by pressure and tractions.
    pub(super) dissipated: Option<f64>,
    /// Friction power due to plastic flow of a layer.
    pub(super) layer: Option<f64>,
}

impl Powers {
    /// Adds the powers of a step that takes this share of the window.
    pub(super) fn add(&mut self, share: f64, step: &Self) {
        self.friction += share * step.friction;
        add(&mut self.dissipated, share, step.dissipated);
        add(&mut self.layer, share, step.layer);
        if let Some(balance) = &step.balance {
            self.balance.get_or_insert_default().add(share, balance);
        }
    }

    /// Adds the figures to the section `contact` of `summary.json`.
    pub(super) fn add_to(&self, figures: &mut Value) {
        figures["friction_power_w"] = self.friction.into();
        if let Some(balance) = &self.balance {
            balance.add_to(figures);
        }
        if let Some(power) = self.dissipated {
            figures["hysteresis_power_w"] = power.into();
        }
        if let Some(power) = self.layer {
            figures["layer_power_w"] = power.into();
        }
    }
}

/// Adds a share of a value that may be unknown.
fn add(sum: &mut Option<f64>, share: f64, value: Option<f64>) {
    if let Some(value) = value {
        *sum.get_or_insert_default() += share * value;
    }
}

/// Σ_m a_m (p_{I+m} − p_{I−m}), with a the antisymmetric part of a finite difference.
fn along(nx: usize, differences: [f64; 2], values: &[f64], index: usize) -> f64 {
    let column = index % nx;
    let at = |reach: usize| {
        let upstream = if column + reach < nx { values[index + reach] } else { 0.0 };
        let downstream = if column >= reach { values[index - reach] } else { 0.0 };
        upstream - downstream
    };
    differences[0] * at(1) + differences[1] * at(2)
}

impl Balance {
    /// Adds a share of another balance, to form the mean over a window.
    fn add(&mut self, share: f64, other: &Self) {
        self.friction += share * other.friction;
        self.forces += share * other.forces;
        self.exchanged += share * other.exchanged;
        add(&mut self.stored, share, other.stored);
        add(&mut self.hysteresis, share, other.hysteresis);
        add(&mut self.numerical_dissipation, share, other.numerical_dissipation);
        if let Some(PressurePower { rolling_resistance, edges, exchanged }) = other.pressure {
            let own = self.pressure.get_or_insert_default();
            own.rolling_resistance += share * rolling_resistance;
            own.edges += share * edges;
            own.exchanged += share * exchanged;
        }
    }

    /// Power supplied and not stored or dissipated inside the bodies [W].
    fn given(&self) -> f64 {
        let pressure = self.pressure.map_or(0.0, |p| p.rolling_resistance + p.edges);
        let kept = self.stored.unwrap_or(0.0) + self.hysteresis.unwrap_or(0.0);
        self.forces + pressure - kept
    }

    /// |friction power − supplied power| divided by the magnitudes of all exchanged power; 0 if no
    /// power is exchanged.
    pub(super) fn imbalance(&self) -> f64 {
        power_imbalance(self.friction, self.given(), self.exchanged)
    }

    /// Refuses an instant whose power balance does not hold.
    pub(super) fn check(self) -> Result<Self, PowerError> {
        let imbalance = self.imbalance();
        match imbalance <= LARGEST_POWER_IMBALANCE {
            true => Ok(self),
            false => Err(PowerError { friction: self.friction, given: self.given(), imbalance }),
        }
    }

    /// Adds the figures of the balance to the section `contact` of `summary.json`.
    fn add_to(&self, figures: &mut Value) {
        figures["creep_power_w"] = json!(self.forces);
        figures["power_imbalance"] = json!(self.imbalance());
        if let Some(PressurePower { rolling_resistance, edges, .. }) = self.pressure {
            figures["rolling_resistance_power_w"] = json!(rolling_resistance);
            figures["edge_power_w"] = json!(edges);
        }
        if let Some(hysteresis) = self.hysteresis {
            figures["hysteresis_power_w"] = json!(hysteresis);
        }
        if let Some(dissipation) = self.numerical_dissipation {
            figures["numerical_dissipation_w"] = json!(dissipation);
        }
        if let Some(stored) = self.stored {
            figures["stored_power_w"] = json!(stored);
        }
    }
}

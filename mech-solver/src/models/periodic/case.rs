//! A checked case.

use super::cell;
use crate::case::scene::{APPROACH, DRIVE, Drive, Load, NORMAL_FORCE, Scene};
use crate::terms::{Kind, Terms};
use elastic::Elasticity;
use half_space::extent::sample;
use proto::configuration::{Configuration, Refusal};
use proto::grid::Structured;
use proto::readable::{number, quantity};

/// A checked case.
pub(super) struct Case {
    pub(super) scene: Scene,
    pub(super) terms: Terms,
    pub(super) grid: Structured,
    /// Load on one cell [N].
    pub(super) load: f64,
    /// Longitudinal and lateral creepage.
    pub(super) creepage: [f64; 2],
}

impl Case {
    /// Reads a case.
    ///
    /// # Errors
    /// Values that are missing or out of range; features that a periodic contact does not support.
    pub(super) fn read(configuration: &Configuration, mut terms: Terms) -> Result<Self, Refusal> {
        let scene = Scene::read(&configuration.case)?;
        let grid = cell::grid(&configuration.case)?;
        for (body, of) in scene.bodies.iter().enumerate() {
            for (radius, key) in [(of.radius_x, "radius_x"), (of.radius_y, "radius_y")] {
                if radius.is_finite() {
                    let key = scene.names.key(body, key);
                    let reason = "bodies with a periodic contact are nominally flat";
                    let fix = "remove the key, or write [mech] model = \"half-space\"";
                    return Err(Refusal::new(&key, reason, fix));
                }
            }
        }
        let Load::NormalForce(load) = scene.load else {
            let reason = "the approach of infinite bodies has no meaning";
            return Err(Refusal::new(
                APPROACH,
                reason,
                "write load.normal_force, the load on one cell",
            ));
        };
        refuse_beyond_limit(load, &grid, &terms)?;
        let creepage = match scene.drive {
            Drive::Creepage { xi, eta, phi: 0.0 } => [xi, eta],
            Drive::Shift([0.0, 0.0, 0.0]) => [0.0; 2],
            _ => {
                let reason = "a periodic contact slides everywhere, with the prescribed creepages";
                let fix = "write motion.creepage without spin, or a surface_speed of the bodies";
                return Err(Refusal::new(DRIVE, reason, fix));
            }
        };
        let [dx, dy] = [grid.dx(), grid.dy()];
        let periods = [grid.ni as f64 * dx, grid.nj as f64 * dy];
        terms.gap.iter_mut().try_for_each(|term| term.repeat(periods))?;
        Ok(Self { scene, terms, grid, load, creepage })
    }

    /// Length and width of the cell [m].
    pub(super) fn cell(&self) -> [f64; 2] {
        [self.grid.ni as f64 * self.grid.dx(), self.grid.nj as f64 * self.grid.dy()]
    }

    /// Load divided by the area of the cell [Pa].
    pub(super) fn mean_pressure(&self) -> f64 {
        let [length, width] = self.cell();
        self.load / (length * width)
    }

    /// Normal compliance of the pair [1/Pa].
    pub(super) fn compliance(&self) -> f64 {
        let [upper, lower] = self.scene.materials();
        Elasticity::of_pair(&upper, &lower).contact_compliance()
    }

    /// Undeformed distance of the surfaces at the elements [m].
    pub(super) fn distance(&self) -> Vec<f64> {
        sample(&self.grid, &|x, y| self.terms.height(x, y))
    }

    /// Velocity of the upper body relative to the lower one [m/s].
    pub(super) fn slip_velocity(&self) -> [f64; 2] {
        self.creepage.map(|creepage| creepage * self.scene.speeds.rolling)
    }

    /// Speeds of the upper and the lower surface [m/s].
    pub(super) fn surface_speeds(&self) -> [f64; 2] {
        self.scene.speeds.of_surfaces(self.creepage[0])
    }
}

/// Refuses a load that a cell cannot carry, because its pressure has a bound.
fn refuse_beyond_limit(load: f64, grid: &Structured, terms: &Terms) -> Result<(), Refusal> {
    let (bound, cell) = (terms.pressure_bound(), grid.points() as f64 * grid.element_area());
    if load < bound * cell {
        return Ok(());
    }
    let effect = terms.effect_of(Kind::PressureBound).unwrap_or_default();
    let reason = format!(
        "{load} on a cell of {cell} m2 need a mean pressure of {}, and \
         effects.{effect} allows less than {bound}",
        quantity(load / cell, "Pa", 5),
        load = quantity(load, "N", 7),
        cell = number(cell, 5),
        bound = quantity(bound, "Pa", 5)
    );
    let fix = "write a lower load, a larger cell (mech.period_x, mech.period_y) or a larger limit";
    Err(Refusal::new(NORMAL_FORCE, reason, fix))
}

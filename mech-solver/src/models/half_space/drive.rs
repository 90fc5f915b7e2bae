//! Prescribed motion of the upper body: a force or a creepage for every component.

use crate::case::ellipse::Ellipse;
use crate::case::keys::CheckedParams;
use crate::case::scene::{Drive, Load, SPEED, Scene, WIDTH, shift_keys};
use crate::effects;
use crate::terms::Kind;
use elastic::carter;
use half_space::tangential::PrescribedMotion;
use proto::configuration::{Configuration, Mode, Refusal};
use proto::description::KeySpec;
use proto::readable::quantity;
use std::sync::LazyLock;

const LATERAL_CREEPAGE: &str = "motion.lateral_creepage";
const LATERAL_FORCE: &str = "motion.lateral_force";
const SPIN_CREEPAGE: &str = "motion.spin_creepage";
const SPIN_MOMENT: &str = "motion.spin_moment";

/// Keys in addition to those of the scene.
pub(super) fn keys() -> Vec<KeySpec> {
    let mut keys = vec![
        KeySpec::number(LATERAL_CREEPAGE, "lateral creepage in addition to a prescribed force")
            .varies(),
        KeySpec::quantity(LATERAL_FORCE, "N", "lateral force on the upper body")
            .magnitude_below(&["friction.coefficient", "load.normal_force"])
            .varies(),
        KeySpec::quantity(SPIN_CREEPAGE, "1/m", "spin [rad/m] in addition to a prescribed force")
            .varies(),
        KeySpec::quantity(SPIN_MOMENT, "N m", "spin moment on the upper body").varies(),
    ];
    keys.extend(shift_keys());
    keys
}

/// Keys, built once because a history reads them in every row.
static KEYS: LazyLock<Vec<KeySpec>> = LazyLock::new(keys);

/// A component of the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Component {
    /// Creepage or shift.
    Creepage(f64),
    /// Force [N] or moment [N m].
    Force(f64),
    /// Force divided by the normal force [-].
    Coefficient(f64),
}

/// Prescribed motion of the upper body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Driven {
    components: [Component; 3],
}

impl Driven {
    /// No creepage and no force.
    pub(super) const AT_REST: Self = Self { components: [Component::Creepage(0.0); 3] };

    /// Reads and checks the prescribed motion. `given` is the ellipse that the case gives,
    /// `ellipse` the contact if it is elliptic; without `partial` the whole contact slides.
    pub(super) fn read(
        configuration: &Configuration,
        scene: &Scene,
        given: Option<&Ellipse>,
        ellipse: Option<&Ellipse>,
        partial: bool,
    ) -> Result<Self, Refusal> {
        refuse_wrong_motion(configuration, scene)?;
        let case = CheckedParams::new(&configuration.case, &KEYS[..]);
        let [along, mut across, mut spin] = match scene.drive {
            Drive::TractionCoefficient(value) => {
                [Component::Coefficient(value), Component::Creepage(0.0), Component::Creepage(0.0)]
            }
            Drive::TangentialForce(value) => {
                [Component::Force(value), Component::Creepage(0.0), Component::Creepage(0.0)]
            }
            Drive::Creepage { xi, eta, phi } => [xi, eta, phi].map(Component::Creepage),
            Drive::Shift(shift) => shift.map(Component::Creepage),
        };
        override_with(&case, &mut across, LATERAL_CREEPAGE, LATERAL_FORCE)?;
        override_with(&case, &mut spin, SPIN_CREEPAGE, SPIN_MOMENT)?;
        let driven = Self { components: [along, across, spin] };
        if scene.width.is_some() && spin != Component::Creepage(0.0) {
            return Err(Refusal::new(
                WIDTH,
                "excludes spin and turning: their slip varies across, but a line contact is uniform across its width",
                "remove the spin, or give radii for an ellipse",
            ));
        }
        let normal_force = match (given, scene.load) {
            (Some(given), _) => Some(given.normal_force),
            (None, Load::NormalForce(force)) => Some(force),
            // The normal force is known only once the contact is solved.
            (None, Load::Approach(_)) => None,
        };
        if let Some(normal_force) = normal_force {
            driven.refuse_beyond_friction(scene.friction_coefficient, normal_force, partial)?;
        }
        if partial { Ok(driven) } else { driven.sliding(scene, ellipse) }
    }

    /// Forces and creepages at this normal force [N].
    pub(super) fn at(&self, normal_force: f64) -> PrescribedMotion {
        let mut prescribed = PrescribedMotion::creepages([0.0; 3]);
        for (k, component) in self.components.iter().enumerate() {
            match component {
                Component::Creepage(value) => prescribed.creepage[k] = *value,
                Component::Force(value) => prescribed.force[k] = Some(*value),
                Component::Coefficient(value) => prescribed.force[k] = Some(value * normal_force),
            }
        }
        prescribed
    }

    /// Returns whether the contact may be lost: the motion follows from a force, or the body is at
    /// rest.
    pub(super) fn may_lose(&self) -> bool {
        self.has_force() || *self == Self::AT_REST
    }

    /// Returns whether any component is prescribed by a force.
    pub(super) fn has_force(&self) -> bool {
        self.components.iter().any(|component| !matches!(component, Component::Creepage(_)))
    }

    /// Returns the remaining motion of bodies that have already been shifted by `shift`; forces
    /// stay.
    pub(super) fn beyond(&self, shift: [f64; 3]) -> Self {
        let mut components = self.components;
        for (component, so_far) in components.iter_mut().zip(shift) {
            if let Component::Creepage(shift) = component {
                *shift -= so_far;
            }
        }
        Self { components }
    }

    fn refuse_beyond_friction(
        &self,
        friction: f64,
        normal_force: f64,
        partial: bool,
    ) -> Result<(), Refusal> {
        let [along, across, _] = self.at(normal_force).force.map(Option::unwrap_or_default);
        let (force, most) = (along.hypot(across), friction * normal_force);
        if force < most || (force == most && !partial) {
            return Ok(());
        }
        let reason = match force > most {
            true => format!(
                "a force of {force} is beyond f N = {most}",
                force = quantity(force, "N", 7),
                most = quantity(most, "N", 7)
            ),
            false => format!(
                "a force of f N = {most} leaves the creepage undetermined",
                most = quantity(most, "N", 7)
            ),
        };
        Err(Refusal::new("motion", reason, "write less, or prescribe motion.creepage"))
    }

    /// Completes the motion of a contact that slides everywhere, whose creepages must all be known.
    /// For a longitudinal force, the creepage follows from Carter's law, as in `hertz-carter`.
    fn sliding(self, scene: &Scene, ellipse: Option<&Ellipse>) -> Result<Self, Refusal> {
        let [along, across, spin] = self.components;
        let known = |component: Component| matches!(component, Component::Creepage(_));
        if !known(across) || !known(spin) || (!known(along) && ellipse.is_none()) {
            let reason =
                "a contact that slides everywhere has the force f N, whatever the case prescribes";
            let Refusal { fix, .. } = effects::lacking(Kind::Adhesion, reason);
            let fix = format!("{fix}, or prescribe motion.creepage");
            return Err(Refusal::new("motion", reason, fix));
        }
        let (false, Some(ellipse)) = (known(along), ellipse) else { return Ok(self) };
        let friction = scene.friction_coefficient;
        let force = self.at(ellipse.normal_force).force[0].unwrap_or_default();
        let ratio = (force / (friction * ellipse.normal_force)).clamp(-1.0, 1.0);
        let compliance = scene.contact_compliance();
        let prefactor = carter::prefactor_by_pressure(friction, ellipse.max_pressure, compliance);
        let creep = -ratio.signum() * carter::creep(prefactor, ratio.abs());
        Ok(Self { components: [Component::Creepage(creep), across, spin] })
    }
}

/// Refuses a shift of rolling bodies, and creepage or a steady state of moving bodies that do not
/// roll.
fn refuse_wrong_motion(configuration: &Configuration, scene: &Scene) -> Result<(), Refusal> {
    let rolls = scene.speeds.rolling > 0.0;
    match scene.drive {
        Drive::Creepage { .. } if !rolls => Err(Refusal::new(
            "motion.creepage",
            "bodies that do not roll have no creepage",
            format!("write motion.shift, a force, or {SPEED} above 0 m/s"),
        )),
        Drive::Shift(_) if rolls => Err(Refusal::new(
            "motion.shift",
            "bodies that roll have creepages; a shift is for bodies that do not roll",
            format!("write motion.creepage, or {SPEED} = 0"),
        )),
        Drive::Shift(shift) if shift == [0.0; 3] => Ok(()),
        _ if !rolls && configuration.mode == Mode::Steady => Err(Refusal::new(
            SPEED,
            "bodies that do not roll have no steady state",
            "write time.mode = \"transient\", with a window for the shift",
        )),
        _ => Ok(()),
    }
}

/// Replaces a component by the force or the creepage of the case, if it has one.
fn override_with(
    case: &CheckedParams<'_>,
    component: &mut Component,
    creepage: &str,
    force: &str,
) -> Result<(), Refusal> {
    let given = (case.maybe_number(creepage)?, case.maybe_number(force)?);
    let (key, value) = match given {
        (None, None) => return Ok(()),
        (Some(_), Some(_)) => {
            let reason = format!("excludes `{creepage}`: each determines the other");
            return Err(Refusal::new(force, reason, "keep one of them"));
        }
        (Some(value), None) => (creepage, Component::Creepage(value)),
        (None, Some(value)) => (force, Component::Force(value)),
    };
    if *component != Component::Creepage(0.0) {
        return Err(Refusal::new(
            key,
            "excludes motion.creepage and motion.shift, which have this component too",
            "keep one of them",
        ));
    }
    *component = value;
    Ok(())
}

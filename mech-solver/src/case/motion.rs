//! Motion of a case: what drives the upper body, and the speeds of rolling and of the surfaces.

use crate::case::keys::CheckedParams;
use proto::bodies::{Bodies, LOWER, UPPER};
use proto::configuration::Refusal;
use proto::description::KeySpec;
use proto::params::Params;

/// Prescribed motion of the upper body: a force, a creepage or a shift. Positive forces and
/// negative creepages drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Drive {
    /// Longitudinal force on the upper body divided by the normal force [-].
    TractionCoefficient(f64),
    /// Longitudinal force on the upper body [N].
    TangentialForce(f64),
    /// Velocity of the upper body relative to the lower one, divided by the rolling speed.
    Creepage {
        /// Longitudinal [-].
        xi: f64,
        /// Lateral [-].
        eta: f64,
        /// Spin [rad/m].
        phi: f64,
    },
    /// Rigid shift of the upper body relative to the lower one, without rolling: along x and y [m],
    /// about z [rad].
    Shift([f64; 3]),
}

/// Speeds of rolling and of the surfaces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Speeds {
    /// Rolling speed V [m/s], the reference of the creepages; 0 for bodies that do not roll.
    pub rolling: f64,
    /// Speeds of the upper and the lower surface [m/s], if the case prescribes them.
    pub prescribed: Option<[f64; 2]>,
}

impl Speeds {
    /// Returns the speeds [m/s] at which the material of the upper and the lower body passes
    /// through the contact. They are V − ξ V and V with the longitudinal creepage ξ, unless the
    /// case prescribes them. A driving body (ξ < 0) is faster.
    #[must_use]
    pub fn of_surfaces(&self, creepage_xi: f64) -> [f64; 2] {
        self.prescribed.unwrap_or([self.rolling * (1.0 - creepage_xi), self.rolling])
    }
}

/// Group of the alternative keys that drive the upper body; none is needed if surface speeds drive
/// it.
pub(crate) const DRIVE: &str = "motion.drive";
const TRACTION_COEFFICIENT: &str = "motion.traction_coefficient";
const TANGENTIAL_FORCE: &str = "motion.tangential_force";
const CREEPAGE: &str = "motion.creepage";
const LONGITUDINAL_CREEPAGE: &str = "motion.creepage.xi";
pub(crate) const SPEED: &str = "motion.speed";
const SHIFT: [&str; 3] = ["motion.shift.x", "motion.shift.y", "motion.shift.turn"];

/// Returns the keys of the motion.
pub(super) fn motion_keys() -> Vec<KeySpec> {
    vec![
        KeySpec::quantity(
            SPEED,
            "m/s",
            "rolling speed V; 0 for a tangential shift without rolling",
        )
        .expected(0.0..=200.0, "the fastest trains reach 160 m/s; km/h is accepted too")
        .at_least(0.0)
        .varies(),
        KeySpec::number(
            TRACTION_COEFFICIENT,
            "longitudinal force on the upper body over normal force; positive drives",
        )
        .one_of_or_none(DRIVE)
        .magnitude_below(&["friction.coefficient"])
        .varies(),
        KeySpec::quantity(
            TANGENTIAL_FORCE,
            "N",
            "longitudinal force on the upper body; positive drives",
        )
        .one_of_or_none(DRIVE)
        .magnitude_below(&["friction.coefficient", "load.normal_force"])
        .varies(),
        KeySpec::number(LONGITUDINAL_CREEPAGE, "longitudinal creepage; negative drives")
            .varies()
            .one_of_or_none(DRIVE),
        KeySpec::number("motion.creepage.eta", "lateral creepage")
            .varies()
            .one_of_or_none(DRIVE)
            .default_value(0.0),
        KeySpec::quantity("motion.creepage.phi", "1/m", "spin creepage [rad/m]")
            .varies()
            .one_of_or_none(DRIVE)
            .default_value(0.0),
    ]
}

/// Returns the keys of a shift, for the models that solve one.
#[must_use]
pub fn shift_keys() -> Vec<KeySpec> {
    let help = [
        "rigid shift of the upper body along x, relative to the start; applied in the first window unless it is a column",
        "rigid shift of the upper body along y",
        "rigid rotation of the upper body about z [rad]",
    ];
    let key = |k: usize| {
        let unit = if k == 2 { "1" } else { "m" };
        KeySpec::quantity(SHIFT[k], unit, help[k]).varies().one_of_or_none(DRIVE).default_value(0.0)
    };
    (0..3).map(key).collect()
}

/// Reads the speeds of both surfaces if the case gives at least one; the other has the rolling
/// speed.
pub(super) fn read_surface_speeds(
    case: &CheckedParams<'_>,
    names: &Bodies,
) -> Result<Option<[f64; 2]>, Refusal> {
    let keys = [UPPER, LOWER].map(|body| names.key(body, "surface_speed"));
    let [upper, lower] = [case.maybe_number(&keys[0])?, case.maybe_number(&keys[1])?];
    if upper.is_none() && lower.is_none() {
        return Ok(None);
    }
    let rolling = case.maybe_number(SPEED)?;
    let missing = |key: &str| {
        let fix = format!("add `{key}`, or `{SPEED}` for the body without a speed of its own");
        Refusal::new(key, "missing", fix)
    };
    let upper = upper.or(rolling).ok_or_else(|| missing(&keys[0]))?;
    let lower = lower.or(rolling).ok_or_else(|| missing(&keys[1]))?;
    if upper + lower > 0.0 {
        return Ok(Some([upper, lower]));
    }
    let fix = format!("let one surface move, or write motion.shift with {SPEED} = 0");
    Err(Refusal::new(&keys[0], "both surfaces are at rest", fix))
}

/// Reads the rolling speed. If the speeds of both surfaces are given, it is their mean.
pub(super) fn read_rolling_speed(
    case: &CheckedParams<'_>,
    names: &Bodies,
    prescribed: Option<[f64; 2]>,
) -> Result<f64, Refusal> {
    /// Relative rounding error of a speed in decimal digits.
    const ROUNDING: f64 = 1e-9;
    let speed = case.maybe_number(SPEED)?;
    let both = [UPPER, LOWER].iter().all(|body| case.has(&names.key(*body, "surface_speed")));
    match (speed, prescribed.map(|[upper, lower]| 0.5 * (upper + lower))) {
        (Some(speed), Some(mean)) if both && (speed - mean).abs() > ROUNDING * mean => {
            let reason = format!(
                "is {speed} m/s, and the speeds of both surfaces already determine the rolling speed: their mean \
                 is {mean} m/s"
            );
            Err(Refusal::new(SPEED, reason, "remove it, or one of the two keys surface_speed"))
        }
        (Some(speed), _) | (None, Some(speed)) => Ok(speed),
        (None, None) => {
            let fix = format!("add `{SPEED} = \"30 m/s\"`, or a surface_speed of both bodies");
            Err(Refusal::new(SPEED, "missing", fix))
        }
    }
}

/// Returns true if the case prescribes a longitudinal force.
pub(crate) fn prescribes_force(case: &Params) -> bool {
    [TRACTION_COEFFICIENT, TANGENTIAL_FORCE].iter().any(|key| case.has(key))
}

/// Reads what drives the upper body: one of the alternatives, or the surface speeds.
pub(super) fn read_drive(
    params: &Params,
    case: &CheckedParams<'_>,
    names: &Bodies,
    speeds: Speeds,
) -> Result<Drive, Refusal> {
    let alternatives = [TRACTION_COEFFICIENT, TANGENTIAL_FORCE, CREEPAGE, "motion.shift"];
    let given: Vec<_> = alternatives.into_iter().filter(|key| case.has(key)).collect();
    if let (Some([upper, lower]), [drive, ..]) = (speeds.prescribed, given.as_slice()) {
        let reason = format!(
            "excludes the surface speeds {upper} m/s and {lower} m/s of the bodies: each determines \
             how the upper body is driven"
        );
        return Err(Refusal::new(drive, reason, "keep one of them"));
    }
    match given[..] {
        [TRACTION_COEFFICIENT] => {
            Ok(Drive::TractionCoefficient(case.number(TRACTION_COEFFICIENT)?))
        }
        [TANGENTIAL_FORCE] => Ok(Drive::TangentialForce(case.number(TANGENTIAL_FORCE)?)),
        [CREEPAGE] => Ok(Drive::Creepage {
            xi: case.number(LONGITUDINAL_CREEPAGE)?,
            eta: case.number("motion.creepage.eta")?,
            phi: case.number("motion.creepage.phi")?,
        }),
        [_] => {
            let case = CheckedParams::new(params, shift_keys());
            let [x, y, turn] = SHIFT.map(|key| case.number(key));
            Ok(Drive::Shift([x?, y?, turn?]))
        }
        [] => match speeds.prescribed {
            Some([upper, lower]) => {
                Ok(Drive::Creepage { xi: (lower - upper) / speeds.rolling, eta: 0.0, phi: 0.0 })
            }
            // Bodies at rest that are only pressed together.
            None if speeds.rolling == 0.0 => Ok(Drive::Shift([0.0; 3])),
            None => Err(Refusal::new(
                "motion",
                format!("no key drives `{}`", names.0[UPPER]),
                format!(
                    "add one of {}, or {}",
                    alternatives.join(", "),
                    names.key(UPPER, "surface_speed")
                ),
            )),
        },
        [_, second, ..] => Err(Refusal::new(
            second,
            format!("excludes `{}`: each determines how the upper body is driven", given[0]),
            format!("keep one of {}", given.join(", ")),
        )),
    }
}

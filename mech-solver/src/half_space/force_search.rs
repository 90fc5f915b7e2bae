//! The creepages at which the contact carries prescribed forces.
//!
//! Of the longitudinal force, the lateral force and the spin moment any may be prescribed; its
//! creepage is then unknown, the others are given. With F the forces on body 1 and c the creepages,
//! a quasi-Newton iteration solves F(c) = F*:
//!
//! c ← c + t d,  J d = F − F*,  J ≈ −∂F/∂c by Broyden's updates (the secant method for one force).
//!
//! **Bracket.** More creepage against a force raises it: (F(c) − F(c'))·(c − c') ≤ 0 for any two, as
//! friction dissipates. So every evaluation k leaves the solution on one side of a plane,
//! (F* − F_k)·(c − c_k) ≤ 0. No step leaves the polyhedron of these planes, which for one force is the
//! bracket of the evaluations below and above: one that would is turned along the walls, and at
//! last cut to half the way, for one force the bisection. Planes hold as far as the forces are
//! right, so that a lack of the size of their noise is looked at again, more accurately, before it
//! becomes one. Where Broyden's updates lose pace, J is taken anew by differences. Steps are
//! limited to a part of the creepage besides, since towards f N the creepage grows without bound.
//!
//! Spin and moment are scaled by a length of the contact, so that all components are alike.
//!
//! Source: Broyden, Math. Comp. 19 (1965) 577–593. The planes are this project's; the sign is
//! exact for a shift, where F is the gradient of a concave function, and has been met in every
//! steady rolling tried.

use super::tangential::Creepage;
use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// Evaluations at most.
const MOST_EVALUATIONS: usize = 80;
/// Longest step, as a share of the creepage.
const GROWTH: f64 = 0.6;
/// Part of the way to the wall that a cut step goes.
const INTO_THE_BRACKET: f64 = 0.5;

/// Accuracy of the tractions asked for, over the last error of the forces, both over their bounds.
const ACCURACY: f64 = 0.1;
/// Best accuracy asked for, unless the result needs a better one.
const BEST_ACCURACY: f64 = 1e-8;
/// Worst accuracy asked for.
const WORST_ACCURACY: f64 = 2e-3;

/// Forces err by about this much of the accuracy of the tractions.
const NOISE: f64 = 2.0;
/// Steps shorter than this share of the creepage mean nothing.
const NARROWEST: f64 = 1e-9;
/// Evaluations without a halved error after which J is taken anew by differences.
const PATIENCE: usize = 6;
/// Side of the differences, as a share of the creepage, and accuracy of the tractions for them.
const DIFFERENCE: f64 = 1e-3;
const DIFFERENCE_ACCURACY: f64 = 1e-6;
/// Small forces are met to this share of themselves.
const RELATIVE_TOLERANCE: f64 = 1e-4;
/// Rounding of the forces over f N.
const ROUNDING: f64 = 1e-13;
/// Turns along the walls of the bracket.
const MOST_WALLS: usize = 20;

/// What is prescribed: a force for some components, a creepage for the others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prescribed {
    /// Creepages [-, -, rad/m], or shifts [m, m, rad]; where a force is prescribed, not used.
    pub creepage: Creepage,
    /// Longitudinal and lateral force [N] and spin moment [N m] on body 1; `None` where the creepage
    /// is prescribed.
    pub force: [Option<f64>; 3],
}

impl Prescribed {
    /// All creepages.
    #[must_use]
    pub fn creepages(creepage: Creepage) -> Self {
        Self { creepage, force: [None; 3] }
    }

    /// A longitudinal force [N]; no lateral creepage and no spin.
    #[must_use]
    pub fn longitudinal_force(force: f64) -> Self {
        Self { creepage: [0.0; 3], force: [Some(force), None, None] }
    }

    /// Whether any force is prescribed.
    #[must_use]
    pub fn has_force(&self) -> bool {
        self.force.iter().any(Option::is_some)
    }
}

/// A search that did not end.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "no creepages were found that give the prescribed forces: after {MOST_EVALUATIONS} evaluations \
     the largest error is {error:.2e} of f N; together they may be beyond what friction carries"
)]
pub struct NotFound {
    /// Largest error of a force over f N.
    pub error: f64,
}

/// The scales of a search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scales {
    /// −∂F_x/∂ξ at small creepage, roughly [N], or [N/m] in a shift.
    pub slope: f64,
    /// A length of the contact [m].
    pub length: f64,
    /// f N [N].
    pub most_force: f64,
    /// Error of the forces allowed, over f N.
    pub tolerance: f64,
    /// Accuracy of the tractions that the result must have.
    pub accuracy: f64,
    /// Nothing but creepage makes forces: no history, no pressure on different bodies.
    pub passive: bool,
}

/// What a search has learned; it serves the next one.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct ForceSearch {
    /// J, row by row.
    jacobian: Option<[[f64; 3]; 3]>,
}

impl ForceSearch {
    /// Finds the creepages, from `start` or, without one, from the linear theory. `forces` returns
    /// the forces at creepages, for tractions that have settled to a given share of the bound: the
    /// closer the forces, the better.
    ///
    /// # Errors
    /// Those of `forces`, and no creepages found.
    pub fn find<E: From<NotFound>>(
        &mut self,
        prescribed: &Prescribed,
        start: Option<Creepage>,
        scales: &Scales,
        mut forces: impl FnMut(Creepage, f64) -> Result<[f64; 3], E>,
    ) -> Result<(), E> {
        let scaled = Scaled::new(prescribed, scales);
        let linear = scaled.linear_theory(scales.slope);
        let learned = self.jacobian.take().map(|rows| Matrix3::from(rows).transpose());
        let mut jacobian = learned.unwrap_or(linear);
        let mut at = match start {
            Some(creepage) => scaled.creepage_in(creepage),
            None => scaled.first_guess(&linear),
        };
        let mut lack_at = |at, accuracy| -> Result<Vector3<f64>, E> {
            Ok(scaled.lack(forces(scaled.creepage_out(at), accuracy)?))
        };
        let tolerance = scaled.tolerance(scales);
        let mut bracket = scaled.known_planes(scales);
        let mut before: Option<(Vector3<f64>, Vector3<f64>)> = None;
        let mut accuracy = WORST_ACCURACY;
        let mut error = f64::INFINITY;
        let mut pace = Pace::default();
        for _ in 0..MOST_EVALUATIONS {
            let lack = lack_at(at, accuracy)?;
            error = lack.amax() / scales.most_force;
            if let Some((at_before, lack_before)) = before.take() {
                update(&mut jacobian, at - at_before, lack - lack_before);
            }
            if error <= tolerance && accuracy <= scales.accuracy {
                self.jacobian = Some(jacobian.transpose().into());
                return Ok(());
            }
            let used = accuracy;
            accuracy = (ACCURACY * error).clamp(BEST_ACCURACY.min(scales.accuracy), WORST_ACCURACY);
            if error <= tolerance || (error < NOISE * used && accuracy < used) {
                // What is lacking may be noise: the same creepage again, more accurately.
                accuracy = accuracy.min(scales.accuracy);
                continue;
            }
            bracket.push(Plane { point: at, normal: lack });
            if pace.is_lost(error) && scaled.is_several() {
                accuracy = DIFFERENCE_ACCURACY;
                let base = lack_at(at, accuracy)?;
                let side = DIFFERENCE * scaled.size(at);
                for k in (0..3).filter(|k| scaled.free[*k]) {
                    let near = at + Vector3::from_fn(|row, _| if row == k { side } else { 0.0 });
                    jacobian.set_column(k, &((lack_at(near, accuracy)? - base) / side));
                }
            }
            let step = bracket.cut(at, scaled.step(&jacobian, &linear, at, lack));
            before = Some((at, lack));
            at += step;
            if step.norm() < NARROWEST * at.norm() {
                // Narrower than the forces are precise: the planes contradict each other.
                bracket.planes.clear();
            }
        }
        Err(NotFound { error }.into())
    }
}

/// Whether the error still falls.
#[derive(Default)]
struct Pace {
    best: Option<f64>,
    stale: usize,
}

impl Pace {
    /// The error has not halved in the last evaluations.
    fn is_lost(&mut self, error: f64) -> bool {
        if self.best.is_none_or(|best| error < 0.5 * best) {
            (self.best, self.stale) = (Some(error), 0);
            return false;
        }
        self.stale += 1;
        let lost = self.stale >= PATIENCE;
        if lost {
            (self.best, self.stale) = (Some(error), 0);
        }
        lost
    }
}

/// The unknown creepages and their forces, the third component over or times a length.
struct Scaled {
    scale: Vector3<f64>,
    given: Vector3<f64>,
    unscaled: Creepage,
    free: [bool; 3],
    wanted: Vector3<f64>,
}

impl Scaled {
    fn new(prescribed: &Prescribed, scales: &Scales) -> Self {
        let scale = Vector3::new(1.0, 1.0, scales.length);
        let wanted = Vector3::from(prescribed.force.map(Option::unwrap_or_default));
        let free = prescribed.force.map(|force| force.is_some());
        let given = |k: usize| if free[k] { 0.0 } else { prescribed.creepage[k] * scale[k] };
        let given = Vector3::from_fn(|k, _| given(k));
        let unscaled = prescribed.creepage;
        Self { scale, given, unscaled, free, wanted: wanted.component_div(&scale) }
    }

    fn masked(&self, values: Vector3<f64>) -> Vector3<f64> {
        Vector3::from_fn(|k, _| if self.free[k] { values[k] } else { 0.0 })
    }

    /// The unknown creepages, zero for the given ones.
    fn creepage_in(&self, creepage: Creepage) -> Vector3<f64> {
        self.masked(Vector3::from(creepage).component_mul(&self.scale))
    }

    fn creepage_out(&self, at: Vector3<f64>) -> Creepage {
        let of = |k: usize| if self.free[k] { at[k] / self.scale[k] } else { self.unscaled[k] };
        std::array::from_fn(of)
    }

    /// F* − F of the prescribed components.
    fn lack(&self, forces: [f64; 3]) -> Vector3<f64> {
        self.masked(self.wanted - Vector3::from(forces).component_div(&self.scale))
    }

    /// J of Kalker's linear theory, with the coefficients of a circle to one digit; rows and columns
    /// of given creepages are those of the identity.
    fn linear_theory(&self, slope: f64) -> Matrix3<f64> {
        let circle = Matrix3::new(1.0, 0.0, 0.0, 0.0, 0.9, 0.35, 0.0, -0.35, 0.25);
        Matrix3::from_fn(|row, column| match self.free[row] && self.free[column] {
            true => slope * circle[(row, column)],
            false => f64::from(u8::from(row == column)),
        })
    }

    fn first_guess(&self, linear: &Matrix3<f64>) -> Vector3<f64> {
        -linear.lu().solve(&self.masked(self.wanted)).unwrap_or_default()
    }

    /// Without creepage there is no force, if nothing else makes one.
    fn known_planes(&self, scales: &Scales) -> Bracket {
        let planes = match scales.passive && self.given == Vector3::zeros() {
            true => vec![Plane { point: Vector3::zeros(), normal: self.masked(self.wanted) }],
            false => Vec::new(),
        };
        Bracket { planes }
    }

    /// Error of the forces allowed, over f N.
    fn tolerance(&self, scales: &Scales) -> f64 {
        let wanted = self.wanted.amax() / scales.most_force;
        let alone = scales.passive && self.given == Vector3::zeros() && wanted > 0.0;
        let relative = if alone { RELATIVE_TOLERANCE * wanted } else { f64::INFINITY };
        scales.tolerance.min(relative.max(ROUNDING))
    }

    fn is_several(&self) -> bool {
        self.free.iter().filter(|free| **free).count() > 1
    }

    /// Size of the creepages.
    fn size(&self, at: Vector3<f64>) -> f64 {
        at.norm().max(self.given.norm())
    }

    /// A step towards the forces, of limited length.
    fn step(
        &self,
        jacobian: &Matrix3<f64>,
        linear: &Matrix3<f64>,
        at: Vector3<f64>,
        lack: Vector3<f64>,
    ) -> Vector3<f64> {
        let by = |matrix: &Matrix3<f64>| -matrix.lu().solve(&lack).unwrap_or_default();
        let proposal = by(jacobian);
        // What does not lead against the lack is of no use.
        let leads = proposal.dot(&lack) < 0.0 && proposal.iter().all(|value| value.is_finite());
        let step = if leads { proposal } else { by(linear) };
        let most = GROWTH * self.size(at).max(by(linear).norm());
        if step.norm() > most { step * (most / step.norm()) } else { step }
    }
}

/// The solution c satisfies normal·(c − point) ≤ 0.
struct Plane {
    point: Vector3<f64>,
    normal: Vector3<f64>,
}

/// Planes on one side of which the solution lies.
struct Bracket {
    planes: Vec<Plane>,
}

impl Bracket {
    fn push(&mut self, plane: Plane) {
        self.planes.push(plane);
    }

    /// The step, turned along the walls that it would cross, and as much of it as stays well inside.
    fn cut(&self, at: Vector3<f64>, mut step: Vector3<f64>) -> Vector3<f64> {
        for _ in 0..MOST_WALLS {
            let mut turned = false;
            for Plane { point, normal } in &self.planes {
                let room = (-normal.dot(&(at - point))).max(0.0);
                let (along, square) = (normal.dot(&step), normal.norm_squared());
                if square > 0.0 && along > room {
                    step -= normal * ((along - INTO_THE_BRACKET * room) / square);
                    turned = true;
                }
            }
            if !turned {
                break;
            }
        }
        let wall = |plane: &Plane| {
            let room = -plane.normal.dot(&(at - plane.point));
            let rate = plane.normal.dot(&step);
            if rate > 0.0 { (room / rate).max(0.0) } else { f64::INFINITY }
        };
        let way = self.planes.iter().map(wall).fold(f64::INFINITY, f64::min);
        if way <= 1.0 { step * (INTO_THE_BRACKET * way) } else { step }
    }
}

/// Broyden's update of J for a step and the change of F* − F it made, if the change is monotone.
fn update(jacobian: &mut Matrix3<f64>, step: Vector3<f64>, change: Vector3<f64>) {
    let square = step.norm_squared();
    if square > 0.0 && change.dot(&step) > 0.0 {
        *jacobian += (change - *jacobian * step) * step.transpose() / square;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Forces that grow to a limit, with spin turning the lateral one.
    fn saturating(creepage: Creepage) -> [f64; 3] {
        let [x, y, spin] = [4.0 * creepage[0], 4.0 * creepage[1] + creepage[2], 0.5 * creepage[2]];
        let size = (x * x + y * y + spin * spin).sqrt();
        let share = if size > 0.0 { -size.tanh() / size } else { -1.0 };
        [x * share, y * share, spin * share]
    }

    const SCALES: Scales = Scales {
        slope: 3.0,
        length: 0.7,
        most_force: 1.0,
        tolerance: 1e-9,
        accuracy: 1e-4,
        passive: true,
    };

    /// The found creepage and the number of evaluations.
    fn find(prescribed: &Prescribed) -> Result<(Creepage, usize), NotFound> {
        let (mut found, mut evaluations) = ([0.0; 3], 0);
        ForceSearch::default().find(prescribed, None, &SCALES, |creepage, _| {
            (found, evaluations) = (creepage, evaluations + 1);
            Ok::<_, NotFound>(saturating(creepage))
        })?;
        Ok((found, evaluations))
    }

    #[test]
    fn one_force_up_to_the_limit() {
        for (share, most) in [(1e-8, 6), (0.1, 8), (0.7, 12), (0.999, 20), (0.999_999, 30)] {
            for sign in [1.0, -1.0] {
                let force = Prescribed::longitudinal_force(sign * share);
                let (creepage, evaluations) = find(&force).unwrap();
                let exact = -sign * share.atanh() / 4.0;
                let error = saturating([exact, 0.0, 0.0])[0] - saturating(creepage)[0];
                assert!(
                    error.abs() <= 1e-9 && evaluations <= most,
                    "{share}: {creepage:?} {evaluations}"
                );
            }
        }
    }

    #[test]
    fn two_forces_and_a_moment_at_once() {
        for wanted in [[0.3, 0.2, 0.05], [0.6, -0.7, 0.1], [0.0, 0.0, 0.2], [-0.5, 0.0, -0.01]] {
            let prescribed = Prescribed { creepage: [0.0; 3], force: wanted.map(Some) };
            let (creepage, evaluations) = find(&prescribed).unwrap();
            let found = saturating(creepage);
            assert!((0..3).all(|k| (found[k] - wanted[k]).abs() <= 1e-8), "{found:?}");
            assert!(evaluations <= 40, "{wanted:?} took {evaluations}");
        }
    }

    #[test]
    fn a_force_beside_given_creepages() {
        let prescribed = Prescribed { creepage: [9.0, -0.05, 0.2], force: [Some(0.4), None, None] };
        let (creepage, _) = find(&prescribed).unwrap();
        assert_eq!([creepage[1], creepage[2]], [-0.05, 0.2]);
        assert!((saturating(creepage)[0] - 0.4).abs() <= 1e-9);
    }

    #[test]
    fn a_force_out_of_reach_is_an_error() {
        assert!(find(&Prescribed::longitudinal_force(1.5)).unwrap_err().error > 0.4);
    }
}

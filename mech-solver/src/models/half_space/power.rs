//! Power balance of an instant: the friction power equals the power supplied.
//!
//! **Steady rolling and sliding.** In the sum over all steps of the particles the elastic part of
//! the slip cancels ([`half_space::tangential`]), and friction dissipates
//!
//! P = −V(ξ F_x + η F_y + φ M_z) + V ∫ p_n ∂h/∂x dA.
//!
//! M_z is the moment about a point ahead of the middle. The distance is that between the middle of
//! a step and the point where its rigid slip is taken: Δx/3 in rolling with a stick zone, since the
//! tractions at the beginning and at the end of a step have equal weight.
//!
//! The last term occurs only for bodies of different elastic constants: their pressure causes slip
//! against the tractions, (p_{I+e_x} − p_{I−e_x})/2 · A_zt p_t in every element by the reciprocity
//! of Maxwell and Betti. The normal contact closes A_zt p_t to δ − h − A_zz p_n, and the part of
//! A_zz cancels again. With h = x²/2R the term is V N x̄/R, with x̄ the centre of pressure: the
//! power of the rolling resistance. 1/R is the sum of both curvatures along x.
//!
//! An open gap is e = h + A_zz p_n + A_zt p_t − δ > 0. In the elements next to the
//! contact, through which the pressure enters and leaves, the step of an element has in addition
//! the power of the pressure on this gap. This *edge power* is a discretisation effect: it
//! decreases with the element size.
//!
//! In the elements in contact e = 0 is assumed, so that the balance shows how well it is met.
//!
//! **Viscoelastic bodies** that roll steadily dissipate D = Σ ½ (p_{I+e_x} − p_{I−e_x})·u_I dA/Δt
//! of pressure and tractions: the sum of the work on their displacements in every step, which does
//! not cancel because their influence coefficients are not symmetric. D is the amount by which V N
//! x̄/R and the power of the creepages together exceed the friction power. If the contact slides
//! everywhere, the tangential displacement is neither in the slip nor in D.
//!
//! **Shifts, and steps of transient rolling** of bodies of the same constants: the forces act with
//! the mean of the tractions before and after a step, and part of the work is stored as elastic
//! energy ½ pᵀA p,
//!
//! P Δt = −Σ ½(S p' + p)·w Δq dA − Δ(½ pᵀA p) dA.
//!
//! With Fromm's difference, in all steps after the first, the tractions at the end of a step do the
//! work, with their own elastic energy and numerical dissipation ([`half_space::difference`]).
//!
//! Bodies whose compliance grows also dissipate D = Σ ½ (p' + p)·(u − u'), minus the stored energy
//! ([`half_space::retarded`]). For different elastic constants the energy of the normal contact
//! takes part too; it is not stored, and there is no balance.

use super::answer::ContactFields;
use super::balance::{Balance, Hysteresis, PressurePower};
use super::case::Case;
use half_space::aligned::AlignedGrid;
use proto::grid::Structured;

/// Work of a traction on the rigid slip at a point, per distance rolled [Pa]: the sum and the sum
/// of the magnitudes of its components.
fn against(creepage: [f64; 3], [x, y]: [f64; 2], [px, py]: [f64; 2]) -> [f64; 2] {
    let [xi, eta, phi] = creepage;
    let (along, across) = (px * (xi - phi * y), py * (eta + phi * x));
    [-(along + across), along.abs() + across.abs()]
}

/// Tractions before and after a step in the rows of a contact [Pa], and its creepages or shift.
#[derive(Clone, Copy)]
pub(super) struct RowStep<'a> {
    pub(super) rows: &'a AlignedGrid,
    pub(super) before: &'a [Vec<f64>; 2],
    pub(super) after: &'a [Vec<f64>; 2],
    pub(super) creepage: [f64; 3],
}

impl Balance {
    /// Balance of an instant without history.
    pub(super) fn steady(
        case: &Case,
        answer: &ContactFields,
        pressure: Option<PressurePower>,
        hysteresis: Option<Hysteresis>,
    ) -> Self {
        let (grid, speed) = (&case.footprint.grid, case.scene.speeds.rolling);
        let (px, py) = answer.traction.split_at(grid.points());
        let mut exchanged = 0.0;
        for (index, traction) in px.iter().zip(py).enumerate() {
            let at = [grid.x(index % grid.ni), grid.y(index / grid.ni)];
            exchanged += against(answer.creepage, at, [*traction.0, *traction.1])[1];
        }
        let [_, mut forces @ ..] = answer.sums(grid).map(|sum| sum * grid.element_area());
        forces[2] -= answer.pivot * forces[1];
        let work: f64 = forces.iter().zip(answer.creepage).map(|(f, c)| f * c).sum();
        Self {
            friction: friction(grid, answer),
            forces: -speed * work,
            pressure,
            stored: None,
            hysteresis: hysteresis.map(|taken| taken.power),
            numerical_dissipation: answer.numerical_dissipation,
            exchanged: speed * grid.element_area() * exchanged
                + pressure.map_or(0.0, |pressure| pressure.exchanged)
                + hysteresis.map_or(0.0, |taken| taken.exchanged),
        }
    }

    /// Balance of a step. `energy` is the elastic energy before and after the step, and `taken` the
    /// work along the plane dissipated by creeping bodies [Pa m].
    pub(super) fn step(
        case: &Case,
        answer: &ContactFields,
        step: &RowStep<'_>,
        energy: [f64; 2],
        taken: Option<f64>,
    ) -> Self {
        let (grid, passage) = (&case.footprint.grid, case.passage());
        let RowStep { rows, before, after, creepage } = *step;
        let [along, across] = after;
        let mut sums = [0.0; 2];
        for index in 0..grid.points() {
            let [x, y] = rows.centre(index);
            let at = [x + passage.ahead, y];
            let mean = |start: &[f64], end: &[f64]| passage.mean(grid.ni, start, end, index);
            let traction = [mean(&before[0], along), mean(&before[1], across)];
            let power = against(creepage, at, traction);
            sums.iter_mut().zip(power).for_each(|(sum, power)| *sum += power);
        }
        let weight = grid.element_area() / passage.duration;
        let [forces, exchanged] = sums.map(|sum| weight * passage.distance * sum);
        Self {
            friction: friction(grid, answer),
            forces,
            pressure: None,
            stored: Some(weight * (energy[1] - energy[0])),
            hysteresis: taken.map(|taken| weight * taken),
            numerical_dissipation: answer.numerical_dissipation,
            exchanged: exchanged
                + weight * (energy[0].abs() + energy[1].abs() + taken.unwrap_or(0.0).abs()),
        }
    }
}

fn friction(grid: &Structured, answer: &ContactFields) -> f64 {
    answer.friction_power.iter().sum::<f64>() * grid.element_area()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_not_add_up_is_refused_with_both_figures() {
        let pressure = PressurePower { rolling_resistance: 30.0, edges: 1.0, exchanged: 60.0 };
        let balance = Balance {
            friction: 101.0,
            forces: 70.0,
            pressure: Some(pressure),
            stored: None,
            hysteresis: None,
            numerical_dissipation: None,
            exchanged: 130.0,
        };
        assert_eq!(balance.imbalance(), 0.0);
        assert_eq!(balance.check(), Ok(balance));
        let off = Balance { friction: 101.001, ..balance };
        let message = off.check().unwrap_err().to_string();
        for part in
            ["friction dissipates 101.0010 W", "where 101.0000 W are supplied", "by 7.7 × 10⁻⁶"]
        {
            assert!(message.contains(part), "{message}");
        }
        assert!(Balance { friction: f64::NAN, ..balance }.check().is_err());
        assert_eq!(Balance::default().imbalance(), 0.0);
    }

    /// A centre of pressure ahead of the middle resists rolling: V N x̄/R, with the sum evaluated
    /// by hand.
    #[test]
    fn a_pressure_ahead_of_the_middle_resists() {
        let grid = Structured::contact_plane(-2.0, 0.0, 1.0, 1.0, 5, 1);
        let (radius, duration) = (10.0, 0.25);
        let distance: Vec<f64> = (0..5).map(|i| 0.5 * grid.x(i) * grid.x(i) / radius).collect();
        let pressure = [0.0, 1.0, 2.0, 3.0, 0.0];
        let power = PressurePower::of(&grid, duration, [0.5, 0.0], &pressure, &distance, |_| 0.0);
        let (speed, load_times_centre) = (1.0 / duration, -1.0 + 3.0);
        let expected = speed * load_times_centre / radius;
        assert!((power.rolling_resistance - expected).abs() < 1e-15, "{power:?}");
        assert_eq!(power.edges, 0.0);
    }
}

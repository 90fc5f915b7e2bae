//! Explicit finite elements of a material that flows plastically.

use explicit_fe::block::{Block, Solid, Support};
use explicit_fe::kernel::Flow;
use explicit_fe::section::Section;

const MU: f64 = 80e9;
const LAMBDA: f64 = 120e9;

/// Bar of elements of 1 mm, one across and one deep.
fn bar(flow: Option<Flow>) -> Block {
    let nodes = vec![[0.0, 0.0], [1e-3, 0.0], [0.0, 1e-3], [1e-3, 1e-3]];
    let section = Section { counts: [1, 1], nodes, fine: [0, 1] };
    let solid = Solid { lame: [LAMBDA, MU], density: 7850.0, flow, radius: f64::INFINITY };
    Block::new(16, 1e-3, section, solid, Support::Nothing)
}

/// Shear stress [Pa] of a bar under a uniform shear strain γ, from the force along its upper nodes.
fn shear_stress(block: &mut Block, gamma: f64) -> f64 {
    let step = 1e-12;
    for row in 0..4 {
        let depth = block.section.nodes[row][1];
        for column in 0..=block.counts[0] {
            block.damped[0][row * block.stride + column] = gamma * depth;
            for values in &mut block.velocity {
                values[row * block.stride + column] = 0.0;
            }
        }
        for k in 1..3 {
            let start = row * block.stride;
            block.damped[k][start..=start + block.counts[0]].fill(0.0);
        }
    }
    block.step(step);
    // Both upper rows, at an inner column; the force is divided by the length and width of an
    // element.
    let force: f64 = (0..2)
        .map(|row| block.velocity[0][row * block.stride + 8] / (block.inverse_mass[row] * step))
        .sum();
    force / 1e-6
}

/// Cyclic shear: elastic up to σ_y/√3, then with the slope μ H/(3μ + H). After reversal the bar
/// flows after 2 σ_y/√3 plus twice the increase by isotropic hardening; kinematic hardening adds
/// nothing. Tolerance: γ² of Green's strain.
#[test]
fn shear_to_and_fro() {
    let yield_stress = 240e6;
    for hardening in [[0.0, 0.0], [20e9, 0.0], [0.0, 20e9], [8e9, 12e9]] {
        let mut block = bar(Some(Flow { yield_stress, hardening }));
        let [isotropic, kinematic] = hardening;
        let all = isotropic + kinematic;
        let (tau_y, most) = (yield_stress / 3.0_f64.sqrt(), 8e-3);
        let slope = MU * all / (3.0 * MU + all);
        let mut at = |gamma: f64| shear_stress(&mut block, gamma);
        let elastic = at(0.99 * tau_y / MU);
        assert!((elastic / (0.99 * tau_y) - 1.0).abs() < 1e-4, "{hardening:?} {elastic:e}");
        let expected = tau_y + slope * (most - tau_y / MU);
        let mut top = 0.0;
        for part in 1..=40 {
            top = at(most * f64::from(part) / 40.0);
        }
        assert!((top / expected - 1.0).abs() < 1e-3, "{hardening:?} {top:e} {expected:e}");
        // Elastic range after reversal; isotropic hardening has enlarged the yield surface.
        let wider = (expected - tau_y) * if all > 0.0 { isotropic / all } else { 0.0 };
        let range = 2.0 * (tau_y + wider);
        let back = at(most - 0.99 * range / MU);
        assert!((back - (top - 0.99 * range)).abs() < 2e-3 * range, "{hardening:?} {back:e}");
        let beyond = at(most - 1.5 * range / MU);
        let lowest = top - range - slope * 0.5 * range / MU;
        assert!((beyond - lowest).abs() < 3e-3 * range, "{hardening:?} {beyond:e} {lowest:e}");
    }
}

/// Plastic work is the supplied work minus the stored energy, to first order in the steps of the
/// path.
#[test]
fn work_is_kept_or_flows() {
    let yield_stress = 240e6;
    let mut errors = Vec::new();
    for count in [40, 80] {
        let mut block = bar(Some(Flow { yield_stress, hardening: [8e9, 12e9] }));
        let (mut done, mut last) = (0.0, 0.0);
        let step = 8e-3 / f64::from(count);
        for part in 1..=count {
            let stress = shear_stress(&mut block, step * f64::from(part));
            done += 0.5 * (stress + last) * step * 1e-9;
            last = stress;
        }
        let [flowed, grown] = block.plastic_work(8);
        let kept = 0.5 * last * last / MU * 1e-9;
        println!("done {done:.4e} J, flowed {flowed:.4e}, kept {kept:.4e}, κ {grown:.4e}");
        assert!(flowed > kept && grown > 0.0);
        errors.push(((flowed + kept) / done - 1.0).abs());
    }
    assert!(errors[0] < 1e-2 && errors[1] < 0.6 * errors[0] + 1e-4, "{errors:?}");
}

/// A material that never yields is elastic. Tolerance: rounding of deviators.
#[test]
fn below_the_yield_stress_it_is_elastic() {
    let mut one = bar(Some(Flow { yield_stress: 1e12, hardening: [0.0; 2] }));
    let mut other = bar(None);
    for gamma in [1e-4, -3e-4, 2e-3] {
        let (a, b) = (shear_stress(&mut one, gamma), shear_stress(&mut other, gamma));
        assert!((a / b - 1.0).abs() < 1e-12, "{a:e} {b:e}");
    }
    assert_eq!(one.plastic_work(8), [0.0; 2]);
}

/// A bar with uniform shares of stiffness and yield stress equals a bar with that stiffness, those
/// hardening moduli and that yield stress. Tolerance: rounding.
#[test]
fn softer_is_less_stiff_and_yields_sooner() {
    let [stiffness, yields] = [0.75, 0.5];
    let flow = Flow { yield_stress: 240e6, hardening: [8e9, 12e9] };
    let mut warm = bar(Some(flow));
    warm.soften(|_, _, _| Ok::<_, ()>([stiffness, yields])).unwrap();
    let softer = Flow {
        yield_stress: yields * flow.yield_stress,
        hardening: flow.hardening.map(|modulus| stiffness * modulus),
    };
    let solid =
        Solid { lame: warm.solid.lame.map(|l| stiffness * l), flow: Some(softer), ..warm.solid };
    let mut other = Block::new(16, 1e-3, warm.section.clone(), solid, Support::Nothing);
    for part in [0.3, 1.0, 4.0, -2.0, 6.0] {
        let gamma = part * 1e-3;
        let (a, b) = (shear_stress(&mut warm, gamma), shear_stress(&mut other, gamma));
        assert!((a / b - 1.0).abs() < 1e-12, "{part}: {a:e} {b:e}");
    }
    assert!(warm.plastic_work(8)[1] > 1e-3);
    let (one, two) = (warm.elastic_energy(), other.elastic_energy());
    assert!((one[0] / two[0] - 1.0).abs() < 1e-12, "{one:?} {two:?}");
}

/// Shares stay in place while the material moves back. Linear shares are interpolated exactly
/// between two columns, and so is the mean of both elements at a node. Tolerance: the stress along
/// the bar, γ²/2 of Green's strain, differs between both elements; a quarter of an element is 7e-3.
#[test]
fn shares_stay_in_their_place() {
    let share = |x: f64| 0.7 - 20.0 * x;
    let gamma = 1e-3;
    let cold = shear_stress(&mut bar(None), gamma);
    let mut block = bar(None);
    block
        .soften(|x, y, depth| {
            assert!((y - 0.5e-3).abs() < 1e-15 && (depth - 1e-3).abs() < 1e-15);
            Ok::<_, ()>([share(x), 1.0])
        })
        .unwrap();
    for way in [0.0, 0.25e-3, 0.5e-3, 0.3e-3] {
        block.travel(way);
        let stress = shear_stress(&mut block, gamma);
        let expected = share(block.place(8)) * cold;
        assert!((stress / expected - 1.0).abs() < 1e-4, "{way}: {stress:e} {expected:e}");
    }
    assert!(block.soften(|_, _, _| Err("beyond")).is_err());
}

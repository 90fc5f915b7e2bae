//! Slip zones below the size of an element, against Carter's strip and finer grids.

use half_space::aligned::{AlignedGrid, Chord};
use half_space::difference::Difference;
use half_space::extent::elliptic;
use half_space::grid_continuation::{Contact, Levels, Motion};
use half_space::slip_zone::{SlippingRows, TrailingZone};
use half_space::tangential::PrescribedMotion;
use half_space::{Elasticity, Material, Structured};

const SPEED: f64 = 3.0;

fn body() -> Material {
    Material { youngs_modulus: 2.56, poisson_ratio: 0.28 }
}

fn elasticity() -> Elasticity {
    Elasticity::of_pair(&body(), &body())
}

/// Slip zones of the rows and the friction power on the grid [W/m²] under a creepage, for a
/// traction bound with the maximum 1 on an ellipse.
fn roll(
    grid: Structured,
    semi_axes: [f64; 2],
    creepage: [f64; 3],
) -> (Vec<Option<TrailingZone>>, Vec<f64>) {
    let rows = AlignedGrid::of_ellipse(grid, semi_axes);
    let bound = elliptic(&rows, semi_axes);
    let contact = Contact {
        bodies: elasticity().into(),
        layer: 0.0,
        yields: None,
        semi_axes,
        motion: Motion::SteadyRolling,
        difference: Difference::Fromm,
        tolerance: 1e-8,
    };
    let mut levels = Levels::of_rows(&rows, &contact);
    let solution = levels.solve(&bound, &PrescribedMotion::creepages(creepage));
    let state = solution.expect("partial slip of a regular contact").state;
    let [x, y] = &state.traction;
    let rate = SPEED / grid.dx();
    let mut power = levels.dissipation([x, y], &bound, SPEED).expect("Fromm's difference");
    for (at, power) in power.iter_mut().enumerate() {
        *power -= rate * (x[at] * state.slip[0][at] + y[at] * state.slip[1][at]);
    }
    let slipping = SlippingRows {
        rows: &rows,
        chords: &Chord::of_ellipse(&grid, semi_axes),
        state: &state,
        bound: &bound,
        elasticity: elasticity(),
        speed: SPEED,
    };
    let (zones, on_grid) = slipping.power_on_grid(&power);
    let [before, after] = [&power, &on_grid].map(|power| power.iter().sum::<f64>());
    assert!((after / before - 1.0).abs() < 1e-12, "{before} {after}");
    (zones, on_grid)
}

/// In Carter's strip (half-length 1, bound √(1 − x²), creepage C L/2) the slip zone has the width
/// L and the power V C (1 − x) √((x + 1)(L − 1 − x)), whether it is half an element wide or twelve.
/// Tolerances: the power of a strip errs by 0.5 % in narrow zones. In wider ones the border errs by
/// 0.1 elements, and the power beside it accordingly.
#[test]
fn zones_are_those_of_carters_strip() {
    for (component, compliance) in
        [elasticity().contact_compliance(), elasticity().shear_compliance].into_iter().enumerate()
    {
        for (tenths, elements) in (0..10).zip([0.5, 1.0, 1.3, 1.7, 2.0, 3.0, 4.0, 5.5, 8.0, 12.0]) {
            let side = 1.0 / (20.0 + 0.1 * f64::from(tenths));
            let grid = Structured::contact_plane(-24.0 * side, 0.0, side, 2.0, 49, 1);
            let width = elements * side;
            let mut creepage = [0.0; 3];
            creepage[component] = -compliance * width;
            let (zones, power) = roll(grid, [1.0; 2], creepage);
            let zone = zones[0].expect("a slip zone");
            let error = (zone.width() - width) / side;
            assert!(error.abs() < 0.03 * f64::max(1.0, 0.5 * elements), "{elements}: {error}");
            let density = |x: f64| {
                let roots = ((x + 1.0) * (width - 1.0 - x)).max(0.0).sqrt();
                SPEED * 2.0 * compliance * (1.0 - x) * roots
            };
            let mean = |x: f64| {
                let parts = (0..400).map(|k| x + side * ((f64::from(k) + 0.5) / 400.0 - 0.5));
                parts.map(density).sum::<f64>() / 400.0
            };
            let means: Vec<f64> = (0..49).map(|i| mean(grid.x(i))).collect();
            let largest = means.iter().copied().fold(0.0, f64::max);
            let errors = means.iter().zip(&power).map(|(mean, power)| (power - mean).abs());
            let worst = errors.fold(0.0, f64::max) / largest;
            println!("{component} {elements}: border {error:.3} elements, power {worst:.4}");
            assert!(worst < 0.03, "{elements}: {worst}");
        }
    }
}

/// On an ellipse, widths and powers of the rows are those of a grid eight times as fine along x,
/// also where the zone is hardly wider than an element and the edge is inclined. Rows with little
/// power do not count. Tolerances: the ragged trailing edge, which makes rows err in turn.
#[test]
fn narrow_zones_on_an_ellipse_are_those_of_a_fine_grid() {
    let axes = [1.0, 0.75];
    for creepage in [[-0.04, 0.0, 0.0], [0.0, -0.04, 0.0], [0.02, -0.03, 0.0], [0.0, 0.0, 0.06]] {
        let [coarse, fine] = [20.0, 160.0].map(|count| {
            let side = 1.0 / count;
            let half = count + 3.0;
            let columns = 2 * half as usize + 1;
            let grid = Structured::contact_plane(-half * side, -0.825, side, 0.05, columns, 34);
            roll(grid, axes, creepage).0
        });
        let total: f64 = fine.iter().flatten().map(|zone| zone.power).sum();
        let mut largest = [0.0_f64; 2];
        for (coarse, fine) in coarse.iter().zip(&fine) {
            if let (Some(coarse), Some(fine)) = (coarse, fine)
                && fine.power > 0.03 * total
            {
                let errors = [coarse.width() / fine.width(), coarse.power / fine.power];
                let errors = errors.map(|ratio| (ratio - 1.0).abs());
                largest.iter_mut().zip(errors).for_each(|(most, error)| *most = most.max(error));
            }
        }
        println!("{creepage:?}: errors of widths and powers {largest:.3?}");
        assert!(largest[0] < 0.08 && largest[1] < 0.09, "{creepage:?}: {largest:?}");
    }
}

//! Fields of the contact as element means.
//!
//! A cell's values are distributed over the elements it covers, in proportion to the area: along x
//! over [x_rear, x_front], along y over the band of its strip. The sum over the elements times
//! their area therefore equals the sum over the cells, to rounding, for forces and heat.

use super::contact::FastsimContact;
use crate::models::power_balance::power_density;
use crate::terms::Terms;
use elastic::fastsim::integration::{Cell, Strip};
use elastic::fastsim::overlaps::overlaps;
use proto::field::{self, FieldSpec};
use proto::grid::Structured;

/// Writes the values of a field that the model or one of its effects provides, component-major.
pub(super) fn write(
    spec: &FieldSpec,
    contact: &FastsimContact,
    grid: Structured,
    terms: &Terms,
    values: &mut [f64],
) {
    let speeds = contact.problem.speeds;
    let speed = speeds.rolling;
    let at_speed = |value: f64| speed * value;
    values.fill(0.0);
    match *spec {
        field::PRESSURE => contact.problem.ellipse.write_pressure(grid, values),
        field::TRACTION => spread(contact, grid, values, |cell| cell.traction),
        field::SLIP_VELOCITY => {
            spread(contact, grid, values, |cell| cell.slip.map(at_speed));
        }
        field::FRICTION_POWER => {
            let power = |cell: &Cell| [at_speed(power_density(cell.traction, cell.slip))];
            spread(contact, grid, values, power);
            terms.keep_heat(values);
        }
        field::SURFACE_SPEED => {
            values.copy_from_slice(&speeds.of_surfaces(contact.creepage[0]));
        }
        field::CONTACT_FORCE => values.copy_from_slice(&contact.force()),
        _ => unreachable!("a field without provider is refused earlier: {}", spec.name),
    }
}

/// Distributes a quantity of the cells over the elements.
fn spread<const N: usize>(
    contact: &FastsimContact,
    grid: Structured,
    means: &mut [f64],
    quantity: impl Fn(&Cell) -> [f64; N],
) {
    let mut row = vec![[0.0; N]; grid.ni];
    for (strip, cells) in contact.strips() {
        row.fill([0.0; N]);
        cells.iter().for_each(|cell| add_cell(cell, quantity(cell), &grid, &mut row));
        add_strip(strip, &row, &grid, means);
    }
}

/// Adds a cell's integral over x, divided by Δx, to the elements of a row.
fn add_cell<const N: usize>(
    cell: &Cell,
    quantity: [f64; N],
    grid: &Structured,
    row: &mut [[f64; N]],
) {
    // Position in units of Δx from the first element's rear edge.
    let place = |x: f64| x / grid.dx() + 0.5 * grid.ni as f64;
    overlaps(cell.ends.map(place), grid.ni, |column, share| {
        for (sum, value) in row[column].iter_mut().zip(quantity) {
            *sum += share * value;
        }
    });
}

/// Adds a strip's integrals over x to the rows of elements that it covers.
fn add_strip<const N: usize>(
    strip: &Strip,
    sums: &[[f64; N]],
    grid: &Structured,
    means: &mut [f64],
) {
    let place = |y: f64| y / grid.dy() + 0.5 * grid.nj as f64;
    let span = strip.span.map(place);
    // The strip is weighted with its width and distributed over its span.
    let scale = strip.width / (grid.dy() * (span[1] - span[0]));
    overlaps(span, grid.nj, |row, share| {
        for component in 0..N {
            let start = component * grid.points() + row * grid.ni;
            for (mean, sum) in means[start..start + grid.ni].iter_mut().zip(sums) {
                *mean += scale * share * sum[component];
            }
        }
    });
}

//! Area of a contact, resolved below the size of its elements.
//!
//! Elements cut by the edge carry pressure too, so the number of loaded elements overestimates the
//! area by first order. Near a smooth edge the pressure rises with the root of the distance, and
//! its square φ = p² rises linearly. The edge is where φ, extrapolated from the inside, is zero.
//! *Inner* elements, two deep in the contact, take φ from their pressure. Other elements that
//! contact connects to three inner elements in a row take the parabola through those three,
//! averaged over the directions that have them. At the centre of an open element φ is at most zero.
//! Between the centres φ is linear on triangles, and the area is where φ > 0.
//!
//! Small patches use inner elements one deep; patches of a few elements have none. There an element
//! of contact takes φ from its pressure, and an open neighbour takes the negative of it, which
//! places the edge midway. The same holds where the extrapolated edge lies well beyond the centre
//! of an open element: there the pressure does not fall with the root, as at a bound of the
//! pressure or in the part of a creeping contact that has touched last.
//!
//! Against Hertz's ellipses the error is below 1.1e-3 from 10 elements per semi-axis, where
//! counting errs by 1 to 4 %, and below 4e-4 from 40. The remaining error is of first order: the
//! edge disturbs the pressure to a depth of some elements, which moves the detected edge by less
//! than a hundredth of an element. Second order would need pressures from ever deeper, and with
//! them the shape of the whole patch.

use grids::Structured;

/// Farthest element from the first inner one to which φ is extrapolated.
const REACH: i64 = 4;

/// Distance beyond the centre of an open element, in elements, from which on an extrapolated edge
/// is discarded. In an elastic contact the extrapolation errs by a hundredth.
const BEYOND: f64 = 0.1;

/// The eight directions in which elements have neighbours.
const DIRECTIONS: [[i64; 2]; 8] =
    [[1, 0], [-1, 0], [0, 1], [0, -1], [1, 1], [1, -1], [-1, 1], [-1, -1]];

/// Contact area of a pressure [m²].
#[must_use]
pub fn contact_area(grid: &Structured, pressure: &[f64]) -> f64 {
    if grid.nj == 1 {
        return contact_length(pressure) * grid.element_area();
    }
    let level = Level::of(grid, pressure);
    let (nx, ny) = (grid.ni as i64, grid.nj as i64);
    // Squares between centres, including one element beyond each side of the grid.
    let cells = (-1..ny).flat_map(|j| (-1..nx).map(move |i| (i, j)));
    let share: f64 = cells.map(|(i, j)| level.share_above_zero(i, j)).sum();
    share * grid.element_area()
}

/// Length of a line contact, in elements.
fn contact_length(pressure: &[f64]) -> f64 {
    let runs = pressure.split(|p| *p <= 0.0).filter(|run| !run.is_empty());
    runs.map(|run| {
        let mirrored: Vec<f64> = run.iter().rev().copied().collect();
        run.len() as f64 - beyond_edge(run) - beyond_edge(&mirrored)
    })
    .sum()
}

/// Length of the loaded elements beyond the edge at the start of a run, in elements.
fn beyond_edge(run: &[f64]) -> f64 {
    let [_, _, first, second, third, _, ..] = run else { return 0.0 };
    let [first, second, third] = [first, second, third].map(|p| p * p);
    // Parabola through three inner elements, as a function of the distance from the first.
    let [slope, bend] = [second - first, 0.5 * (third - 2.0 * second + first)];
    let at = |s: f64| first + s * (slope - bend) + s * s * bend;
    // Searches between the first inner element and two elements outside the run.
    let edge = (-4..=-1).rev().map(f64::from).find(|s| at(*s) <= 0.0).map_or(-4.0, |outer| {
        let [low, high] = [at(outer), at(outer + 1.0)];
        outer - low / (high - low)
    });
    edge + 2.5
}

/// φ at the centres of a grid, relative to its largest value.
struct Level {
    nx: i64,
    ny: i64,
    values: Vec<f64>,
}

impl Level {
    fn of(grid: &Structured, pressure: &[f64]) -> Self {
        let largest = pressure.iter().copied().fold(0.0, f64::max);
        let square = |p: &f64| if largest > 0.0 { (p.max(0.0) / largest).powi(2) } else { 0.0 };
        let (nx, ny) = (grid.ni as i64, grid.nj as i64);
        let raw = Self { nx, ny, values: pressure.iter().map(square).collect() };
        let centres = || (0..ny).flat_map(|j| (0..nx).map(move |i| [i, j]));
        let deep = |level: &Self| -> Vec<f64> {
            centres().map(|at| f64::from(u8::from(level.is_surrounded(at)))).collect()
        };
        let once = Self { nx, ny, values: deep(&raw) };
        let twice = Self { nx, ny, values: deep(&once) };
        let values = centres().map(|at| raw.continued(at, [&twice, &once])).collect();
        Self { nx, ny, values }
    }

    /// φ at an element; zero outside the grid.
    fn at(&self, [i, j]: [i64; 2]) -> f64 {
        let inside = (0..self.nx).contains(&i) && (0..self.ny).contains(&j);
        if inside { self.values[(j * self.nx + i) as usize] } else { 0.0 }
    }

    /// Returns true if φ is above zero in an element and its eight neighbours.
    fn is_surrounded(&self, [i, j]: [i64; 2]) -> bool {
        let touches = |[di, dj]: &[i64; 2]| self.at([i + di, j + dj]) > 0.0;
        self.at([i, j]) > 0.0 && DIRECTIONS.iter().all(touches)
    }

    /// φ of an element: its own, or extrapolated from the deepest inner elements nearby.
    fn continued(&self, at: [i64; 2], inner: [&Self; 2]) -> f64 {
        let own = self.at(at);
        if inner[0].at(at) > 0.0 {
            return own;
        }
        match (inner.iter().find_map(|inner| self.seen_from_inside(at, inner)), own > 0.0) {
            (Some([value, _]), true) => value,
            (Some([value, inside]), false) if value > BEYOND * (inside - value) => -inside.abs(),
            (Some([value, _]), false) => value.min(0.0),
            (None, true) => own,
            (None, false) => {
                let beside = DIRECTIONS.iter().map(|[di, dj]| self.at([at[0] + di, at[1] + dj]));
                -beside.fold(0.0, f64::max)
            }
        }
    }

    /// φ extrapolated from inner elements to an element and to its inner neighbour, averaged over
    /// the directions; `None` without inner elements.
    fn seen_from_inside(&self, [i, j]: [i64; 2], inner: &Self) -> Option<[f64; 2]> {
        let along = |[di, dj]: &[i64; 2]| {
            let place = |steps: i64| [i + steps * di, j + steps * dj];
            let first = (1..=REACH).find(|steps| inner.at(place(*steps)) > 0.0)?;
            let contact_leads_there = (1..first).all(|steps| self.at(place(steps)) > 0.0);
            let row = [0, 1, 2].map(|more| place(first + more));
            (contact_leads_there && row.iter().all(|at| inner.at(*at) > 0.0)).then(|| {
                let [a, b, c] = row.map(|at| self.at(at));
                let at = |steps: f64| {
                    a + steps * (a - b) + 0.5 * steps * (steps + 1.0) * (a - 2.0 * b + c)
                };
                [at(first as f64), at(first as f64 - 1.0)]
            })
        };
        let found: Vec<[f64; 2]> = DIRECTIONS.iter().filter_map(along).collect();
        let mean = |k: usize| found.iter().map(|of| of[k]).sum::<f64>() / found.len() as f64;
        (!found.is_empty()).then(|| [0, 1].map(mean))
    }

    /// Share of the square between four centres, with (i, j) and (i + 1, j + 1) at its corners, in
    /// which φ is above zero. The square is split into four triangles that meet in the middle.
    fn share_above_zero(&self, i: i64, j: i64) -> f64 {
        let corners = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]].map(|at| self.at(at));
        let middle = 0.25 * corners.iter().sum::<f64>();
        let triangle = |k: usize| share_of_triangle([corners[k], corners[(k + 1) % 4], middle]);
        0.25 * (0..4).map(triangle).sum::<f64>()
    }
}

/// Share of a triangle in which a linear function with these corner values is above zero.
fn share_of_triangle(mut corners: [f64; 3]) -> f64 {
    corners.sort_by(f64::total_cmp);
    let [low, middle, high] = corners;
    match (low > 0.0, middle > 0.0, high > 0.0) {
        (true, ..) => 1.0,
        (_, true, _) => 1.0 - low * low / ((low - middle) * (low - high)),
        (.., true) => high * high / ((high - middle) * (high - low)),
        _ => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A straight edge between elements, at an element's edge and at a centre: triangles are exact.
    #[test]
    fn shares_of_triangles() {
        for (corners, share) in [
            ([1.0, 2.0, 3.0], 1.0),
            ([-1.0, -2.0, 0.0], 0.0),
            ([1.0, -1.0, -1.0], 0.25),
            ([-1.0, 1.0, 1.0], 0.75),
            ([0.0, 1.0, -1.0], 0.5),
            ([0.0, 0.0, 1.0], 1.0),
            ([0.0, 0.0, 0.0], 0.0),
        ] {
            assert!((share_of_triangle(corners) - share).abs() < 1e-15, "{corners:?}");
        }
    }

    /// The root of the distance from the edge of a circle, at any position on the grid. The
    /// triangles alone cause an error, of second order.
    #[test]
    fn a_smooth_edge_is_found_with_the_second_order() {
        for (x, y) in [(0.0, 0.0), (0.31, 0.17), (0.5, 0.5)] {
            for elements in [8.0_f64, 16.0, 32.0] {
                let side = 1.0 / elements;
                let (n, first) = (2 * elements as usize + 7, -1.0 - 3.0 * side);
                let grid = Structured::contact_plane(first, first, side, side, n, n);
                let pressure: Vec<f64> = (0..n * n)
                    .map(|at| [grid.x(at % n) - x * side, grid.y(at / n) - y * side])
                    .map(|[x, y]| (1.0 - x * x - y * y).max(0.0).sqrt())
                    .collect();
                let error = contact_area(&grid, &pressure) / std::f64::consts::PI - 1.0;
                assert!(error.abs() < 0.4 * side * side, "{elements} {x}: {error:e}");
            }
        }
    }

    /// No contact, one element, and two separate patches.
    #[test]
    fn small_patches() {
        let grid = Structured::contact_plane(0.0, 0.0, 1.0, 1.0, 23, 11);
        let mut pressure = vec![0.0; grid.points()];
        assert_eq!(contact_area(&grid, &pressure), 0.0);
        pressure[5 * 23 + 2] = 7.0;
        let one = contact_area(&grid, &pressure);
        assert!((0.3..=1.0).contains(&one), "{one}");
        pressure[5 * 23 + 2] = 0.0;
        let bump = |x: f64, y: f64, r: f64| (r * r - x * x - y * y).max(0.0).sqrt();
        let mut of = |places: &[f64]| {
            for (at, p) in pressure.iter_mut().enumerate() {
                let (x, y) = (grid.x(at % 23), grid.y(at / 23));
                *p = places.iter().map(|place| bump(x - place, y - 5.0, 4.4)).fold(0.0, f64::max);
            }
            contact_area(&grid, &pressure)
        };
        let (left, both) = (of(&[5.0]), of(&[5.0, 17.0]));
        assert!((both / left - 2.0).abs() < 1e-9, "{left} {both}");
        assert!((left / (std::f64::consts::PI * 4.4 * 4.4) - 1.0).abs() < 0.02, "{left}");
    }
}

use super::*;

const DEPTHS: [f64; 5] = [0.0, 0.03, 0.2, 0.9, 4.0];

/// Pressure and tractions without symmetry; some rows and columns are unloaded.
fn loads(grid: &Structured, seed: u64) -> (Vec<f64>, Vec<f64>) {
    let points = grid.points();
    let free = |index: usize| (index / grid.ni) % 5 == 2 || index % grid.ni == 1;
    let masked = |mut values: Vec<f64>| {
        values.iter_mut().enumerate().for_each(|(at, value)| {
            if free(at % points) {
                *value = 0.0;
            }
        });
        values
    };
    (masked(noise(points, seed)), masked(noise(2 * points, seed + 1)))
}

fn direct(load: &SurfaceLoad<'_>, y: f64, depths: &[f64]) -> Vec<Stress> {
    let columns = 0..load.grid.ni;
    let row = |depth: &f64| columns.clone().map(move |i| (i, *depth)).collect::<Vec<_>>();
    let points = depths.iter().flat_map(row).map(|(i, depth)| [load.grid.x(i), y, depth]);
    load.stresses_at(0.3, &points.collect::<Vec<_>>())
}

/// Sections on a row, between rows, at an arbitrary position and beside the grid. Tolerance:
/// rounding of transforms and of sums over some hundred elements.
#[test]
fn equals_the_direct_sum() {
    for (nx, ny) in [(1, 1), (1, 7), (8, 1), (13, 10), (31, 17)] {
        let grid = Structured::contact_plane(-0.7, 0.4, 0.1, 0.15, nx, ny);
        let (pressure, traction) = loads(&grid, nx as u64);
        let middle = 0.5 * (grid.y(0) + grid.y(ny - 1));
        for y in [middle, grid.y(ny / 3), middle + 0.04, grid.y(0) - 0.225, 9.0] {
            let mut section = Section::new(&grid, 0.3, y, &DEPTHS);
            let mut stresses = vec![Stress::default(); section.points()];
            // Solves twice, to detect state left in the working memory.
            for traction in [&traction[..], &[]] {
                let load = SurfaceLoad::new(&grid, &pressure, traction);
                section.stresses(&load, &mut stresses);
                for (stress, expected) in stresses.iter().zip(direct(&load, y, &DEPTHS)) {
                    let error = largest(&(*stress - expected));
                    assert!(error < 1e-13, "{nx} x {ny} at {y}: {error:e}");
                }
            }
        }
    }
}

/// Von Mises and largest shear stresses equal those of the tensors.
#[test]
fn equivalents_are_those_of_the_stresses() {
    let grid = Structured::contact_plane(0.0, 0.0, 0.1, 0.1, 9, 6);
    let (pressure, traction) = loads(&grid, 5);
    let load = SurfaceLoad::new(&grid, &pressure, &traction);
    let mut section = Section::new(&grid, 0.25, 0.25, &DEPTHS);
    let mut stresses = vec![Stress::default(); section.points()];
    let (mut von_mises, mut max_shear) = (vec![0.0; stresses.len()], vec![0.0; stresses.len()]);
    let effort = section.stresses(&load, &mut stresses);
    assert_eq!(section.equivalents(&load, None, &mut von_mises, &mut max_shear), effort);
    for ((stress, mises), shear) in stresses.iter().zip(von_mises).zip(max_shear) {
        assert_eq!((stress.von_mises(), stress.max_shear()), (mises, shear));
        assert!(mises > 0.0);
    }
}

/// Cost of a section: zero loads cost nothing, rows at the same distance are computed once, and
/// lines of corners between rows are shared.
#[test]
fn work_of_a_section() {
    let grid = Structured::contact_plane(-2.0, -1.0, 0.1, 0.1, 40, 20);
    let mut pressure = vec![1.0; 800];
    pressure[..4 * 40].fill(0.0);
    pressure[16 * 40..].fill(0.0);
    let traction: Vec<f64> = [pressure.clone(), vec![0.0; 800]].concat();
    let depths = [0.1, 0.2, 0.3];
    // Twelve rows are loaded; seen from halfway between rows, they are six pairs.
    for (y, rows) in [(-0.05, 6), (-0.03, 12)] {
        for (traction, kinds) in [(&traction[..], 2), (&[], 1)] {
            let load = SurfaceLoad::new(&grid, &pressure, traction);
            let mut section = Section::new(&grid, 0.3, y, &depths);
            let effort = section.stresses(&load, &mut vec![Stress::default(); section.points()]);
            let corners = depths.len() * (rows + 1) * 41;
            let transforms = depths.len() * (4 * kinds * rows + 6) + 2 * kinds * rows;
            assert_eq!(effort, SectionCost { corners, transforms });
        }
    }
}

#[test]
#[should_panic(expected = "another grid")]
fn refuses_a_load_on_another_grid() {
    let grid = Structured::contact_plane(0.0, 0.0, 0.1, 0.1, 3, 2);
    let other = Structured { ni: 2, nj: 3, ..grid };
    let mut section = Section::new(&grid, 0.3, 0.0, &[0.1]);
    section.stresses(&SurfaceLoad::new(&other, &[0.0; 6], &[]), &mut [Stress::default(); 3]);
}

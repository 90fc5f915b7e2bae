//! Grids of any size.

use super::bench::Bench;
use super::check::Check;
use super::fault::{Fault, Seen};
use super::solving::same;

pub(super) const GROWING_GRIDS: Check = Check {
    name: "growing-grids",
    demand: "inputs on grids from 8 x 6 to 512 x 384 elements all work; outputs have the sizes of the \
             layout",
    fix: "sizes come from the configuration; nothing has a fixed length",
    run: growing,
};

/// Elements of the grids over the patch of the case.
const SIZES: [[usize; 2]; 4] = [[8, 6], [32, 24], [128, 96], [512, 384]];

/// Those of them that are asked for.
fn sizes(bench: &Bench) -> &'static [[usize; 2]] {
    if bench.quick { &SIZES[..2] } else { &SIZES }
}

/// The largest of them.
pub(super) fn largest(bench: &Bench) -> [usize; 2] {
    sizes(bench)[sizes(bench).len() - 1]
}

// A grid that moves in mid-run would be one more check here: the same setting, the same numbers of
// elements, and a new geometry with every window.

fn growing(bench: &Bench) -> Result<Seen, Fault> {
    bench.each(|setting| {
        let mut points = Vec::new();
        for &size in sizes(bench) {
            let Some(setting) = setting.resized(size) else {
                return Seen::inapplicable("no input has a grid that can be refined");
            };
            let place = format!("{} x {} elements", size[0], size[1]);
            let mut life = bench.joined()?;
            // That outputs have the sizes of the layout is part of what every sample is checked for.
            let (layout, _) = life.prepare(&setting).map_err(|fault| fault.at(&place))?;
            let step = setting.step(0);
            let mut solve = || life.solve_with(&step, 0).map_err(|fault| fault.at(&place));
            let first = solve()?.outputs;
            if setting.rewinds && size == largest(bench) {
                same(&solve()?.outputs, &first, &place)?;
            }
            points.push(layout.grids.iter().map(contract::grid::Grid::points).sum::<usize>());
        }
        let points: Vec<String> = points.iter().map(usize::to_string).collect();
        Seen::kept(format!("own grids of {} points", points.join(", ")))
    })
}

//! Volumes: announced by their elements, with a geometry that follows.

use super::bench::Bench;
use super::check::Check;
use super::fault::{Fault, Seen};

pub(super) const VOLUMES: Check = Check {
    name: "volumes",
    demand: "Initialise publishes the geometry of every volume that a field of the run is on, before \
             its reply: rising axes or vertices that exist, elements with a positive volume; fields \
             on it name its revision",
    fix: "the layout of the geometry, component by component; corners in VTK's order",
    run: volumes,
};

fn volumes(bench: &Bench) -> Result<Seen, Fault> {
    bench.each(|setting| {
        let mut life = bench.ready(setting)?;
        let step = life.next(setting);
        life.solve_with(&step, 0)?;
        life.accept(&step, true)?;
        let seen: Vec<String> = life
            .volumes()
            .map(|grid| format!("{} ({} elements)", grid.name, grid.points()))
            .collect();
        bench.keep(setting, life);
        match seen.is_empty() {
            true => Seen::inapplicable("it has no field on a volume"),
            false => Seen::kept(seen.join(", ")),
        }
    })
}

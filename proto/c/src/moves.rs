//! Geometry of moving grids and of volumes, as supplied by C.

use crate::fault::{Fault, call, exclusive, guard, text};
use proto::grid::Grid;
use std::ffi::{c_char, c_int};

/// Grids whose geometry a program may supply: moving grids and volumes.
pub struct CosimMoves<'a> {
    followed: &'a Followed,
    given: Vec<(usize, u64, Vec<f64>)>,
}

/// Grids of a run whose geometry is needed, in the accepted state.
pub(crate) struct Followed {
    pub(crate) grids: Vec<Grid>,
    /// Names of the other grids of the layout.
    others: Vec<String>,
}

impl Followed {
    /// Sorts the grids of a layout by whether their geometry is needed.
    pub(crate) fn among(grids: &[Grid], is_needed: impl Fn(&Grid) -> bool) -> Self {
        let (grids, others): (Vec<_>, Vec<_>) = grids.iter().cloned().partition(is_needed);
        Self { grids, others: others.into_iter().map(|grid| grid.name).collect() }
    }

    /// Asks a program for the geometry of these grids, if there are any.
    pub(crate) fn ask(
        &mut self,
        moved_grids: impl FnOnce(*mut CosimMoves<'_>) -> c_int,
    ) -> Result<(), Fault> {
        if self.grids.is_empty() {
            return Ok(());
        }
        let mut moves = CosimMoves { followed: self, given: Vec::new() };
        call("moved_grids", || moved_grids(&raw mut moves))?;
        for (index, revision, values) in moves.given {
            let grid = &mut self.grids[index];
            *grid = grid.with_geometry(&values, revision).map_err(Fault::Failed)?;
        }
        Ok(())
    }
}

/// Returns the buffer for the geometry of a grid in a revision: vectors of three components [m],
/// component-major (all first components, then all second, then all third). Every value must be
/// written. Returns NULL, and a count of 0, if the geometry is already known or nobody needs it.
///
/// Structured: origin, step_i, step_j and (ni, nj, 1). Quadrilaterals: the vertices. Volume: see
/// cosim_volume. Writes the number of values; `count` may be NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cosim_geometry(
    moves: *mut CosimMoves<'_>,
    grid: *const c_char,
    revision: u64,
    count: *mut usize,
) -> *mut f64 {
    guard("cosim_geometry", || {
        // SAFETY: the header requires moves, a string, and room or NULL.
        let (moves, name) = unsafe {
            if !count.is_null() {
                count.write(0);
            }
            (exclusive("moves", moves)?, text("grid", grid)?)
        };
        let Followed { grids, others } = moves.followed;
        let Some(index) = grids.iter().position(|grid| grid.name == name) else {
            if others.iter().any(|other| other == name) {
                return Ok(std::ptr::null_mut());
            }
            return Err(Fault::Misused(format!("there is no grid `{name}` in the layout")));
        };
        let grid = &grids[index];
        if revision == grid.revision && !grid.is_announced() {
            return Ok(std::ptr::null_mut());
        }
        // Unwritten values stay NaN, which the check of the grid reports.
        let mut values = vec![f64::NAN; 3 * grid.geometry_points()];
        let (place, length) = (values.as_mut_ptr(), values.len());
        // The values keep their address when the list grows.
        moves.given.push((index, revision, values));
        if !count.is_null() {
            // SAFETY: not NULL, and the header requires room for one value.
            unsafe { count.write(length) };
        }
        Ok(place)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fault::COSIM_OK;
    use proto::grid::{Hexahedra, Structured};

    fn followed() -> Followed {
        let plane = |x| Structured::contact_plane(x, 0.0, 1.0, 1.0, 2, 1);
        let volume = Grid::volume("block", Hexahedra::Rectilinear { ni: 1, nj: 1, nk: 1 });
        let (moving, fixed) =
            (Grid::structured("patch", plane(0.0)), Grid::structured("rest", plane(9.0)));
        Followed::among(&[moving, volume, fixed], |grid| grid.name != "rest")
    }

    fn give(name: &std::ffi::CStr, revision: u64, values: &[f64]) -> Result<Followed, Fault> {
        let mut followed = followed();
        let asked = followed.ask(|moves| unsafe {
            let mut count = 9;
            let place = cosim_geometry(moves, name.as_ptr(), revision, &raw mut count);
            if place.is_null() {
                assert_eq!(count, 0);
                return COSIM_OK;
            }
            assert_eq!(count, values.len());
            place.copy_from_nonoverlapping(values.as_ptr(), count);
            COSIM_OK
        });
        asked.map(|()| followed)
    }

    const MOVED: [f64; 12] = [3.0, 1.0, 0.0, 2.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0];

    #[test]
    fn a_grid_moves_and_a_volume_gets_its_geometry() {
        let grids = give(c"patch", 2, &MOVED).unwrap().grids;
        assert_eq!(grids[0].as_structured().unwrap().origin[0], 3.0);
        assert_eq!((grids[0].revision, grids[1].is_announced()), (2, true));
        let nodes = [0.0, 1.0, 0.0, 1.0, 0.0, 1.0];
        let grids = give(c"block", 1, &nodes).unwrap().grids;
        assert_eq!((grids[0].revision, grids[1].is_announced()), (1, false));
    }

    #[test]
    fn a_geometry_that_is_known_or_not_needed_has_no_place() {
        assert_eq!(give(c"patch", 1, &[]).unwrap().grids, followed().grids);
        assert_eq!(give(c"rest", 2, &[]).unwrap().grids, followed().grids);
        let nobody = Followed::among(&[], |_| true).ask(|_| unreachable!("there is no grid"));
        assert_eq!(nobody, Ok(()));
    }

    #[test]
    fn a_wrong_geometry_is_reported() {
        let mut flat = MOVED;
        flat[1] = 0.0;
        for (name, revision, values, why) in [
            (c"elsewhere", 1, &MOVED[..], "there is no grid `elsewhere`"),
            (c"patch", 0, &MOVED, "revision 0 after 1"),
            (c"patch", 2, &flat, "without an area"),
            (c"block", 1, &[f64::NAN; 6], "is NaN"),
        ] {
            let fault = give(name, revision, values).map(|_| ()).unwrap_err().to_string();
            assert!(fault.contains(why), "{fault}");
        }
    }
}

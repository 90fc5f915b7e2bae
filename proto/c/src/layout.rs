//! Layout, as written by C: grids, placement of the fields, cost.

use crate::fault::{COSIM_OK, Fault, exclusive, guard, shared, text};
use crate::grid::CosimGrid;
use crate::volume::CosimVolume;
use proto::accuracy::Simplification;
use proto::configuration::{FieldOnGrid, Layout};
use std::ffi::{c_char, c_int};

/// Answer of configure: the program's grids, the grid of each field, and the expected cost.
#[derive(Default)]
pub struct CosimLayout {
    pub(crate) layout: Layout,
}

fn placed(
    field: *const c_char,
    grid: *const c_char,
    among: &mut Vec<FieldOnGrid>,
) -> Result<c_int, Fault> {
    // SAFETY: the header requires strings.
    let (field, grid) = unsafe { (text("field", field)?, text("grid", grid)?) };
    among.push(FieldOnGrid { field: field.to_owned(), grid: grid.to_owned() });
    Ok(COSIM_OK)
}

/// Sets the whole layout from JSON (docs/write-a-solver.md), for entries without a function of
/// their own. Returns COSIM_FAILED if the text is not a layout or is invalid, such as a grid
/// without area or a field on an unknown grid.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cosim_layout_json(layout: *mut CosimLayout, json: *const c_char) -> c_int {
    guard("cosim_layout_json", || {
        // SAFETY: the header requires a layout and a string.
        let (layout, json) = unsafe { (exclusive("layout", layout)?, text("json", json)?) };
        let wrong = |why: String| Fault::Failed(format!("the layout as JSON: {why}"));
        let given: Layout = serde_json::from_str(json).map_err(|error| wrong(error.to_string()))?;
        given.check().map_err(wrong)?;
        layout.layout = given;
        Ok(COSIM_OK)
    })
}

/// Adds a copy of a grid. Returns COSIM_FAILED if the grid is invalid: name, counts, elements
/// without area.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cosim_layout_grid(
    layout: *mut CosimLayout,
    grid: *const CosimGrid,
) -> c_int {
    guard("cosim_layout_grid", || {
        // SAFETY: the header requires a layout, and a grid whose pointers hold as many numbers as
        // it counts.
        let (layout, grid) =
            unsafe { (exclusive("layout", layout)?, shared("grid", grid)?.copied()?) };
        layout.layout.grids.push(grid);
        Ok(COSIM_OK)
    })
}

/// Adds a copy of a volume; `moved_grids` supplies its geometry. Returns COSIM_FAILED if the volume
/// is invalid: name, counts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cosim_layout_volume(
    layout: *mut CosimLayout,
    volume: *const CosimVolume,
) -> c_int {
    guard("cosim_layout_volume", || {
        // SAFETY: the header requires a layout and a volume.
        let (layout, volume) =
            unsafe { (exclusive("layout", layout)?, shared("volume", volume)?.announced()?) };
        layout.layout.grids.push(volume);
        Ok(COSIM_OK)
    })
}

/// Sets the grid of an output or observed field. Both names are copied.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cosim_layout_output(
    layout: *mut CosimLayout,
    field: *const c_char,
    grid: *const c_char,
) -> c_int {
    guard("cosim_layout_output", || {
        // SAFETY: the header requires a layout.
        let layout = unsafe { exclusive("layout", layout)? };
        placed(field, grid, &mut layout.layout.fields)
    })
}

/// Requests an input on one of the program's grids; the coordinator maps it there from the
/// producer's grid. Inputs without a request arrive on the grid of their producer. Both names are
/// copied.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cosim_layout_input(
    layout: *mut CosimLayout,
    field: *const c_char,
    grid: *const c_char,
) -> c_int {
    guard("cosim_layout_input", || {
        // SAFETY: the header requires a layout.
        let layout = unsafe { exclusive("layout", layout)? };
        placed(field, grid, &mut layout.layout.inputs)
    })
}

/// Sets the expected processor time of one solve [s] and the memory of the program's arrays [byte].
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cosim_layout_cost(
    layout: *mut CosimLayout,
    solve_seconds: f64,
    memory_bytes: u64,
) -> c_int {
    guard("cosim_layout_cost", || {
        // SAFETY: the header requires a layout.
        let layout = unsafe { exclusive("layout", layout)? };
        if !(solve_seconds >= 0.0 && solve_seconds.is_finite()) {
            return Err(Fault::Misused(format!("a solve takes {solve_seconds} s")));
        }
        layout.layout.solve_seconds = solve_seconds;
        layout.layout.memory_bytes = memory_bytes;
        Ok(COSIM_OK)
    })
}

/// Sets the expected processor time of `build` [s], from which the deadline for building follows.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cosim_layout_build_seconds(
    layout: *mut CosimLayout,
    build_seconds: f64,
) -> c_int {
    guard("cosim_layout_build_seconds", || {
        // SAFETY: the header requires a layout.
        let layout = unsafe { exclusive("layout", layout)? };
        if !(build_seconds >= 0.0 && build_seconds.is_finite()) {
            return Err(Fault::Misused(format!("building takes {build_seconds} s")));
        }
        layout.layout.build_seconds = build_seconds;
        Ok(COSIM_OK)
    })
}

/// Adds a simplification of the model in this particular case, with its expected relative error and
/// the origin of this number. Both texts are copied.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cosim_layout_left_out(
    layout: *mut CosimLayout,
    what: *const c_char,
    error: f64,
    source: *const c_char,
) -> c_int {
    guard("cosim_layout_left_out", || {
        // SAFETY: the header requires a layout and strings.
        let (layout, what, source) =
            unsafe { (exclusive("layout", layout)?, text("what", what)?, text("source", source)?) };
        if !(error >= 0.0 && error.is_finite()) {
            return Err(Fault::Misused(format!("`{what}` has an error of {error}")));
        }
        layout.layout.left_out.push(Simplification::always(what, error, source));
        Ok(COSIM_OK)
    })
}

/// Adds a quantity of the summary whose exact value is known in this case, by its dotted key, which
/// is copied.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cosim_layout_closed_form(
    layout: *mut CosimLayout,
    key: *const c_char,
    exact: f64,
) -> c_int {
    guard("cosim_layout_closed_form", || {
        // SAFETY: the header requires a layout and a string.
        let (layout, key) = unsafe { (exclusive("layout", layout)?, text("key", key)?) };
        if !exact.is_finite() {
            return Err(Fault::Misused(format!("the closed form of `{key}` is {exact}")));
        }
        layout.layout.closed_forms.insert(key.to_owned(), exact);
        Ok(COSIM_OK)
    })
}

/// Adds a line to the output of `coordinator plan`, on the model's view of the case. The text is
/// copied.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cosim_layout_remark(
    layout: *mut CosimLayout,
    remark: *const c_char,
) -> c_int {
    guard("cosim_layout_remark", || {
        // SAFETY: the header requires a layout and a string.
        let (layout, remark) = unsafe { (exclusive("layout", layout)?, text("remark", remark)?) };
        layout.layout.remarks.push(remark.to_owned());
        Ok(COSIM_OK)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fault::{COSIM_FAILED, call};
    use proto::grid::{Grid, Structured};
    use std::ptr::{null, null_mut};

    #[test]
    fn a_layout_in_parts() {
        let grid = Grid::structured("contact", Structured::contact_plane(0.0, 0.0, 1.0, 1.0, 2, 3));
        let mut layout = CosimLayout::default();
        let (to, view) = (&raw mut layout, CosimGrid::of(&grid));
        let (field, on) = (c"lower_temperature".as_ptr(), c"contact".as_ptr());
        let statuses = unsafe {
            [
                cosim_layout_grid(to, &raw const view),
                cosim_layout_output(to, field, on),
                cosim_layout_input(to, c"friction_power".as_ptr(), on),
                cosim_layout_cost(to, 1e-3, 800),
                cosim_layout_build_seconds(to, 2.5),
                cosim_layout_left_out(to, c"the wake".as_ptr(), 0.01, c"a study".as_ptr()),
                cosim_layout_closed_form(to, c"contact.area_m2".as_ptr(), 1e-4),
                cosim_layout_remark(to, c"coarse".as_ptr()),
            ]
        };
        assert_eq!(statuses, [COSIM_OK; 8]);
        let Layout { solve_seconds, memory_bytes, remarks, .. } = &layout.layout;
        let Layout { build_seconds, left_out, closed_forms, .. } = &layout.layout;
        assert_eq!((*build_seconds, closed_forms["contact.area_m2"]), (2.5, 1e-4));
        assert_eq!(*left_out, [Simplification::always("the wake", 0.01, "a study")]);
        assert_eq!((*solve_seconds, *memory_bytes, remarks.len()), (1e-3, 800, 1));
        assert_eq!(layout.layout.grid_of("lower_temperature"), Some(&grid));
        assert_eq!(layout.layout.input_grid("friction_power"), Some(&grid));
        assert_eq!(layout.layout.check(), Ok(()));
    }

    #[test]
    fn a_layout_as_json() {
        let grid = Grid::structured("contact", Structured::contact_plane(0.0, 0.0, 1.0, 1.0, 2, 3));
        let whole = Layout { moving: vec!["contact".to_owned()], ..Layout::default() };
        let whole = Layout { grids: vec![grid], seconds_per_second: 2.0, ..whole };
        let mut layout = CosimLayout::default();
        let to = &raw mut layout;
        let give = |json: &str| {
            let json = std::ffi::CString::new(json).unwrap();
            call("configure", || unsafe { cosim_layout_json(to, json.as_ptr()) })
        };
        give(&serde_json::to_string(&whole).unwrap()).unwrap();
        assert_eq!(layout.layout, whole);
        let nowhere = Layout { grids: Vec::new(), ..whole };
        for (json, why) in [
            ("[]", "the layout as JSON: "),
            (&serde_json::to_string(&nowhere).unwrap(), "`contact`"),
        ] {
            let fault = give(json).unwrap_err().to_string();
            assert!(fault.contains(why), "{fault}");
        }
    }

    #[test]
    fn null_and_nonsense_are_reported() {
        let mut layout = CosimLayout::default();
        let (to, word) = (&raw mut layout, c"x".as_ptr());
        let all = call("configure", || unsafe {
            let statuses = [
                cosim_layout_grid(null_mut(), null()),
                cosim_layout_grid(to, null()),
                cosim_layout_output(null_mut(), word, word),
                cosim_layout_output(to, null(), word),
                cosim_layout_input(to, word, null()),
                cosim_layout_cost(to, f64::NAN, 0),
                cosim_layout_build_seconds(to, -1.0),
                cosim_layout_left_out(to, word, f64::INFINITY, word),
                cosim_layout_closed_form(to, word, f64::NAN),
                cosim_layout_remark(to, null()),
            ];
            assert_eq!(statuses, [COSIM_FAILED; 10]);
            COSIM_OK
        });
        assert_eq!(all.unwrap_err().to_string(), "cosim_layout_grid: `layout` is NULL");
        assert_eq!(layout.layout, Layout::default());
    }

    /// Durations and errors that are negative, unbounded or no numbers.
    #[test]
    fn numbers_out_of_range_are_reported() {
        for number in [-1.0, f64::INFINITY, f64::NAN] {
            let mut layout = CosimLayout::default();
            let to = &raw mut layout;
            let all = call("configure", || unsafe {
                let statuses = [
                    cosim_layout_cost(to, number, 0),
                    cosim_layout_build_seconds(to, number),
                    cosim_layout_left_out(to, c"the wake".as_ptr(), number, c"a study".as_ptr()),
                ];
                assert_eq!(statuses, [COSIM_FAILED; 3], "{number}");
                COSIM_OK
            });
            assert!(all.is_err(), "{number}");
            assert_eq!(layout.layout, Layout::default());
        }
    }
}

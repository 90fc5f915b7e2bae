//! Inputs, outputs and state, as read and written in place by C.

use crate::fault::{COSIM_OK, Fault, exclusive, guard, shared, text};
use crate::grid::CosimGrid;
use proto::field::FieldSpec;
use proto::model::{Inputs, Outputs, StateError, StepError, first_non_finite};
use std::ffi::{c_char, c_int, c_void};
use std::io::{self, Read, Write};

/// The inputs of a solve.
pub struct CosimInputs<'a> {
    pub(crate) inputs: &'a dyn Inputs,
    pub(crate) fields: &'a [FieldSpec],
}

/// The outputs of a callback.
pub struct CosimOutputs<'a> {
    pub(crate) outputs: &'a mut dyn Outputs,
    pub(crate) fields: &'a [FieldSpec],
}

/// A state being written to or read from a file.
pub struct CosimBlob<'a>(pub(crate) Direction<'a>);

/// Direction in which a state is transferred.
pub(crate) enum Direction<'a> {
    Saving(&'a mut dyn Write),
    Restoring(&'a mut dyn Read),
}

/// Finds a field of this run by name.
///
/// # Safety
/// `name` must be NULL or a string.
unsafe fn find(fields: &[FieldSpec], name: *const c_char) -> Result<Option<&FieldSpec>, Fault> {
    // SAFETY: guaranteed by the caller.
    let name = unsafe { text("field", name)? };
    Ok(fields.iter().find(|field| field.name == name))
}

/// Writes a result, unless C passes NULL.
unsafe fn put<T>(into: *mut T, value: T) {
    if !into.is_null() {
        // SAFETY: not NULL, and the header requires room for one value.
        unsafe { into.write(value) };
    }
}

/// Returns the values of an input at the end of the window, component by component with one value
/// per element. The values are read in place and valid until the callback returns.
///
/// Writes the number of values and the current grid; both pointers may be NULL. Returns NULL, and a
/// count of 0, if the field does not arrive in this run.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cosim_input(
    inputs: *const CosimInputs<'_>,
    field: *const c_char,
    count: *mut usize,
    grid: *mut CosimGrid,
) -> *const f64 {
    guard("cosim_input", || {
        // SAFETY: the header requires inputs, a string, and room or NULL.
        unsafe {
            put(count, 0);
            let inputs = shared("inputs", inputs)?;
            let field = find(inputs.fields, field)?.and_then(|field| inputs.inputs.get(field));
            let Some(input) = field else { return Ok(std::ptr::null()) };
            put(count, input.values.len());
            if !grid.is_null() {
                grid.write(CosimGrid::of(input.grid));
            }
            Ok(input.values.as_ptr())
        }
    })
}

/// Returns the values of an input at the start of the window, as many as in cosim_input(). Within
/// the window the field varies linearly from these values to those of cosim_input(). Returns NULL
/// for a field that is constant within a window.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cosim_input_start(
    inputs: *const CosimInputs<'_>,
    field: *const c_char,
    count: *mut usize,
) -> *const f64 {
    guard("cosim_input_start", || {
        // SAFETY: the header requires inputs, a string, and room or NULL.
        unsafe {
            put(count, 0);
            let inputs = shared("inputs", inputs)?;
            let start = find(inputs.fields, field)?.and_then(|field| inputs.inputs.start(field));
            let Some(values) = start else { return Ok(std::ptr::null()) };
            put(count, values.len());
            Ok(values.as_ptr())
        }
    })
}

/// Returns a required input like cosim_input(): `count` values, all finite. Otherwise returns NULL
/// and records a reason that names the field, to be returned as COSIM_FAILED. This happens if the
/// field does not arrive, has another number of values, or holds a NaN or an infinity.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cosim_require_input(
    inputs: *const CosimInputs<'_>,
    field: *const c_char,
    count: usize,
) -> *const f64 {
    guard("cosim_require_input", || {
        // SAFETY: the header requires inputs and a string.
        let (inputs, name) = unsafe { (shared("inputs", inputs)?, text("field", field)?) };
        let spec = inputs.fields.iter().find(|field| field.name == name);
        let failed = |error: StepError| Fault::Failed(error.to_string());
        let missing = || failed(StepError::MissingInput { field: name.to_owned() });
        let values = spec.and_then(|spec| inputs.inputs.get(spec)).ok_or_else(missing)?.values;
        if values.len() != count {
            let got = values.len();
            return Err(Fault::Failed(format!("`{name}` has {got} values, not {count}")));
        }
        match first_non_finite(values) {
            Some(index) => {
                let (field, value) = (name.to_owned(), values[index]);
                Err(failed(StepError::NonFiniteInput { field, index, value }))
            }
            None => Ok(values.as_ptr()),
        }
    })
}

/// Returns the buffer for the values of an output, component by component with one value per
/// element, valid until the callback returns. Every value must be written: the buffer holds old
/// data, and an unwritten output fails the call. Writes the number of values; `count` may be NULL.
/// Returns NULL, and a count of 0, if nobody needs the field now.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cosim_output(
    outputs: *mut CosimOutputs<'_>,
    field: *const c_char,
    count: *mut usize,
) -> *mut f64 {
    guard("cosim_output", || {
        // SAFETY: the header requires outputs, a string, and room or NULL.
        unsafe {
            put(count, 0);
            let CosimOutputs { outputs, fields } = exclusive("outputs", outputs)?;
            let place = find(fields, field)?.and_then(|field| outputs.get(field));
            let Some(values) = place else { return Ok(std::ptr::null_mut()) };
            put(count, values.len());
            Ok(values.as_mut_ptr())
        }
    })
}

/// Appends `size` bytes to the state, for save.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cosim_blob_write(
    blob: *mut CosimBlob<'_>,
    bytes: *const c_void,
    size: usize,
) -> c_int {
    guard("cosim_blob_write", || {
        // SAFETY: the header requires a blob.
        let Direction::Saving(into) = &mut unsafe { exclusive("blob", blob)? }.0 else {
            return Err(Fault::Misused("this state is restored, not saved".to_owned()));
        };
        if size > 0 {
            // SAFETY: the header requires `size` bytes, and `size` is at least 1.
            let bytes =
                unsafe { std::slice::from_raw_parts(shared("bytes", bytes.cast::<u8>())?, size) };
            into.write_all(bytes).map_err(|error| Fault::Failed(error.to_string()))?;
        }
        Ok(COSIM_OK)
    })
}

/// Reads the next `size` bytes of the state, for restore, which must read all bytes. Returns
/// COSIM_FAILED and records a reason if there are fewer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cosim_blob_read(
    blob: *mut CosimBlob<'_>,
    bytes: *mut c_void,
    size: usize,
) -> c_int {
    guard("cosim_blob_read", || {
        // SAFETY: the header requires a blob and room for `size` bytes.
        unsafe { reading(blob, bytes, size, |from, bytes| from.read_exact(bytes))? };
        Ok(COSIM_OK)
    })
}

/// Reads at most `size` bytes of the state, for restore. Returns the number of bytes read, 0 at the
/// end of the state and on failure.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cosim_blob_read_some(
    blob: *mut CosimBlob<'_>,
    bytes: *mut c_void,
    size: usize,
) -> usize {
    guard("cosim_blob_read_some", || {
        // SAFETY: the header requires a blob and room for `size` bytes.
        unsafe { reading(blob, bytes, size, |from, bytes| from.read(bytes)) }
    })
}

/// Reads into `size` bytes with `read`.
///
/// # Safety
/// `blob` must be NULL or the library's, and `bytes` must be NULL or have room for `size` bytes.
unsafe fn reading<T: Default>(
    blob: *mut CosimBlob<'_>,
    bytes: *mut c_void,
    size: usize,
    read: impl FnOnce(&mut dyn Read, &mut [u8]) -> io::Result<T>,
) -> Result<T, Fault> {
    // SAFETY: guaranteed by the caller.
    let Direction::Restoring(from) = &mut unsafe { exclusive("blob", blob)? }.0 else {
        return Err(Fault::Misused("this state is saved, not restored".to_owned()));
    };
    if size == 0 {
        return Ok(T::default());
    }
    // SAFETY: the caller guarantees room for `size` bytes, at least 1; filled with zeros they are
    // initialised.
    let bytes = unsafe {
        let first = std::ptr::from_mut(exclusive("bytes", bytes.cast::<u8>())?);
        first.write_bytes(0, size);
        std::slice::from_raw_parts_mut(first, size)
    };
    read(*from, bytes).map_err(|error| Fault::Failed(StateError::from(error).0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fault::{COSIM_FAILED, call};
    use proto::field::{FRICTION_POWER, LOWER_TEMPERATURE, PRESSURE, SURFACE_SPEED};
    use proto::grid::{Grid, Structured};
    use proto::model::InputField;
    use std::ptr::{null, null_mut};

    struct Fields(Grid, Vec<f64>, Vec<f64>);

    fn fields() -> Fields {
        let shape = Structured::contact_plane(0.0, 0.0, 1.0, 1.0, 3, 1);
        Fields(Grid::structured("contact", shape), vec![1.0, 2.0, 3.0], vec![0.5; 3])
    }

    impl Inputs for Fields {
        fn get(&self, field: &FieldSpec) -> Option<InputField<'_>> {
            let here = field.name == FRICTION_POWER.name;
            here.then_some(InputField { values: &self.1, grid: &self.0 })
        }

        fn start(&self, field: &FieldSpec) -> Option<&[f64]> {
            (field.name == FRICTION_POWER.name).then_some(&self.2)
        }
    }

    impl Outputs for Fields {
        fn get(&mut self, field: &FieldSpec) -> Option<&mut [f64]> {
            (field.name == LOWER_TEMPERATURE.name).then_some(&mut self.1)
        }
    }

    const KNOWN: &[FieldSpec] = &[FRICTION_POWER, SURFACE_SPEED, LOWER_TEMPERATURE];

    #[test]
    fn values_are_where_they_were() {
        let mut here = fields();
        let inputs = CosimInputs { inputs: &here, fields: KNOWN };
        let (from, name) = (&raw const inputs, c"friction_power".as_ptr());
        let (mut count, mut grid) = (9, unsafe { std::mem::zeroed::<CosimGrid>() });
        unsafe {
            let values = cosim_input(from, name, &raw mut count, &raw mut grid);
            assert_eq!((values, count, grid.ni), (here.1.as_ptr(), 3, 3));
            assert_eq!(cosim_input(from, name, null_mut(), null_mut()), values);
            assert_eq!(cosim_require_input(from, name, 3), values);
            assert_eq!(cosim_input_start(from, name, null_mut()), here.2.as_ptr());
            for absent in [c"surface_speed", c"nonsense"] {
                count = 9;
                let absent = absent.as_ptr();
                assert!(cosim_input(from, absent, &raw mut count, null_mut()).is_null());
                assert_eq!(count, 0);
                assert!(cosim_input_start(from, absent, null_mut()).is_null());
            }
        }
        let place = here.1.as_ptr();
        let mut outputs = CosimOutputs { outputs: &mut here, fields: KNOWN };
        let to = &raw mut outputs;
        unsafe {
            let values = cosim_output(to, c"lower_temperature".as_ptr(), &raw mut count);
            assert_eq!((values.cast_const(), count), (place, 3));
            assert!(cosim_output(to, c"pressure".as_ptr(), &raw mut count).is_null());
            assert_eq!(count, 0);
        }
        assert_eq!(PRESSURE.name, "pressure");
    }

    #[test]
    fn a_required_input_is_checked() {
        let mut here = fields();
        here.1[1] = f64::NAN;
        let inputs = CosimInputs { inputs: &here, fields: KNOWN };
        for (name, count, why) in [
            (c"friction_power", 3, "input `friction_power` is not finite at index 1 (NaN)"),
            (c"friction_power", 4, "`friction_power` has 3 values, not 4"),
            (c"surface_speed", 2, "input `surface_speed` is missing"),
        ] {
            let fault = call("solve", || unsafe {
                assert!(cosim_require_input(&raw const inputs, name.as_ptr(), count).is_null());
                COSIM_FAILED
            });
            assert_eq!(fault.unwrap_err().to_string(), why);
        }
    }

    #[test]
    fn null_is_reported() {
        let here = fields();
        let inputs = CosimInputs { inputs: &here, fields: KNOWN };
        let name = c"friction_power".as_ptr();
        let misuses: [(&str, &dyn Fn()); 6] = [
            ("cosim_input: `inputs`", &|| unsafe {
                assert!(cosim_input(null(), name, null_mut(), null_mut()).is_null());
            }),
            ("cosim_input: `field`", &|| unsafe {
                assert!(cosim_input(&raw const inputs, null(), null_mut(), null_mut()).is_null());
            }),
            ("cosim_input_start: `inputs`", &|| unsafe {
                assert!(cosim_input_start(null(), name, null_mut()).is_null());
            }),
            ("cosim_require_input: `field`", &|| unsafe {
                assert!(cosim_require_input(&raw const inputs, null(), 3).is_null());
            }),
            ("cosim_output: `outputs`", &|| unsafe {
                assert!(cosim_output(null_mut(), name, null_mut()).is_null());
            }),
            ("cosim_blob_write: `blob`", &|| unsafe {
                assert_eq!(cosim_blob_write(null_mut(), null(), 0), COSIM_FAILED);
            }),
        ];
        for (what, misuse) in misuses {
            let fault = call("solve", || [misuse()].map(|()| COSIM_OK)[0]).unwrap_err();
            assert_eq!(fault, Fault::Misused(format!("{what} is NULL")));
        }
    }

    #[test]
    fn a_state_is_written_and_read_piece_by_piece() {
        let mut bytes = vec![7];
        let mut saving = CosimBlob(Direction::Saving(&mut bytes));
        let number = 1.5_f64;
        let from = (&raw const number).cast::<c_void>();
        unsafe {
            let to = &raw mut saving;
            assert_eq!(cosim_blob_write(to, from, 8), COSIM_OK);
            assert_eq!(cosim_blob_write(to, null(), 0), COSIM_OK);
            assert!(call("save", || cosim_blob_write(to, null(), 1)).is_err());
            assert!(call("save", || cosim_blob_read(to, null_mut(), 0)).is_err());
        }
        let (mut back, mut rest) = (0.0_f64, &bytes[1..]);
        let mut restoring = CosimBlob(Direction::Restoring(&mut rest));
        let (of, into) = (&raw mut restoring, (&raw mut back).cast::<c_void>());
        unsafe {
            assert_eq!(cosim_blob_read(of, into, 8), COSIM_OK);
            assert_eq!(back, 1.5);
            assert_eq!(cosim_blob_read_some(of, into, 8), 0);
            let short = call("restore", || cosim_blob_read(of, into, 1)).unwrap_err();
            assert_eq!(short.to_string(), "it is truncated");
            assert!(call("restore", || cosim_blob_write(of, from, 8)).is_err());
        }
        assert_eq!(bytes[0], 7);
        let mut rest = &bytes[..3];
        let mut restoring = CosimBlob(Direction::Restoring(&mut rest));
        let mut room = [9_u8; 8];
        let (of, into) = (&raw mut restoring, room.as_mut_ptr().cast());
        let taken = [0, 1].map(|_| unsafe { cosim_blob_read_some(of, into, 8) });
        assert_eq!((taken, rest), ([3, 0], &[][..]));
    }
}

//! Configuration of a participant, as read from C.

use crate::fault::{COSIM_OK, Fault, exclusive, guard, shared, text};
use crate::grid::CosimGrid;
use proto::bodies::{Bodies, LOWER, UPPER};
use proto::configuration::{Configuration, Mode, Refusal};
use std::cell::RefCell;
use std::ffi::{CString, c_char, c_int};

/// Configuration of a program before a run: role, model, case values, inputs and outputs. Strings
/// obtained from it are valid until configure returns.
pub struct CosimConfiguration<'a> {
    configuration: &'a Configuration,
    texts: RefCell<Vec<CString>>,
}

impl<'a> CosimConfiguration<'a> {
    pub(crate) fn new(configuration: &'a Configuration) -> Self {
        Self { configuration, texts: RefCell::default() }
    }

    /// Stores a text and returns a pointer for C.
    fn lend(&self, text: &str) -> Result<*const c_char, Fault> {
        let text = CString::new(text)
            .map_err(|_| Fault::Misused(format!("a text of the case has a NUL: {text:?}")))?;
        // The bytes keep their address when the list grows.
        let pointer = text.as_ptr();
        self.texts.borrow_mut().push(text);
        Ok(pointer)
    }
}

/// Checks the configuration argument of an accessor.
unsafe fn settings<'a>(
    configuration: *const CosimConfiguration<'a>,
) -> Result<&'a CosimConfiguration<'a>, Fault> {
    // SAFETY: the header requires what the library has handed out.
    unsafe { shared("configuration", configuration) }
}

/// Reads the value at a key of the case into `into`.
unsafe fn value<'a, T>(
    configuration: *const CosimConfiguration<'a>,
    key: *const c_char,
    into: *mut T,
    read: impl FnOnce(&Configuration, &str) -> Result<T, Refusal>,
) -> Result<c_int, Fault> {
    // SAFETY: the header requires a configuration, a string and room for a value.
    let (settings, key, into) =
        unsafe { (settings(configuration)?, text("key", key)?, exclusive("value", into)?) };
    *into = read(settings.configuration, key).map_err(Fault::Refused)?;
    Ok(COSIM_OK)
}

/// Returns the whole configuration as JSON, for entries without an accessor. NULL on failure.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cosim_configuration_json(
    configuration: *const CosimConfiguration<'_>,
) -> *const c_char {
    guard("cosim_configuration_json", || {
        // SAFETY: guaranteed by the caller, see the header.
        let settings = unsafe { settings(configuration)? };
        let json = serde_json::to_string(settings.configuration);
        settings.lend(&json.map_err(|error| Fault::Failed(error.to_string()))?)
    })
}

/// Returns the role to play ("thermal"). NULL on failure.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cosim_role(configuration: *const CosimConfiguration<'_>) -> *const c_char {
    guard("cosim_role", || {
        // SAFETY: guaranteed by the caller, see the header.
        let settings = unsafe { settings(configuration)? };
        settings.lend(&settings.configuration.role)
    })
}

/// Returns the name of the chosen model, from the description. NULL on failure.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cosim_model(
    configuration: *const CosimConfiguration<'_>,
) -> *const c_char {
    guard("cosim_model", || {
        // SAFETY: guaranteed by the caller, see the header.
        let settings = unsafe { settings(configuration)? };
        settings.lend(&settings.configuration.model)
    })
}

/// Returns true for a transient case (windows of coupling time), false for a steady case (a single
/// window without duration).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cosim_is_transient(configuration: *const CosimConfiguration<'_>) -> bool {
    guard("cosim_is_transient", || {
        // SAFETY: guaranteed by the caller, see the header.
        Ok(unsafe { settings(configuration)? }.configuration.mode == Mode::Transient)
    })
}

/// Returns the number of threads to compute on, at least 1. Results must be independent of this
/// number. 0 on failure.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cosim_threads(configuration: *const CosimConfiguration<'_>) -> usize {
    guard("cosim_threads", || {
        // SAFETY: guaranteed by the caller, see the header.
        Ok(unsafe { settings(configuration)? }.configuration.threads)
    })
}

/// Returns true if an effect is active and claimed by this program.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cosim_has_effect(
    configuration: *const CosimConfiguration<'_>,
    effect: *const c_char,
) -> bool {
    guard("cosim_has_effect", || {
        // SAFETY: guaranteed by the caller, see the header.
        let (settings, effect) = unsafe { (settings(configuration)?, text("effect", effect)?) };
        Ok(settings.configuration.has_effect(effect))
    })
}

/// Returns true if an output is requested, in every iteration or when observed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cosim_is_wanted(
    configuration: *const CosimConfiguration<'_>,
    field: *const c_char,
) -> bool {
    guard("cosim_is_wanted", || {
        // SAFETY: guaranteed by the caller, see the header.
        let (settings, field) = unsafe { (settings(configuration)?, text("field", field)?) };
        let Configuration { outputs, observed, .. } = settings.configuration;
        Ok(outputs.iter().chain(observed).any(|name| name == field))
    })
}

/// Returns true if the case has a value or table at a dotted key.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cosim_case_has(
    configuration: *const CosimConfiguration<'_>,
    key: *const c_char,
) -> bool {
    guard("cosim_case_has", || {
        // SAFETY: guaranteed by the caller, see the header.
        let (settings, key) = unsafe { (settings(configuration)?, text("key", key)?) };
        Ok(settings.configuration.case.has(key))
    })
}

/// Reads a number of the case, in SI units, at a dotted key ("materials.steel.conductivity").
///
/// Returns COSIM_OK. If the number is missing or not finite, returns COSIM_REFUSED with a reason
/// that names the key, which the callback can return; *value is then unchanged.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cosim_case_number(
    configuration: *const CosimConfiguration<'_>,
    key: *const c_char,
    value: *mut f64,
) -> c_int {
    guard("cosim_case_number", || {
        // SAFETY: guaranteed by the caller, see the header.
        unsafe { self::value(configuration, key, value, |settings, key| settings.case.number(key)) }
    })
}

/// Reads a whole number of the case; otherwise like cosim_case_number().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cosim_case_integer(
    configuration: *const CosimConfiguration<'_>,
    key: *const c_char,
    value: *mut i64,
) -> c_int {
    guard("cosim_case_integer", || {
        // SAFETY: guaranteed by the caller, see the header.
        unsafe {
            self::value(configuration, key, value, |settings, key| settings.case.integer(key))
        }
    })
}

/// Reads a Boolean of the case; otherwise like cosim_case_number().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cosim_case_flag(
    configuration: *const CosimConfiguration<'_>,
    key: *const c_char,
    value: *mut bool,
) -> c_int {
    guard("cosim_case_flag", || {
        let read = |settings: &Configuration, key: &str| {
            settings.case.get(key).and_then(serde_json::Value::as_bool).ok_or_else(|| {
                Refusal::new(key, "is not true or false", format!("write `{key} = true`"))
            })
        };
        // SAFETY: guaranteed by the caller, see the header.
        unsafe { self::value(configuration, key, value, read) }
    })
}

/// Returns a text or word of the case at a dotted key. If it is missing or not a text, returns NULL
/// and records a refusal that names the key.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cosim_case_text(
    configuration: *const CosimConfiguration<'_>,
    key: *const c_char,
) -> *const c_char {
    guard("cosim_case_text", || {
        // SAFETY: guaranteed by the caller, see the header.
        let (settings, key) = unsafe { (settings(configuration)?, text("key", key)?) };
        settings.lend(settings.configuration.case.text(key).map_err(Fault::Refused)?)
    })
}

/// Index of the upper body in a pair.
pub const COSIM_UPPER: c_int = 0;
/// Index of the lower body in a pair.
pub const COSIM_LOWER: c_int = 1;
const _: () = assert!(COSIM_UPPER as usize == UPPER && COSIM_LOWER as usize == LOWER);

/// Returns the case's name of a body, COSIM_UPPER or COSIM_LOWER; the body's values stand under
/// "bodies.NAME". Returns NULL and records a refusal unless the case has one body at each position.
/// The description must list the key "bodies.*.position".
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cosim_body_name(
    configuration: *const CosimConfiguration<'_>,
    body: c_int,
) -> *const c_char {
    guard("cosim_body_name", || {
        // SAFETY: guaranteed by the caller, see the header.
        let settings = unsafe { settings(configuration)? };
        let Bodies(names) = Bodies::read(&settings.configuration.case).map_err(Fault::Refused)?;
        match usize::try_from(body).ok().and_then(|body| names.get(body)) {
            Some(name) => settings.lend(name),
            None => Err(Fault::Misused(format!("there is no body {body}"))),
        }
    })
}

/// Writes the grid on which an input will arrive; returns false if it is unknown. The grid is
/// unknown if the field is not an input of this run, or while its producer is not yet configured.
/// In the latter case configure returns without grids and is called again later.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cosim_input_grid(
    configuration: *const CosimConfiguration<'_>,
    field: *const c_char,
    grid: *mut CosimGrid,
) -> bool {
    guard("cosim_input_grid", || {
        // SAFETY: guaranteed by the caller, see the header.
        let (settings, field, into) =
            unsafe { (settings(configuration)?, text("field", field)?, exclusive("grid", grid)?) };
        let Some(grid) = settings.configuration.input_grid(field) else { return Ok(false) };
        *into = CosimGrid::of(grid);
        Ok(true)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fault::{COSIM_FAILED, COSIM_REFUSED, call};
    use std::ffi::CStr;
    use std::ptr::{null, null_mut};

    fn configuration() -> Configuration {
        serde_json::from_value(serde_json::json!({
            "role": "thermal", "model": "closed", "mode": "steady",
            "case": {
                "materials": {"steel": {"density": 7850.0}}, "thermal": {"n": 3, "on": true},
                "effects": {"friction_heat": {"partition": "equal"}},
            },
            "inputs": [{
                "field": proto::field::FRICTION_POWER.kind(), "producer": "mech",
                "grid": {"name": "contact", "revision": 4, "kind": "structured",
                    "origin": [0.0, 0.0, 0.0], "step_i": [1.0, 0.0, 0.0],
                    "step_j": [0.0, 2.0, 0.0], "ni": 5, "nj": 7},
            }],
            "outputs": ["lower_temperature"], "observed": ["upper_temperature"], "threads": 3,
        }))
        .unwrap()
    }

    #[test]
    fn values_by_dotted_key() {
        let given = configuration();
        let settings = CosimConfiguration::new(&given);
        let settings = &raw const settings;
        let (mut number, mut integer, mut flag) = (0.0, 0, false);
        unsafe {
            let key = c"materials.steel.density".as_ptr();
            assert_eq!(cosim_case_number(settings, key, &raw mut number), COSIM_OK);
            let key = c"thermal.n".as_ptr();
            assert_eq!(cosim_case_integer(settings, key, &raw mut integer), COSIM_OK);
            assert_eq!(cosim_case_flag(settings, c"thermal.on".as_ptr(), &raw mut flag), COSIM_OK);
            assert_eq!((number, integer, flag), (7850.0, 3, true));
            let partition = cosim_case_text(settings, c"effects.friction_heat.partition".as_ptr());
            let names = [cosim_role(settings), cosim_model(settings), partition];
            let names = names.map(|name| CStr::from_ptr(name).to_str().unwrap());
            assert_eq!(names, ["thermal", "closed", "equal"]);
            let json = CStr::from_ptr(cosim_configuration_json(settings)).to_str().unwrap();
            assert_eq!(serde_json::from_str::<Configuration>(json).unwrap(), given);
        }
    }

    #[test]
    fn what_is_there() {
        let given = configuration();
        let settings = CosimConfiguration::new(&given);
        let settings = &raw const settings;
        unsafe {
            assert!(!cosim_is_transient(settings));
            assert_eq!(cosim_threads(settings), 3);
            let effects = [c"friction_heat", c"wear"];
            assert_eq!(effects.map(|e| cosim_has_effect(settings, e.as_ptr())), [true, false]);
            let outputs = [c"lower_temperature", c"upper_temperature", c"pressure"];
            let wanted = outputs.map(|o| cosim_is_wanted(settings, o.as_ptr()));
            assert_eq!(wanted, [true, true, false]);
            assert!(cosim_case_has(settings, c"materials.steel".as_ptr()));
            assert!(!cosim_case_has(settings, c"materials.iron".as_ptr()));
            let mut grid = std::mem::zeroed();
            assert!(cosim_input_grid(settings, c"friction_power".as_ptr(), &raw mut grid));
            assert_eq!((grid.ni, grid.nj, grid.points, grid.revision), (5, 7, 35, 4));
            assert!(!cosim_input_grid(settings, c"pressure".as_ptr(), &raw mut grid));
        }
    }

    #[test]
    fn refusals_name_the_key_and_null_is_reported() {
        let given = configuration();
        let settings = CosimConfiguration::new(&given);
        let settings = &raw const settings;
        let mut number = -1.0;
        let fault = call("configure", || unsafe {
            let status = cosim_case_number(settings, c"thermal.depth".as_ptr(), &raw mut number);
            assert_eq!((status, number), (COSIM_REFUSED, -1.0));
            status
        });
        assert_eq!(fault.unwrap_err().to_string(), "thermal.depth: missing; add `thermal.depth`");
        let fault = call("configure", || unsafe {
            assert!(cosim_case_text(settings, c"thermal.n".as_ptr()).is_null());
            COSIM_REFUSED
        });
        assert_eq!(fault.unwrap_err().to_string(), "thermal.n: 3 is not a text; write a text");
        let key = c"thermal.n".as_ptr();
        let misuses: [(&str, &dyn Fn() -> c_int); 4] = [
            ("configuration", &|| unsafe { cosim_case_number(null(), key, null_mut()) }),
            ("key", &|| unsafe { cosim_case_number(settings, null(), null_mut()) }),
            ("value", &|| unsafe { cosim_case_number(settings, key, null_mut()) }),
            ("configuration", &|| unsafe { c_int::from(!cosim_role(null()).is_null()) }),
        ];
        for (what, misuse) in misuses {
            let fault = call("configure", || [misuse(), COSIM_OK][1]).unwrap_err().to_string();
            assert!(fault.ends_with(&format!("`{what}` is NULL")), "{fault}");
        }
        let mut flag = true;
        assert_eq!(unsafe { cosim_case_flag(settings, key, &raw mut flag) }, COSIM_REFUSED);
        assert_eq!(unsafe { cosim_case_flag(settings, key, null_mut()) }, COSIM_FAILED);
    }
}

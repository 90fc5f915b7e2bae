//! Library of an FMU, and the functions that differ between FMI 2.0 and 3.0 only in their names.

use crate::description::{ModelDescription, Version};
use crate::slave::{Fault, Health, Kept};
use libloading::{Library, Symbol};
use std::ffi::c_void;
use std::mem::ManuallyDrop;
use std::path::{Path, PathBuf};

/// Handle of an instance, passed to functions of FMI.
pub type Component = *mut c_void;

type Keep = unsafe extern "C" fn(Component, *mut *mut c_void) -> i32;
type Return = unsafe extern "C" fn(Component, *mut c_void) -> i32;
type Size = unsafe extern "C" fn(Component, *mut c_void, *mut usize) -> i32;
type Write = unsafe extern "C" fn(Component, *mut c_void, *mut u8, usize) -> i32;
type Read = unsafe extern "C" fn(Component, *const u8, usize, *mut *mut c_void) -> i32;

/// Loaded library. It stays loaded until the process ends, because a thread started by the FMU may
/// still use its code.
#[derive(Debug)]
pub struct Loaded {
    library: ManuallyDrop<Library>,
    path: PathBuf,
}

impl Loaded {
    /// Loads the library of the FMU unpacked in `folder`.
    ///
    /// # Errors
    /// Fails if the FMU has no library for this machine or the system cannot load it.
    pub fn open(folder: &Path, of: &ModelDescription) -> Result<Self, String> {
        let (os, arch) = (std::env::consts::OS, std::env::consts::ARCH);
        let platform = match of.version {
            Version::Two if arch == "x86_64" => format!("{os}64"),
            _ => format!("{arch}-{os}"),
        };
        let inside = format!("binaries/{platform}/{}.so", of.identifier);
        let path = folder.join(&inside);
        if !path.is_file() {
            return Err(format!("the FMU has no {inside}, the library for this machine"));
        }
        // SAFETY: from here on, code of the FMU runs. A user who names an FMU in a case trusts it,
        // and this process holds no data of others.
        let library = unsafe { Library::new(&path) };
        let library = library.map_err(|error| {
            let error = error.to_string();
            format!("the library of the FMU cannot be loaded: {error}{}", advice(&error, folder))
        })?;
        Ok(Self { library: ManuallyDrop::new(library), path })
    }

    /// Finds a function of the library.
    ///
    /// # Errors
    /// Fails if the library has no function with this name.
    ///
    /// # Safety
    /// `F` must be the type of the function.
    pub unsafe fn function<F: Copy>(&self, name: &str) -> Result<F, String> {
        // SAFETY: guaranteed by the caller.
        let found: Result<Symbol<'_, F>, _> = unsafe { self.library.get(name.as_bytes()) };
        found.map(|symbol| *symbol).map_err(|_| format!("{} has no {name}", self.path.display()))
    }
}

/// Returns what to do about an error of the system's loader.
fn advice(error: &str, folder: &Path) -> String {
    let says = |words: &[&str]| words.iter().any(|word| error.contains(word));
    if says(&["failed to map segment", "Operation not permitted", "Permission denied"]) {
        return format!(
            "; if files in {} must not be executed, set COSIM_RUNTIME_DIR to a folder where files \
             may be executed",
            folder.display()
        );
    }
    if says(&["undefined symbol: Py", "undefined symbol: _Py"]) {
        return "; it needs the library of Python and does not name it: start the coordinator with \
                LD_PRELOAD=libpython3.N.so of the Python that the FMU was made with"
            .to_owned();
    }
    if says(&["undefined symbol"]) {
        return "; it needs a library that it does not name: start the coordinator with that library \
                in LD_PRELOAD"
            .to_owned();
    }
    String::new()
}

/// Functions that save and restore states.
#[derive(Debug)]
pub struct States {
    keep: (String, Keep),
    give_back: (String, Return),
    free: Keep,
    /// Functions that serialise states, if supported.
    bytes: Option<Bytes>,
}

#[derive(Debug)]
struct Bytes {
    size: (String, Size),
    write: (String, Write),
    read: (String, Read),
}

impl States {
    /// Finds the functions for states; `None` if the FMU cannot save states.
    ///
    /// # Errors
    /// Fails if a function is missing.
    pub fn find(library: &Loaded, of: &ModelDescription) -> Result<Option<Self>, String> {
        if !of.keeps_states {
            return Ok(None);
        }
        let names = match of.version {
            Version::Two => [
                "fmi2GetFMUstate",
                "fmi2SetFMUstate",
                "fmi2FreeFMUstate",
                "fmi2SerializedFMUstateSize",
                "fmi2SerializeFMUstate",
                "fmi2DeSerializeFMUstate",
            ],
            Version::Three => [
                "fmi3GetFMUState",
                "fmi3SetFMUState",
                "fmi3FreeFMUState",
                "fmi3SerializedFMUStateSize",
                "fmi3SerializeFMUState",
                "fmi3DeserializeFMUState",
            ],
        };
        let [keep, give_back, free, size, write, read] = names.map(str::to_owned);
        // SAFETY: both versions of FMI give functions with these names these types.
        unsafe {
            let bytes = match of.serialises {
                false => None,
                true => Some(Bytes {
                    size: (size.clone(), library.function(&size)?),
                    write: (write.clone(), library.function(&write)?),
                    read: (read.clone(), library.function(&read)?),
                }),
            };
            Ok(Some(Self {
                keep: (keep.clone(), library.function(&keep)?),
                give_back: (give_back.clone(), library.function(&give_back)?),
                free: library.function(&free)?,
                bytes,
            }))
        }
    }

    pub(crate) fn keep(
        &self,
        of: Component,
        health: &mut Health,
        state: &mut Kept,
    ) -> Result<(), Fault> {
        let (name, keep) = &self.keep;
        // SAFETY: the instance lives; the state is null or belongs to the instance and is updated.
        let status = unsafe { keep(of, &raw mut state.0) };
        health.check(name, status)
    }

    pub(crate) fn return_to(
        &self,
        of: Component,
        health: &mut Health,
        state: &Kept,
    ) -> Result<(), Fault> {
        let (name, give_back) = &self.give_back;
        // SAFETY: the instance lives; the state belongs to it.
        let status = unsafe { give_back(of, state.0) };
        health.check(name, status)
    }

    pub(crate) fn free(&self, of: Component, state: &mut Kept) {
        if !state.0.is_null() {
            // SAFETY: the instance lives; the state belongs to it and is not used afterwards.
            unsafe { (self.free)(of, &raw mut state.0) };
            state.0 = std::ptr::null_mut();
        }
    }

    fn as_bytes(&self) -> Result<&Bytes, Fault> {
        self.bytes.as_ref().ok_or_else(|| {
            Fault(
                "the FMU cannot serialise its state (canSerializeFMUstate): a run with it has no \
                 checkpoints; remove output.checkpoint_every"
                    .to_owned(),
            )
        })
    }

    pub(crate) fn write(
        &self,
        of: Component,
        health: &mut Health,
        state: &Kept,
    ) -> Result<Vec<u8>, Fault> {
        let Bytes { size: (name, size), write: (of_write, write), .. } = self.as_bytes()?;
        let mut length = 0_usize;
        // SAFETY: the instance lives; the state belongs to it.
        let status = unsafe { size(of, state.0, &raw mut length) };
        health.check(name, status)?;
        let mut bytes = vec![0; length];
        // SAFETY: as above; the buffer has room for `length` bytes.
        let status = unsafe { write(of, state.0, bytes.as_mut_ptr(), length) };
        health.check(of_write, status)?;
        Ok(bytes)
    }

    pub(crate) fn read(
        &self,
        of: Component,
        health: &mut Health,
        bytes: &[u8],
        state: &mut Kept,
    ) -> Result<(), Fault> {
        let (name, read) = &self.as_bytes()?.read;
        // SAFETY: the instance lives; the length of the list is passed.
        let status = unsafe { read(of, bytes.as_ptr(), bytes.len(), &raw mut state.0) };
        health.check(name, status)
    }
}

#[cfg(test)]
mod tests {
    use super::advice;
    use std::path::Path;

    #[test]
    fn advice_fits_the_error() {
        let folder = Path::new("/dev/shm/x");
        let python = advice("a.so: undefined symbol: _Py_NoneStruct", folder);
        assert!(python.contains("LD_PRELOAD=libpython3") && !python.contains("COSIM_RUNTIME_DIR"));
        assert!(advice("undefined symbol: dgemm_", folder).contains("LD_PRELOAD"));
        let refused = advice("a.so: failed to map segment from shared object", folder);
        assert!(refused.contains("/dev/shm/x") && refused.contains("COSIM_RUNTIME_DIR"));
        assert_eq!(advice("libfoo.so: cannot open shared object file", folder), "");
    }
}

//! The functions of preCICE's C interface, declared in `include/precice/preciceC.h`.
//!
//! A refused call tells the launcher the reason, prints it and ends the program. The C++ class
//! throws an exception instead: it defers errors with [`precice_cosim_defer_errors`] and fetches
//! them with [`precice_cosim_error`].

use super::error::CallError;
use super::participant::Participant;
use std::ffi::{CStr, CString, c_char, c_double, c_int, c_void};
use std::io::Write as _;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The only participant of the process.
static PARTICIPANT: Mutex<Option<Participant>> = Mutex::new(None);
/// True if errors are stored instead of ending the program.
static DEFERS: AtomicBool = AtomicBool::new(false);
/// Text of the stored error, and the text that was fetched last.
static ERROR: Mutex<[Option<CString>; 2]> = Mutex::new([None, None]);
/// Version of the interface and of this library; shorter than 16 characters.
pub(super) const VERSION: &CStr = c"3.4.0;cosim;";

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Calls the participant. A refusal is reported under the name of the function, and gives the
/// default value if the program goes on.
fn call<T: Default>(
    function: &str,
    act: impl FnOnce(&mut Participant) -> Result<T, CallError>,
) -> T {
    let mut participant = lock(&PARTICIPANT);
    let result = match participant.as_mut() {
        Some(participant) => act(participant),
        None => Err(CallError::NoParticipant),
    };
    result.unwrap_or_else(|error| refused(function, &error, participant.as_mut()))
}

fn refused<T: Default>(
    function: &str,
    error: &CallError,
    participant: Option<&mut Participant>,
) -> T {
    let text = format!("{function}: {error}");
    if let Some(participant) = participant {
        participant.fail(text.clone());
    }
    if DEFERS.load(Ordering::Relaxed) {
        lock(&ERROR)[0] = CString::new(text).ok();
        return T::default();
    }
    let _ = writeln!(std::io::stderr(), "error: {text}");
    std::process::exit(1);
}

/// Reads a name passed by the program.
///
/// # Safety
/// `text` is null or a null-terminated string.
unsafe fn name<'a>(text: *const c_char) -> Result<&'a str, CallError> {
    if text.is_null() {
        return Err(CallError::Text);
    }
    // SAFETY: guaranteed by the caller.
    unsafe { CStr::from_ptr(text) }.to_str().map_err(|_| CallError::Text)
}

/// Returns the number of values in `size` groups.
fn count(size: c_int, group: usize) -> Result<usize, CallError> {
    usize::try_from(size).map(|size| size * group).map_err(|_| CallError::Size(size))
}

/// Returns a list passed by the program.
///
/// # Safety
/// `first` is null or points to `count` values.
unsafe fn list<'a, T>(first: *const T, count: usize) -> Result<&'a [T], CallError> {
    match (first.is_null(), count) {
        (_, 0) => Ok(&[]),
        (true, _) => Err(CallError::Null(count)),
        // SAFETY: guaranteed by the caller.
        (false, _) => Ok(unsafe { std::slice::from_raw_parts(first, count) }),
    }
}

/// Returns a list passed by the program for results.
///
/// # Safety
/// `first` is null or points to `count` values that nothing else uses.
unsafe fn room<'a, T>(first: *mut T, count: usize) -> Result<&'a mut [T], CallError> {
    match (first.is_null(), count) {
        (_, 0) => Ok(&mut []),
        (true, _) => Err(CallError::Null(count)),
        // SAFETY: guaranteed by the caller.
        (false, _) => Ok(unsafe { std::slice::from_raw_parts_mut(first, count) }),
    }
}

/// Creates the participant.
///
/// # Safety
/// The names are null-terminated strings.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn precicec_createParticipant(
    participant_name: *const c_char,
    _configuration_file: *const c_char,
    rank: c_int,
    size: c_int,
) {
    let mut participant = lock(&PARTICIPANT);
    let created = match *participant {
        Some(_) => Err(CallError::SecondParticipant),
        // SAFETY: guaranteed by the caller.
        None => {
            unsafe { name(participant_name) }.and_then(|name| Participant::create(name, rank, size))
        }
    };
    match created {
        Ok(created) => *participant = Some(created),
        Err(error) => refused("createParticipant", &error, participant.as_mut()),
    }
}

/// Creates the participant. The communicator is not used, because one process takes part.
///
/// # Safety
/// The names are null-terminated strings.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn precicec_createParticipant_withCommunicator(
    participant_name: *const c_char,
    configuration_file: *const c_char,
    rank: c_int,
    size: c_int,
    _communicator: *mut c_void,
) {
    // SAFETY: guaranteed by the caller.
    unsafe { precicec_createParticipant(participant_name, configuration_file, rank, size) }
}

/// Waits for the first window.
#[unsafe(no_mangle)]
pub extern "C" fn precicec_initialize() {
    call("initialize", Participant::initialize);
}

/// Adds a time step [s] to the window.
#[unsafe(no_mangle)]
pub extern "C" fn precicec_advance(step: c_double) {
    call("advance", |participant| participant.advance(step));
}

/// Ends the participant; another may then be created.
#[unsafe(no_mangle)]
pub extern "C" fn precicec_finalize() {
    call("finalize", Participant::finalize);
    *lock(&PARTICIPANT) = None;
}

/// Ends the participant if it exists.
pub(super) fn release() {
    let exists = lock(&PARTICIPANT).is_some();
    if exists {
        precicec_finalize();
    }
}

/// Returns 1 at the start of a window.
#[unsafe(no_mangle)]
pub extern "C" fn precicec_requiresWritingCheckpoint() -> c_int {
    call("requiresWritingCheckpoint", Participant::requires_writing_checkpoint).into()
}

/// Returns 1 if the window has to be solved again.
#[unsafe(no_mangle)]
pub extern "C" fn precicec_requiresReadingCheckpoint() -> c_int {
    call("requiresReadingCheckpoint", Participant::requires_reading_checkpoint).into()
}

/// Returns the number of coordinates of a vertex.
///
/// # Safety
/// The name is a null-terminated string.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn precicec_getMeshDimensions(mesh: *const c_char) -> c_int {
    call("getMeshDimensions", |participant| {
        // SAFETY: guaranteed by the caller.
        participant.mesh_dimensions(unsafe { name(mesh) }?).map(|count| count as c_int)
    })
}

/// Returns the number of components of data.
///
/// # Safety
/// The names are null-terminated strings.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn precicec_getDataDimensions(
    mesh: *const c_char,
    data: *const c_char,
) -> c_int {
    call("getDataDimensions", |participant| {
        // SAFETY: guaranteed by the caller.
        let (mesh, data) = unsafe { (name(mesh)?, name(data)?) };
        participant.data_dimensions(mesh, data).map(|count| count as c_int)
    })
}

/// Returns 1 until the simulation has ended.
#[unsafe(no_mangle)]
pub extern "C" fn precicec_isCouplingOngoing() -> c_int {
    call("isCouplingOngoing", |participant| Ok(participant.is_coupling_ongoing())).into()
}

/// Returns 1 if the last advance completed a window.
#[unsafe(no_mangle)]
pub extern "C" fn precicec_isTimeWindowComplete() -> c_int {
    call("isTimeWindowComplete", |participant| Ok(participant.is_time_window_complete())).into()
}

/// Returns the rest of the window [s].
#[unsafe(no_mangle)]
pub extern "C" fn precicec_getMaxTimeStepSize() -> c_double {
    call("getMaxTimeStepSize", |participant| Ok(participant.max_time_step_size()))
}

/// Returns 1 if a mapping of the configuration uses the connectivity of a mesh.
///
/// # Safety
/// The name is a null-terminated string.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn precicec_requiresMeshConnectivityFor(mesh: *const c_char) -> c_int {
    call("requiresMeshConnectivityFor", |participant| {
        // SAFETY: guaranteed by the caller.
        participant.requires_mesh_connectivity(unsafe { name(mesh) }?)
    })
    .into()
}

/// Refused: meshes are fixed in a run.
///
/// # Safety
/// The name is a null-terminated string.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn precicec_resetMesh(_mesh: *const c_char) {
    call("resetMesh", |_| {
        let fix = "keep the mesh for the whole simulation";
        Err::<(), _>(CallError::Unsupported { what: "a mesh that changes during the run", fix })
    });
}

/// Adds a vertex; returns its number.
///
/// # Safety
/// The name is a null-terminated string, and `coordinates` has as many values as the mesh has
/// dimensions.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn precicec_setMeshVertex(
    mesh: *const c_char,
    coordinates: *const c_double,
) -> c_int {
    call("setMeshVertex", |participant| {
        // SAFETY: guaranteed by the caller.
        let mesh = participant.open_mesh(unsafe { name(mesh) }?)?;
        // SAFETY: guaranteed by the caller.
        let coordinates = unsafe { list(coordinates, mesh.info.dimensions) }?;
        mesh.add_vertices(coordinates).map(|first| first as c_int)
    })
}

/// Returns the number of vertices of a mesh.
///
/// # Safety
/// The name is a null-terminated string.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn precicec_getMeshVertexSize(mesh: *const c_char) -> c_int {
    call("getMeshVertexSize", |participant| {
        // SAFETY: guaranteed by the caller.
        participant.own_mesh(unsafe { name(mesh) }?).map(|mesh| mesh.size() as c_int)
    })
}

/// Adds vertices and writes their numbers to `ids`.
///
/// # Safety
/// The name is a null-terminated string; `coordinates` has `size` vertices, and `ids` room for as
/// many numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn precicec_setMeshVertices(
    mesh: *const c_char,
    size: c_int,
    coordinates: *const c_double,
    ids: *mut c_int,
) {
    call("setMeshVertices", |participant| {
        // SAFETY: guaranteed by the caller.
        let mesh = participant.open_mesh(unsafe { name(mesh) }?)?;
        // SAFETY: guaranteed by the caller.
        let coordinates = unsafe { list(coordinates, count(size, mesh.info.dimensions)?) }?;
        // SAFETY: guaranteed by the caller.
        let ids = unsafe { room(ids, count(size, 1)?) }?;
        let first = mesh.add_vertices(coordinates)?;
        ids.iter_mut().enumerate().for_each(|(at, id)| *id = (first + at) as c_int);
        Ok(())
    });
}

/// Adds an edge.
///
/// # Safety
/// The name is a null-terminated string.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn precicec_setMeshEdge(mesh: *const c_char, first: c_int, second: c_int) {
    call("setMeshEdge", |participant| {
        // SAFETY: guaranteed by the caller.
        participant.open_mesh(unsafe { name(mesh) }?)?.add_edges(&[first, second])
    });
}

/// Adds edges.
///
/// # Safety
/// The name is a null-terminated string, and `ids` has two numbers an edge.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn precicec_setMeshEdges(
    mesh: *const c_char,
    size: c_int,
    ids: *const c_int,
) {
    call("setMeshEdges", |participant| {
        // SAFETY: guaranteed by the caller.
        let (mesh, ids) = unsafe { (name(mesh)?, list(ids, count(size, 2)?)?) };
        participant.open_mesh(mesh)?.add_edges(ids)
    });
}

/// Adds a triangle.
///
/// # Safety
/// The name is a null-terminated string.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn precicec_setMeshTriangle(
    mesh: *const c_char,
    first: c_int,
    second: c_int,
    third: c_int,
) {
    call("setMeshTriangle", |participant| {
        // SAFETY: guaranteed by the caller.
        participant.open_mesh(unsafe { name(mesh) }?)?.add_triangles(&[first, second, third])
    });
}

/// Adds triangles.
///
/// # Safety
/// The name is a null-terminated string, and `ids` has three numbers a triangle.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn precicec_setMeshTriangles(
    mesh: *const c_char,
    size: c_int,
    ids: *const c_int,
) {
    call("setMeshTriangles", |participant| {
        // SAFETY: guaranteed by the caller.
        let (mesh, ids) = unsafe { (name(mesh)?, list(ids, count(size, 3)?)?) };
        participant.open_mesh(mesh)?.add_triangles(ids)
    });
}

/// Adds a quadrilateral.
///
/// # Safety
/// The name is a null-terminated string.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn precicec_setMeshQuad(
    mesh: *const c_char,
    first: c_int,
    second: c_int,
    third: c_int,
    fourth: c_int,
) {
    call("setMeshQuad", |participant| {
        // SAFETY: guaranteed by the caller.
        let mesh = participant.open_mesh(unsafe { name(mesh) }?)?;
        mesh.add_quads(&[first, second, third, fourth])
    });
}

/// Adds quadrilaterals.
///
/// # Safety
/// The name is a null-terminated string, and `ids` has four numbers a quadrilateral.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn precicec_setMeshQuads(
    mesh: *const c_char,
    size: c_int,
    ids: *const c_int,
) {
    call("setMeshQuads", |participant| {
        // SAFETY: guaranteed by the caller.
        let (mesh, ids) = unsafe { (name(mesh)?, list(ids, count(size, 4)?)?) };
        participant.open_mesh(mesh)?.add_quads(ids)
    });
}

/// Checks a tetrahedron.
///
/// # Safety
/// The name is a null-terminated string.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn precicec_setMeshTetrahedron(
    mesh: *const c_char,
    first: c_int,
    second: c_int,
    third: c_int,
    fourth: c_int,
) {
    call("setMeshTetrahedron", |participant| {
        // SAFETY: guaranteed by the caller.
        let mesh = participant.open_mesh(unsafe { name(mesh) }?)?;
        mesh.check_tetrahedra(&[first, second, third, fourth])
    });
}

/// Checks tetrahedra.
///
/// # Safety
/// The name is a null-terminated string, and `ids` has four numbers a tetrahedron.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn precicec_setMeshTetrahedra(
    mesh: *const c_char,
    size: c_int,
    ids: *const c_int,
) {
    call("setMeshTetrahedra", |participant| {
        // SAFETY: guaranteed by the caller.
        let (mesh, ids) = unsafe { (name(mesh)?, list(ids, count(size, 4)?)?) };
        participant.open_mesh(mesh)?.check_tetrahedra(ids)
    });
}

/// Returns 1 if the program has to write initial data.
#[unsafe(no_mangle)]
pub extern "C" fn precicec_requiresInitialData() -> c_int {
    call("requiresInitialData", |participant| Ok(participant.requires_initial_data())).into()
}

/// Writes data at vertices.
///
/// # Safety
/// The names are null-terminated strings; `ids` has `size` numbers, and `values` all components of
/// as many vertices.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn precicec_writeData(
    mesh: *const c_char,
    data: *const c_char,
    size: c_int,
    ids: *const c_int,
    values: *const c_double,
) {
    call("writeData", |participant| {
        // SAFETY: guaranteed by the caller.
        let (mesh, data) = unsafe { (name(mesh)?, name(data)?) };
        let components = participant.data_dimensions(mesh, data)?;
        // SAFETY: guaranteed by the caller.
        let (ids, values) =
            unsafe { (list(ids, count(size, 1)?)?, list(values, count(size, components)?)?) };
        participant.write(mesh, data, ids, values)
    });
}

/// Reads data at vertices at a time after the last step.
///
/// # Safety
/// The names are null-terminated strings; `ids` has `size` numbers, and `values` room for all
/// components of as many vertices.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn precicec_readData(
    mesh: *const c_char,
    data: *const c_char,
    size: c_int,
    ids: *const c_int,
    time: c_double,
    values: *mut c_double,
) {
    call("readData", |participant| {
        // SAFETY: guaranteed by the caller.
        let (mesh, data) = unsafe { (name(mesh)?, name(data)?) };
        let components = participant.data_dimensions(mesh, data)?;
        // SAFETY: guaranteed by the caller.
        let (ids, values) =
            unsafe { (list(ids, count(size, 1)?)?, room(values, count(size, components)?)?) };
        participant.read(mesh, data, ids, time, values)
    });
}

const MAPPED: CallError = CallError::Unsupported {
    what: "mapping at coordinates of the moment (writeAndMapData, mapAndReadData)",
    fix: "set vertices before initialize, and use writeData and readData",
};

/// Refused: data is mapped between meshes that are set before `initialize`.
///
/// # Safety
/// Never reads its arguments.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn precicec_writeAndMapData(
    _mesh: *const c_char,
    _data: *const c_char,
    _size: c_int,
    _coordinates: *const c_double,
    _values: *const c_double,
) {
    call("writeAndMapData", |_| Err::<(), _>(MAPPED));
}

/// Refused: data is mapped between meshes that are set before `initialize`.
///
/// # Safety
/// Never reads its arguments.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn precicec_mapAndReadData(
    _mesh: *const c_char,
    _data: *const c_char,
    _size: c_int,
    _coordinates: *const c_double,
    _time: c_double,
    _values: *mut c_double,
) {
    call("mapAndReadData", |_| Err::<(), _>(MAPPED));
}

/// Refused: a program has no access to received meshes.
///
/// # Safety
/// Never reads its arguments.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn precicec_setMeshAccessRegion(
    _mesh: *const c_char,
    _bounding_box: *const c_double,
) {
    call("setMeshAccessRegion", |_| {
        let fix = "provide a mesh of the program's own";
        Err::<(), _>(CallError::Unsupported { what: "direct access to a received mesh", fix })
    });
}

/// Writes the numbers and coordinates of all vertices of a mesh.
///
/// # Safety
/// The name is a null-terminated string; `ids` has room for `size` numbers, and `coordinates` for
/// the coordinates of as many vertices.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn precicec_getMeshVertexIDsAndCoordinates(
    mesh: *const c_char,
    size: c_int,
    ids: *mut c_int,
    coordinates: *mut c_double,
) {
    call("getMeshVertexIDsAndCoordinates", |participant| {
        // SAFETY: guaranteed by the caller.
        let mesh = participant.own_mesh(unsafe { name(mesh) }?)?;
        let (found, expected) = (count(size, 1)?, mesh.size());
        if found != expected {
            return Err(CallError::Count { what: "vertices", found, expected });
        }
        let dimensions = mesh.info.dimensions;
        // SAFETY: guaranteed by the caller.
        let (ids, coordinates) =
            unsafe { (room(ids, found)?, room(coordinates, count(size, dimensions)?)?) };
        for (id, point) in mesh.mesh.points.iter().enumerate() {
            ids[id] = id as c_int;
            coordinates[id * dimensions..][..dimensions].copy_from_slice(&point[..dimensions]);
        }
        Ok(())
    });
}

/// Returns 0: no mapping uses gradients.
///
/// # Safety
/// The names are null-terminated strings.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn precicec_requiresGradientDataFor(
    mesh: *const c_char,
    data: *const c_char,
) -> c_int {
    call("requiresGradientDataFor", |participant| {
        // SAFETY: guaranteed by the caller.
        let (mesh, data) = unsafe { (name(mesh)?, name(data)?) };
        participant.data_dimensions(mesh, data).map(|_| false)
    })
    .into()
}

/// Does nothing: gradients are never required.
///
/// # Safety
/// Never reads its arguments.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn precicec_writeGradientData(
    _mesh: *const c_char,
    _data: *const c_char,
    _size: c_int,
    _ids: *const c_int,
    _gradients: *const c_double,
) {
}

/// Does nothing: the coordinator measures the time of each solve.
///
/// # Safety
/// Never reads its argument.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn precicec_startProfilingSection(_section: *const c_char) {}

/// Does nothing: the coordinator measures the time of each solve.
#[unsafe(no_mangle)]
pub extern "C" fn precicec_stopLastProfilingSection() {}

/// Returns the version of the interface.
#[unsafe(no_mangle)]
pub extern "C" fn precicec_getVersionInformation() -> *const c_char {
    VERSION.as_ptr()
}

/// Stores errors (1) instead of ending the program (0); returns the earlier choice.
#[unsafe(no_mangle)]
pub extern "C" fn precice_cosim_defer_errors(on: c_int) -> c_int {
    DEFERS.swap(on != 0, Ordering::Relaxed).into()
}

/// Returns the text of the stored error and clears it; null if there is none. The text is valid
/// until the next call.
#[unsafe(no_mangle)]
pub extern "C" fn precice_cosim_error() -> *const c_char {
    let mut errors = lock(&ERROR);
    errors[1] = errors[0].take();
    errors[1].as_ref().map_or(std::ptr::null(), |text| text.as_ptr())
}

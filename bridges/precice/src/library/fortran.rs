//! The functions of preCICE's Fortran interface, over those of the C interface.
//!
//! Names are in lower case with an underscore at the end. All arguments are pointers. Texts are
//! padded with blanks, and their lengths follow all other arguments. Answers are written to an
//! integer, 1 for true.

use super::c_interface as c;
use std::ffi::{CString, c_char, c_double, c_int};

/// Reads a text padded with blanks or null characters.
///
/// # Safety
/// `first` points to `length` characters.
unsafe fn text(first: *const c_char, length: c_int) -> CString {
    let length = usize::try_from(length).unwrap_or(0);
    // SAFETY: guaranteed by the caller.
    let bytes = unsafe { std::slice::from_raw_parts(first.cast::<u8>(), length) };
    let end = bytes.iter().rposition(|byte| !matches!(byte, b' ' | 0)).map_or(0, |last| last + 1);
    CString::new(&bytes[..end]).unwrap_or_default()
}

/// Defines functions: texts with their lengths, then pointers, then the call of the C function. In
/// the call, a text is a pointer to its C string.
macro_rules! functions {
    ($(
        $(#[$doc:meta])*
        fn $name:ident($($text:ident [$length:ident],)* ; $($argument:ident: $type:ty),*) $body:block
    )*) => {$(
        $(#[$doc])*
        ///
        /// # Safety
        /// The arguments are those of the Fortran interface.
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $name(
            $($text: *const c_char,)*
            $($argument: $type,)*
            $($length: c_int,)*
        ) {
            // SAFETY: guaranteed by the caller.
            #[allow(unused_unsafe, reason = "functions without arguments are safe")]
            unsafe {
                $(
                    let $length = text($text, $length);
                    let $text = $length.as_ptr();
                )*
                $body
            }
        }
    )*};
}

functions! {
    /// Creates the participant.
    fn precicef_create_(name [n], file [f], ; rank: *const c_int, size: *const c_int) {
        c::precicec_createParticipant(name, file, *rank, *size);
    }
    /// Creates the participant; the communicator is not used.
    fn precicef_create_with_communicator_(
        name [n], file [f], ;
        rank: *const c_int, size: *const c_int, _communicator: *const c_int
    ) {
        c::precicec_createParticipant(name, file, *rank, *size);
    }
    /// Waits for the first window.
    fn precicef_initialize_(;) {
        c::precicec_initialize();
    }
    /// Adds a time step to the window.
    fn precicef_advance_(; step: *const c_double) {
        c::precicec_advance(*step);
    }
    /// Ends the participant.
    fn precicef_finalize_(;) {
        c::precicec_finalize();
    }
    /// Gives the number of coordinates of a vertex.
    fn precicef_get_mesh_dimensions_(mesh [m], ; dimensions: *mut c_int) {
        *dimensions = c::precicec_getMeshDimensions(mesh);
    }
    /// Gives the number of components of data.
    fn precicef_get_data_dimensions_(mesh [m], data [d], ; dimensions: *mut c_int) {
        *dimensions = c::precicec_getDataDimensions(mesh, data);
    }
    /// Gives 1 until the simulation has ended.
    fn precicef_is_coupling_ongoing_(; answer: *mut c_int) {
        *answer = c::precicec_isCouplingOngoing();
    }
    /// Gives 1 if the last advance completed a window.
    fn precicef_is_time_window_complete_(; answer: *mut c_int) {
        *answer = c::precicec_isTimeWindowComplete();
    }
    /// Gives the rest of the window.
    fn precicef_get_max_time_step_size_(; size: *mut c_double) {
        *size = c::precicec_getMaxTimeStepSize();
    }
    /// Gives 1 if initial data have to be written.
    fn precicef_requires_initial_data_(; answer: *mut c_int) {
        *answer = c::precicec_requiresInitialData();
    }
    /// Gives 1 at the start of a window.
    fn precicef_requires_writing_checkpoint_(; answer: *mut c_int) {
        *answer = c::precicec_requiresWritingCheckpoint();
    }
    /// Gives 1 if the window has to be solved again.
    fn precicef_requires_reading_checkpoint_(; answer: *mut c_int) {
        *answer = c::precicec_requiresReadingCheckpoint();
    }
    /// Gives 1 if a mapping of the configuration uses the connectivity.
    fn precicef_requires_mesh_connectivity_for_(mesh [m], ; answer: *mut c_int) {
        *answer = c::precicec_requiresMeshConnectivityFor(mesh);
    }
    /// Refused: meshes are fixed in a run.
    fn precicef_reset_mesh_(mesh [m], ;) {
        c::precicec_resetMesh(mesh);
    }
    /// Adds a vertex.
    fn precicef_set_mesh_vertex_(mesh [m], ; place: *const c_double, id: *mut c_int) {
        *id = c::precicec_setMeshVertex(mesh, place);
    }
    /// Gives the number of vertices.
    fn precicef_get_mesh_vertex_size_(mesh [m], ; size: *mut c_int) {
        *size = c::precicec_getMeshVertexSize(mesh);
    }
    /// Adds vertices.
    fn precicef_set_mesh_vertices_(
        mesh [m], ; size: *const c_int, places: *const c_double, ids: *mut c_int
    ) {
        c::precicec_setMeshVertices(mesh, *size, places, ids);
    }
    /// Adds an edge.
    fn precicef_set_mesh_edge_(mesh [m], ; first: *const c_int, second: *const c_int) {
        c::precicec_setMeshEdge(mesh, *first, *second);
    }
    /// Adds edges.
    fn precicef_set_mesh_edges_(mesh [m], ; size: *const c_int, ids: *const c_int) {
        c::precicec_setMeshEdges(mesh, *size, ids);
    }
    /// Adds a triangle.
    fn precicef_set_mesh_triangle_(
        mesh [m], ; first: *const c_int, second: *const c_int, third: *const c_int
    ) {
        c::precicec_setMeshTriangle(mesh, *first, *second, *third);
    }
    /// Adds triangles.
    fn precicef_set_mesh_triangles_(mesh [m], ; size: *const c_int, ids: *const c_int) {
        c::precicec_setMeshTriangles(mesh, *size, ids);
    }
    /// Adds a quadrilateral.
    fn precicef_set_mesh_quad_(
        mesh [m], ;
        first: *const c_int, second: *const c_int, third: *const c_int, fourth: *const c_int
    ) {
        c::precicec_setMeshQuad(mesh, *first, *second, *third, *fourth);
    }
    /// Adds quadrilaterals.
    fn precicef_set_mesh_quads_(mesh [m], ; size: *const c_int, ids: *const c_int) {
        c::precicec_setMeshQuads(mesh, *size, ids);
    }
    /// Checks a tetrahedron.
    fn precicef_set_mesh_tetrahedron_(
        mesh [m], ;
        first: *const c_int, second: *const c_int, third: *const c_int, fourth: *const c_int
    ) {
        c::precicec_setMeshTetrahedron(mesh, *first, *second, *third, *fourth);
    }
    /// Checks tetrahedra.
    fn precicef_set_mesh_tetrahedra_(mesh [m], ; size: *const c_int, ids: *const c_int) {
        c::precicec_setMeshTetrahedra(mesh, *size, ids);
    }
    /// Writes data at vertices.
    fn precicef_write_data_(
        mesh [m], data [d], ; size: *const c_int, ids: *const c_int, values: *const c_double
    ) {
        c::precicec_writeData(mesh, data, *size, ids, values);
    }
    /// Reads data at vertices at a time after the last step.
    fn precicef_read_data_(
        mesh [m], data [d], ;
        size: *const c_int, ids: *const c_int, time: *const c_double, values: *mut c_double
    ) {
        c::precicec_readData(mesh, data, *size, ids, *time, values);
    }
    /// Refused: data is mapped between meshes that are set before `initialize`.
    fn precicef_write_and_map_data_(
        mesh [m], data [d], ; size: *const c_int, places: *const c_double, values: *const c_double
    ) {
        c::precicec_writeAndMapData(mesh, data, *size, places, values);
    }
    /// Refused: data is mapped between meshes that are set before `initialize`.
    fn precicef_map_and_read_data_(
        mesh [m], data [d], ;
        size: *const c_int, places: *const c_double, time: *const c_double, values: *mut c_double
    ) {
        c::precicec_mapAndReadData(mesh, data, *size, places, *time, values);
    }
    /// Refused: a program has no access to received meshes.
    fn precicef_set_mesh_access_region_(mesh [m], ; region: *const c_double) {
        c::precicec_setMeshAccessRegion(mesh, region);
    }
    /// Gives the numbers and coordinates of all vertices of a mesh.
    fn precicef_get_mesh_vertex_ids_and_coordinates_(
        mesh [m], ; size: *const c_int, ids: *mut c_int, places: *mut c_double
    ) {
        c::precicec_getMeshVertexIDsAndCoordinates(mesh, *size, ids, places);
    }
    /// Gives 0: no mapping uses gradients.
    fn precicef_requires_gradient_data_for_(mesh [m], data [d], ; answer: *mut c_int) {
        *answer = c::precicec_requiresGradientDataFor(mesh, data);
    }
    /// Does nothing: gradients are never required.
    fn precicef_write_gradient_data_(
        mesh [m], data [d], ; size: *const c_int, ids: *const c_int, gradients: *const c_double
    ) {
        c::precicec_writeGradientData(mesh, data, *size, ids, gradients);
    }
    /// Does nothing: the coordinator measures the time of each solve.
    fn precicef_start_profiling_section_(section [s], ;) {
        c::precicec_startProfilingSection(section);
    }
    /// Does nothing: the coordinator measures the time of each solve.
    fn precicef_stop_last_profiling_section_(;) {
        c::precicec_stopLastProfilingSection();
    }
}

/// Copies the version of the interface, padded with null characters.
///
/// # Safety
/// `version` has room for `length` characters.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn precicef_get_version_information_(version: *mut c_char, length: c_int) {
    // SAFETY: guaranteed by the caller; the version is a null-terminated text.
    unsafe {
        libc::strncpy(
            version,
            c::precicec_getVersionInformation(),
            usize::try_from(length).unwrap_or(0),
        );
    }
}

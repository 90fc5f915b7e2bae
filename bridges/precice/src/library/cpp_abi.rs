//! The symbols of preCICE's C++ class, for programs that were linked with preCICE's own library.
//!
//! The headers of this library are inline and need none of these symbols. A program that was built
//! with preCICE 3 finds them here under the names of the Itanium C++ ABI, so that it runs without
//! being built again. A `precice::span` is a pointer and a length; a text is a span of characters.
//! Exceptions cannot be thrown from here: a refused call ends the program, as in C.

use super::c_interface as c;
use std::ffi::{CString, c_char, c_double, c_int, c_void};

/// `precice::span`.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Span<T> {
    first: *mut T,
    length: usize,
}

impl<T> Span<T> {
    /// Returns the number of groups of values, as a C integer.
    fn count(self, group: c_int) -> c_int {
        let group = usize::try_from(group).unwrap_or(1).max(1);
        c_int::try_from(self.length / group).unwrap_or(-1)
    }
}

/// Copies a text.
///
/// # Safety
/// The span is valid.
unsafe fn text(span: Span<c_char>) -> CString {
    if span.first.is_null() {
        return CString::default();
    }
    // SAFETY: guaranteed by the caller.
    let bytes = unsafe { std::slice::from_raw_parts(span.first.cast::<u8>(), span.length) };
    CString::new(bytes).unwrap_or_default()
}

/// Defines methods: the symbol, texts, other arguments, and the call of the C function. In the
/// call, a text is a pointer to its C string.
macro_rules! methods {
    ($(
        $symbol:literal
        fn $name:ident($($text:ident,)* ; $($argument:ident: $type:ty),*) $(-> $answer:ty)? $body:block
    )*) => {$(
        #[doc = concat!("`precice::Participant::", stringify!($name), "`.")]
        ///
        /// # Safety
        /// The arguments are those of the C++ interface.
        #[unsafe(export_name = $symbol)]
        pub unsafe extern "C" fn $name(
            _this: *mut c_void,
            $($text: Span<c_char>,)*
            $($argument: $type,)*
        ) $(-> $answer)? {
            // SAFETY: guaranteed by the caller.
            #[allow(unused_unsafe, reason = "functions without arguments are safe")]
            unsafe {
                $(
                    let $text = text($text);
                    let $text = $text.as_ptr();
                )*
                $body
            }
        }
    )*};
}

methods! {
    "_ZN7precice11ParticipantC1ENS_4spanIKcLm18446744073709551615EEES3_ii"
    fn construct(name, file, ; rank: c_int, size: c_int) {
        c::precicec_createParticipant(name, file, rank, size);
    }
    "_ZN7precice11ParticipantC2ENS_4spanIKcLm18446744073709551615EEES3_ii"
    fn construct_base(name, file, ; rank: c_int, size: c_int) {
        c::precicec_createParticipant(name, file, rank, size);
    }
    "_ZN7precice11ParticipantC1ENS_4spanIKcLm18446744073709551615EEES3_iiPv"
    fn construct_with(name, file, ; rank: c_int, size: c_int, _communicator: *mut c_void) {
        c::precicec_createParticipant(name, file, rank, size);
    }
    "_ZN7precice11ParticipantC2ENS_4spanIKcLm18446744073709551615EEES3_iiPv"
    fn construct_base_with(name, file, ; rank: c_int, size: c_int, _communicator: *mut c_void) {
        c::precicec_createParticipant(name, file, rank, size);
    }
    "_ZN7precice11ParticipantD1Ev"
    fn destroy(;) {
        c::release();
    }
    "_ZN7precice11ParticipantD2Ev"
    fn destroy_base(;) {
        c::release();
    }
    "_ZN7precice11Participant10initializeEv"
    fn initialize(;) {
        c::precicec_initialize();
    }
    "_ZN7precice11Participant7advanceEd"
    fn advance(; step: c_double) {
        c::precicec_advance(step);
    }
    "_ZN7precice11Participant8finalizeEv"
    fn finalize(;) {
        c::precicec_finalize();
    }
    "_ZNK7precice11Participant17getMeshDimensionsENS_4spanIKcLm18446744073709551615EEE"
    fn mesh_dimensions(mesh, ;) -> c_int {
        c::precicec_getMeshDimensions(mesh)
    }
    "_ZNK7precice11Participant17getDataDimensionsENS_4spanIKcLm18446744073709551615EEES3_"
    fn data_dimensions(mesh, data, ;) -> c_int {
        c::precicec_getDataDimensions(mesh, data)
    }
    "_ZNK7precice11Participant17isCouplingOngoingEv"
    fn is_coupling_ongoing(;) -> bool {
        c::precicec_isCouplingOngoing() != 0
    }
    "_ZNK7precice11Participant20isTimeWindowCompleteEv"
    fn is_time_window_complete(;) -> bool {
        c::precicec_isTimeWindowComplete() != 0
    }
    "_ZNK7precice11Participant18getMaxTimeStepSizeEv"
    fn max_time_step_size(;) -> c_double {
        c::precicec_getMaxTimeStepSize()
    }
    "_ZN7precice11Participant19requiresInitialDataEv"
    fn requires_initial_data(;) -> bool {
        c::precicec_requiresInitialData() != 0
    }
    "_ZN7precice11Participant25requiresWritingCheckpointEv"
    fn requires_writing_checkpoint(;) -> bool {
        c::precicec_requiresWritingCheckpoint() != 0
    }
    "_ZN7precice11Participant25requiresReadingCheckpointEv"
    fn requires_reading_checkpoint(;) -> bool {
        c::precicec_requiresReadingCheckpoint() != 0
    }
    "_ZNK7precice11Participant27requiresMeshConnectivityForENS_4spanIKcLm18446744073709551615EEE"
    fn requires_mesh_connectivity_for(mesh, ;) -> bool {
        c::precicec_requiresMeshConnectivityFor(mesh) != 0
    }
    "_ZN7precice11Participant9resetMeshENS_4spanIKcLm18446744073709551615EEE"
    fn reset_mesh(mesh, ;) {
        c::precicec_resetMesh(mesh);
    }
    "_ZN7precice11Participant13setMeshVertexENS_4spanIKcLm18446744073709551615EEENS1_IKdLm18446744073709551615EEE"
    fn set_mesh_vertex(mesh, ; place: Span<c_double>) -> c_int {
        c::precicec_setMeshVertex(mesh, place.first)
    }
    "_ZNK7precice11Participant17getMeshVertexSizeENS_4spanIKcLm18446744073709551615EEE"
    fn mesh_vertex_size(mesh, ;) -> c_int {
        c::precicec_getMeshVertexSize(mesh)
    }
    "_ZN7precice11Participant15setMeshVerticesENS_4spanIKcLm18446744073709551615EEENS1_IKdLm18446744073709551615EEENS1_IiLm18446744073709551615EEE"
    fn set_mesh_vertices(mesh, ; places: Span<c_double>, ids: Span<c_int>) {
        c::precicec_setMeshVertices(mesh, ids.count(1), places.first, ids.first);
    }
    "_ZN7precice11Participant11setMeshEdgeENS_4spanIKcLm18446744073709551615EEEii"
    fn set_mesh_edge(mesh, ; first: c_int, second: c_int) {
        c::precicec_setMeshEdge(mesh, first, second);
    }
    "_ZN7precice11Participant12setMeshEdgesENS_4spanIKcLm18446744073709551615EEENS1_IKiLm18446744073709551615EEE"
    fn set_mesh_edges(mesh, ; ids: Span<c_int>) {
        c::precicec_setMeshEdges(mesh, ids.count(2), ids.first);
    }
    "_ZN7precice11Participant15setMeshTriangleENS_4spanIKcLm18446744073709551615EEEiii"
    fn set_mesh_triangle(mesh, ; first: c_int, second: c_int, third: c_int) {
        c::precicec_setMeshTriangle(mesh, first, second, third);
    }
    "_ZN7precice11Participant16setMeshTrianglesENS_4spanIKcLm18446744073709551615EEENS1_IKiLm18446744073709551615EEE"
    fn set_mesh_triangles(mesh, ; ids: Span<c_int>) {
        c::precicec_setMeshTriangles(mesh, ids.count(3), ids.first);
    }
    "_ZN7precice11Participant11setMeshQuadENS_4spanIKcLm18446744073709551615EEEiiii"
    fn set_mesh_quad(mesh, ; first: c_int, second: c_int, third: c_int, fourth: c_int) {
        c::precicec_setMeshQuad(mesh, first, second, third, fourth);
    }
    "_ZN7precice11Participant12setMeshQuadsENS_4spanIKcLm18446744073709551615EEENS1_IKiLm18446744073709551615EEE"
    fn set_mesh_quads(mesh, ; ids: Span<c_int>) {
        c::precicec_setMeshQuads(mesh, ids.count(4), ids.first);
    }
    "_ZN7precice11Participant18setMeshTetrahedronENS_4spanIKcLm18446744073709551615EEEiiii"
    fn set_mesh_tetrahedron(mesh, ; first: c_int, second: c_int, third: c_int, fourth: c_int) {
        c::precicec_setMeshTetrahedron(mesh, first, second, third, fourth);
    }
    "_ZN7precice11Participant17setMeshTetrahedraENS_4spanIKcLm18446744073709551615EEENS1_IKiLm18446744073709551615EEE"
    fn set_mesh_tetrahedra(mesh, ; ids: Span<c_int>) {
        c::precicec_setMeshTetrahedra(mesh, ids.count(4), ids.first);
    }
    "_ZN7precice11Participant9writeDataENS_4spanIKcLm18446744073709551615EEES3_NS1_IKiLm18446744073709551615EEENS1_IKdLm18446744073709551615EEE"
    fn write_data(mesh, data, ; ids: Span<c_int>, values: Span<c_double>) {
        c::precicec_writeData(mesh, data, ids.count(1), ids.first, values.first);
    }
    "_ZNK7precice11Participant8readDataENS_4spanIKcLm18446744073709551615EEES3_NS1_IKiLm18446744073709551615EEEdNS1_IdLm18446744073709551615EEE"
    fn read_data(mesh, data, ; ids: Span<c_int>, time: c_double, values: Span<c_double>) {
        c::precicec_readData(mesh, data, ids.count(1), ids.first, time, values.first);
    }
    "_ZN7precice11Participant15writeAndMapDataENS_4spanIKcLm18446744073709551615EEES3_NS1_IKdLm18446744073709551615EEES5_"
    fn write_and_map_data(mesh, data, ; places: Span<c_double>, values: Span<c_double>) {
        c::precicec_writeAndMapData(mesh, data, 0, places.first, values.first);
    }
    "_ZNK7precice11Participant14mapAndReadDataENS_4spanIKcLm18446744073709551615EEES3_NS1_IKdLm18446744073709551615EEEdNS1_IdLm18446744073709551615EEE"
    fn map_and_read_data(
        mesh, data, ; places: Span<c_double>, time: c_double, values: Span<c_double>
    ) {
        c::precicec_mapAndReadData(mesh, data, 0, places.first, time, values.first);
    }
    "_ZNK7precice11Participant19setMeshAccessRegionENS_4spanIKcLm18446744073709551615EEENS1_IKdLm18446744073709551615EEE"
    fn set_mesh_access_region(mesh, ; region: Span<c_double>) {
        c::precicec_setMeshAccessRegion(mesh, region.first);
    }
    "_ZNK7precice11Participant30getMeshVertexIDsAndCoordinatesENS_4spanIKcLm18446744073709551615EEENS1_IiLm18446744073709551615EEENS1_IdLm18446744073709551615EEE"
    fn mesh_vertex_ids_and_coordinates(mesh, ; ids: Span<c_int>, places: Span<c_double>) {
        c::precicec_getMeshVertexIDsAndCoordinates(mesh, ids.count(1), ids.first, places.first);
    }
    "_ZNK7precice11Participant23requiresGradientDataForENS_4spanIKcLm18446744073709551615EEES3_"
    fn requires_gradient_data_for(mesh, data, ;) -> bool {
        c::precicec_requiresGradientDataFor(mesh, data) != 0
    }
    "_ZN7precice11Participant17writeGradientDataENS_4spanIKcLm18446744073709551615EEES3_NS1_IKiLm18446744073709551615EEENS1_IKdLm18446744073709551615EEE"
    fn write_gradient_data(mesh, data, ; ids: Span<c_int>, gradients: Span<c_double>) {
        c::precicec_writeGradientData(mesh, data, ids.count(1), ids.first, gradients.first);
    }
    "_ZN7precice11Participant21startProfilingSectionENS_4spanIKcLm18446744073709551615EEE"
    fn start_profiling_section(section, ;) {
        c::precicec_startProfilingSection(section);
    }
    "_ZN7precice11Participant24stopLastProfilingSectionEv"
    fn stop_last_profiling_section(;) {
        c::precicec_stopLastProfilingSection();
    }
}

/// `std::string` of GNU's C++ library, with its text inside.
#[cfg(target_arch = "x86_64")]
#[repr(C)]
pub struct ShortString {
    first: *mut u8,
    length: usize,
    characters: [u8; 16],
}

/// `precice::getVersionInformation`. The caller passes the place of the returned object as a hidden
/// argument.
///
/// # Safety
/// `answer` has room for a string.
#[cfg(target_arch = "x86_64")]
#[unsafe(export_name = "_ZN7precice21getVersionInformationB5cxx11Ev")]
pub unsafe extern "C" fn version_information(answer: *mut ShortString) -> *mut ShortString {
    let version = c::VERSION.to_bytes();
    let mut characters = [0; 16];
    characters[..version.len()].copy_from_slice(version);
    // SAFETY: guaranteed by the caller.
    unsafe {
        let first = (&raw mut (*answer).characters).cast();
        answer.write(ShortString { first, length: version.len(), characters });
    }
    answer
}

//! Reasons why a call of the program is refused.

use std::io;

/// Refused call. The text names the cause and the fix; the name of the function is added by its
/// caller.
#[derive(Debug, thiserror::Error)]
pub enum CallError {
    /// The program was started by hand.
    #[error(
        "the program is not started by `precice-participant`, which gives it a socket in {0}; \
         name that command in the case"
    )]
    NotLaunched(&'static str),
    /// The connection to the launcher is lost.
    #[error("the connection to `precice-participant` is lost: {0}")]
    Link(#[from] io::Error),
    /// The launcher refuses the request.
    #[error("{0}")]
    Refused(String),
    /// The launcher's answer does not fit the request.
    #[error("`precice-participant` gave an answer that does not fit the request")]
    Protocol,
    /// The program has several processes.
    #[error(
        "rank {rank} of {size} creates a participant; only one process may: gather the values on \
         rank 0, and create the participant there as rank 0 of 1"
    )]
    Parallel {
        /// Rank of the process.
        rank: i32,
        /// Number of processes.
        size: i32,
    },
    /// No participant exists.
    #[error("no participant exists; create one first")]
    NoParticipant,
    /// A second participant is created.
    #[error("a participant exists already; a process can have one")]
    SecondParticipant,
    /// The call comes too early or too late.
    #[error("not allowed {0}")]
    Order(&'static str),
    /// The feature does not exist here.
    #[error("{what} is not supported; {fix}")]
    Unsupported {
        /// Name of the feature.
        what: &'static str,
        /// Replacement for the feature.
        fix: &'static str,
    },
    /// The participant provides no mesh of this name.
    #[error("mesh `{name}` is not provided by this participant; it provides: {known}")]
    UnknownMesh {
        /// Name in the call.
        name: String,
        /// Names of the meshes.
        known: String,
    },
    /// The mesh has no such data in this direction.
    #[error(
        "data `{data}` is not {direction} on mesh `{mesh}` by this participant; these are: {known}"
    )]
    UnknownData {
        /// Name of the mesh.
        mesh: String,
        /// Name in the call.
        data: String,
        /// `read` or `written`.
        direction: &'static str,
        /// Names of the data.
        known: String,
    },
    /// A vertex does not exist.
    #[error(
        "vertex {id} of mesh `{mesh}` does not exist; it has {count} vertices, numbered from 0"
    )]
    UnknownVertex {
        /// Name of the mesh.
        mesh: String,
        /// Number in the call.
        id: i32,
        /// Number of vertices.
        count: usize,
    },
    /// The vertices of a quadrilateral form none that is convex.
    #[error(
        "the vertices {}, {}, {}, {} of mesh `{mesh}` form no convex quadrilateral; pass two \
         triangles", .vertices[0], .vertices[1], .vertices[2], .vertices[3]
    )]
    NotConvex {
        /// Name of the mesh.
        mesh: String,
        /// Numbers of the vertices.
        vertices: [u32; 4],
    },
    /// The number of values does not match.
    #[error("{found} {what} instead of {expected}")]
    Count {
        /// Kind of values.
        what: &'static str,
        /// Number in the call.
        found: usize,
        /// Expected number.
        expected: usize,
    },
    /// A value is not finite.
    #[error("{what} {index} is {value}")]
    NotFinite {
        /// Kind of values.
        what: &'static str,
        /// Index in the call.
        index: usize,
        /// The value.
        value: f64,
    },
    /// A mesh has no vertices.
    #[error("mesh `{0}` has no vertices; set them before initialize")]
    EmptyMesh(String),
    /// A value was not written.
    #[error(
        "data `{data}` of mesh `{mesh}` was not written at vertex {vertex} in the window; write all \
         vertices before the last advance of each window"
    )]
    NotWritten {
        /// Name of the mesh.
        mesh: String,
        /// Name of the data.
        data: String,
        /// First vertex without a value.
        vertex: usize,
    },
    /// The time step does not fit the window.
    #[error(
        "a time step of {step} s; it must be above 0 and at most getMaxTimeStepSize() = {most} s"
    )]
    Step {
        /// Length of the step [s].
        step: f64,
        /// Rest of the window [s].
        most: f64,
    },
    /// The relative time does not lie in the window.
    #[error("a relative time of {time} s; it must be from 0 to getMaxTimeStepSize() = {most} s")]
    Time {
        /// Time in the call [s].
        time: f64,
        /// Rest of the window [s].
        most: f64,
    },
    /// The program cannot repeat a window.
    #[error(
        "the coupling solves the window again, but the program has not called \
         requiresWritingCheckpoint at its start, and cannot go back; choose an explicit \
         coupling.scheme, or a program with checkpoints"
    )]
    NoCheckpoint,
    /// The program has not asked whether to go back.
    #[error(
        "the coupling solves the window again, but the program has not called \
         requiresReadingCheckpoint after the last advance"
    )]
    CheckpointNotRead,
    /// A text of the call is null or not UTF-8.
    #[error("a name is null or not UTF-8")]
    Text,
    /// A pointer of the call is null.
    #[error("a pointer is null although {0} values are expected")]
    Null(usize),
    /// The number of values is negative.
    #[error("a size of {0}")]
    Size(i32),
}

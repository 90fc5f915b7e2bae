/*
 * libcosim: a participant of a co-simulation in C, C++ or Fortran.
 *
 * Fill a cosim_solver and pass it to cosim_main(); proto/c/README.md shows how, and
 * proto/c/examples/closed_form.c is a complete solver.
 *
 * Numbers are in SI units. Strings are UTF-8 and end with a NUL. Pointers passed to a callback are
 * valid until the callback returns. Any misuse, such as a forbidden NULL, makes the callback fail,
 * whatever status it returns.
 */

#ifndef COSIM_H
#define COSIM_H

/* Written from the sources by `COSIM_HEADER=write cargo test -p cosim-c --test header`. */

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** JSON without quotes to escape: COSIM_JSON({"name": "mine"}). */
#define COSIM_JSON(...) #__VA_ARGS__

/**
 * Index of the upper body in a pair.
 */
#define COSIM_UPPER 0

/**
 * Index of the lower body in a pair.
 */
#define COSIM_LOWER 1

/**
 * Status of a callback or function: success.
 */
#define COSIM_OK 0

/**
 * Status of a callback or function: the case is refused, see cosim_refuse().
 */
#define COSIM_REFUSED 1

/**
 * Status of a callback or function: failure, see cosim_fail().
 */
#define COSIM_FAILED 2

/**
 * Kind of a grid: a plane patch of ni x nj equal elements.
 */
#define COSIM_STRUCTURED 1

/**
 * Kind of a grid: a surface of quadrilaterals.
 */
#define COSIM_QUADRILATERALS 2

/**
 * Kind of a grid: vertices that carry values. Such a grid is only received.
 */
#define COSIM_VERTICES 3

/**
 * Version of this interface; raised when programs must be changed, not only recompiled.
 */
#define COSIM_VERSION 4

/**
 * Flag of cosim_report.present: the program reports the power that it receives.
 */
#define COSIM_RECEIVED_POWER 1

/**
 * Flag of cosim_report.present: the program limits the window.
 */
#define COSIM_WANTED_WINDOW 2

/**
 * Kind of a volume: ni x nj x nk boxes between the nodes of three axes.
 */
#define COSIM_RECTILINEAR 3

/**
 * Kind of a volume: ni x nj x nk hexahedra with vertices at any position.
 */
#define COSIM_STRUCTURED_HEXAHEDRA 4

/**
 * Kind of a volume: hexahedra over shared vertices.
 */
#define COSIM_UNSTRUCTURED_HEXAHEDRA 5

/**
 * A state being written to or read from a file.
 */
typedef struct cosim_blob cosim_blob;

/**
 * Configuration of a program before a run: role, model, case values, inputs and outputs. Strings
 * obtained from it are valid until configure returns.
 */
typedef struct cosim_configuration cosim_configuration;

/**
 * The inputs of a solve.
 */
typedef struct cosim_inputs cosim_inputs;

/**
 * Answer of configure: the program's grids, the grid of each field, and the expected cost.
 */
typedef struct cosim_layout cosim_layout;

/**
 * Grids whose geometry a program may supply: moving grids and volumes.
 */
typedef struct cosim_moves cosim_moves;

/**
 * The outputs of a callback.
 */
typedef struct cosim_outputs cosim_outputs;

/**
 * One iteration of one window.
 */
typedef struct cosim_step {
    /**
     * Number of the window, from 0.
     */
    uint64_t window;
    /**
     * Iteration within the window, from 1.
     */
    uint32_t iteration;
    /**
     * Start of the window [s].
     */
    double start;
    /**
     * End of the window [s]; equal to start in a steady case.
     */
    double end;
} cosim_step;

/**
 * Report of a solve, besides its outputs. The library initialises all members to 0.
 */
typedef struct cosim_report {
    /**
     * Number of steps inside the window.
     */
    uint32_t substeps;
    /**
     * Number of iterations of the inner solver.
     */
    uint32_t inner_iterations;
    /**
     * Number of elementary operations, in the program's own unit.
     */
    uint64_t work;
    /**
     * Any of COSIM_RECEIVED_POWER and COSIM_WANTED_WINDOW: the quantities that the program
     * reports.
     */
    uint32_t present;
    /**
     * Mean power received through conservative inputs over the window [W]; the coordinator
     * compares it with the power sent.
     */
    double received_power;
    /**
     * Longest window that the program accepts from the start of this one [s], limited by an event
     * or by accuracy. Adaptive windows respect a shorter value.
     */
    double wanted_window;
} cosim_report;

/**
 * A solver: its callbacks. Each is called with the `user` of cosim_main() as the first argument,
 * and never from two threads at once.
 *
 * A callback returns COSIM_OK, or the result of cosim_refuse() or cosim_fail(). A callback that
 * returns a text returns NULL after one of these. A callback must not throw a C++ exception nor
 * longjmp out. Optional callbacks may be NULL; describe, configure and solve are required.
 */
typedef struct cosim_solver {
    /**
     * sizeof(cosim_solver); callbacks appended in a later version are NULL for this program.
     */
    size_t size;
    /**
     * COSIM_VERSION.
     */
    uint32_t version;
    /**
     * Returns the description of the program as JSON (see proto/c/README.md); called once. The
     * program owns the text, which must stay valid until destroy.
     */
    const char *(*describe)(void *user);
    /**
     * Checks a configuration and sets grids and cost. Cheap; allocates no fields. May be called
     * more than once; the last call counts.
     */
    int (*configure)(void *user,
                     const struct cosim_configuration *configuration,
                     struct cosim_layout *layout);
    /**
     * Allocates everything the solver needs. NULL: nothing to allocate. A program that describes
     * itself as "reusable" is configured and built again for another run, in which nothing of the
     * previous run may remain.
     */
    int (*build)(void *user);
    /**
     * Writes the initial outputs, before the first solve. NULL: zeros.
     */
    int (*first_outputs)(void *user, struct cosim_outputs *outputs);
    /**
     * Solves one window from the accepted state with the given inputs, and writes the outputs. A
     * window may be solved any number of times; only accept advances the state.
     */
    int (*solve)(void *user,
                 const struct cosim_step *step,
                 const struct cosim_inputs *inputs,
                 struct cosim_outputs *outputs,
                 struct cosim_report *report);
    /**
     * Makes the last solve the accepted state. NULL: the program has no state.
     */
    int (*accept)(void *user);
    /**
     * Writes the observed fields of the accepted state, which are output fields not needed in
     * every iteration. NULL: runs that observe a field are refused.
     */
    int (*observe)(void *user, struct cosim_outputs *outputs);
    /**
     * Writes the accepted state with cosim_blob_write(). NULL, together with restore: the program
     * has no state.
     */
    int (*save)(void *user, struct cosim_blob *blob);
    /**
     * Restores a saved state, which it must read completely with cosim_blob_read(); the run then
     * continues bit-identically.
     */
    int (*restore)(void *user, struct cosim_blob *blob);
    /**
     * Returns the program's part of summary.json, a JSON object of sections that are merged over
     * the participants: {"temperature": {...}}. The program owns the text, which must stay valid
     * until destroy. NULL: no summary.
     */
    const char *(*summary)(void *user);
    /**
     * Frees the resources of `user`; called once, last.
     */
    void (*destroy)(void *user);
    /**
     * Supplies the geometry of the layout's volumes and moving grids in the accepted state, with
     * cosim_geometry(). Called after build, accept and restore, if any of these grids is needed;
     * the geometry must not change in between. NULL: there are no such grids.
     */
    int (*moved_grids)(void *user, struct cosim_moves *moves);
    /**
     * Frees the allocations of build, because the run is over. Called after every successful
     * build, even if the run failed. NULL: destroy or the next build frees them.
     */
    int (*finish)(void *user);
} cosim_solver;

/**
 * A surface grid. Values belong to element centres or, on vertices, to the vertices.
 *
 * Structured: the centre of element (i, j) is origin + i step_i + j step_j, and its value stands
 * at j ni + i. In the contact plane, step_i points along x, the rolling direction, and step_j
 * along y, to the left. Quadrilaterals: element n has the corners elements[4n] to elements[4n+3],
 * in order around the element; vertex v stands at vertices[3v] to vertices[3v+2]. Vertices: vertex
 * v stands there too, and its value at v.
 *
 * In a grid obtained from the library, the library owns the pointers; they are valid until the
 * callback returns. Members of the other kind are 0.
 */
typedef struct cosim_grid {
    /**
     * Name, unique within the program that owns the grid: letters, digits, `_` and `-`.
     */
    char name[32];
    /**
     * Increases by one whenever the geometry changes; starts at 1, and 0 is read as 1.
     */
    uint64_t revision;
    /**
     * COSIM_STRUCTURED, COSIM_QUADRILATERALS or COSIM_VERTICES.
     */
    int kind;
    /**
     * Number of elements or vertices with values; unused for a structured grid passed to the
     * library.
     */
    size_t points;
    /**
     * Structured: centre of element (0, 0) [m].
     */
    double origin[3];
    /**
     * Structured: vector from one element to the next in i [m].
     */
    double step_i[3];
    /**
     * Structured: vector from one element to the next in j [m].
     */
    double step_j[3];
    /**
     * Structured: number of elements in i.
     */
    size_t ni;
    /**
     * Structured: number of elements in j.
     */
    size_t nj;
    /**
     * Quadrilaterals and vertices: number of vertices.
     */
    size_t vertex_count;
    /**
     * Quadrilaterals and vertices: three coordinates of each vertex [m].
     */
    const double *vertices;
    /**
     * Quadrilaterals: four vertices of each element, numbered from 0.
     */
    const uint32_t *elements;
} cosim_grid;

/**
 * A volume: hexahedra for output fields only. Element (i, j, k) has index (k nj + j) ni + i.
 *
 * The geometry goes into the buffer of cosim_geometry(): vectors of three components [m],
 * component-major (all first components, then all second, then all third). Rectilinear: the n-th
 * nodes of the axes x, y and z, as many as the longest axis has; 0 beyond the end of a shorter
 * axis. Structured: the (ni + 1) (nj + 1) (nk + 1) vertices, i fastest, then j. Unstructured: the
 * vertices, followed for each element by its corners a to h, vertex numbers from 0, as (a, b, c),
 * (d, e, f) and (g, h, 0). Corners are in VTK's order, with a positive volume.
 */
typedef struct cosim_volume {
    /**
     * Name, unique among the program's grids: letters, digits, `_` and `-`.
     */
    char name[32];
    /**
     * COSIM_RECTILINEAR, COSIM_STRUCTURED_HEXAHEDRA or COSIM_UNSTRUCTURED_HEXAHEDRA.
     */
    int kind;
    /**
     * Number of elements in i; unused for unstructured hexahedra, like nj and nk.
     */
    size_t ni;
    /**
     * Number of elements in j.
     */
    size_t nj;
    /**
     * Number of elements in k.
     */
    size_t nk;
    /**
     * Unstructured: number of vertices.
     */
    size_t vertices;
    /**
     * Unstructured: number of elements.
     */
    size_t elements;
} cosim_volume;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/**
 * Complete main function of a participant: prints the description with --describe, and with --join
 * takes part in a run until the run is finished. `user` is passed unchanged to every callback.
 *
 * Returns the exit code: 0 for success, 1 for an error, which is written to standard error, 2 for
 * invalid arguments. A thread of the library sends the heartbeat and ends the process if the
 * coordinator dies. SIGPIPE is ignored from here on, unless the program handles it.
 */
int cosim_main(int argc, char **argv, const struct cosim_solver *solver, void *user);

/**
 * Returns the whole configuration as JSON, for entries without an accessor. NULL on failure.
 */
const char *cosim_configuration_json(const struct cosim_configuration *configuration);

/**
 * Returns the role to play ("thermal"). NULL on failure.
 */
const char *cosim_role(const struct cosim_configuration *configuration);

/**
 * Returns the name of the chosen model, from the description. NULL on failure.
 */
const char *cosim_model(const struct cosim_configuration *configuration);

/**
 * Returns true for a transient case (windows of coupling time), false for a steady case (a single
 * window without duration).
 */
bool cosim_is_transient(const struct cosim_configuration *configuration);

/**
 * Returns the number of threads to compute on, at least 1. Results must be independent of this
 * number. 0 on failure.
 */
size_t cosim_threads(const struct cosim_configuration *configuration);

/**
 * Returns true if an effect is active and claimed by this program.
 */
bool cosim_has_effect(const struct cosim_configuration *configuration, const char *effect);

/**
 * Returns true if an output is requested, in every iteration or when observed.
 */
bool cosim_is_wanted(const struct cosim_configuration *configuration, const char *field);

/**
 * Returns true if the case has a value or table at a dotted key.
 */
bool cosim_case_has(const struct cosim_configuration *configuration, const char *key);

/**
 * Reads a number of the case, in SI units, at a dotted key ("materials.steel.conductivity").
 *
 * Returns COSIM_OK. If the number is missing or not finite, returns COSIM_REFUSED with a reason
 * that names the key, which the callback can return; *value is then unchanged.
 */
int cosim_case_number(const struct cosim_configuration *configuration,
                      const char *key,
                      double *value);

/**
 * Reads a whole number of the case; otherwise like cosim_case_number().
 */
int cosim_case_integer(const struct cosim_configuration *configuration,
                       const char *key,
                       int64_t *value);

/**
 * Reads a Boolean of the case; otherwise like cosim_case_number().
 */
int cosim_case_flag(const struct cosim_configuration *configuration, const char *key, bool *value);

/**
 * Returns a text or word of the case at a dotted key. If it is missing or not a text, returns NULL
 * and records a refusal that names the key.
 */
const char *cosim_case_text(const struct cosim_configuration *configuration, const char *key);

/**
 * Returns the case's name of a body, COSIM_UPPER or COSIM_LOWER; the body's values stand under
 * "bodies.NAME". Returns NULL and records a refusal unless the case has one body at each position.
 * The description must list the key "bodies.*.position".
 */
const char *cosim_body_name(const struct cosim_configuration *configuration, int body);

/**
 * Writes the grid on which an input will arrive; returns false if it is unknown. The grid is
 * unknown if the field is not an input of this run, or while its producer is not yet configured.
 * In the latter case configure returns without grids and is called again later.
 */
bool cosim_input_grid(const struct cosim_configuration *configuration,
                      const char *field,
                      struct cosim_grid *grid);

/**
 * Refuses the case; the run ends before it has begun, with exit code 2.
 *
 * For configure and build: `return cosim_refuse(...)`. `key` is the dotted key of the case at
 * fault ("motion.speed"), `reason` states why its value is refused, `fix` what to write instead.
 * All three are copied. Returns COSIM_REFUSED.
 */
int cosim_refuse(const char *key, const char *reason, const char *fix);

/**
 * Reports the failure of a callback; the run ends with exit code 1 and this text as its error.
 *
 * Use `return cosim_fail("...")` in any callback, on the thread of the call. `message` is copied.
 * Returns COSIM_FAILED.
 */
int cosim_fail(const char *message);

/**
 * Returns the values of an input at the end of the window, component by component with one value
 * per element. The values are read in place and valid until the callback returns.
 *
 * Writes the number of values and the current grid; both pointers may be NULL. Returns NULL, and a
 * count of 0, if the field does not arrive in this run.
 */
const double *cosim_input(const struct cosim_inputs *inputs,
                          const char *field,
                          size_t *count,
                          struct cosim_grid *grid);

/**
 * Returns the values of an input at the start of the window, as many as in cosim_input(). Within
 * the window the field varies linearly from these values to those of cosim_input(). Returns NULL
 * for a field that is constant within a window.
 */
const double *cosim_input_start(const struct cosim_inputs *inputs,
                                const char *field,
                                size_t *count);

/**
 * Returns a required input like cosim_input(): `count` values, all finite. Otherwise returns NULL
 * and records a reason that names the field, to be returned as COSIM_FAILED. This happens if the
 * field does not arrive, has another number of values, or holds a NaN or an infinity.
 */
const double *cosim_require_input(const struct cosim_inputs *inputs,
                                  const char *field,
                                  size_t count);

/**
 * Returns the buffer for the values of an output, component by component with one value per
 * element, valid until the callback returns. Every value must be written: the buffer holds old
 * data, and an unwritten output fails the call. Writes the number of values; `count` may be NULL.
 * Returns NULL, and a count of 0, if nobody needs the field now.
 */
double *cosim_output(struct cosim_outputs *outputs, const char *field, size_t *count);

/**
 * Appends `size` bytes to the state, for save.
 */
int cosim_blob_write(struct cosim_blob *blob, const void *bytes, size_t size);

/**
 * Reads the next `size` bytes of the state, for restore, which must read all bytes. Returns
 * COSIM_FAILED and records a reason if there are fewer.
 */
int cosim_blob_read(struct cosim_blob *blob, void *bytes, size_t size);

/**
 * Reads at most `size` bytes of the state, for restore. Returns the number of bytes read, 0 at the
 * end of the state and on failure.
 */
size_t cosim_blob_read_some(struct cosim_blob *blob, void *bytes, size_t size);

/**
 * Sets the whole layout from JSON (docs/write-a-solver.md), for entries without a function of
 * their own. Returns COSIM_FAILED if the text is not a layout or is invalid, such as a grid
 * without area or a field on an unknown grid.
 */
int cosim_layout_json(struct cosim_layout *layout, const char *json);

/**
 * Adds a copy of a grid. Returns COSIM_FAILED if the grid is invalid: name, counts, elements
 * without area.
 */
int cosim_layout_grid(struct cosim_layout *layout, const struct cosim_grid *grid);

/**
 * Adds a copy of a volume; `moved_grids` supplies its geometry. Returns COSIM_FAILED if the volume
 * is invalid: name, counts.
 */
int cosim_layout_volume(struct cosim_layout *layout, const struct cosim_volume *volume);

/**
 * Sets the grid of an output or observed field. Both names are copied.
 */
int cosim_layout_output(struct cosim_layout *layout, const char *field, const char *grid);

/**
 * Requests an input on one of the program's grids; the coordinator maps it there from the
 * producer's grid. Inputs without a request arrive on the grid of their producer. Both names are
 * copied.
 */
int cosim_layout_input(struct cosim_layout *layout, const char *field, const char *grid);

/**
 * Sets the expected processor time of one solve [s] and the memory of the program's arrays [byte].
 */
int cosim_layout_cost(struct cosim_layout *layout, double solve_seconds, uint64_t memory_bytes);

/**
 * Sets the expected processor time of `build` [s], from which the deadline for building follows.
 */
int cosim_layout_build_seconds(struct cosim_layout *layout, double build_seconds);

/**
 * Adds a simplification of the model in this particular case, with its expected relative error and
 * the origin of this number. Both texts are copied.
 */
int cosim_layout_left_out(struct cosim_layout *layout,
                          const char *what,
                          double error,
                          const char *source);

/**
 * Adds a quantity of the summary whose exact value is known in this case, by its dotted key, which
 * is copied.
 */
int cosim_layout_closed_form(struct cosim_layout *layout, const char *key, double exact);

/**
 * Adds a line to the output of `coordinator plan`, on the model's view of the case. The text is
 * copied.
 */
int cosim_layout_remark(struct cosim_layout *layout, const char *remark);

/**
 * Returns the buffer for the geometry of a grid in a revision: vectors of three components [m],
 * component-major (all first components, then all second, then all third). Every value must be
 * written. Returns NULL, and a count of 0, if the geometry is already known or nobody needs it.
 *
 * Structured: origin, step_i, step_j and (ni, nj, 1). Quadrilaterals: the vertices. Volume: see
 * cosim_volume. Writes the number of values; `count` may be NULL.
 */
double *cosim_geometry(struct cosim_moves *moves,
                       const char *grid,
                       uint64_t revision,
                       size_t *count);

/**
 * Reports the progress of build, solve, save or restore: `done` of `of` units of work; `of` is 0
 * if unknown. `what` names the activity in one ASCII word of at most 31 letters ("factorising").
 * May be called from any thread, as often as needed.
 *
 * Whenever the report changes, the coordinator restarts its deadline and shows the report to the
 * user.
 */
int cosim_progress(uint64_t done, uint64_t of, const char *what);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* COSIM_H */

/*
 * libcosim: a participant of a co-simulation in C, C++ or Fortran.
 *
 * Fill a cosim_solver and hand it to cosim_main(); proto/c/README.md shows how, and
 * proto/c/examples/closed_form.c is a whole solver.
 *
 * Numbers are in SI units. Strings end with a NUL and are UTF-8. A pointer that a callback is given
 * holds until it returns. A NULL where none is allowed, like every other wrong use, makes the
 * callback in which it happens fail, whatever that returns.
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
 * Status of a callback or function: done.
 */
#define COSIM_OK 0

/**
 * Status of a callback or function: the case is refused, see cosim_refuse().
 */
#define COSIM_REFUSED 1

/**
 * Status of a callback or function: it failed, see cosim_fail().
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
 * Version of this interface. Raised when a program has to be changed, and not only compiled again.
 */
#define COSIM_VERSION 3

/**
 * Kind of a volume: ni x nj x nk boxes between the nodes of three axes.
 */
#define COSIM_RECTILINEAR 3

/**
 * Kind of a volume: ni x nj x nk hexahedra with vertices anywhere.
 */
#define COSIM_STRUCTURED_HEXAHEDRA 4

/**
 * Kind of a volume: hexahedra over shared vertices.
 */
#define COSIM_UNSTRUCTURED_HEXAHEDRA 5

/**
 * A state on its way to or from a file.
 */
typedef struct cosim_blob cosim_blob;

/**
 * What a program is given before a run: role, model, case values, inputs and outputs. Strings that
 * come from it hold until configure returns.
 */
typedef struct cosim_configuration cosim_configuration;

/**
 * The inputs of a solve.
 */
typedef struct cosim_inputs cosim_inputs;

/**
 * What configure answers: the program's grids, which field lives on which, and the expected cost.
 */
typedef struct cosim_layout cosim_layout;

/**
 * Grids whose geometry a program may give: those that move, and volumes.
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
 * What a solve says besides its outputs. The library sets everything to 0 or NAN before.
 */
typedef struct cosim_report {
    /**
     * Steps taken inside the window.
     */
    uint32_t substeps;
    /**
     * Iterations of the inner solver.
     */
    uint32_t inner_iterations;
    /**
     * Number of elementary operations in the program's own measure.
     */
    uint64_t work;
    /**
     * Heat received through conservative inputs, as the mean power over the window [W]: the
     * coordinator's audit compares it with what was sent. NAN for a program that receives none.
     */
    double heat_received;
    /**
     * Longest window that the program would take from this one's start [s]: up to an event, or for
     * its accuracy. Adaptive windows obey it where it is shorter. NAN for no wish.
     */
    double wanted_window;
} cosim_report;

/**
 * A solver: its callbacks, each called with the `user` of cosim_main() as the first argument, and
 * never from two threads at once.
 *
 * A callback answers COSIM_OK, or what cosim_refuse() or cosim_fail() return; one that answers with
 * a text, NULL after one of these. It must not throw a C++ exception nor jump out. A callback that
 * is NULL is left out; describe, configure and solve must be there.
 */
typedef struct cosim_solver {
    /**
     * sizeof(cosim_solver): callbacks that a later version appends are NULL for this program.
     */
    size_t size;
    /**
     * COSIM_VERSION.
     */
    uint32_t version;
    /**
     * What the program can do, as JSON (see proto/c/README.md); called once. The text is the
     * program's and stays until destroy.
     */
    const char *(*describe)(void *user);
    /**
     * Checks a configuration and answers with grids and cost; cheap, allocates no field. May be
     * called more than once, the last one counts.
     */
    int (*configure)(void *user,
                     const struct cosim_configuration *configuration,
                     struct cosim_layout *layout);
    /**
     * Allocates everything the solver needs. NULL: nothing. A program that describes itself as
     * "reusable" is configured and built again for another run, in which nothing of the one before
     * may be left.
     */
    int (*build)(void *user);
    /**
     * Writes the outputs that hold before the first solve. NULL: zeros.
     */
    int (*first_outputs)(void *user, struct cosim_outputs *outputs);
    /**
     * Solves one window from the accepted state with the given inputs, and writes the outputs. A
     * window may be solved any number of times: only accept moves on.
     */
    int (*solve)(void *user,
                 const struct cosim_step *step,
                 const struct cosim_inputs *inputs,
                 struct cosim_outputs *outputs,
                 struct cosim_report *report);
    /**
     * Makes the last solve the accepted state. NULL: there is no state.
     */
    int (*accept)(void *user);
    /**
     * Writes the observed fields of the accepted state: those that are only looked at and need not
     * be there in every iteration. NULL: a run that would observe any is refused.
     */
    int (*observe)(void *user, struct cosim_outputs *outputs);
    /**
     * Writes the accepted state with cosim_blob_write(). NULL, together with restore: no state.
     */
    int (*save)(void *user, struct cosim_blob *blob);
    /**
     * Returns to a saved state, all of which it reads with cosim_blob_read(); the run then continues
     * bit-identically.
     */
    int (*restore)(void *user, struct cosim_blob *blob);
    /**
     * The program's part of summary.json, a JSON object of sections that are merged over the
     * participants: {"temperature": {...}}. The text is the program's and stays until destroy.
     * NULL: none.
     */
    const char *(*summary)(void *user);
    /**
     * Frees what `user` holds; called once, last.
     */
    void (*destroy)(void *user);
    /**
     * Gives the geometry of the layout's volumes and of its grids that move, as they are in the
     * accepted state, with cosim_geometry(). Called after build, accept and restore, if anybody
     * needs one of them; between these calls they stay. NULL: there are none.
     */
    int (*moved_grids)(void *user, struct cosim_moves *moves);
    /**
     * Frees what build has allocated: the run is over. Called after a build that succeeded, also
     * if the run failed. NULL: destroy or the next build does it.
     */
    int (*finish)(void *user);
} cosim_solver;

/**
 * A surface grid. Values belong to element centres.
 *
 * Structured: the centre of element (i, j) is origin + i step_i + j step_j, its value stands at
 * j ni + i. For the contact plane step_i points along x, the rolling direction, and step_j along
 * y, to the left. Quadrilaterals: element n has the corners elements[4n] to elements[4n+3], in
 * order round it; vertex v is at vertices[3v] to vertices[3v+2].
 *
 * In a grid that comes from the library the pointers are the library's and hold until the callback
 * returns; members of the other kind are 0.
 */
typedef struct cosim_grid {
    /**
     * Name, unique within the program that owns the grid: letters, digits, `_` and `-`.
     */
    char name[32];
    /**
     * Rises by one whenever the geometry changes; the first is 1, and 0 is taken for 1.
     */
    uint64_t revision;
    /**
     * COSIM_STRUCTURED or COSIM_QUADRILATERALS.
     */
    int kind;
    /**
     * Number of elements, whatever the kind; for a structured grid given to the library, unused.
     */
    size_t points;
    /**
     * Structured: centre of element (0, 0) [m].
     */
    double origin[3];
    /**
     * Structured: from one element to the next in i [m].
     */
    double step_i[3];
    /**
     * Structured: from one element to the next in j [m].
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
     * Quadrilaterals: number of vertices.
     */
    size_t vertex_count;
    /**
     * Quadrilaterals: three coordinates of each vertex [m].
     */
    const double *vertices;
    /**
     * Quadrilaterals: four vertices of each element, counted from 0.
     */
    const uint32_t *elements;
} cosim_grid;

/**
 * A volume: hexahedra on which fields are only written out. The value of element (i, j, k) stands at
 * (k nj + j) ni + i.
 *
 * Its geometry goes into the place of cosim_geometry(): vectors of three components [m], the
 * first components of all of them, then the second, then the third. Rectilinear: the n-th nodes of
 * the axes x, y and z, as many as the longest axis has, 0 beyond the last of a shorter one.
 * Structured: the (ni + 1) (nj + 1) (nk + 1) vertices, i fastest, then j. Unstructured: the vertices,
 * then for each element its corners a to h, numbers of vertices from 0, as (a, b, c), (d, e, f) and
 * (g, h, 0). Corners are in VTK's order, with a positive volume.
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
     * Number of elements in i; of unstructured hexahedra unused, as nj and nk.
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
 * The whole main of a participant: answers --describe and --estimate, and with --join takes part in
 * a run until it is finished. `user` is handed to every callback and not looked at.
 *
 * Returns the exit code: 0, 1 for an error, which is written to standard error, 2 for wrong
 * arguments. While it runs, a thread of the library's own beats the heart; should the coordinator
 * die, that thread ends the process. SIGPIPE is ignored from here on, unless the program handles it.
 */
int cosim_main(int argc,
               char **argv,
               const struct cosim_solver *solver,
               void *user);

/**
 * The whole configuration as JSON, for what has no accessor. NULL on failure.
 */
const char *cosim_configuration_json(const struct cosim_configuration *configuration);

/**
 * The role to play ("thermal"). NULL on failure.
 */
const char *cosim_role(const struct cosim_configuration *configuration);

/**
 * The model chosen, one of the description's. NULL on failure.
 */
const char *cosim_model(const struct cosim_configuration *configuration);

/**
 * Whether the case is transient: windows of coupling time, and not one without duration.
 */
bool cosim_is_transient(const struct cosim_configuration *configuration);

/**
 * Threads that the program may compute on at the same time, at least 1. Its results must not depend
 * on it. 0 on failure.
 */
size_t cosim_threads(const struct cosim_configuration *configuration);

/**
 * Whether an effect is active and claimed by this program.
 */
bool cosim_has_effect(const struct cosim_configuration *configuration, const char *effect);

/**
 * Whether an output is wanted: in every iteration, or observed.
 */
bool cosim_is_wanted(const struct cosim_configuration *configuration, const char *field);

/**
 * Whether the case has a value or table at a dotted key.
 */
bool cosim_case_has(const struct cosim_configuration *configuration, const char *key);

/**
 * Reads a number of the case, in SI units, at a dotted key ("materials.steel.conductivity").
 *
 * COSIM_OK; or COSIM_REFUSED with a reason that names the key, ready to be returned, if it is
 * missing or no finite number; *value then stays as it was.
 */
int cosim_case_number(const struct cosim_configuration *configuration,
                      const char *key,
                      double *value);

/**
 * Reads a whole number of the case; otherwise as cosim_case_number().
 */
int cosim_case_integer(const struct cosim_configuration *configuration,
                       const char *key,
                       int64_t *value);

/**
 * Reads a truth value of the case; otherwise as cosim_case_number().
 */
int cosim_case_flag(const struct cosim_configuration *configuration, const char *key, bool *value);

/**
 * A text or word of the case at a dotted key. NULL, with a refusal that names the key ready to be
 * returned, if it is missing or no text.
 */
const char *cosim_case_text(const struct cosim_configuration *configuration, const char *key);

/**
 * The name that the case gives to a body, COSIM_UPPER or COSIM_LOWER; its values are those under
 * "bodies.NAME". NULL, with a refusal ready to be returned, if the case has not one body at each
 * position; the description has to list the key "bodies.*.position".
 */
const char *cosim_body_name(const struct cosim_configuration *configuration, int body);

/**
 * Writes the grid on which an input will arrive, and says whether it is known. It is not for a
 * field that is no input of this run, nor as long as its producer has not been configured: then
 * configure answers without grids, and is called again later.
 */
bool cosim_input_grid(const struct cosim_configuration *configuration,
                      const char *field,
                      struct cosim_grid *grid);

/**
 * Says why a case cannot be computed; the run ends before it has begun, with exit code 2.
 *
 * For configure and build: `return cosim_refuse(...)`. `key` is the dotted key of the case at
 * fault ("motion.speed"), `reason` why its value cannot be, `fix` what to write instead. All three
 * are copied. Returns COSIM_REFUSED.
 */
int cosim_refuse(const char *key, const char *reason, const char *fix);

/**
 * Says why a callback failed; the run ends with exit code 1 and an error that has this text.
 *
 * `return cosim_fail("...")` from any callback, on the thread on which it was called. `message` is
 * copied. Returns COSIM_FAILED.
 */
int cosim_fail(const char *message);

/**
 * The values of an input at the end of the window: its components one after the other, each with
 * one value an element, read in place and valid until the callback returns.
 *
 * Writes the number of values and the grid as it is now; both pointers may be NULL. NULL, and a
 * count of 0, for a field that does not arrive in this run.
 */
const double *cosim_input(const struct cosim_inputs *inputs,
                          const char *field,
                          size_t *count,
                          struct cosim_grid *grid);

/**
 * The values of an input at the start of the window, as long as those of cosim_input(): within the
 * window the field goes in a straight line from these to those. NULL for a field that does not
 * vary within a window.
 */
const double *cosim_input_start(const struct cosim_inputs *inputs,
                                const char *field,
                                size_t *count);

/**
 * As cosim_input(), for an input that the program cannot do without: `count` values, all finite.
 * NULL, with a reason that names the field ready to be returned as COSIM_FAILED, if it does not
 * arrive, has another number of values, or holds a NaN or an infinity.
 */
const double *cosim_require_input(const struct cosim_inputs *inputs,
                                  const char *field,
                                  size_t count);

/**
 * The place for the values of an output: its components one after the other, each with one value an
 * element, valid until the callback returns. Every value has to be written: the place holds old data
 * before, and an output that is left as it was fails the call. Writes the number of values; `count`
 * may be NULL. NULL, and a count of 0, for a field that nobody needs now.
 */
double *cosim_output(struct cosim_outputs *outputs,
                     const char *field,
                     size_t *count);

/**
 * Appends `size` bytes to the state, for save.
 */
int cosim_blob_write(struct cosim_blob *blob, const void *bytes, size_t size);

/**
 * Takes the next `size` bytes of the state, for restore, which has to take all of them. COSIM_FAILED,
 * with a reason ready to be returned, if there are fewer.
 */
int cosim_blob_read(struct cosim_blob *blob,
                    void *bytes,
                    size_t size);

/**
 * Takes at most `size` of the next bytes of the state, for restore; how many that were, 0 at its end
 * and on failure.
 */
size_t cosim_blob_read_some(struct cosim_blob *blob,
                            void *bytes,
                            size_t size);

/**
 * Sets the whole layout from JSON, as docs/write-a-solver.md has it, for what has no function of its
 * own. COSIM_FAILED if it is none, or cannot be: a grid without area, a field on a grid that there
 * is not.
 */
int cosim_layout_json(struct cosim_layout *layout,
                      const char *json);

/**
 * Adds a grid, which is copied. COSIM_FAILED if it cannot be: name, counts, elements without area.
 */
int cosim_layout_grid(struct cosim_layout *layout, const struct cosim_grid *grid);

/**
 * Adds a volume, which is copied; `moved_grids` gives its geometry. COSIM_FAILED if it cannot be:
 * name, counts.
 */
int cosim_layout_volume(struct cosim_layout *layout, const struct cosim_volume *volume);

/**
 * Says on which of the grids an output, or an observed field, lives. Both names are copied.
 */
int cosim_layout_output(struct cosim_layout *layout, const char *field, const char *grid);

/**
 * Asks for an input on one of the grids: the coordinator maps it there, if its producer's is
 * another. An input without such a wish arrives on its producer's grid. Both names are copied.
 */
int cosim_layout_input(struct cosim_layout *layout, const char *field, const char *grid);

/**
 * Sets the expected processor time of one solve [s] and the memory of the program's arrays [byte].
 */
int cosim_layout_cost(struct cosim_layout *layout, double solve_seconds, uint64_t memory_bytes);

/**
 * Sets the expected processor time of `build` [s]; the deadline for building follows it.
 */
int cosim_layout_build_seconds(struct cosim_layout *layout, double build_seconds);

/**
 * Adds what the model leaves out in this very case, its expected relative error, and where that
 * number comes from. Both texts are copied.
 */
int cosim_layout_left_out(struct cosim_layout *layout,
                          const char *what,
                          double error,
                          const char *source);

/**
 * Adds a quantity of the summary that is known exactly in this case, by its dotted key, which is
 * copied.
 */
int cosim_layout_closed_form(struct cosim_layout *layout, const char *key, double exact);

/**
 * Adds a line to what `coordinator plan` prints: what the model makes of the case. It is copied.
 */
int cosim_layout_remark(struct cosim_layout *layout, const char *remark);

/**
 * The place for the geometry of a grid in a revision: vectors of three components [m], the first
 * components of all of them, then the second, then the third, every value to be written. NULL, and
 * a count of 0, if it is known already or nobody needs it.
 *
 * Structured: origin, step_i, step_j and (ni, nj, 1). Quadrilaterals: the vertices. Volume: see
 * cosim_volume. Writes the number of values; `count` may be NULL.
 */
double *cosim_geometry(struct cosim_moves *moves,
                       const char *grid,
                       uint64_t revision,
                       size_t *count);

/**
 * Says how far build, solve, save or restore is: `done` of `of` in the program's own measure, `of`
 * being 0 if nobody knows; `what` is being done, in an ASCII word of at most 31 letters
 * ("factorising"). From any thread, as often as the program likes.
 *
 * Whenever it changes, the deadline of the coordinator starts anew, and the user sees it.
 */
int cosim_progress(uint64_t done, uint64_t of, const char *what);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* COSIM_H */

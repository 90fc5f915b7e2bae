/* A clock that goes wrong at some time, as the parameter `how` says. FMI 2.0, without states.
 *
 * 0 not at all, 1 with an error, 2 with a fatal error, 3 with an output that is no number, 4 by a crash
 */
#define TOKEN "{trouble}"
enum { TIME, Y, HOW, AT, STOP, TOLERANCE, COUNT };
static const double START[COUNT] = {[AT] = 0.25, [STOP] = -1, [TOLERANCE] = -1};
/* It returns what it is told of the experiment; -1 is nothing. */
#define EXPERIMENT

#include "../model.h"

#include <math.h>

static size_t locate(uint32_t reference, size_t *first) { return scalar(reference, COUNT, first); }

static volatile intptr_t nowhere = 0;

static int advance(double *v, double time, double length) {
    v[Y] = v[TIME] = time + length;
    if (time < v[AT]) return STATUS_OK;
    switch ((int)v[HOW]) {
        case 1: return STATUS_ERROR;
        case 2: return STATUS_FATAL;
        case 3: return v[Y] = NAN, STATUS_OK;
        case 4: return *(volatile int *)nowhere;
        default: return STATUS_OK;
    }
}

#include "../fmi2.h"

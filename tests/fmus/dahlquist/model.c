/* Dahlquist's equation, x' = -k x. FMI 3.0. */
#define TOKEN "{dahlquist}"
enum { TIME, X, K, COUNT };
static const double START[COUNT] = {[X] = 1, [K] = 1};

#include "../model.h"

static size_t locate(uint32_t reference, size_t *first) { return scalar(reference, COUNT, first); }

static int advance(double *v, double time, double length) {
    double inner = 0.03125;
    for (long n = inner_steps(length, inner); n > 0; --n) v[X] -= inner * v[K] * v[X];
    v[TIME] = time + length;
    return STATUS_OK;
}

#include "../fmi3.h"

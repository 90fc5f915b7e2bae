/* A body that friction warms up: half of the power goes into it, C T' = P/2 - G T, and of the surface as an array each element
 * is warmer by r q/2. FMI 3.0.
 */
#define TOKEN "{body}"
enum { SIZE = 96, TIME = 0, P, T, C, G, R, Q, S = Q + SIZE, COUNT = S + SIZE };
static const double START[COUNT] = {[C] = 1e3, [G] = 10, [R] = 1e-9};

#include "../model.h"

/* References: the scalars are their places, 6 and 7 the arrays of the flux and of the surface. */
static size_t locate(uint32_t reference, size_t *first) {
    *first = reference == 7 ? S : reference;
    return reference < 6 ? 1 : reference < 8 ? SIZE : 0;
}

static int advance(double *v, double time, double length) {
    double inner = 1e-5;
    for (long n = inner_steps(length, inner); n > 0; --n) v[T] += inner * (0.5 * v[P] - v[G] * v[T]) / v[C];
    for (int i = 0; i < SIZE; ++i) v[S + i] = v[T] + 0.5 * v[R] * v[Q + i];
    v[TIME] = time + length;
    return STATUS_OK;
}

#include "../fmi3.h"

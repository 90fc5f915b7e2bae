/* A ball that bounces, with events inside a step. FMI 3.0. */
#define TOKEN "{ball}"
enum { TIME, H, V, G, E, COUNT };
static const double START[COUNT] = {[H] = 1, [G] = -9.81, [E] = 0.7};

#include "../model.h"

static size_t locate(uint32_t reference, size_t *first) { return scalar(reference, COUNT, first); }

static int advance(double *v, double time, double length) {
    double inner = 0.0009765625;
    for (long n = inner_steps(length, inner); n > 0; --n) {
        v[H] += inner * v[V];
        v[V] += inner * v[G];
        if (v[H] <= 0 && v[V] < 0) v[H] = 0, v[V] *= -v[E];
    }
    v[TIME] = time + length;
    return STATUS_OK;
}

#include "../fmi3.h"

/* A state space, x' = A x + B u, y = C x, whose variables are arrays. FMI 3.0. */
#define TOKEN "{space}"
enum { SIZE = 3, TIME = 0, A = 1, B = A + 9, C = B + 9, X = C + 9, U = X + 3, Y = U + 3, COUNT = Y + 3 };
static const double START[COUNT] = {
    [A] = -1, 0.5, 0, 0, -2, 0.25, 0, 0, -3,
    [B] = 1, 0, 0, 0, 1, 0, 0, 0, 1,
    [C] = 1, 0, 0, 0, 1, 0, 1, 1, 1,
    [X] = 1, 2, 3,
};

#include "../model.h"

/* References: 1 the size, which never changes, 2 to 7 the arrays. */
static size_t locate(uint32_t reference, size_t *first) {
    static const size_t places[][2] = {{A, 9}, {B, 9}, {C, 9}, {X, 3}, {U, 3}, {Y, 3}};
    if (reference < 2 || reference > 7) return 0;
    *first = places[reference - 2][0];
    return places[reference - 2][1];
}

static double row(const double *matrix, int i, const double *vector) {
    double sum = 0;
    for (int j = 0; j < SIZE; ++j) sum += matrix[SIZE * i + j] * vector[j];
    return sum;
}

static int advance(double *v, double time, double length) {
    double inner = 0.03125, rate[SIZE];
    for (long n = inner_steps(length, inner); n > 0; --n) {
        for (int i = 0; i < SIZE; ++i) rate[i] = row(v + A, i, v + X) + row(v + B, i, v + U);
        for (int i = 0; i < SIZE; ++i) v[X + i] += inner * rate[i];
    }
    for (int i = 0; i < SIZE; ++i) v[Y + i] = row(v + C, i, v + X);
    v[TIME] = time + length;
    return STATUS_OK;
}

#include "../fmi3.h"

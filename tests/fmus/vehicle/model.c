/* A quarter of a vehicle that rolls over an irregular rail. FMI 2.0.
 *
 * The body (mass m) stands on a spring and a damper over the wheel, which follows the rail, z = a sin(2 pi V t / l). The wheel
 * is driven by a torque; with the moment of inertia J it turns by the creep force: J/R dw/dt = T/R - F_x, w the speed of its
 * surface over that of rolling, so that the creepage is -w/V. Symplectic Euler, in steps of 0.1 ms.
 */
#define TOKEN "{vehicle}"
enum {
    TIME, LOAD, CREEPAGE, FORCE_X, FORCE_Y, FORCE_Z,            /* what crosses */
    SPEED, MASS, STIFFNESS, DAMPING, HEIGHT, LENGTH, INERTIA, RADIUS, TORQUE, /* parameters */
    Z, V, W, UTILISATION, COUNT
};
static const double START[COUNT] = {
    [SPEED] = 38.889, [MASS] = 12.5, [STIFFNESS] = 1.2, [DAMPING] = 50, [HEIGHT] = 2, [LENGTH] = 3,
    [INERTIA] = 80, [RADIUS] = 0.46, [TORQUE] = 10,
};

#include <math.h>

#include "../model.h"

static size_t locate(uint32_t reference, size_t *first) { return scalar(reference, COUNT, first); }

static int advance(double *v, double time, double length) {
    const double inner = 1e-4, g = 9.81;
    const double m = 1e3 * v[MASS], k = 1e6 * v[STIFFNESS], c = 1e3 * v[DAMPING];
    const double torque = 1e3 * v[TORQUE] / v[RADIUS], inertia = v[INERTIA] / (v[RADIUS] * v[RADIUS]);
    const double amplitude = 1e-3 * v[HEIGHT], rate = 2 * 3.14159265358979323846 * v[SPEED] / v[LENGTH];
    double spring = 0;
    for (long n = 0, all = inner_steps(length, inner); n <= all; ++n) {
        double t = time + n * inner;
        double up = amplitude * sin(rate * t), rises = amplitude * rate * cos(rate * t);
        spring = -k * (v[Z] - up) - c * (v[V] - rises);
        if (n == all) break;
        v[V] += inner * spring / m;
        v[Z] += inner * v[V];
        v[W] += inner * (torque - v[FORCE_X]) / inertia;
    }
    v[LOAD] = (m * g + spring) / 1e3;
    v[CREEPAGE] = -v[W] / v[SPEED];
    v[UTILISATION] = v[FORCE_Z] > 0 ? hypot(v[FORCE_X], v[FORCE_Y]) / v[FORCE_Z] : 0;
    v[TIME] = time + length;
    return STATUS_OK;
}

#include "../fmi2.h"

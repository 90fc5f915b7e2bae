/* What the models of these FMUs have in common. A model defines, before it includes fmi2.h or fmi3.h:
 *
 *   TOKEN     the token of its description
 *   COUNT     the number of its values
 *   START     their values at the start
 *   advance   takes a step: values, time [s], length [s]; a status of FMI
 *   locate    the first value of a variable, and how many it has
 */
#ifndef MODEL_H
#define MODEL_H

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { STATUS_OK, STATUS_WARNING, STATUS_DISCARD, STATUS_ERROR, STATUS_FATAL };

/* Every scalar is a variable: its reference is its place. */
static size_t scalar(uint32_t reference, size_t count, size_t *first) {
    *first = reference;
    return reference < count ? 1 : 0;
}

/* Explicit Euler steps of this length, as many as the step has. */
static long inner_steps(double length, double inner) { return (long)(length / inner + 0.5); }

#endif

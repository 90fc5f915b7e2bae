// Two masses between two walls, held by three springs: wall - left - right - wall. Each mass is a
// participant, Left or Right. It writes the force of the middle spring caused by its own
// displacement u, and reads the force of the other mass:
//
//   m u'' + (k + k12) u = F_other,  F = k12 u,  m = 1 kg,  k = 4 pi^2 N/m,  k12 = 6 pi^2 N/m
//
// Left starts at u = 1 m, Right at 0, both at rest. The frequencies are 1 Hz (in phase) and 2 Hz
// (opposed), so u = (cos(2 pi t) + cos(4 pi t)) / 2 for Left, with a minus for Right.
//
// Newmark's method with constant average acceleration keeps the amplitudes. With one step h a
// window, it turns an angular frequency w into (2 / h) atan(w h / 2), which gives the solution of
// the coupled steps exactly. With substeps, the error falls with the square of the step.

#include "precice/preciceC.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
  double time, displacement, velocity, acceleration;
} State;

static const double pi = 3.14159265358979323846;

// Returns the state one step later, given the force at its end.
static State step(State old, double dt, double stiffness, double force) {
  State new = {.time = old.time + dt};
  double displacement = old.displacement + dt * old.velocity + dt * dt / 4 * old.acceleration;
  new.acceleration = (force - stiffness * displacement) / (1 + dt * dt / 4 * stiffness);
  new.displacement = displacement + dt * dt / 4 * new.acceleration;
  new.velocity = old.velocity + dt / 2 * (old.acceleration + new.acceleration);
  return new;
}

int main(int count, char **arguments) {
  if (count < 4) {
    fprintf(stderr, "usage: oscillator Left|Right CONFIGURATION OUTPUT [SUBSTEPS]\n");
    return 2;
  }
  int left = strcmp(arguments[1], "Left") == 0;
  const char *mesh = left ? "Left-Mesh" : "Right-Mesh";
  const char *writes = left ? "Force-Left" : "Force-Right";
  const char *reads = left ? "Force-Right" : "Force-Left";
  int substeps = count > 4 ? atoi(arguments[4]) : 1;
  double middle = 6 * pi * pi, stiffness = 4 * pi * pi + middle;

  precicec_createParticipant(arguments[1], arguments[2], 0, 1);
  double position[2] = {0, 0};
  int vertex = precicec_setMeshVertex(mesh, position);
  State state = {.displacement = left ? 1 : 0};
  double force = middle * state.displacement;
  if (precicec_requiresInitialData()) {
    precicec_writeData(mesh, writes, 1, &vertex, &force);
  }
  precicec_initialize();

  FILE *output = fopen(arguments[3], "w");
  if (!output) {
    perror(arguments[3]);
    return 1;
  }
  fprintf(output, "time,displacement,velocity,iterations\n%.17g,%.17g,%.17g,0\n", state.time,
          state.displacement, state.velocity);
  precicec_readData(mesh, reads, 1, &vertex, 0, &force);
  state.acceleration = force - stiffness * state.displacement;
  State saved = state;
  int substep = 0, iterations = 1;
  double dt = 0;
  while (precicec_isCouplingOngoing()) {
    if (precicec_requiresWritingCheckpoint()) {
      saved = state;
    }
    double rest = precicec_getMaxTimeStepSize();
    if (substep == 0) {
      dt = rest / substeps;
    } else if (substep == substeps - 1) {
      dt = rest;
    }
    precicec_readData(mesh, reads, 1, &vertex, dt, &force);
    state = step(state, dt, stiffness, force);
    force = middle * state.displacement;
    precicec_writeData(mesh, writes, 1, &vertex, &force);
    precicec_advance(dt);
    substep = (substep + 1) % substeps;
    if (precicec_requiresReadingCheckpoint()) {
      state = saved;
      iterations += 1;
    } else if (precicec_isTimeWindowComplete()) {
      fprintf(output, "%.17g,%.17g,%.17g,%d\n", state.time, state.displacement, state.velocity,
              iterations);
      iterations = 1;
    }
  }
  precicec_finalize();
  return fclose(output) == 0 ? 0 : 1;
}

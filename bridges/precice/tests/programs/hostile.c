// A program with a defect, chosen by its third argument, in the coupling of dummy.xml. Without a
// defect ("none") it behaves well; it also serves as the partner of a program with one.

#define _POSIX_C_SOURCE 200809L

#include "precice/preciceC.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { SIZE = 4 };

static const char *defects[][2] = {
    {"none", "behaves well"},
    {"abort", "dies in the second window"},
    {"exit", "ends with success in the second window, without finalize"},
    {"hang", "sleeps in the second window"},
    {"finalize-early", "finalizes in the second window"},
    {"advance-first", "advances before initialize"},
    {"initialize-twice", "initializes twice"},
    {"create-twice", "creates a second participant"},
    {"finalize-twice", "finalizes twice"},
    {"write-last", "writes data after finalize"},
    {"advance-last", "advances after the end of the simulation"},
    {"long-step", "advances by twice the longest step"},
    {"negative-step", "advances by a negative step"},
    {"nan-step", "advances by a step that is not a number"},
    {"read-late", "reads data after the end of the window"},
    {"silent", "never writes data"},
    {"nan", "writes a value that is not a number"},
    {"nan-vertex", "sets a vertex whose coordinates are not numbers"},
    {"no-vertices", "leaves its mesh empty"},
    {"late-vertex", "sets a vertex after initialize"},
    {"reset-mesh", "removes its mesh in the second window"},
    {"wrong-vertex", "writes data at a vertex that does not exist"},
    {"negative-size", "writes data at -1 vertices"},
    {"null-values", "writes data from a null pointer"},
    {"null-name", "passes a null pointer for a mesh"},
    {"unknown-participant", "takes a name that the configuration lacks"},
    {"unknown-mesh", "uses a mesh that the configuration lacks"},
    {"unknown-data", "uses data that the configuration lacks"},
    {"foreign-mesh", "sets vertices of the partner's mesh"},
    {"foreign-data", "writes data that the partner writes"},
    {"ranks", "says that it is one of two processes"},
    {"wrong-rank", "says that it is process 1 of 1"},
};

static const char *defect;

static int has(const char *name) { return strcmp(defect, name) == 0; }

static int is_known(void) {
  for (size_t i = 0; i < sizeof defects / sizeof *defects; i++) {
    if (has(defects[i][0])) {
      return 1;
    }
  }
  return 0;
}

static void usage(void) {
  fprintf(stderr, "usage: hostile One|Two CONFIGURATION DEFECT\n");
  for (size_t i = 0; i < sizeof defects / sizeof *defects; i++) {
    fprintf(stderr, "  %-20s %s\n", defects[i][0], defects[i][1]);
  }
}

// The defects of the second window, before data is written.
static void disturb(const char *mesh) {
  if (has("abort")) {
    abort();
  } else if (has("exit")) {
    exit(0);
  } else if (has("hang")) {
    sleep(3600);
  } else if (has("finalize-early")) {
    precicec_finalize();
    exit(0);
  } else if (has("reset-mesh")) {
    precicec_resetMesh(mesh);
  }
}

static double step_size(double longest) {
  return has("long-step")       ? 2 * longest
         : has("negative-step") ? -longest
         : has("nan-step")      ? NAN
                                : longest;
}

int main(int count, char **arguments) {
  defect = count > 3 ? arguments[3] : "";
  if (!is_known()) {
    usage();
    return 2;
  }
  int one = strcmp(arguments[1], "One") == 0;
  const char *mesh = one ? "One-Mesh" : "Two-Mesh", *other = one ? "Two-Mesh" : "One-Mesh";
  const char *writes = one ? "Scalar-One" : "Scalar-Two";
  const char *vector = one ? "Vector-One" : "Vector-Two";
  const char *reads = one ? "Scalar-Two" : "Scalar-One";
  double coordinates[3 * SIZE] = {0}, values[3 * SIZE] = {0}, read[SIZE];
  int vertices[SIZE];
  for (int i = 0; i < SIZE; i++) {
    coordinates[3 * i] = i;
  }

  const char *name = has("unknown-participant") ? "Three" : arguments[1];
  precicec_createParticipant(name, arguments[2], has("wrong-rank"), has("ranks") ? 2 : 1);
  if (has("create-twice")) {
    precicec_createParticipant(name, arguments[2], 0, 1);
  }
  if (has("advance-first")) {
    precicec_advance(1);
  }
  if (has("nan-vertex")) {
    coordinates[0] = NAN;
  }
  const char *written = has("unknown-mesh")   ? "Three-Mesh"
                        : has("foreign-mesh") ? other
                        : has("null-name")    ? NULL
                                              : mesh;
  if (!has("no-vertices")) {
    precicec_setMeshVertices(written, SIZE, coordinates, vertices);
  }
  precicec_initialize();
  if (has("initialize-twice")) {
    precicec_initialize();
  }
  if (has("late-vertex")) {
    precicec_setMeshVertex(mesh, coordinates);
  }
  const int size = has("no-vertices") ? 0 : SIZE;
  if (has("wrong-vertex")) {
    vertices[SIZE - 1] = 1000;
  }
  const char *data = has("unknown-data") ? "Scalar-Three" : has("foreign-data") ? reads : writes;

  for (int window = 1; precicec_isCouplingOngoing(); window++) {
    double longest = precicec_getMaxTimeStepSize();
    precicec_readData(mesh, reads, size, vertices, has("read-late") ? 2 * longest : longest, read);
    if (window == 2) {
      disturb(mesh);
    }
    if (has("nan")) {
      values[1] = NAN;
    }
    if (!has("silent")) {
      precicec_writeData(mesh, data, has("negative-size") ? -1 : size, vertices,
                         has("null-values") ? NULL : values);
      precicec_writeData(mesh, vector, size, vertices, values);
    }
    precicec_advance(step_size(longest));
  }
  if (has("advance-last")) {
    precicec_advance(1);
  }
  precicec_finalize();
  if (has("finalize-twice")) {
    precicec_finalize();
  }
  if (has("write-last")) {
    precicec_writeData(mesh, data, size, vertices, values);
  }
  printf("%s: ends well\n", arguments[1]);
  return 0;
}

#ifndef PRECICE_VERSION_H
#define PRECICE_VERSION_H

// Version of preCICE whose interface these headers declare.
#define PRECICE_VERSION_MAJOR 3
#define PRECICE_VERSION_MINOR 4
#define PRECICE_VERSION_PATCH 0
#define PRECICE_VERSION "3.4.0"

// True if the interface is at least as new as the given version.
#define PRECICE_VERSION_GREATER_EQUAL(major, minor, patch)                     \
  (PRECICE_VERSION_MAJOR != (major)   ? PRECICE_VERSION_MAJOR > (major)        \
   : PRECICE_VERSION_MINOR != (minor) ? PRECICE_VERSION_MINOR > (minor)        \
                                      : PRECICE_VERSION_PATCH >= (patch))

#endif

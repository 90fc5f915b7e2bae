#ifndef PRECICE_EXPORT_H
#define PRECICE_EXPORT_H

// Marks the functions that the library exports.
#if defined(_WIN32)
#define PRECICE_API __declspec(dllimport)
#else
#define PRECICE_API __attribute__((visibility("default")))
#endif

#endif

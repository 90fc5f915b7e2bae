// The C interface of preCICE 3, implemented by a library that takes part in a co-simulation.
//
// A process has one participant at a time. Functions that ask a question return 1 for yes and 0
// for no. Values of vertices are stored one vertex after the other: a vertex of a mesh with d
// dimensions has d coordinates, and data of c components has c values at each vertex. Vertices
// are named by the numbers that setMeshVertex and setMeshVertices return.
//
// A refused call prints the reason and ends the program.

#ifndef PRECICE_C_H
#define PRECICE_C_H

#include "precice/Version.h"
#include "precice/export.h"

#ifdef __cplusplus
extern "C" {
#endif

// --- Start and end ---

// Creates the participant. A program of several processes passes the number of this one (`rank`,
// from 0) and their number (`size`).
PRECICE_API void precicec_createParticipant(const char *participantName,
                                            const char *configFileName, int rank, int size);

// Creates the participant of a program with an MPI communicator, given by a pointer to it.
PRECICE_API void precicec_createParticipant_withCommunicator(const char *participantName,
                                                             const char *configFileName, int rank,
                                                             int size, void *communicator);

// Sends meshes and initial data, and waits for the data of the first time window.
PRECICE_API void precicec_initialize(void);

// Reports a time step [s]. At the end of a window, written data is exchanged for new data to read.
PRECICE_API void precicec_advance(double computedTimeStepSize);

// Leaves the simulation and removes the participant.
PRECICE_API void precicec_finalize(void);

// --- Time ---

// Asks whether the simulation goes on.
PRECICE_API int precicec_isCouplingOngoing(void);

// Asks whether the last call of advance completed a time window.
PRECICE_API int precicec_isTimeWindowComplete(void);

// Returns the longest time step [s] that advance accepts.
PRECICE_API double precicec_getMaxTimeStepSize(void);

// Asks whether the program has to save its state: a time window begins that may be repeated.
PRECICE_API int precicec_requiresWritingCheckpoint(void);

// Asks whether the program has to return to the saved state: the time window is repeated.
PRECICE_API int precicec_requiresReadingCheckpoint(void);

// --- Meshes ---

// Returns the number of coordinates of a vertex: 2 or 3.
PRECICE_API int precicec_getMeshDimensions(const char *meshName);

// Returns the number of vertices of a mesh.
PRECICE_API int precicec_getMeshVertexSize(const char *meshName);

// Asks whether edges and faces of a mesh are of use.
PRECICE_API int precicec_requiresMeshConnectivityFor(const char *meshName);

// Removes all vertices of a mesh, so that the program can define it anew.
PRECICE_API void precicec_resetMesh(const char *meshName);

// Adds a vertex and returns its number.
PRECICE_API int precicec_setMeshVertex(const char *meshName, const double *coordinates);

// Adds `size` vertices and stores their numbers in `ids`.
PRECICE_API void precicec_setMeshVertices(const char *meshName, int size,
                                          const double *coordinates, int *ids);

// Adds an edge between two vertices.
PRECICE_API void precicec_setMeshEdge(const char *meshName, int first, int second);

// Adds `size` edges; `ids` has two vertices for each.
PRECICE_API void precicec_setMeshEdges(const char *meshName, int size, const int *ids);

// Adds a triangle.
PRECICE_API void precicec_setMeshTriangle(const char *meshName, int first, int second, int third);

// Adds `size` triangles; `ids` has three vertices for each.
PRECICE_API void precicec_setMeshTriangles(const char *meshName, int size, const int *ids);

// Adds a quadrilateral.
PRECICE_API void precicec_setMeshQuad(const char *meshName, int first, int second, int third,
                                      int fourth);

// Adds `size` quadrilaterals; `ids` has four vertices for each.
PRECICE_API void precicec_setMeshQuads(const char *meshName, int size, const int *ids);

// Adds a tetrahedron.
PRECICE_API void precicec_setMeshTetrahedron(const char *meshName, int first, int second,
                                             int third, int fourth);

// Adds `size` tetrahedra; `ids` has four vertices for each.
PRECICE_API void precicec_setMeshTetrahedra(const char *meshName, int size, const int *ids);

// --- Data ---

// Returns the number of components of data: 1 for a scalar, else the dimensions of the mesh.
PRECICE_API int precicec_getDataDimensions(const char *meshName, const char *dataName);

// Asks whether the program has to write data before initialize.
PRECICE_API int precicec_requiresInitialData(void);

// Writes data at `size` vertices.
PRECICE_API void precicec_writeData(const char *meshName, const char *dataName, int size,
                                    const int *ids, const double *values);

// Reads data at `size` vertices, `relativeReadTime` seconds after the start of the time step.
PRECICE_API void precicec_readData(const char *meshName, const char *dataName, int size,
                                   const int *ids, double relativeReadTime, double *values);

// Asks whether the program has to write gradients of data.
PRECICE_API int precicec_requiresGradientDataFor(const char *meshName, const char *dataName);

// Writes gradients at `size` vertices: the derivatives of all components along x, then along y
// and z.
PRECICE_API void precicec_writeGradientData(const char *meshName, const char *dataName, int size,
                                            const int *ids, const double *gradients);

// --- Meshes of other participants ---

// Selects the part of a received mesh that the program works on: the lowest and the highest value
// of each coordinate in turn.
PRECICE_API void precicec_setMeshAccessRegion(const char *meshName, const double *boundingBox);

// Stores the numbers and coordinates of all `size` vertices of a mesh.
PRECICE_API void precicec_getMeshVertexIDsAndCoordinates(const char *meshName, int size, int *ids,
                                                         double *coordinates);

// Writes data at `size` points, which are mapped to a received mesh at once.
PRECICE_API void precicec_writeAndMapData(const char *meshName, const char *dataName, int size,
                                          const double *coordinates, const double *values);

// Reads data at `size` points, mapped from a received mesh at once.
PRECICE_API void precicec_mapAndReadData(const char *meshName, const char *dataName, int size,
                                         const double *coordinates, double relativeReadTime,
                                         double *values);

// --- Profiling and version ---

// Starts a named section of the profile.
PRECICE_API void precicec_startProfilingSection(const char *sectionName);

// Ends the section that was started last.
PRECICE_API void precicec_stopLastProfilingSection(void);

// Returns the version, the revision and the configuration, separated by semicolons.
PRECICE_API const char *precicec_getVersionInformation(void);

// --- Additions: functions that preCICE does not have ---

// Chooses for the whole process how a refused call ends: the error is stored (1), or printed
// before the program ends (0, the default). Returns the earlier choice.
PRECICE_API int precice_cosim_defer_errors(int on);

// Returns the text of the stored error and clears it; NULL if no call has been refused. The text
// is valid until the next call.
PRECICE_API const char *precice_cosim_error(void);

#ifdef __cplusplus
}
#endif

#endif

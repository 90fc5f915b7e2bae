// The C++ interface of preCICE 3, built on the functions of preciceC.h.

#ifndef PRECICE_PARTICIPANT_HPP
#define PRECICE_PARTICIPANT_HPP

#include "precice/Exceptions.hpp"
#include "precice/Types.hpp"
#include "precice/preciceC.h"
#include "precice/span.hpp"

#include <climits>
#include <cstddef>
#include <cstdio>
#include <string>
#include <type_traits>

namespace precice {

/// The participant of this process; the functions are described in preciceC.h. A refused call
/// throws an Error.
class Participant {
public:
  Participant(string_view participantName, string_view configurationFileName, int rank, int size) {
    create([&] {
      precicec_createParticipant(text(participantName).c_str(),
                                 text(configurationFileName).c_str(), rank, size);
    });
  }

  Participant(string_view participantName, string_view configurationFileName, int rank, int size,
              void *communicator) {
    create([&] {
      precicec_createParticipant_withCommunicator(text(participantName).c_str(),
                                                  text(configurationFileName).c_str(), rank, size,
                                                  communicator);
    });
  }

  Participant(const Participant &) = delete;
  Participant &operator=(const Participant &) = delete;

  /// Leaves the simulation if the program has not.
  ~Participant() {
    if (!_finalized) {
      precicec_finalize();
      if (const char *reason = precice_cosim_error()) {
        std::fprintf(stderr, "error: %s\n", reason);
      }
    }
    exists() = false;
  }

  void initialize() { checked(precicec_initialize); }
  void advance(double computedTimeStepSize) { checked(precicec_advance, computedTimeStepSize); }
  void finalize() {
    _finalized = true;
    checked(precicec_finalize);
  }

  bool isCouplingOngoing() const { return checked(precicec_isCouplingOngoing); }
  bool isTimeWindowComplete() const { return checked(precicec_isTimeWindowComplete); }
  double getMaxTimeStepSize() const { return checked(precicec_getMaxTimeStepSize); }
  bool requiresWritingCheckpoint() { return checked(precicec_requiresWritingCheckpoint); }
  bool requiresReadingCheckpoint() { return checked(precicec_requiresReadingCheckpoint); }

  int getMeshDimensions(string_view mesh) const {
    return checked(precicec_getMeshDimensions, text(mesh).c_str());
  }

  int getMeshVertexSize(string_view mesh) const {
    return checked(precicec_getMeshVertexSize, text(mesh).c_str());
  }

  bool requiresMeshConnectivityFor(string_view mesh) const {
    return checked(precicec_requiresMeshConnectivityFor, text(mesh).c_str());
  }

  void resetMesh(string_view mesh) { checked(precicec_resetMesh, text(mesh).c_str()); }

  VertexID setMeshVertex(string_view mesh, span<const double> position) {
    expect(mesh, position.size(), dimensions(mesh), "coordinates of a vertex");
    return checked(precicec_setMeshVertex, text(mesh).c_str(), position.data());
  }

  void setMeshVertices(string_view mesh, span<const double> coordinates, span<VertexID> ids) {
    expect(mesh, coordinates.size(), dimensions(mesh) * ids.size(), "coordinates of vertices");
    checked(precicec_setMeshVertices, text(mesh).c_str(), count(ids), coordinates.data(),
            ids.data());
  }

  void setMeshEdge(string_view mesh, VertexID first, VertexID second) {
    checked(precicec_setMeshEdge, text(mesh).c_str(), first, second);
  }

  void setMeshEdges(string_view mesh, span<const VertexID> ids) {
    checked(precicec_setMeshEdges, text(mesh).c_str(), groups(ids, 2), ids.data());
  }

  void setMeshTriangle(string_view mesh, VertexID first, VertexID second, VertexID third) {
    checked(precicec_setMeshTriangle, text(mesh).c_str(), first, second, third);
  }

  void setMeshTriangles(string_view mesh, span<const VertexID> ids) {
    checked(precicec_setMeshTriangles, text(mesh).c_str(), groups(ids, 3), ids.data());
  }

  void setMeshQuad(string_view mesh, VertexID first, VertexID second, VertexID third,
                   VertexID fourth) {
    checked(precicec_setMeshQuad, text(mesh).c_str(), first, second, third, fourth);
  }

  void setMeshQuads(string_view mesh, span<const VertexID> ids) {
    checked(precicec_setMeshQuads, text(mesh).c_str(), groups(ids, 4), ids.data());
  }

  void setMeshTetrahedron(string_view mesh, VertexID first, VertexID second, VertexID third,
                          VertexID fourth) {
    checked(precicec_setMeshTetrahedron, text(mesh).c_str(), first, second, third, fourth);
  }

  void setMeshTetrahedra(string_view mesh, span<const VertexID> ids) {
    checked(precicec_setMeshTetrahedra, text(mesh).c_str(), groups(ids, 4), ids.data());
  }

  int getDataDimensions(string_view mesh, string_view data) const {
    return checked(precicec_getDataDimensions, text(mesh).c_str(), text(data).c_str());
  }

  bool requiresInitialData() { return checked(precicec_requiresInitialData); }

  void writeData(string_view mesh, string_view data, span<const VertexID> ids,
                 span<const double> values) {
    expect(mesh, values.size(), components(mesh, data) * ids.size(), "values to write");
    checked(precicec_writeData, text(mesh).c_str(), text(data).c_str(), count(ids), ids.data(),
            values.data());
  }

  void readData(string_view mesh, string_view data, span<const VertexID> ids,
                double relativeReadTime, span<double> values) const {
    expect(mesh, values.size(), components(mesh, data) * ids.size(), "values to read");
    checked(precicec_readData, text(mesh).c_str(), text(data).c_str(), count(ids), ids.data(),
            relativeReadTime, values.data());
  }

  bool requiresGradientDataFor(string_view mesh, string_view data) const {
    return checked(precicec_requiresGradientDataFor, text(mesh).c_str(), text(data).c_str());
  }

  void writeGradientData(string_view mesh, string_view data, span<const VertexID> ids,
                         span<const double> gradients) {
    const auto expected = dimensions(mesh) * components(mesh, data) * ids.size();
    expect(mesh, gradients.size(), expected, "gradients");
    checked(precicec_writeGradientData, text(mesh).c_str(), text(data).c_str(), count(ids),
            ids.data(), gradients.data());
  }

  void setMeshAccessRegion(string_view mesh, span<const double> boundingBox) const {
    expect(mesh, boundingBox.size(), 2 * dimensions(mesh), "bounds of a region");
    checked(precicec_setMeshAccessRegion, text(mesh).c_str(), boundingBox.data());
  }

  void getMeshVertexIDsAndCoordinates(string_view mesh, span<VertexID> ids,
                                      span<double> coordinates) const {
    expect(mesh, coordinates.size(), dimensions(mesh) * ids.size(), "coordinates of vertices");
    checked(precicec_getMeshVertexIDsAndCoordinates, text(mesh).c_str(), count(ids), ids.data(),
            coordinates.data());
  }

  void writeAndMapData(string_view mesh, string_view data, span<const double> coordinates,
                       span<const double> values) {
    const int points = groups(coordinates, dimensions(mesh));
    expect(mesh, values.size(), components(mesh, data) * static_cast<std::size_t>(points),
           "values to write");
    checked(precicec_writeAndMapData, text(mesh).c_str(), text(data).c_str(), points,
            coordinates.data(), values.data());
  }

  void mapAndReadData(string_view mesh, string_view data, span<const double> coordinates,
                      double relativeReadTime, span<double> values) const {
    const int points = groups(coordinates, dimensions(mesh));
    expect(mesh, values.size(), components(mesh, data) * static_cast<std::size_t>(points),
           "values to read");
    checked(precicec_mapAndReadData, text(mesh).c_str(), text(data).c_str(), points,
            coordinates.data(), relativeReadTime, values.data());
  }

  void startProfilingSection(string_view section) {
    checked(precicec_startProfilingSection, text(section).c_str());
  }

  void stopLastProfilingSection() { checked(precicec_stopLastProfilingSection); }

private:
  bool _finalized = false;

  static bool &exists() {
    static bool one = false;
    return one;
  }

  template <typename Create>
  static void create(Create &&call) {
    if (exists()) {
      throw Error("a process has one precice::Participant at a time: destroy the first one before "
                  "creating another");
    }
    precice_cosim_defer_errors(1);
    checked(call);
    exists() = true;
  }

  /// Calls a function of the C interface and throws the error that it has stored.
  template <typename Function, typename... Arguments>
  static std::invoke_result_t<Function, Arguments...> checked(Function &&function,
                                                              Arguments... arguments) {
    if constexpr (std::is_void_v<std::invoke_result_t<Function, Arguments...>>) {
      function(arguments...);
      raise();
    } else {
      const auto result = function(arguments...);
      raise();
      return result;
    }
  }

  static void raise() {
    if (const char *reason = precice_cosim_error()) {
      throw Error(reason);
    }
  }

  std::size_t dimensions(string_view mesh) const {
    return static_cast<std::size_t>(getMeshDimensions(mesh));
  }

  std::size_t components(string_view mesh, string_view data) const {
    return static_cast<std::size_t>(getDataDimensions(mesh, data));
  }

  static std::string text(string_view view) { return {view.data(), view.size()}; }

  static void expect(string_view mesh, std::size_t found, std::size_t expected, const char *what) {
    if (found != expected) {
      throw Error("mesh " + text(mesh) + ": " + std::to_string(found) + " " + what +
                  ", expected " + std::to_string(expected));
    }
  }

  /// Returns the number of entries, which the C interface counts with an int.
  template <typename T>
  static int count(span<T> list) {
    return groups(list, 1);
  }

  /// Returns the number of groups of `size` entries.
  template <typename T>
  static int groups(span<T> list, std::size_t size) {
    if (list.size() % size != 0 || list.size() / size > INT_MAX) {
      throw Error("list of " + std::to_string(list.size()) + " entries: expected at most " +
                  std::to_string(INT_MAX) + " groups of " + std::to_string(size));
    }
    return static_cast<int>(list.size() / size);
  }
};

} // namespace precice

#endif

// Every function of the C++ interface, with the kinds of arguments that adapters pass. Without a
// launcher only the constructor runs: it throws, and leaves nothing behind that hinders another.

#include "precice/Tooling.hpp"
#include "precice/precice.hpp"

#include <array>
#include <cstdio>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

using precice::span;

static_assert(PRECICE_VERSION_GREATER_EQUAL(3, 0, 0) && PRECICE_VERSION_GREATER_EQUAL(2, 9, 9));
static_assert(!PRECICE_VERSION_GREATER_EQUAL(3, 5, 0) && !PRECICE_VERSION_GREATER_EQUAL(4, 0, 0));

template <typename From, typename To>
constexpr bool converts = std::is_convertible_v<From, To>;

static_assert(converts<std::vector<double> &, span<double>>);
static_assert(converts<const std::vector<double> &, span<const double>>);
static_assert(converts<span<double>, span<const double>>);
static_assert(!converts<const std::vector<double> &, span<double>>, "constants stay constant");
static_assert(!converts<std::vector<int> &, span<const double>>, "numbers are not reinterpreted");

void call_all(precice::Participant &participant) {
  const std::string mesh = "mesh";
  const std::string_view data = "data";
  char name[8] = "name";
  std::vector<double> values(6);
  const std::vector<double> constant(6);
  const std::array<double, 3> point{};
  double position[3] = {};
  std::vector<precice::VertexID> ids(2);
  double value = 0;

  participant.setMeshVertex(mesh, point);
  ids[0] = participant.setMeshVertex(data, position);
  ids[1] = participant.setMeshVertex(name, {values.data(), 3});
  participant.setMeshVertices("mesh", constant, ids);
  participant.setMeshVertices(mesh, {&values[0], values.size()}, {ids.data(), ids.size()});
  participant.setMeshEdge(mesh, ids[0], ids[1]);
  participant.setMeshEdges(mesh, ids);
  participant.setMeshTriangle(mesh, 0, 1, 2);
  participant.setMeshTriangles(mesh, ids);
  participant.setMeshQuad(mesh, 0, 1, 2, 3);
  participant.setMeshQuads(mesh, ids);
  participant.setMeshTetrahedron(mesh, 0, 1, 2, 3);
  participant.setMeshTetrahedra(mesh, ids);
  participant.setMeshAccessRegion(mesh, values);
  if (participant.requiresInitialData() || participant.requiresMeshConnectivityFor(mesh)) {
    participant.initialize();
  }
  while (participant.isCouplingOngoing() && !participant.requiresWritingCheckpoint()) {
    participant.readData(mesh, data, ids, 0.0, values);
    participant.readData(mesh, "data", span(&ids[0], 1), 0, span(&value, 1));
    participant.mapAndReadData(mesh, data, constant, 0, values);
    participant.writeData(mesh, data, ids, span<double>(values));
    participant.writeData("mesh", "data", {ids.data(), 1}, {&value, 1});
    participant.writeAndMapData(mesh, data, values, constant);
    if (participant.requiresGradientDataFor(mesh, data)) {
      participant.writeGradientData(mesh, data, ids, values);
    }
    participant.advance(participant.getMaxTimeStepSize());
    if (participant.requiresReadingCheckpoint() || participant.isTimeWindowComplete()) {
      participant.resetMesh(mesh);
    }
  }
  participant.startProfilingSection("section");
  participant.stopLastProfilingSection();
  participant.getMeshVertexIDsAndCoordinates(mesh, ids, values);
  value = participant.getMeshVertexSize(mesh) + participant.getMeshDimensions(mesh) +
          participant.getDataDimensions(mesh, data);
  participant.finalize();
}

// Returns the reason for which no participant can be created.
std::string refusal() {
  try {
    precice::Participant participant("One", "none.xml", 0, 1);
    call_all(participant);
    return "";
  } catch (const precice::Error &error) {
    return error.what();
  }
}

int main() {
  const char text[] = "four";
  const std::string reason = refusal();
  std::printf("%s\n", reason.c_str());
  const bool passes = !reason.empty() && refusal() == reason &&
                      precice::string_view(text).size() == 4 &&
                      !precice::getVersionInformation().empty();
  return passes ? 0 : 1;
}

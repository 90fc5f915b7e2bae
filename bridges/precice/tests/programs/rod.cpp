// Heat conduction in the rectangle [0, 2] x [0, 1], split at x = 1 into two participants:
// Dirichlet (left) reads the temperature of the interface and writes the heat flux, Neumann (right)
// reads the heat flux and writes the temperature.
//
//   du/dt = d2u/dx2 + d2u/dy2 + f,  f = b - 2 - 2 a,  a = 3, b = 1.2
//
// The outer boundary has the temperatures of the solution u = 1 + x^2 + a y^2 + b t. Finite volumes
// around the nodes of a square grid and the implicit Euler method reproduce that solution exactly.
// Errors therefore come from the mapping between grids of different size, and from the coupling.

#include "precice/precice.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

using Field = std::vector<double>;

constexpr double a = 3, b = 1.2, source = b - 2 - 2 * a;

double exact(double x, double y, double t) { return 1 + x * x + a * y * y + b * t; }

/// One half of the rectangle, with (n + 1) x (n + 1) nodes.
struct Square {
  const bool neumann;
  const int n;
  const double h;
  /// Column of nodes on the interface.
  const int interface;
  /// Temperatures, column by column, and their rates on the interface.
  Field u, rate;

  Square(bool neumann, int n)
      : neumann(neumann), n(n), h(1.0 / n), interface(neumann ? 0 : n), u(size()),
        rate(static_cast<std::size_t>(n) + 1, b) {
    for (int i = 0; i <= n; i++) {
      for (int j = 0; j <= n; j++) {
        u[at(i, j)] = exact(x(i), j * h, 0);
      }
    }
  }

  std::size_t size() const { return static_cast<std::size_t>((n + 1) * (n + 1)); }
  std::size_t at(int i, int j) const { return static_cast<std::size_t>(i * (n + 1) + j); }
  double x(int i) const { return i * h + (neumann ? 1 : 0); }
  double width(int i) const { return i == interface ? h / 2 : h; }
  bool unknown(int i, int j) const { return j > 0 && j < n && i < n && (i > 0 || neumann); }

  Field temperature() const {
    const double *first = &u[at(interface, 0)];
    return Field(first, first + n + 1);
  }

  /// Returns the flux that leaves the Dirichlet half, from the balance of the interface's cells.
  Field flux() const {
    Field result(rate.size());
    for (int j = 1; j < n; j++) {
      const auto k = static_cast<std::size_t>(j);
      result[k] = conduction(u, n, j) / h + width(n) * (source - rate[k]);
    }
    result.front() = result[1];
    result.back() = result[result.size() - 2];
    return result;
  }

  double error(double t) const {
    double largest = 0;
    for (int i = 0; i <= n; i++) {
      for (int j = 0; j <= n; j++) {
        largest = std::max(largest, std::abs(u[at(i, j)] - exact(x(i), j * h, t)));
      }
    }
    return largest;
  }

  /// Solves a step that ends at `t`, given the flux into the Neumann half or the temperature of
  /// the interface. The ends of the interface belong to the outer boundary.
  void step(double dt, double t, const Field &given) {
    Field right(size());
    for (int i = 0; i <= n; i++) {
      for (int j = 0; j <= n; j++) {
        right[at(i, j)] = width(i) * h * (u[at(i, j)] / dt + source);
      }
    }
    const Field before = temperature();
    for (int j = 0; j <= n; j++) {
      const double value = given[static_cast<std::size_t>(j)];
      if (neumann) {
        right[at(interface, j)] += h * value;
      } else {
        u[at(interface, j)] = value;
      }
    }
    for (int k = 0; k <= n; k++) {
      u[at(k, 0)] = exact(x(k), 0, t);
      u[at(k, n)] = exact(x(k), 1, t);
      u[at(n - interface, k)] = exact(x(n - interface), k * h, t);
    }
    solve(dt, right);
    const Field after = temperature();
    for (std::size_t k = 0; k < rate.size(); k++) {
      rate[k] = (after[k] - before[k]) / dt;
    }
  }

  /// Returns the heat that enters the cell of a node from its neighbours.
  double conduction(const Field &v, int i, int j) const {
    const double here = v[at(i, j)];
    double heat = (v[at(i, j - 1)] + v[at(i, j + 1)] - 2 * here) * width(i) / h;
    heat += i > 0 ? v[at(i - 1, j)] - here : 0;
    heat += i < n ? v[at(i + 1, j)] - here : 0;
    return heat;
  }

  /// Returns the storage less the conduction of all cells with an unknown temperature.
  Field balance(const Field &v, double dt) const {
    Field result(size());
    for (int i = 0; i <= n; i++) {
      for (int j = 0; j <= n; j++) {
        if (unknown(i, j)) {
          result[at(i, j)] = width(i) * h / dt * v[at(i, j)] - conduction(v, i, j);
        }
      }
    }
    return result;
  }

  /// Solves for the unknown temperatures with the conjugate gradient method.
  void solve(double dt, const Field &right) {
    const auto dot = [](const Field &p, const Field &q) {
      double sum = 0;
      for (std::size_t k = 0; k < p.size(); k++) {
        sum += p[k] * q[k];
      }
      return sum;
    };
    Field residual = balance(u, dt);
    for (int i = 0; i <= n; i++) {
      for (int j = 0; j <= n; j++) {
        auto &value = residual[at(i, j)];
        value = unknown(i, j) ? right[at(i, j)] - value : 0;
      }
    }
    Field direction = residual;
    double norm = dot(residual, residual);
    while (norm > 1e-28) {
      const Field image = balance(direction, dt);
      const double length = norm / dot(direction, image);
      for (std::size_t k = 0; k < size(); k++) {
        u[k] += length * direction[k];
        residual[k] -= length * image[k];
      }
      const double next = dot(residual, residual);
      for (std::size_t k = 0; k < size(); k++) {
        direction[k] = residual[k] + next / norm * direction[k];
      }
      norm = next;
    }
  }
};

void run(const std::string &name, const std::string &configuration, int n, std::ostream &output,
         int substeps) {
  const bool neumann = name == "Neumann";
  const std::string mesh = name + "-Mesh";
  const char *reads = neumann ? "Heat-Flux" : "Temperature";
  const char *writes = neumann ? "Temperature" : "Heat-Flux";
  Square square(neumann, n);
  const auto result = [&] { return neumann ? square.temperature() : square.flux(); };

  precice::Participant participant(name, configuration, 0, 1);
  Field points;
  for (int j = 0; j <= n; j++) {
    points.insert(points.end(), {1.0, static_cast<double>(j) / n});
  }
  std::vector<precice::VertexID> vertices(points.size() / 2);
  participant.setMeshVertices(mesh, points, vertices);
  if (participant.requiresMeshConnectivityFor(mesh)) {
    for (std::size_t j = 1; j < vertices.size(); j++) {
      participant.setMeshEdge(mesh, vertices[j - 1], vertices[j]);
    }
  }
  if (participant.requiresInitialData()) {
    participant.writeData(mesh, writes, vertices, result());
  }
  participant.initialize();

  output << "time,error,iterations\n";
  output.precision(17);
  Field saved;
  double time = 0, start = 0, dt = 0;
  int substep = 0, iterations = 1;
  Field values(vertices.size());
  while (participant.isCouplingOngoing()) {
    if (participant.requiresWritingCheckpoint()) {
      saved = square.u;
      start = time;
    }
    const double rest = participant.getMaxTimeStepSize();
    if (substep == 0) {
      dt = rest / substeps;
    } else if (substep == substeps - 1) {
      dt = rest;
    }
    participant.readData(mesh, reads, vertices, dt, values);
    time += dt;
    square.step(dt, time, values);
    participant.writeData(mesh, writes, vertices, result());
    participant.advance(dt);
    substep = (substep + 1) % substeps;
    if (participant.requiresReadingCheckpoint()) {
      square.u = saved;
      time = start;
      iterations += 1;
    } else if (participant.isTimeWindowComplete()) {
      output << time << ',' << square.error(time) << ',' << iterations << '\n';
      iterations = 1;
    }
  }
}

int main(int count, char **arguments) {
  const std::string name = count > 1 ? arguments[1] : "";
  const int n = count > 3 ? std::atoi(arguments[3]) : 0;
  const int substeps = count > 5 ? std::atoi(arguments[5]) : 1;
  if (count < 5 || (name != "Dirichlet" && name != "Neumann") || n < 2 || substeps < 1) {
    std::cerr << "usage: rod Dirichlet|Neumann CONFIGURATION CELLS OUTPUT [SUBSTEPS]\n";
    return 2;
  }
  std::ofstream output(arguments[4]);
  try {
    run(name, arguments[2], n, output, substeps);
  } catch (const std::exception &error) {
    std::cerr << "rod: " << error.what() << '\n';
    return 1;
  }
  return output.flush() ? 0 : 1;
}

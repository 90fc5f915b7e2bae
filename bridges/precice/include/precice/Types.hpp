#ifndef PRECICE_TYPES_HPP
#define PRECICE_TYPES_HPP

namespace precice {

/// Number of a vertex in its mesh.
using VertexID = int;

} // namespace precice

#endif

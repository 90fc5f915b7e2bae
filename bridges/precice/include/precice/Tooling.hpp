#ifndef PRECICE_TOOLING_HPP
#define PRECICE_TOOLING_HPP

#include "precice/preciceC.h"

#include <string>

namespace precice {

/// Returns the version, the revision and the configuration, separated by semicolons.
inline std::string getVersionInformation() { return precicec_getVersionInformation(); }

} // namespace precice

#endif

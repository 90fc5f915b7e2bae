#ifndef PRECICE_EXCEPTIONS_HPP
#define PRECICE_EXCEPTIONS_HPP

#include <stdexcept>

namespace precice {

/// A refused call, with its reason.
class Error : public std::runtime_error {
public:
  using std::runtime_error::runtime_error;
};

} // namespace precice

#endif

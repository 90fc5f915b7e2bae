#ifndef PRECICE_HPP
#define PRECICE_HPP

#include "precice/Exceptions.hpp"
#include "precice/Participant.hpp"
#include "precice/Types.hpp"
#include "precice/Version.h"
#include "precice/span.hpp"

#endif

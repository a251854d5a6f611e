/// @file
#pragma once

#include <functional>

#include "envmap/base/export.h"

namespace ENVMAP_EXPORT envmap {

/// Called with the part done, 0 to 1, from any thread; may be empty.
using Progress = std::function<void(double)>;

}  // namespace envmap

/// @file
#pragma once

#include <functional>

namespace envmap {

/// Called with the part done, 0 to 1, from any thread; may be empty.
using Progress = std::function<void(double)>;

}  // namespace envmap

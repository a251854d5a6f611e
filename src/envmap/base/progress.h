/// @file
/// How far an operation is.
#pragma once

#include <functional>

#include "envmap/base/export.h"

namespace ENVMAP_EXPORT envmap {

/// Receives the part done: one call at a time, from any thread, with values that never fall and end at 1. An
/// exception that it throws cancels the operation and leaves the call; no file is written. It may be empty. It must
/// not use the object that calls it.
using Progress = std::function<void(double)>;

}  // namespace envmap

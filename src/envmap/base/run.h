/// @file
/// How an operation runs: how far it is, what stops it, and how many threads it takes.
#pragma once

#include <exception>
#include <functional>
#include <stop_token>

#include "envmap/base/export.h"

namespace ENVMAP_EXPORT envmap {

/// Receives the part done: one call at a time, from any thread, with values that never fall and end at 1. An
/// exception that it throws cancels the operation and leaves the call; no file is written. It may be empty. It must
/// not use the object that calls it.
using Progress = std::function<void(double)>;

/// The last argument of operations that take time. An operation that is stopped leaves no file, and a file that was
/// there stays.
struct Run {
  Progress progress = {};
  std::stop_token stop = {};  ///< A request ends the operation by Cancelled, within about 0.2 s.
  int threads = 0;  ///< At most so many, the caller's among them, up to 1024. 0: what oneTBB gives the caller.
};

/// Thrown by an operation that was asked to stop.
struct Cancelled : std::exception {
  [[nodiscard]] const char* what() const noexcept override { return "cancelled"; }
};

}  // namespace envmap

/// @file
/// Threads that take turns at one thing.
#pragma once

#include <chrono>
#include <mutex>

#include "envmap/base/run.h"

namespace envmap {

/// The turn of this thread. One that is asked to stop while others take theirs ends at once. @param progress may be
/// empty. @throws Cancelled
inline std::unique_lock<std::timed_mutex> wait_for_turn(std::timed_mutex& in_use, const Progress& progress) {
  std::unique_lock turn(in_use, std::defer_lock);
  while (!turn.try_lock_for(std::chrono::milliseconds(20)))
    if (progress) progress(0);
  return turn;
}

}  // namespace envmap

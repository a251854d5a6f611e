/// @file
/// OpenGL in a thread of its own, so that the context that is current in the caller's stays current.
#pragma once

#include <exception>
#include <thread>

namespace envmap {

/// Calls f() in a thread and waits for it. What it throws is thrown again.
template <class F>
void in_own_thread(const F& f) {
  std::exception_ptr raised;
  std::thread([&] {
    try {
      f();
    } catch (...) {
      raised = std::current_exception();
    }
  }).join();
  if (raised) std::rethrow_exception(raised);
}

}  // namespace envmap

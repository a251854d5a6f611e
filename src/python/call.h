/// @file
/// Calls of the library that Python can interrupt.
#pragma once

#include <pybind11/pybind11.h>

#include <functional>
#include <memory>
#include <optional>
#include <type_traits>

#include "envmap/envmap.h"

namespace envmap_python {

/// Runs a task in a thread of its own. Meanwhile the calling thread, without the GIL, calls `progress` (a function or
/// None) and lets Python handle its signals every 50 ms. What either raises stops the task and is raised. A task that
/// a signal stops has 0.3 s to end. After that it is left behind: it must own all that it uses, and nothing of Python.
void run_task(const pybind11::object& progress, std::function<void(const envmap::Run&)> task);

/// The same of a function with a result. @param task takes a Run, or nothing where it has no use for one.
template <class F>
auto run_operation(const pybind11::object& progress, F task) {
  constexpr bool takes_run = std::is_invocable_v<F&, const envmap::Run&>;
  const auto call = [task = std::move(task)](const envmap::Run& run) mutable {
    if constexpr (takes_run)
      return task(run);
    else
      return task();
  };
  using Result = std::invoke_result_t<std::remove_const_t<decltype(call)>&, const envmap::Run&>;
  auto work = std::make_shared<std::remove_const_t<decltype(call)>>(std::move(call));
  if constexpr (std::is_void_v<Result>) {
    run_task(progress, [work](const envmap::Run& run) { (*work)(run); });
  } else {
    const auto result = std::make_shared<std::optional<Result>>();
    run_task(progress, [work, result](const envmap::Run& run) { result->emplace((*work)(run)); });
    return std::move(**result);
  }
}

/// The same of a task that does not tell how far it is.
template <class F>
auto run_operation(F task) {
  return run_operation(pybind11::none(), std::move(task));
}

/// Adds before_fork(), which a process that forks calls.
void add_before_fork(pybind11::module_& module);

}  // namespace envmap_python

/// @file
/// A public operation as its caller wants it run.
#pragma once

#include <algorithm>
#include <atomic>
#include <optional>
#include <type_traits>

#include "envmap/base/bounds.h"
#include "envmap/base/parallel.h"
#include "envmap/base/run.h"

namespace envmap {

/// What the parts of an operation report to. The caller's callback sees one call at a time, values that never fall, and
/// 1 at the end. Threads that report while another call runs go on with their work.
class MonotonicProgress {
 public:
  /// @param run must outlive this.
  explicit MonotonicProgress(const Run& run) : run_(run) {
    if (run.progress || run.stop.stop_possible()) report_ = [this](double part) { report(part); };
  }
  MonotonicProgress(const MonotonicProgress&) = delete;
  MonotonicProgress& operator=(const MonotonicProgress&) = delete;

  /// For the parts of the operation; empty where nobody listens. @throws Cancelled from there.
  [[nodiscard]] const Progress& callback() const { return report_; }

  /// Reports 1, after all threads are done.
  void finish() const {
    if (run_.progress) run_.progress(1);
  }

 private:
  void report(double part) {
    if (run_.stop.stop_requested()) throw Cancelled();
    if (!run_.progress || busy_.test_and_set(std::memory_order_acquire)) return;
    struct Release {
      std::atomic_flag& busy;
      ~Release() { busy.clear(std::memory_order_release); }
    } const release{busy_};
    if (part < 1) last_ = std::max(last_, part);
    run_.progress(last_);
  }

  const Run& run_;
  Progress report_;
  std::atomic_flag busy_;
  double last_ = 0;
};

/// Calls work(progress) with the threads of the run. @return its result. @throws UsageError where `threads` is out of
/// its range, Cancelled where the run was stopped before it began.
template <class Work>
auto run_operation(const Run& run, const Work& work) {
  check_range(limits::threads, run.threads);
  if (run.stop.stop_requested()) throw Cancelled();
  const MonotonicProgress steady(run);
  using Made = decltype(work(steady.callback()));
  if constexpr (std::is_void_v<Made>) {
    with_threads(run.threads, [&] { with_stop(run.stop, [&] { work(steady.callback()); }); });
    steady.finish();
  } else {
    std::optional<Made> made;
    with_threads(run.threads, [&] { with_stop(run.stop, [&] { made.emplace(work(steady.callback())); }); });
    steady.finish();
    return std::move(*made);
  }
}

}  // namespace envmap

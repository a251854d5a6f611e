/// @file
/// What a caller's progress callback sees: one call at a time, values that never fall, and 1 at the end.
#pragma once

#include <algorithm>
#include <atomic>

#include "envmap/base/progress.h"

namespace envmap {

/// Wraps the callback of one operation. Threads that report while another call runs go on with their work.
class SteadyProgress {
 public:
  /// @param wanted must outlive this; may be empty.
  explicit SteadyProgress(const Progress& wanted) : wanted_(wanted) {
    if (wanted) report_ = [this](double part) { report(part); };
  }
  SteadyProgress(const SteadyProgress&) = delete;
  SteadyProgress& operator=(const SteadyProgress&) = delete;

  /// For the parts of the operation; empty where the caller's is.
  [[nodiscard]] const Progress& callback() const { return report_; }

  /// Reports 1, after all threads are done.
  void finish() const {
    if (wanted_) wanted_(1);
  }

 private:
  void report(double part) {
    if (busy_.test_and_set(std::memory_order_acquire)) return;
    struct Release {
      std::atomic_flag& busy;
      ~Release() { busy.clear(std::memory_order_release); }
    } const release{busy_};
    if (part < 1) last_ = std::max(last_, part);
    wanted_(last_);
  }

  const Progress& wanted_;
  Progress report_;
  std::atomic_flag busy_;
  double last_ = 0;
};

}  // namespace envmap

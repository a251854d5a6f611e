/// @file
/// Sums that keep what plain addition loses.
#pragma once

#include <cmath>

namespace envmap {

/// Compensated sum of doubles (Neumaier 1974): error of one rounding, whatever the order of magnitude of the terms.
class CompensatedSum {
 public:
  void add(double x) {
    const double t = total_ + x;
    lost_ += std::abs(total_) >= std::abs(x) ? (total_ - t) + x : (x - t) + total_;
    total_ = t;
  }
  void add(const CompensatedSum& other) {
    add(other.total_);
    lost_ += other.lost_;
  }
  [[nodiscard]] double value() const { return total_ + lost_; }

 private:
  double total_ = 0, lost_ = 0;
};

}  // namespace envmap

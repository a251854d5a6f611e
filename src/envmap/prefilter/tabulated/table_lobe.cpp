#include "envmap/prefilter/tabulated/table_lobe.h"

#include <algorithm>
#include <cmath>

#include "envmap/maths/vector.h"

namespace envmap::prefiltering {
namespace {

constexpr int bins = 1024;

std::size_t bin_of(double cosine) { return std::size_t(std::clamp(cosine, 0.0, 1.0) * bins); }

}  // namespace

TableLobe::TableLobe(std::span<const LobeSample> samples) : samples_(samples.begin(), samples.end()) {
  // Values and slopes of any size, down to the smallest of floats.
  double most = 0, integral = 0;
  for (const LobeSample& s : samples_) most = std::max(most, s.value);
  for (LobeSample& s : samples_) s.value /= most;
  for (std::size_t k = 0; k + 1 < samples_.size(); ++k)
    integral += pi * (samples_[k].value + samples_[k + 1].value) * (samples_[k + 1].cosine - samples_[k].cosine);
  for (LobeSample& s : samples_) s.value /= integral;
  std::uint32_t next = 0;
  for (int bin = 0; bin <= bins; ++bin) {
    while (next < samples_.size() && !(samples_[next].cosine > double(bin) / bins)) ++next;
    after_.push_back(next);
  }
}

std::size_t TableLobe::after(double cosine) const {
  std::size_t k = after_[bin_of(cosine)];
  while (k > 0 && samples_[k - 1].cosine > cosine) --k;
  while (k < samples_.size() && !(samples_[k].cosine > cosine)) ++k;
  return k;
}

double TableLobe::slope(std::size_t k) const {
  return (samples_[k + 1].value - samples_[k].value) / (samples_[k + 1].cosine - samples_[k].cosine);
}

double TableLobe::value(double cosine) const {
  const std::size_t k = after(cosine);
  if (k == 0) return 0;
  if (k == samples_.size()) return samples_.back().value;
  return samples_[k - 1].value + slope(k - 1) * (cosine - samples_[k - 1].cosine);
}

LobeLine TableLobe::line(double low, double high, double at) const {
  if (high < samples_.front().cosine) return {};
  const double top = std::min(1.0, high);
  std::size_t k = after(low);
  if (k >= samples_.size() || low >= top) return {.value = samples_.back().value};  // Rounding beyond 1.
  if (k > 0 && samples_[k].cosine >= top) {
    const double s = slope(k - 1);
    return {.value = samples_[k - 1].value + s * (at - samples_[k - 1].cosine), .slope = s};
  }
  const double first = value(low), s = (value(top) - first) / (top - low);
  double least = 0, most = 0;
  const auto see = [&](double cosine, double there) {
    const double off = there - (first + s * (cosine - low));
    least = std::min(least, off), most = std::max(most, off);
  };
  if (k == 0) see(samples_.front().cosine, 0);  // Where the lobe breaks off it has two values.
  for (; k < samples_.size() && samples_[k].cosine <= top; ++k) see(samples_[k].cosine, samples_[k].value);
  return {.value = first + s * (at - low) + 0.5 * (least + most), .slope = s, .error = 0.5 * (most - least)};
}

}  // namespace envmap::prefiltering

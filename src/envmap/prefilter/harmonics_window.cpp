// The search for the weakest window that leaves no irradiance negative: points of a grid first, then descent to the
// lowest places between them.
#include "envmap/prefilter/harmonics_window.h"

#include <algorithm>
#include <cmath>

#include "envmap/base/bounds.h"
#include "envmap/base/parallel.h"
#include "envmap/base/run_operation.h"
#include "envmap/maths/portable.h"

namespace envmap {
namespace {

// An irradiance, degree by degree, so that windows can be tried.
class Irradiance {
 public:
  explicit Irradiance(const Harmonics& radiance) : degrees_(std::size_t(radiance.order) + 1), series_(radiance) {
    scale_degrees(series_, irradiance_factors(radiance.order));
    rows_ = 8 * (radiance.order + 1), columns_ = 2 * rows_;
    step_ = pi / rows_;
    points_.resize(index(rows_, 0));
    parts_.resize(points_.size() * degrees_);
    for_each_row(1, rows_, {}, [&](int, int j) {
      std::vector<double> y(series_.coefficients.size());
      for (int i = 0; i < columns_; ++i) {
        const std::size_t k = index(j, i);
        const double polar = (j + 0.5) * step_, azimuth = i * step_, s = portable::sin(polar);
        points_[k] = {s * portable::sin(azimuth), portable::cos(polar), s * portable::cos(azimuth)};
        parts(points_[k], y, std::span(parts_).subspan(k * degrees_, degrees_));
      }
    });
  }

  [[nodiscard]] Flux mean() const { return series_.coefficients[0] * std::sqrt(0.25 / pi); }

  // Whether any channel is below 0 anywhere.
  [[nodiscard]] bool negative(std::span<const double> window) const {
    return negative(window, 0) || negative(window, 1) || negative(window, 2);
  }

  [[nodiscard]] double rms(std::span<const double> window) const {
    Flux change(0), whole(0);  // Parseval: integrals of squares are sums of squares.
    for (int l = 0; l <= series_.order; ++l)
      for (int m = -l; m <= l; ++m) {
        const Flux square =
            series_.coefficients[std::size_t(l * (l + 1) + m)] * series_.coefficients[std::size_t(l * (l + 1) + m)];
        const double lost = 1 - window[std::size_t(l)];
        whole += square, change += lost * lost * square;
      }
    double most = 0;
    for (int c = 0; c < 3; ++c)
      if (whole[c] > 0) most = std::max(most, std::sqrt(change[c] / whole[c]));
    return most;
  }
  [[nodiscard]] double maximum(std::span<const double> window) const {
    Flux most(0);
    for (std::size_t k = 0; k < points_.size(); ++k) {
      Flux change(0);
      for (std::size_t l = 0; l < degrees_; ++l) change += (1 - window[l]) * parts_[k * degrees_ + l];
      most = glm::max(most, glm::abs(change));
    }
    double relative = 0;
    for (int c = 0; c < 3; ++c)
      if (mean()[c] > 0) relative = std::max(relative, most[c] / mean()[c]);
    return relative;
  }

 private:
  // What each degree gives in a direction. @param y room for the harmonics.
  void parts(const Direction& d, std::span<double> y, std::span<Flux> out) const {
    harmonics_at(series_.order, d, y);
    for (std::size_t l = 0; l < out.size(); ++l) {
      out[l] = Flux(0);
      for (std::size_t k = l * l; k < (l + 1) * (l + 1); ++k) out[l] += y[k] * series_.coefficients[k];
    }
  }

  [[nodiscard]] std::size_t index(int row, int column) const {
    return std::size_t(row) * std::size_t(columns_) + std::size_t((column + columns_) % columns_);
  }

  [[nodiscard]] bool negative(std::span<const double> window, int channel) const {
    std::vector<double> values(points_.size(), 0);
    for (std::size_t k = 0; k < values.size(); ++k)
      for (std::size_t l = 0; l < degrees_; ++l) values[k] += window[l] * parts_[k * degrees_ + l][channel];
    const double least = *std::ranges::min_element(values), gap = between(window, channel);
    if (least < 0 || least >= gap) return least < 0;
    const auto lowest_around = [&](int j, int i) {
      for (int b = std::max(0, j - 1); b <= std::min(rows_ - 1, j + 1); ++b)
        for (int a = i - 1; a <= i + 1; ++a)
          if (values[index(b, a)] < values[index(j, i)]) return false;
      return true;
    };
    for (int j = 0; j < rows_; ++j)
      for (int i = 0; i < columns_; ++i)
        if (const std::size_t k = index(j, i); values[k] < gap && lowest_around(j, i))
          if (descend(points_[k], values[k], window, channel) < 0) return true;
    return false;
  }

  // How far below the points an irradiance may be at its lowest: there its slope is 0, and along a great circle a part
  // of degree l bends by no more than l^2 x its largest (Bernstein's inequality), which is below sqrt((2l + 1) / 4 pi)
  // x the norm of its coefficients. No place is farther than step / sqrt(2) from a point.
  [[nodiscard]] double between(std::span<const double> window, int channel) const {
    double bend = 0;
    for (int l = 0; l <= series_.order; ++l) {
      double square = 0;
      for (int k = l * l; k < (l + 1) * (l + 1); ++k) {
        const double c = series_.coefficients[std::size_t(k)][channel];
        square += c * c;
      }
      bend += window[std::size_t(l)] * l * l * std::sqrt((2 * l + 1) / (4 * pi) * square);
    }
    return 0.25 * step_ * step_ * bend;
  }

  // Down to the bottom, to 1e-8 of what it is below the points: steps in the tangent plane, halved where none of them
  // leads down.
  [[nodiscard]] double descend(Direction at, double value, std::span<const double> window, int channel) const {
    std::vector<double> y(series_.coefficients.size());
    std::vector<Flux> degree(degrees_);
    const double least = 1e-14 * mean()[channel];
    for (double step = 0.5 * step_; step > 1e-4 * step_;) {
      const Direction side =
          glm::normalize(glm::cross(at, std::abs(at.y) < 0.8 ? Direction(0, 1, 0) : Direction(1, 0, 0)));
      const Direction up = glm::cross(side, at);
      bool lower = false;
      for (const Direction& move : {side, -side, up, -up}) {
        const Direction next = glm::normalize(at + step * move);
        parts(next, y, degree);
        double sum = 0;
        for (std::size_t l = 0; l < degrees_; ++l) sum += window[l] * degree[l][channel];
        if (sum >= value - least) continue;
        value = sum, at = next, lower = true;
        break;
      }
      if (!lower) step *= 0.5;
    }
    return value;
  }

  std::size_t degrees_;
  Harmonics series_;
  int rows_, columns_;  // Of the grid.
  double step_;
  std::vector<Direction> points_;
  std::vector<Flux> parts_;  // By point and degree.
};

Deringing least_window(const Harmonics& radiance, const Progress& progress) {
  const Irradiance irradiance(radiance);
  const auto negative = [&](double lambda) {
    if (progress) progress(0);  // Which ends it where a stop is requested.
    return irradiance.negative(laplacian_window(radiance.order, lambda));
  };
  if (!negative(0)) return {};
  // Degree 0 alone, which is all that is left in the end, is not below 0.
  double low = 0, high = 1e-6;
  while (negative(high) && high < 1e6) low = high, high *= 4;
  while (high - low > 1e-6 * high) {
    const double middle = 0.5 * (low + high);
    (negative(middle) ? low : high) = middle;
  }
  const std::vector<double> window = laplacian_window(radiance.order, high);
  return {high, irradiance.rms(window), irradiance.maximum(window)};
}

}  // namespace

std::vector<double> hann_window(int order) {
  check_range(limits::order, order);
  std::vector<double> factors;
  for (int l = 0; l <= order; ++l) factors.push_back(0.5 + 0.5 * portable::cos(pi * l / (order + 1)));
  return factors;
}

std::vector<double> laplacian_window(int order, double lambda) {
  check_range(limits::order, order);
  check_range({"lambda", 0, 1e30}, lambda);
  std::vector<double> factors;
  for (int l = 0; l <= order; ++l) {
    const double laplacian = 1.0 * l * (l + 1);
    factors.push_back(1 / (1 + lambda * laplacian * laplacian));
  }
  return factors;
}

Deringing weakest_window(const Harmonics& radiance, const Run& run) {
  check_range({"order", 0, max_deringed_order}, radiance.order);
  return run_operation(run, [&](const Progress& progress) { return least_window(radiance, progress); });
}

}  // namespace envmap

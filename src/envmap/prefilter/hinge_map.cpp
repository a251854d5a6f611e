#include "envmap/prefilter/hinge_map.h"

#include <cmath>

#include "envmap/base/parallel.h"
#include "envmap/operate/measure.h"

namespace envmap::prefiltering {

namespace {

constexpr double rounding = 0x1p-24;  // Of a float.

// Of one texel. @return its bound.
float set_texel(const HingeSum& sum, double floor, Colour& out) {
  double largest = 0;
  for (int c = 0; c < 3; ++c) {
    largest = std::max(largest, sum.bound[c] / std::max(sum.value[c] - sum.bound[c], floor));
    out[c] = float(std::max(0.0, sum.value[c]));
  }
  return std::nextafter(float(largest + 2 * rounding), 1.F);  // Of the texels less the darkest, and of the result.
}

}  // namespace

void hinge_map(const Hinges& hinges, const HingePolynomial& weight, double max_error, double mean, const Making& map) {
  const double error = max_error - 3 * rounding;
  map.each_row([&](std::span<const Direction> directions, std::span<Colour> texels, std::span<float> bounds) {
    std::vector<HingeSum> sums(directions.size());
    hinges.sums(weight, directions, error, {}, sums);
    for (std::size_t k = 0; k < sums.size(); ++k) bounds[k] = set_texel(sums[k], 1e-3 * mean, texels[k]);
  });
}

}  // namespace envmap::prefiltering

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

void hinge_map(const Hinges& hinges, const HingePolynomial& weight, const Target& target, double max_error, double mean,
               std::span<const char> rows, Level& out, std::span<float> bounds, const Progress& progress) {
  const double error = max_error - 3 * rounding;
  for_each_row(out.faces(), out.height(), progress, [&](int face, int row) {
    if (!rows.empty() && rows[std::size_t(face * out.height() + row)] == 0) return;
    const Columns in = columns(target.to, target.size, row);
    std::vector<Direction> directions(in.count());
    texel_directions(target.to, target.size, face, row, in.first, directions);
    rotate(target.to_source, directions);
    std::vector<HingeSum> sums(directions.size());
    hinges.sums(weight, directions, error, {}, sums);
    float* bound = &bounds[index_of(out, {face, in.first, row})];
    for (std::size_t k = 0; k < sums.size(); ++k)
      bound[k] = set_texel(sums[k], 1e-3 * mean, *out.texel(face, in.first + int(k), row));
  });
}

}  // namespace envmap::prefiltering

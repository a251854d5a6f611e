#include "envmap/io/limit.h"

#include <algorithm>
#include <cmath>

#include "envmap/io/rgbd.h"
#include "envmap/io/texels.h"

namespace envmap {
namespace {

double sum(const Colour& c) { return double{c.x} + double{c.y} + double{c.z}; }

}  // namespace

Range range_of(Depth depth, double largest) {
  if (is_integer(depth)) return {.largest = 1};
  // Half has 11 bits down to 2^-14; of a shared exponent 9 down to 2^-15 (a texel below that has no finer exponent).
  // What half has to refuse blocks of halves cannot hold either.
  if (depth == Depth::half || depth == Depth::bc6h)
    return {.largest = 65504, .fine = 0x1p-14, .step = 0x1p-24, .precision = 0x1p-11};
  if (depth == Depth::rgb9e5) return {.largest = largest_rgb9e5, .fine = 0x1p-15, .step = 0x1p-24, .precision = 0x1p-9};
  if (depth == Depth::rgbd) return {.largest = largest_rgbd};
  return {.largest = largest};
}

ClampedRows::ClampedRows(const Rows& rows, const Range& range, bool weigh)
    : range_(range),
      weigh_(weigh || range.step > 0),
      limited_(rows),
      misfits_(std::size_t(faces(rows.projection)) * std::size_t(rows.size)) {
  limited_.fill = [this, &rows](int face, int row, std::span<Colour> out) {
    rows.fill(face, row, out);
    misfits_[std::size_t(face) * std::size_t(rows.size) + std::size_t(row)] = cut(row, out);
  };
}

ClampStatistics ClampedRows::total() const {
  ClampStatistics sum;
  for (const ClampStatistics& m : misfits_) {
    sum.over += m.over;
    sum.dark += m.dark;
    sum.nan += m.nan;
    sum.cut += m.cut;
    sum.rounded += m.rounded;
    sum.flux += m.flux;
    sum.brightest = std::max(sum.brightest, m.brightest);
  }
  return sum;
}

ClampStatistics ClampedRows::cut(int row, std::span<Colour> out) const {
  ClampStatistics m;
  const auto largest = float(range_.largest);
  const double fine = range_.fine, step = range_.step;
  std::vector<double> w;
  if (weigh_) {
    w.resize(out.size());
    solid_angles(limited_.projection, limited_.size, row, w);
  }
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Colour c = out[i], over = glm::max(c - largest, Colour(0));
    m.nan += std::isnan(sum(c));
    if (over.x > 0 || over.y > 0 || over.z > 0) ++m.over, m.brightest = std::max({m.brightest, c.x, c.y, c.z});
    out[i] = glm::min(c, Colour(largest));
    if (weigh_) m.cut += w[i] * sum(over), m.flux += w[i] * sum(c);
    if (step == 0 || !(std::min({c.x, c.y, c.z}) < fine) || c == Colour(0)) continue;
    double error = 0;
    for (int k = 0; k < 3; ++k)
      if (c[k] < fine) error += std::abs(c[k] - step * std::nearbyint(c[k] / step));
    m.dark += error > 0;
    m.rounded += w[i] * error;
  }
  return m;
}

}  // namespace envmap

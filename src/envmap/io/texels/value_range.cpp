#include "envmap/io/texels/value_range.h"

#include <algorithm>
#include <cmath>

#include "envmap/io/texels/rgbd.h"
#include "envmap/io/texels/texels.h"

namespace envmap {
namespace {

double sum(const Colour& c) { return double{c.x} + double{c.y} + double{c.z}; }
float largest_channel(const Colour& c) { return std::max({c.x, c.y, c.z}); }

// Whether what is below 0 is more than the last bit of a channel that shares the texel's exponent.
bool matters(const Colour& below, const Colour& c) {
  return largest_channel(below) > 0x1p-9F * std::max(largest_channel(c), 0x1p-15F);
}

}  // namespace

Range range_of(Depth depth, double largest) {
  if (is_integer(depth)) return {.largest = 1};
  // Half has 11 bits down to 2^-14; of a shared exponent 9 down to 2^-15 (a texel below that has no finer exponent).
  // What half has to refuse blocks of halves cannot hold either.
  if (depth == Depth::half || depth == Depth::bc6h || depth == Depth::uastc_hdr)
    return {.largest = 65504, .fine = 0x1p-14, .step = 0x1p-24, .precision = 0x1p-11, .has_sign = depth == Depth::half};
  if (depth == Depth::rgb9e5)
    return {.largest = largest_rgb9e5, .fine = 0x1p-15, .step = 0x1p-24, .precision = 0x1p-9, .has_sign = false};
  if (depth == Depth::rgbd) return {.largest = largest_rgbd, .has_sign = false};
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
    sum.negative += m.negative;
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
    const Colour given = out[i], over = glm::max(given - largest, Colour(0));
    const Colour below = range_.has_sign ? Colour(0) : glm::max(-given, Colour(0)), c = given + below;
    m.nan += std::isnan(sum(c));
    if (over.x > 0 || over.y > 0 || over.z > 0) ++m.over, m.brightest = std::max({m.brightest, c.x, c.y, c.z});
    out[i] = glm::min(c, Colour(largest));
    m.negative += matters(below, c);
    if (weigh_) m.cut += w[i] * sum(over + below), m.flux += w[i] * sum(c);
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

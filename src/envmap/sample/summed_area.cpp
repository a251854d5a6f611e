#include "envmap/sample/summed_area.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "envmap/base/parallel.h"
#include "envmap/maths/portable.h"
#include "envmap/projection/matching_size.h"
#include "envmap/sample/footprint.h"
#include "envmap/sample/multi_sample.h"
#include "envmap/sample/point.h"

namespace envmap {
namespace {

// One probe, of this size.
struct Box {
  int across = 1, down = 1;
  Point2 half;
};

// A texel of the face, or of the environment where the projection continues to beyond it; weighted by |dd/du x dd/dv|.
SummedArea::Entry texel_or_beyond(const PaddedLevel& level, int face, int i, int j) {
  const double n = level.height(), u = (i + 0.5) / level.width(), v = (j + 0.5) / n;
  const Derivative d = derivative(level.projection(), {face, u, v}, 0.25 / n);
  const double weight = glm::length(glm::cross(d.du, d.dv));
  const bool in_face = i >= 0 && j >= 0 && i < level.width() && j < level.height();
  if (in_face && (!on_disc(level.projection()) || portable::hypot(2 * u - 1, 2 * v - 1) <= 1))
    return {weight * Rgb<double>(*level.texel(face, i, j)), weight};
  const Location<double> place = locate(level.projection(), direction_at(level.projection(), face, {u, v}));
  return {weight * Rgb<double>(bilinear(level, place)), weight};
}

}  // namespace

SummedArea::SummedArea(const PaddedLevel& level, int margin)
    : margin_(margin),
      width_(level.width() + 2 * margin),
      height_(level.height() + 2 * margin),
      entries_(std::size_t(level.faces()) * std::size_t(width_ + 1) * std::size_t(height_ + 1)) {
  parallel_for(level.faces(), [&](int face) { fill_face(level, face); });
}

const SummedArea::Entry* SummedArea::entry(int face, int i, int j) const {
  return entries_.data() + (std::ptrdiff_t(face) * (height_ + 1) + j) * (width_ + 1) + i;
}

void SummedArea::fill_face(const PaddedLevel& level, int face) {
  const auto at = [&](int i, int j) { return const_cast<Entry*>(entry(face, i, j)); };
  parallel_for(height_, [&](int j) {
    Entry row;
    for (int i = 0; i < width_; ++i) {
      row.add(texel_or_beyond(level, face, i - margin_, j - margin_));
      *at(i + 1, j + 1) = row;
    }
  });
  for (int j = 1; j < height_; ++j)
    for (int i = 1; i <= width_; ++i) at(i, j + 1)->add(*at(i, j));
}

// The table is linear between its entries, as the sum over a texel of one colour is.
void SummedArea::add_corner(int face, double x, double y, double sign, Entry& sum) const {
  const int i = std::clamp(int(x), 0, width_ - 1), j = std::clamp(int(y), 0, height_ - 1);
  const double fx = x - i, fy = y - j;
  const Entry* a = entry(face, i, j);
  const Entry* b = entry(face, i, j + 1);
  const double w[4] = {sign * (1 - fx) * (1 - fy), sign * fx * (1 - fy), sign * (1 - fx) * fy, sign * fx * fy};
  sum.light += w[0] * a[0].light + w[1] * a[1].light + w[2] * b[0].light + w[3] * b[1].light;
  sum.weight += w[0] * a[0].weight + w[1] * a[1].weight + w[2] * b[0].weight + w[3] * b[1].weight;
}

Colour SummedArea::mean(const Location<double>& at, Point2 half) const {
  half = glm::clamp(half, Point2(0.5), Point2(margin_));
  const double x = at.u * (width_ - 2 * margin_) + margin_, y = at.v * (height_ - 2 * margin_) + margin_;
  Entry sum;
  add_corner(at.face, x + half.x, y + half.y, 1, sum);
  add_corner(at.face, x - half.x, y + half.y, -1, sum);
  add_corner(at.face, x + half.x, y - half.y, -1, sum);
  add_corner(at.face, x - half.x, y - half.y, 1, sum);
  return Colour(glm::max(sum.light / sum.weight, Rgb<double>(0)));  // Rounding may leave a black place below 0.
}

Sampler summed_area_sampler(const PaddedLevel& source, const Target& target) {
  const double covers = double(matching_size(source.projection(), source.height(), target.to)) / target.size;
  const int margin = std::clamp(int(2 * covers) + 2, 2, std::max(2, source.height() / 2));
  const auto table = std::make_shared<SummedArea>(source, margin);
  return [&source, target, table](int face, int row, int first, std::span<Colour> out) {
    const auto plan = [&](int on, const Point2& at) {
      const Jacobian j = jacobian(target, source.projection(), source.height(), on, at);
      return Box{.half = 0.5 * (glm::abs(j.du) + glm::abs(j.dv))};
    };
    const auto find = [&](std::span<const Direction> d, std::span<Location<double>> at) {
      locate(source.projection(), d, at);
    };
    sample_probes(target, face, row, first, out, find, plan,
                  [&](std::span<const Location<double>> at, const Box& box, std::span<Colour> to) {
                    for (std::size_t k = 0; k < at.size(); ++k) to[k] = table->mean(at[k], box.half);
                  });
  };
}

}  // namespace envmap

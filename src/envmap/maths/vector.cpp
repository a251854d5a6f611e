// rotate(), compiled once for every instruction set and chosen at run time.
#include "envmap/maths/vector.h"

#include <array>
#include <cmath>

#include "envmap/maths/check_direction.h"
#include "envmap/maths/portable.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "envmap/maths/vector.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace envmap {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void Rotate(const Rotation& turn, std::span<Direction> directions) {
  const hn::ScalableTag<double> d;
  std::size_t k = 0;
  for (; k + hn::Lanes(d) <= directions.size(); k += hn::Lanes(d)) {
    hn::Vec<decltype(d)> x, y, z;
    hn::LoadInterleaved3(d, &directions[k].x, x, y, z);
    // GLM matrices are lists of columns; the order of the sum is GLM's.
    const auto component = [&](int row) HWY_ATTR {
      const auto xy = hn::Add(hn::Mul(hn::Set(d, turn[0][row]), x), hn::Mul(hn::Set(d, turn[1][row]), y));
      return hn::Add(xy, hn::Mul(hn::Set(d, turn[2][row]), z));
    };
    hn::StoreInterleaved3(component(0), component(1), component(2), d, &directions[k].x);
  }
  for (; k < directions.size(); ++k) directions[k] = turn * directions[k];
}

}  // namespace HWY_NAMESPACE
}  // namespace envmap
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace envmap {

HWY_EXPORT(Rotate);

void rotate(const Rotation& turn, std::span<Direction> directions) { HWY_DYNAMIC_DISPATCH(Rotate)(turn, directions); }

namespace {

// Exact at multiples of a quarter turn, so that --rotate 90,0,0 moves texels onto texels.
std::array<double, 2> cos_sin_degrees(double degrees) {
  const double turn = std::remainder(degrees, 360.0);
  const double quarter = std::nearbyint(turn / 90.0);
  const double rest = (turn - 90.0 * quarter) / 180.0;
  const double c = portable::cos_pi(rest), s = portable::sin_pi(rest);
  switch (int(quarter) & 3) {
    case 0: return {c, s};
    case 1: return {-s, c};
    case 2: return {-c, -s};
    default: return {s, -c};
  }
}

}  // namespace

Rotation rotation(double yaw, double pitch, double roll) {
  const auto [cy, sy] = cos_sin_degrees(yaw);
  const auto [cp, sp] = cos_sin_degrees(pitch);
  const auto [cr, sr] = cos_sin_degrees(roll);
  // GLM matrices are written column by column.
  const Rotation about_y(cy, 0, -sy, 0, 1, 0, sy, 0, cy);
  const Rotation about_x(1, 0, 0, 0, cp, sp, 0, -sp, cp);
  const Rotation about_z(cr, sr, 0, -sr, cr, 0, 0, 0, 1);
  return about_y * about_x * about_z;
}

Rotation upright_about(const Direction& towards) {
  const Direction z = checked_direction("z", towards);
  const bool upright = std::abs(z.y) < 1 - 1e-12;
  const Direction x = glm::normalize(glm::cross(upright ? Direction(0, 1, 0) : Direction(0, 0, z.y > 0 ? -1 : 1), z));
  return {x, glm::cross(z, x), z};
}

Direction unit(const Direction& v, const Direction& otherwise) {
  const double length = glm::length(v);
  return length > 0 && std::isfinite(length) ? v / length : otherwise;
}

double angle_between(const Direction& first, const Direction& second) {
  const Direction a = checked_direction("a", first), b = checked_direction("b", second);
  return 2 * portable::atan2(glm::length(a - b), glm::length(a + b));
}

}  // namespace envmap
#endif  // HWY_ONCE

// rotate(), compiled once for every instruction set and chosen at run time.
#include "envmap/maths/vector.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "envmap/maths/rotate.cpp"
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

}  // namespace envmap
#endif  // HWY_ONCE

// sample_bilinear, compiled once for every instruction set and chosen at run time.
#include "envmap/sample/point.h"

#include <hwy/cache_control.h>

#include <algorithm>
#include <array>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "envmap/sample/point.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace envmap {
namespace HWY_NAMESPACE {

#if HWY_TARGET == HWY_SCALAR
void SampleBilinear(const PaddedLevel& level, std::span<const Location<double>> at, std::span<Colour> out) {
  for (std::size_t k = 0; k < at.size(); ++k) out[k] = bilinear(level, at[k]);
}
#else
namespace hn = hwy::HWY_NAMESPACE;

constexpr std::size_t block = 64;

// What the taps of many locations are found from, worked out together.
struct Places {
  HWY_ALIGN double face[block], u[block], v[block];
  HWY_ALIGN double offset[block];  // Of the upper left tap from texel (0,0) of the first face; whole.
  HWY_ALIGN float fx[block], fy[block];
};

// x rounded down, for |x| < 2^51; the same on every target. hn::Floor is slow before SSE4.
template <class D, class V>
HWY_INLINE V whole_below(D d, V x) {
  const V shift = hn::Set(d, 0x1.8p52), nearest = hn::Sub(hn::Add(x, shift), shift);
  return hn::Sub(nearest, hn::IfThenElseZero(hn::Gt(nearest, x), hn::Set(d, 1)));
}

void place(const PaddedLevel& level, std::size_t count, Places& places) {
  const hn::ScalableTag<double> d;
  const hn::Rebind<float, decltype(d)> df;
  const auto width = hn::Set(d, level.width()), height = hn::Set(d, level.height()), half = hn::Set(d, 0.5);
  const auto rows = hn::Set(d, level.height() + 2 * Level::padding);
  const auto stride = hn::Set(d, double(level.stride()));
  for (std::size_t k = 0; k < count; k += hn::Lanes(d)) {
    const auto x = hn::Sub(hn::Mul(hn::Load(d, places.u + k), width), half);
    const auto y = hn::Sub(hn::Mul(hn::Load(d, places.v + k), height), half);
    const auto left = whole_below(d, x), top = whole_below(d, y);
    const auto row = hn::Add(hn::Mul(hn::Load(d, places.face + k), rows), top);
    hn::Store(hn::Add(hn::Mul(row, stride), left), d, places.offset + k);
    hn::Store(hn::DemoteTo(df, hn::Sub(x, left)), df, places.fx + k);
    hn::Store(hn::DemoteTo(df, hn::Sub(y, top)), df, places.fy + k);
  }
}

// The formula of bilinear(), red, green and blue at once. Loads and stores four floats where a colour has three: a
// level ends with a spare texel, and the next colour overwrites what is stored too much.
void blend(const Colour* origin, std::ptrdiff_t stride, const Places& places, std::size_t count, Colour* out) {
  const hn::FixedTag<float, 4> d;
  const auto one = hn::Set(d, 1);
  // Of a map beyond the caches all taps of a block are waited for at once: 1.35 times as fast at 16384x8192.
  for (std::size_t k = 0; k < count; ++k) {
    const Colour* a = origin + std::ptrdiff_t(places.offset[k]);
    hwy::Prefetch(a);
    hwy::Prefetch(a + stride);
  }
  const auto colour = [&](std::size_t k) HWY_ATTR {
    const Colour* a = origin + std::ptrdiff_t(places.offset[k]);
    const Colour* b = a + stride;
    const auto fx = hn::Set(d, places.fx[k]), gx = hn::Sub(one, fx);
    const auto fy = hn::Set(d, places.fy[k]), gy = hn::Sub(one, fy);
    const auto upper = hn::Add(hn::Mul(gx, hn::LoadU(d, &a[0].x)), hn::Mul(fx, hn::LoadU(d, &a[1].x)));
    const auto lower = hn::Add(hn::Mul(gx, hn::LoadU(d, &b[0].x)), hn::Mul(fx, hn::LoadU(d, &b[1].x)));
    return hn::Add(hn::Mul(gy, upper), hn::Mul(fy, lower));
  };
  for (std::size_t k = 0; k + 1 < count; ++k) hn::StoreU(colour(k), d, &out[k].x);
  HWY_ALIGN float last[4];
  hn::Store(colour(count - 1), d, last);
  out[count - 1] = {last[0], last[1], last[2]};
}

void SampleBilinear(const PaddedLevel& level, std::span<const Location<double>> at, std::span<Colour> out) {
  Places places;
  for (std::size_t start = 0; start < at.size(); start += block) {
    const std::size_t count = std::min(block, at.size() - start);
    for (std::size_t k = 0; k < count; ++k) {
      const Location<double>& l = at[start + k];
      places.face[k] = l.face, places.u[k] = l.u, places.v[k] = l.v;
    }
    // Lanes beyond the last one are worked out, too.
    const std::size_t end = std::min(block, count + hn::Lanes(hn::ScalableTag<double>()));
    for (std::size_t k = count; k < end; ++k) places.face[k] = places.u[k] = places.v[k] = 0;
    place(level, count, places);
    blend(level.texel(0, 0, 0), level.stride(), places, count, &out[start]);
  }
}
#endif

}  // namespace HWY_NAMESPACE
}  // namespace envmap
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace envmap {

HWY_EXPORT(SampleBilinear);

void sample_bilinear(const PaddedLevel& level, std::span<const Location<double>> at, std::span<Colour> out) {
  HWY_DYNAMIC_DISPATCH(SampleBilinear)(level, at, out);
}

Colour nearest(const PaddedLevel& level, const Location<double>& at) {
  const int i = std::clamp(int(at.u * level.width()), 0, level.width() - 1);
  const int j = std::clamp(int(at.v * level.height()), 0, level.height() - 1);
  return *level.texel(at.face, i, j);
}

namespace {

// Of 4 x 4 texels, at a place (x, y) beyond the second of the second row.
template <class T>
Rgb<T> catmull_rom_sum(const Colour* rows, std::ptrdiff_t stride, double x, double y) {
  const std::array<T, 4> wx = catmull_rom<T>(x), wy = catmull_rom<T>(y);
  Rgb<T> sum(0);
  for (std::size_t j = 0; j < 4; ++j) {
    const Colour* c = rows + std::ptrdiff_t(j) * stride;
    sum += wy[j] * (wx[0] * Rgb<T>(c[0]) + wx[1] * Rgb<T>(c[1]) + wx[2] * Rgb<T>(c[2]) + wx[3] * Rgb<T>(c[3]));
  }
  return sum;
}

}  // namespace

Colour bicubic(const PaddedLevel& level, const Location<double>& at) {
  const double x = at.u * level.width() - 0.5, y = at.v * level.height() - 0.5;
  const double left = std::floor(x), top = std::floor(y);
  const Colour* rows = level.texel(at.face, int(left) - 1, int(top) - 1);
  Colour sum = catmull_rom_sum<float>(rows, level.stride(), x - left, y - top);
  if (!std::isfinite(sum.x + sum.y + sum.z))  // A part of the sum is beyond the largest float.
    sum = Colour(catmull_rom_sum<double>(rows, level.stride(), x - left, y - top));
  const Colour* a = rows + level.stride() + 1;
  const Colour* b = a + level.stride();
  return glm::clamp(sum, glm::min(glm::min(a[0], a[1]), glm::min(b[0], b[1])),
                    glm::max(glm::max(a[0], a[1]), glm::max(b[0], b[1])));
}

void sample_nearest(const PaddedLevel& level, std::span<const Location<double>> at, std::span<Colour> out) {
  for (std::size_t k = 0; k < at.size(); ++k) out[k] = nearest(level, at[k]);
}

void sample_bicubic(const PaddedLevel& level, std::span<const Location<double>> at, std::span<Colour> out) {
  for (std::size_t k = 0; k < at.size(); ++k) out[k] = bicubic(level, at[k]);
}

}  // namespace envmap
#endif  // HWY_ONCE

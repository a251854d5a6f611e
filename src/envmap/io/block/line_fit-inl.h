/// @file
/// Lines through the texels of blocks, for vectors of float of any Highway target: what the encoders of BC6H and UASTC
/// HDR have in common. Included once a target, by files that foreach_target.h compiles.
///
/// A region's texels are put on the line through their mean along which they spread most (the covariance matrix's first
/// eigenvector, found by power iteration), then endpoints and indices are improved by turns: indices by projection,
/// endpoints by least squares, as van Waveren and Castano do for other block formats ("Real-Time YCoCg-DXT
/// Compression", 2007; Castano, "High Quality DXT Compression using CUDA", 2007). All partitions are ranked by what
/// their lines leave over; the best few are tried.
#if defined(ENVMAP_IO_BLOCK_LINE_FIT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ENVMAP_IO_BLOCK_LINE_FIT_INL_H_
#undef ENVMAP_IO_BLOCK_LINE_FIT_INL_H_
#else
#define ENVMAP_IO_BLOCK_LINE_FIT_INL_H_
#endif

#include <hwy/highway.h>

#include <span>

#include "envmap/io/block/texel_block.h"
#include "envmap/io/block/weighted_halves.h"

HWY_BEFORE_NAMESPACE();
namespace envmap::block {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::CappedTag<float, batch>;
using V = hn::Vec<D>;
using Mask = hn::Mask<D>;

HWY_INLINE V number(double x) { return hn::Set(D(), float(x)); }
HWY_INLINE V ratio(V a, V b) { return hn::Div(a, hn::Max(b, number(1e-20))); }
HWY_INLINE V whole(V x) { return hn::Floor(hn::Add(x, number(0.5))); }
HWY_INLINE V dot(const V* a, const V* b) {
  return hn::Add(hn::Add(hn::Mul(a[0], b[0]), hn::Mul(a[1], b[1])), hn::Mul(a[2], b[2]));
}
HWY_INLINE void choose(Mask m, V a, V& b) { b = hn::IfThenElse(m, a, b); }

struct Texels {
  V half[3][block_texels];
  V at[block_texels][3];  // Where they lie in the 16 bits of endpoints, from `middle` on.
  V middle[3];
  V weight[block_texels];
};

// @param place where the texels that become a half lie in the 16 bits of a format's endpoints: the middle of them.
template <class Place>
Texels load(const WeightedHalves& wanted, std::size_t lane, Place place) {
  const D d;
  Texels t;
  V all = hn::Zero(d);
  for (int k = 0; k < block_texels; ++k) all = hn::Add(all, t.weight[k] = hn::Load(d, &wanted.weights[k][lane]));
  for (int c = 0; c < 3; ++c) {
    V sum = hn::Zero(d);
    for (int k = 0; k < block_texels; ++k) {
      t.half[c][k] = hn::Load(d, &wanted.halves[c][k][lane]);
      t.at[k][c] = place(t.half[c][k]);
      sum = hn::Add(sum, hn::Mul(t.weight[k], t.at[k][c]));
    }
    t.middle[c] = whole(ratio(sum, all));
    for (int k = 0; k < block_texels; ++k) t.at[k][c] = hn::Sub(t.at[k][c], t.middle[c]);
  }
  return t;
}

// ---- lines ----------------------------------------------------------------------------------------------------------

// Sums over texels: of weights, of weighted places, and of their products xx, xy, xz, yy, yz, zz.
struct Moments {
  V sum[10];
};

HWY_INLINE Moments moments_of(const Texels& t, int k) {
  const V* x = t.at[k];
  Moments m;
  m.sum[0] = t.weight[k];
  for (int c = 0; c < 3; ++c) m.sum[1 + c] = hn::Mul(t.weight[k], x[c]);
  for (int i = 0, n = 4; i < 3; ++i)
    for (int j = i; j < 3; ++j, ++n) m.sum[n] = hn::Mul(m.sum[1 + i], x[j]);
  return m;
}

struct Axis {
  V mean[3], direction[3], rest;  // The rest is what lies off the line: a sum of squares.
};

// Which way lines run: as the texels spread most, or through equal steps of all channels.
enum class Slope { free, grey };

template <Slope slope = Slope::free>
HWY_INLINE Axis axis_of(const Moments& m) {
  Axis axis;
  V c[3][3];
  for (int i = 0; i < 3; ++i) axis.mean[i] = ratio(m.sum[1 + i], m.sum[0]);
  for (int i = 0, n = 4; i < 3; ++i)
    for (int j = i; j < 3; ++j, ++n) c[i][j] = c[j][i] = hn::Sub(m.sum[n], hn::Mul(axis.mean[i], m.sum[1 + j]));
  V* v = axis.direction;
  const Mask green = hn::Gt(c[1][1], c[0][0]), blue = hn::Gt(c[2][2], hn::Max(c[0][0], c[1][1]));
  for (int i = 0; i < 3; ++i) v[i] = hn::IfThenElse(blue, c[2][i], hn::IfThenElse(green, c[1][i], c[0][i]));
  V along[3];
  if constexpr (slope == Slope::grey) {
    for (int i = 0; i < 3; ++i) along[i] = number(1);
    for (int i = 0; i < 3; ++i) v[i] = dot(c[i], along);
  }
  for (int turn = 0; slope == Slope::free && turn < 3; ++turn) {
    const V largest = hn::Max(hn::Max(hn::Abs(v[0]), hn::Abs(v[1])), hn::Abs(v[2]));
    const V scale = ratio(number(1), largest);
    for (int i = 0; i < 3; ++i) along[i] = hn::Mul(v[i], scale);
    for (int i = 0; i < 3; ++i) v[i] = dot(c[i], along);
  }
  const V spread = ratio(dot(along, v), dot(along, along));
  for (int i = 0; i < 3; ++i) v[i] = along[i];
  axis.rest = hn::Max(hn::Zero(D()), hn::Sub(hn::Add(hn::Add(c[0][0], c[1][1]), c[2][2]), spread));
  return axis;
}

struct Line {
  V ends[2][3];
};

// Which texels are whose, lane by lane.
struct Regions {
  V partition;
  Mask second[block_texels], anchor[block_texels];  // The anchors of both.
};

inline Regions whole_block() {
  const D d;
  Regions r{.partition = hn::Zero(d)};
  const Mask none = hn::Ne(hn::Zero(d), hn::Zero(d)), all = hn::Eq(hn::Zero(d), hn::Zero(d));
  for (int k = 0; k < block_texels; ++k) r.second[k] = none, r.anchor[k] = k == 0 ? all : none;
  return r;
}

inline Regions regions_of(V partition) {
  const D d;
  const hn::RebindToSigned<D> di;
  HWY_ALIGN std::array<std::int32_t, batch> numbers, seconds, anchors;
  hn::Store(hn::ConvertTo(di, partition), di, numbers.data());
  for (std::size_t k = 0; k < hn::Lanes(d); ++k) {
    const Partition& p = partitions[std::size_t(numbers[k])];
    seconds[k] = p.second, anchors[k] = 1 << p.anchor | 1;
  }
  const auto second = hn::Load(di, seconds.data()), anchor = hn::Load(di, anchors.data());
  Regions r{.partition = partition};
  for (int k = 0; k < block_texels; ++k) {
    const auto bit = hn::Set(di, 1 << k);
    r.second[k] = hn::RebindMask(d, hn::TestBit(second, bit));
    r.anchor[k] = hn::RebindMask(d, hn::TestBit(anchor, bit));
  }
  return r;
}

// The line through a region's texels from the first to the last of them, so that the anchor lies in its first half.
template <Slope slope = Slope::free>
Line line_of(const Texels& t, const Regions& regions, bool second) {
  const D d;
  Moments sums;
  for (V& s : sums.sum) s = hn::Zero(d);
  for (int k = 0; k < block_texels; ++k) {
    const Moments m = moments_of(t, k);
    const Mask here = second ? regions.second[k] : hn::Not(regions.second[k]);
    for (int n = 0; n < 10; ++n) sums.sum[n] = hn::Add(sums.sum[n], hn::IfThenElseZero(here, m.sum[n]));
  }
  const Axis axis = axis_of<slope>(sums);
  const V scale = ratio(number(1), dot(axis.direction, axis.direction));
  V low = number(1e9), high = number(-1e9), anchor = hn::Zero(d);
  for (int k = 0; k < block_texels; ++k) {
    V from[3];
    for (int c = 0; c < 3; ++c) from[c] = hn::Sub(t.at[k][c], axis.mean[c]);
    const V along = hn::Mul(dot(from, axis.direction), scale);
    const Mask here = second ? regions.second[k] : hn::Not(regions.second[k]);
    const Mask counts = hn::And(here, hn::Gt(t.weight[k], hn::Zero(d)));
    choose(counts, hn::Min(low, along), low);
    choose(counts, hn::Max(high, along), high);
    choose(hn::And(here, regions.anchor[k]), along, anchor);
  }
  choose(hn::Gt(low, high), hn::Zero(d), high);  // No texel that counts.
  low = hn::Min(low, high);
  const Mask turned = hn::Gt(hn::Add(anchor, anchor), hn::Add(low, high));
  const V start = hn::IfThenElse(turned, high, low), end = hn::IfThenElse(turned, low, high);
  Line line;
  for (int c = 0; c < 3; ++c) {
    line.ends[0][c] = hn::Add(axis.mean[c], hn::Mul(axis.direction[c], start));
    line.ends[1][c] = hn::Add(axis.mean[c], hn::Mul(axis.direction[c], end));
  }
  return line;
}

// ---- better lines ---------------------------------------------------------------------------------------------------

// Sums of a region for least squares: with s the second endpoint's part of a texel x, of (1-s)^2, s(1-s), s^2, (1-s)x,
// sx.
struct Squares {
  V aa, ab, bb, ax[3], bx[3];
};

HWY_INLINE void add(Squares& sums, V weight, V s, const V* x) {
  const V r = hn::Sub(number(1), s), wr = hn::Mul(weight, r), ws = hn::Mul(weight, s);
  sums.aa = hn::Add(sums.aa, hn::Mul(wr, r));
  sums.ab = hn::Add(sums.ab, hn::Mul(wr, s));
  sums.bb = hn::Add(sums.bb, hn::Mul(ws, s));
  for (int c = 0; c < 3; ++c) {
    sums.ax[c] = hn::Add(sums.ax[c], hn::Mul(wr, x[c]));
    sums.bx[c] = hn::Add(sums.bx[c], hn::Mul(ws, x[c]));
  }
}

HWY_INLINE Squares no_squares() {
  const V zero = hn::Zero(D());
  return {zero, zero, zero, {zero, zero, zero}, {zero, zero, zero}};
}

// Adds texel k to the sums of its region. @param s the second endpoint's part of it.
template <int regions>
HWY_INLINE void add(Squares (&sums)[regions], const Texels& t, const Regions& where, int k, V s) {
  if constexpr (regions == 2) {
    add(sums[0], hn::IfThenZeroElse(where.second[k], t.weight[k]), s, t.at[k]);
    add(sums[1], hn::IfThenElseZero(where.second[k], t.weight[k]), s, t.at[k]);
  } else {
    add(sums[0], t.weight[k], s, t.at[k]);
  }
}

// The same of ends as far from each other in all channels: with r = 1 - s, x = second - scale r in each.
HWY_INLINE void improve_grey(Line& line, const Squares& s) {
  const V weight = hn::Add(hn::Add(s.aa, s.bb), hn::Add(s.ab, s.ab)), r = hn::Add(s.aa, s.ab), mean = ratio(r, weight);
  const V variance = hn::Sub(s.aa, hn::Mul(mean, r));
  const Mask sound = hn::Gt(variance, hn::Mul(number(1e-4), weight));
  V covariance = hn::Zero(D());
  for (int c = 0; c < 3; ++c)
    covariance = hn::Add(covariance, hn::Sub(s.ax[c], hn::Mul(mean, hn::Add(s.ax[c], s.bx[c]))));
  const V scale = hn::Neg(ratio(covariance, hn::Mul(number(3), variance)));
  for (int c = 0; c < 3; ++c) {
    const V second = hn::Add(ratio(hn::Add(s.ax[c], s.bx[c]), weight), hn::Mul(scale, mean));
    choose(sound, second, line.ends[1][c]);
    choose(sound, hn::Sub(second, scale), line.ends[0][c]);
  }
}

// The ends that leave least over; as they were where all texels have one index.
template <Slope slope = Slope::free>
HWY_INLINE void improve(Line& line, const Squares& s) {
  if constexpr (slope == Slope::grey) return improve_grey(line, s);
  const V determinant = hn::Sub(hn::Mul(s.aa, s.bb), hn::Mul(s.ab, s.ab));
  const Mask sound = hn::Gt(determinant, hn::Mul(number(1e-4), hn::Mul(s.aa, s.bb)));
  const V scale = ratio(number(1), determinant);
  for (int c = 0; c < 3; ++c) {
    choose(sound, hn::Mul(scale, hn::Sub(hn::Mul(s.ax[c], s.bb), hn::Mul(s.bx[c], s.ab))), line.ends[0][c]);
    choose(sound, hn::Mul(scale, hn::Sub(hn::Mul(s.bx[c], s.aa), hn::Mul(s.ax[c], s.ab))), line.ends[1][c]);
  }
}

// ---- partitions -----------------------------------------------------------------------------------------------------

// The partitions whose lines leave least over, the best first. @param among bit k of partition k.
template <Slope slope = Slope::free, int tried>
void rank(const Texels& t, std::uint32_t among, V (&ranked)[tried]) {
  const D d;
  Moments of[block_texels], all;
  for (V& s : all.sum) s = hn::Zero(d);
  for (int k = 0; k < block_texels; ++k) {
    of[k] = moments_of(t, k);
    for (int n = 0; n < 10; ++n) all.sum[n] = hn::Add(all.sum[n], of[k].sum[n]);
  }
  V rest[tried];
  for (int r = 0; r < tried; ++r) rest[r] = number(1e30), ranked[r] = hn::Zero(d);
  for (std::size_t p = 0; p < partitions.size(); ++p) {
    if (!(among >> p & 1)) continue;
    Moments second, first;
    for (V& s : second.sum) s = hn::Zero(d);
    for (int k = 0; k < block_texels; ++k)
      if (partitions[p].second >> k & 1)
        for (int n = 0; n < 10; ++n) second.sum[n] = hn::Add(second.sum[n], of[k].sum[n]);
    for (int n = 0; n < 10; ++n) first.sum[n] = hn::Sub(all.sum[n], second.sum[n]);
    V left = hn::Add(axis_of<slope>(first).rest, axis_of<slope>(second).rest), number_of = number(double(p));
    for (int r = 0; r < tried; ++r) {  // Insertion: what is pushed out goes on to the next place.
      const Mask better = hn::Lt(left, rest[r]);
      const V out = hn::IfThenElse(better, rest[r], left), out_number = hn::IfThenElse(better, ranked[r], number_of);
      choose(better, left, rest[r]);
      choose(better, number_of, ranked[r]);
      left = out, number_of = out_number;
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace envmap::block
HWY_AFTER_NAMESPACE();

#endif  // ENVMAP_IO_BLOCK_LINE_FIT_INL_H_

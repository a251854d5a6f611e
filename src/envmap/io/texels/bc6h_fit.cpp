// Compiled once for every instruction set and chosen at run time; each block has a lane, so that none changes another.
//
// A region's texels are put on the line through their mean along which they spread most (the covariance matrix's first
// eigenvector, found by power iteration), then endpoints and indices are improved by turns: indices by projection,
// endpoints by least squares, as van Waveren and Castano do for other block formats ("Real-Time YCoCg-DXT Compression",
// 2007; Castano, "High Quality DXT Compression using CUDA", 2007). All partitions are ranked by what their lines leave
// over; the best few are tried.
#include "envmap/io/texels/bc6h_fit.h"

#include "envmap/base/without_avx512.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "envmap/io/texels/bc6h_fit.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace envmap::bc6h {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using D = hn::CappedTag<float, batch>;
using V = hn::Vec<D>;
using Mask = hn::Mask<D>;

// Partitions that are tried, and rounds of endpoints for each. Of three probes as cubes of 512, in sums of squares:
// blocks of one region alone leave 46% to 98% more; 1 partition 4%, 2 partitions 2% more than 4; 16 of them 2% less in
// twice the time; 2 rounds 1% more, 6 no less.
constexpr int tried = 4, rounds = 3;

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

Texels load(const Wanted& wanted, std::size_t lane) {
  const D d;
  Texels t;
  V all = hn::Zero(d);
  for (int k = 0; k < block_texels; ++k) all = hn::Add(all, t.weight[k] = hn::Load(d, &wanted.weights[k][lane]));
  for (int c = 0; c < 3; ++c) {
    V sum = hn::Zero(d);
    for (int k = 0; k < block_texels; ++k) {
      t.half[c][k] = hn::Load(d, &wanted.halves[c][k][lane]);
      // The middle of those that become this half, x 31 / 64 and rounded down.
      t.at[k][c] = hn::Sub(hn::Mul(hn::Add(t.half[c][k], number(0.5)), number(64.0 / 31)), number(0.5));
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
  for (int turn = 0; turn < 3; ++turn) {
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

Regions whole_block() {
  const D d;
  Regions r{.partition = hn::Zero(d)};
  const Mask none = hn::Ne(hn::Zero(d), hn::Zero(d)), all = hn::Eq(hn::Zero(d), hn::Zero(d));
  for (int k = 0; k < block_texels; ++k) r.second[k] = none, r.anchor[k] = k == 0 ? all : none;
  return r;
}

Regions regions_of(V partition) {
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
Line line_of(const Texels& t, const Regions& regions, bool second) {
  const D d;
  Moments sums;
  for (V& s : sums.sum) s = hn::Zero(d);
  for (int k = 0; k < block_texels; ++k) {
    const Moments m = moments_of(t, k);
    const Mask here = second ? regions.second[k] : hn::Not(regions.second[k]);
    for (int n = 0; n < 10; ++n) sums.sum[n] = hn::Add(sums.sum[n], hn::IfThenElseZero(here, m.sum[n]));
  }
  const Axis axis = axis_of(sums);
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

// ---- endpoints as the modes hold them -------------------------------------------------------------------------------

// How an endpoint's 16 bits are rounded: value = floor(x / step + rounding), x = value step + centre, but for both
// ends.
struct Steps {
  V mode, step, inverse, rounding, centre, largest;
};

Steps steps_of(int mode) {
  const int bits = modes[std::size_t(mode)].bits;
  const double step = 1 << (16 - bits);
  return {number(mode),
          number(step),
          number(1 / step),
          number(bits == 16 ? 0.5 : 0),
          number(bits == 16 ? 0 : step / 2),
          number((1 << bits) - 1)};
}

template <int n>
struct Endpoints {
  V value[n][3];
};

template <int n>
Endpoints<n> rounded(const Steps& s, const Texels& t, const Line* lines) {
  Endpoints<n> q;
  for (int e = 0; e < n; ++e)
    for (int c = 0; c < 3; ++c) {
      const V x = hn::Add(lines[e / 2].ends[e % 2][c], t.middle[c]);
      q.value[e][c] = hn::Min(hn::Max(hn::Floor(hn::Add(hn::Mul(x, s.inverse), s.rounding)), hn::Zero(D())), s.largest);
    }
  return q;
}

// Whether the mode holds the endpoints.
template <int n>
Mask holds(const Mode& mode, const Endpoints<n>& q) {
  Mask fits = hn::Eq(number(0), number(0));
  for (int c = 0; c < 3 && mode.differences; ++c) {
    const double half = 1 << (mode.others[std::size_t(c)] - 1);
    for (int e = 1; e < n; ++e) {
      const V difference = hn::Sub(q.value[e][c], q.value[0][c]);
      fits = hn::And(fits, hn::And(hn::Ge(difference, number(-half)), hn::Le(difference, number(half - 1))));
    }
  }
  return fits;
}

// From the coarsest, which holds any endpoints, to the finest: numbers in `modes`.
constexpr int of_one_region[] = {10, 11, 12, 13}, of_two_regions[] = {9, 1, 6, 7, 8, 5, 0, 2, 3, 4};

// The finest mode that holds the lines' ends.
template <int n>
Steps finest(const Texels& t, const Line* lines) {
  const std::span<const int> order =
      n == 2 ? std::span<const int>(of_one_region) : std::span<const int>(of_two_regions);
  Steps best = steps_of(order[0]);
  for (const int mode : order.subspan(1)) {
    const Steps s = steps_of(mode);
    const Mask fits = holds<n>(modes[std::size_t(mode)], rounded<n>(s, t, lines));
    choose(fits, s.mode, best.mode);
    choose(fits, s.step, best.step);
    choose(fits, s.inverse, best.inverse);
    choose(fits, s.rounding, best.rounding);
    choose(fits, s.centre, best.centre);
    choose(fits, s.largest, best.largest);
  }
  return best;
}

// ---- a block --------------------------------------------------------------------------------------------------------

template <int n>
struct Trial {
  V error, mode;
  Endpoints<n> endpoints;
  V indices[block_texels];
};

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

// The ends that leave least over; as they were where all texels have one index.
HWY_INLINE void improve(Line& line, const Squares& s) {
  const V determinant = hn::Sub(hn::Mul(s.aa, s.bb), hn::Mul(s.ab, s.ab));
  const Mask sound = hn::Gt(determinant, hn::Mul(number(1e-4), hn::Mul(s.aa, s.bb)));
  const V scale = ratio(number(1), determinant);
  for (int c = 0; c < 3; ++c) {
    choose(sound, hn::Mul(scale, hn::Sub(hn::Mul(s.ax[c], s.bb), hn::Mul(s.bx[c], s.ab))), line.ends[0][c]);
    choose(sound, hn::Mul(scale, hn::Sub(hn::Mul(s.bx[c], s.aa), hn::Mul(s.ax[c], s.ab))), line.ends[1][c]);
  }
}

// Rounds the lines' ends, finds the indices and what is read back, and makes the lines better by them.
template <int n>
Trial<n> round_of(const Texels& t, const Regions& regions, Line* lines) {
  const D d;
  constexpr double last = n == 2 ? 15 : 7;
  const Steps s = finest<n>(t, lines);
  Trial<n> trial{.error = hn::Zero(d), .mode = s.mode, .endpoints = rounded<n>(s, t, lines)};
  V start[n / 2][3], way[n / 2][3], inverse[n / 2];
  Squares sums[n / 2];
  for (int r = 0; r < n / 2; ++r) {
    for (int c = 0; c < 3; ++c) {
      V x[2];
      for (int e = 0; e < 2; ++e) {
        const V q = trial.endpoints.value[2 * r + e][c];
        x[e] = hn::Add(hn::Mul(q, s.step), s.centre);
        choose(hn::Eq(q, hn::Zero(d)), hn::Zero(d), x[e]);
        choose(hn::Eq(q, s.largest), number(65535), x[e]);
      }
      start[r][c] = x[0];
      way[r][c] = hn::Sub(x[1], x[0]);
    }
    inverse[r] = ratio(number(last), dot(way[r], way[r]));
    sums[r].aa = sums[r].ab = sums[r].bb = hn::Zero(d);
    for (int c = 0; c < 3; ++c) sums[r].ax[c] = sums[r].bx[c] = hn::Zero(d);
  }
  for (int k = 0; k < block_texels; ++k) {
    V from[3], along[3], first[3], scale = inverse[0];
    for (int c = 0; c < 3; ++c) {
      first[c] = start[0][c], along[c] = way[0][c];
      if constexpr (n == 4)
        choose(regions.second[k], start[1][c], first[c]), choose(regions.second[k], way[1][c], along[c]);
      from[c] = hn::Sub(t.at[k][c], hn::Sub(first[c], t.middle[c]));
    }
    if constexpr (n == 4) choose(regions.second[k], inverse[1], scale);
    const V most = hn::IfThenElse(regions.anchor[k], number((last - 1) / 2), number(last));
    const V index = hn::Min(hn::Max(whole(hn::Mul(dot(from, along), scale)), hn::Zero(d)), most);
    const V weight = whole(hn::Mul(index, number(64 / last)));
    for (int c = 0; c < 3; ++c) {
      const V sum = hn::Add(hn::Add(hn::Mul(first[c], number(64)), hn::Mul(along[c], weight)), number(32));
      const V read = hn::Floor(hn::Mul(hn::Floor(hn::Mul(sum, number(1.0 / 64))), number(31.0 / 64)));
      const V off = hn::Sub(read, t.half[c][k]);
      trial.error = hn::Add(trial.error, hn::Mul(t.weight[k], hn::Mul(off, off)));
    }
    trial.indices[k] = index;
    const V part = hn::Mul(weight, number(1.0 / 64));
    if constexpr (n == 4) {
      add(sums[0], hn::IfThenZeroElse(regions.second[k], t.weight[k]), part, t.at[k]);
      add(sums[1], hn::IfThenElseZero(regions.second[k], t.weight[k]), part, t.at[k]);
    } else {
      add(sums[0], t.weight[k], part, t.at[k]);
    }
  }
  for (int r = 0; r < n / 2; ++r) improve(lines[r], sums[r]);
  return trial;
}

struct Best {
  V error, mode, partition, endpoints[4][3], indices[block_texels];
};

// Tries a choice of regions; what comes nearer is kept.
template <int n>
void attempt(const Texels& t, const Regions& regions, Best& best) {
  Line lines[2];
  for (int r = 0; r < n / 2; ++r) lines[r] = line_of(t, regions, r == 1);
  for (int round = 0; round < rounds; ++round) {
    const Trial<n> trial = round_of<n>(t, regions, lines);
    const Mask nearer = hn::Lt(trial.error, best.error);
    choose(nearer, trial.error, best.error);
    choose(nearer, trial.mode, best.mode);
    choose(nearer, regions.partition, best.partition);
    for (int e = 0; e < n; ++e)
      for (int c = 0; c < 3; ++c) choose(nearer, trial.endpoints.value[e][c], best.endpoints[e][c]);
    for (int k = 0; k < block_texels; ++k) choose(nearer, trial.indices[k], best.indices[k]);
  }
}

// The partitions whose lines leave least over, the best first.
void rank(const Texels& t, V (&ranked)[tried]) {
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
    Moments second, first;
    for (V& s : second.sum) s = hn::Zero(d);
    for (int k = 0; k < block_texels; ++k)
      if (partitions[p].second >> k & 1)
        for (int n = 0; n < 10; ++n) second.sum[n] = hn::Add(second.sum[n], of[k].sum[n]);
    for (int n = 0; n < 10; ++n) first.sum[n] = hn::Sub(all.sum[n], second.sum[n]);
    V left = hn::Add(axis_of(first).rest, axis_of(second).rest), number_of = number(double(p));
    for (int r = 0; r < tried; ++r) {  // Insertion: what is pushed out goes on to the next place.
      const Mask better = hn::Lt(left, rest[r]);
      const V out = hn::IfThenElse(better, rest[r], left), out_number = hn::IfThenElse(better, ranked[r], number_of);
      choose(better, left, rest[r]);
      choose(better, number_of, ranked[r]);
      left = out, number_of = out_number;
    }
  }
}

void Fit(const Wanted& wanted, Found& found) {
  const D d;
  for (std::size_t lane = 0; lane < batch; lane += hn::Lanes(d)) {
    const Texels t = load(wanted, lane);
    Best best;
    best.error = number(1e30);
    for (auto& endpoint : best.endpoints)
      for (V& v : endpoint) v = hn::Zero(d);
    attempt<2>(t, whole_block(), best);
    if (!hn::AllTrue(d, hn::Eq(best.error, hn::Zero(d)))) {
      V ranked[tried];
      rank(t, ranked);
      for (const V partition : ranked) attempt<4>(t, regions_of(partition), best);
    }
    hn::Store(best.mode, d, &found.mode[lane]);
    hn::Store(best.partition, d, &found.partition[lane]);
    for (std::size_t e = 0; e < 4; ++e)
      for (std::size_t c = 0; c < 3; ++c) hn::Store(best.endpoints[e][c], d, &found.endpoints[e][c][lane]);
    for (std::size_t k = 0; k < block_texels; ++k) hn::Store(best.indices[k], d, &found.indices[k][lane]);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace envmap::bc6h
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace envmap::bc6h {

HWY_EXPORT(Fit);

void fit(const Wanted& wanted, Found& found) { HWY_DYNAMIC_DISPATCH(Fit)(wanted, found); }

}  // namespace envmap::bc6h
#endif  // HWY_ONCE

// Compiled once for every instruction set and chosen at run time; each block has a lane, so that none changes another.
#include "envmap/io/block/bc6h_fit.h"

#include "envmap/base/without_avx512.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "envmap/io/block/bc6h_fit.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "envmap/io/block/line_fit-inl.h"

HWY_BEFORE_NAMESPACE();
namespace envmap::bc6h {
namespace HWY_NAMESPACE {

using namespace block::HWY_NAMESPACE;

// Partitions that are tried, and rounds of endpoints for each. Of three probes as cubes of 512, in sums of squares:
// blocks of one region alone leave 46% to 98% more; 1 partition 4%, 2 partitions 2% more than 4; 16 of them 2% less in
// twice the time; 2 rounds 1% more, 6 no less.
constexpr int tried = 4, rounds = 3;

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
    sums[r] = no_squares();
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
    add(sums, t, regions, k, hn::Mul(weight, number(1.0 / 64)));
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

void Fit(const WeightedHalves& wanted, Found& found) {
  const D d;
  for (std::size_t lane = 0; lane < batch; lane += hn::Lanes(d)) {
    // The middle of those that become a half, x 31 / 64 and rounded down.
    const Texels t = load(wanted, lane, [](V half) {
      return hn::Sub(hn::Mul(hn::Add(half, number(0.5)), number(64.0 / 31)), number(0.5));
    });
    Best best;
    best.error = number(1e30);
    for (auto& endpoint : best.endpoints)
      for (V& v : endpoint) v = hn::Zero(d);
    attempt<2>(t, whole_block(), best);
    if (!hn::AllTrue(d, hn::Eq(best.error, hn::Zero(d)))) {
      V ranked[tried];
      rank(t, ~0U, ranked);
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

void fit(const WeightedHalves& wanted, Found& found) { HWY_DYNAMIC_DISPATCH(Fit)(wanted, found); }

}  // namespace envmap::bc6h
#endif  // HWY_ONCE

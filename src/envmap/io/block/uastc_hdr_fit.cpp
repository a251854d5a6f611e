// Compiled once for every instruction set and chosen at run time; each block has a lane, so that none changes another.
// How ends are stored is searched lane by lane; texels, lines and indices in all lanes at once.
#include "envmap/io/block/uastc_hdr_fit.h"

#include "envmap/base/without_avx512.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "envmap/io/block/uastc_hdr_fit.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "envmap/io/block/line_fit-inl.h"

HWY_BEFORE_NAMESPACE();
namespace envmap::uastc_hdr {
namespace HWY_NAMESPACE {

using namespace block::HWY_NAMESPACE;
using block::batch;

// Partitions that are tried of each kind.
constexpr int tried = 2;

// The modes that are tried, of `modes`: of one region, and with each of the best partitions.
constexpr int whole_coloured[] = {7, 6}, whole_scaled[] = {15};
constexpr int divided_scaled[] = {20, 17}, divided_coloured[] = {21, 22};

// Where a half lies among ASTC's logarithms of 16 bits: the inverse of half_of_log(), which is three straight lines an
// octave.
V log_of(V half) {
  const V octave = hn::Floor(hn::Mul(half, number(1.0 / 1024)));
  const V m = hn::Add(hn::Mul(hn::Sub(half, hn::Mul(octave, number(1024))), number(8)), number(4));
  const V low = hn::Mul(m, number(1.0 / 3)), middle = hn::Mul(hn::Add(m, number(512)), number(0.25));
  const V high = hn::Mul(hn::Add(m, number(2048)), number(0.2));
  return hn::Add(hn::Mul(octave, number(2048)), hn::Min(low, hn::Min(middle, high)));
}

// half_of_log().
HWY_INLINE V half_of(V log16) {
  const V octave = hn::Floor(hn::Mul(log16, number(1.0 / 2048)));
  const V m = hn::Sub(log16, hn::Mul(octave, number(2048)));
  const V middle = hn::Sub(hn::Mul(m, number(4)), number(512)), high = hn::Sub(hn::Mul(m, number(5)), number(2048));
  const V curve = hn::Max(hn::Mul(m, number(3)), hn::Max(middle, high));
  return hn::Add(hn::Mul(octave, number(1024)), hn::Floor(hn::Mul(curve, number(0.125))));
}

// What a mode's indices mean.
struct Weights {
  HWY_ALIGN std::array<float, 16> astc{}, bc6h{};
};

Weights weights_of(const Mode& mode) {
  Weights w;
  for (int k = 0; k < mode.weights; ++k) {
    const int index = bc6h_index(mode, k);
    w.astc[std::size_t(k)] = float(weight(mode, k));
    w.bc6h[std::size_t(k)] = float(has_short_indices(mode) ? bc6h::weights_of_8[std::size_t(index)]
                                                           : bc6h::weights_of_16[std::size_t(index)]);
  }
  return w;
}

// Ends as they are read back: the first, and the way to the second.
template <int regions>
struct Segments {
  V start[regions][3], way[regions][3];
};

template <int regions>
using Numbers = std::array<std::array<std::array<block::Lanes<float>, 3>, 2>, regions>;

template <int regions>
Segments<regions> segments(const Numbers<regions>& ends) {
  const D d;
  Segments<regions> s;
  for (int r = 0; r < regions; ++r)
    for (int c = 0; c < 3; ++c) {
      s.start[r][c] = hn::LoadU(d, ends[r][0][c].data());
      s.way[r][c] = hn::Sub(hn::LoadU(d, ends[r][1][c].data()), s.start[r][c]);
    }
  return s;
}

// How BC6H's modes round ends of 16 bits, the finest first; the last takes any. The others hold ends whose channels
// differ by less than half of what they have bits for.
struct Steps {
  double step;
  std::array<double, 3> reach;
};
template <std::size_t n>
std::array<Steps, n> roundings_of(const std::array<int, n>& order) {
  std::array<Steps, n> all;
  for (std::size_t k = 0; k < n; ++k) {
    const bc6h::Mode& m = bc6h::modes[std::size_t(order[k])];
    all[k].step = 1 << (16 - m.bits);
    for (std::size_t c = 0; c < 3; ++c) all[k].reach[c] = m.differences ? (1 << (m.others[c] - 1)) * all[k].step : 1e9;
  }
  return all;
}

// The ends of the BC6H that the transcoder makes of ASTC's, near enough for the search: the mode is one that holds them
// whichever end its anchor takes for the first.
template <int regions>
Segments<regions> transcoded(const Segments<regions>& logs, bool short_indices) {
  static const auto of_two = roundings_of(bc6h_modes_of_two);
  static const auto of_one = roundings_of(bc6h_modes_of_one);
  const D d;
  V ends[2 * regions][3], reach[3];
  for (int c = 0; c < 3; ++c) {
    V least = number(1e9), most = hn::Zero(d);
    for (int e = 0; e < 2 * regions; ++e) {
      const V start = logs.start[e / 2][c], log16 = e % 2 ? hn::Add(start, logs.way[e / 2][c]) : start;
      ends[e][c] = hn::Mul(hn::Add(half_of(log16), number(0.5)), number(64.0 / 31));
      least = hn::Min(least, ends[e][c]), most = hn::Max(most, ends[e][c]);
    }
    reach[c] = hn::Sub(most, least);
  }
  V step = number(short_indices ? of_two.back().step : of_one.back().step);
  const std::span<const Steps> order = short_indices ? std::span<const Steps>(of_two) : of_one;
  for (std::size_t k = order.size() - 1; k-- > 0;) {
    const Steps& r = order[k];
    const Mask fits = hn::And(hn::And(hn::Lt(reach[0], number(r.reach[0])), hn::Lt(reach[1], number(r.reach[1]))),
                              hn::Lt(reach[2], number(r.reach[2])));
    choose(fits, number(r.step), step);
  }
  const V inverse = hn::Div(number(1), step), half = hn::Mul(step, number(0.5));
  Segments<regions> made;
  for (int e = 0; e < 2 * regions; ++e)
    for (int c = 0; c < 3; ++c) {
      const V rounded = hn::Mul(hn::Floor(hn::Mul(ends[e][c], inverse)), step);
      const V centre = hn::IfThenElseZero(hn::Gt(rounded, hn::Zero(d)), hn::Add(rounded, half));
      if (e % 2)
        made.way[e / 2][c] = hn::Sub(centre, made.start[e / 2][c]);
      else
        made.start[e / 2][c] = centre;
    }
  return made;
}

template <int regions>
HWY_INLINE V of_region(const Regions& r, int k, const V (&v)[regions][3], int c) {
  if constexpr (regions == 1)
    return v[0][c];
  else
    return hn::IfThenElse(r.second[k], v[1][c], v[0][c]);
}

// What is stored of lines, lane by lane.
template <int regions>
struct Stored {
  std::array<std::array<StoredEnds, regions>, batch> ends;
  Numbers<regions> logs;
};

template <int regions>
void store(const Texels& t, const Line* lines, const Mode& mode, Stored<regions>& stored) {
  const D d;
  Numbers<regions> wanted;
  for (int r = 0; r < regions; ++r)
    for (int e = 0; e < 2; ++e)
      for (int c = 0; c < 3; ++c)
        hn::StoreU(hn::Mul(hn::Add(lines[r].ends[e][c], t.middle[c]), number(1.0 / 16)), d, wanted[r][e][c].data());
  const ByteLevels& levels = byte_levels(mode.bytes);
  for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) {
    std::array<std::array<Rgb, 2>, 2> both{};
    for (std::size_t r = 0; r < regions; ++r) {
      std::array<std::array<float, 3>, 2> ends;
      for (std::size_t e = 0; e < 2; ++e)
        for (std::size_t c = 0; c < 3; ++c) ends[e][c] = wanted[r][e][c][lane];
      stored.ends[lane][r] = store_ends(mode.ends, levels, ends);
      both[r] = stored.ends[lane][r].ends;
    }
    for (std::size_t r = 0; r < regions; ++r)
      for (std::size_t e = 0; e < 2; ++e)
        for (std::size_t c = 0; c < 3; ++c) {
          stored.logs[r][e][c][lane] = float(both[r][e][c] << 4);
        }
  }
}

// Keeps what came nearer.
template <int regions>
void keep(int mode, const Regions& where, V error, const V (&indices)[block_texels], const Stored<regions>& stored,
          std::size_t first, Found& found) {
  const D d;
  std::array<block::Lanes<float>, block_texels> index;
  block::Lanes<float> errors, partition;
  for (std::size_t k = 0; k < block_texels; ++k) hn::StoreU(indices[k], d, index[k].data());
  hn::StoreU(error, d, errors.data());
  hn::StoreU(where.partition, d, partition.data());
  for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) {
    if (!(errors[lane] < found.error[first + lane])) continue;
    found.error[first + lane] = errors[lane];
    Block& block = found.blocks[first + lane];
    block = {.mode = mode, .partition = int(partition[lane])};
    for (std::size_t r = 0; r < regions; ++r) block.endpoints[r] = stored.ends[lane][r].bytes;
    for (std::size_t k = 0; k < block_texels; ++k) block.indices[k] = std::uint8_t(index[k][lane]);
  }
}

// Stores the lines' ends, finds the indices and what is read back in both ways, and makes the lines better by them.
template <Slope slope, int regions>
void round_of(const Texels& t, const Regions& where, Line* lines, int number_of_mode, std::size_t first, Found& found) {
  const D d;
  const hn::RebindToSigned<D> di;
  const Mode& mode = modes[std::size_t(number_of_mode)];
  const Weights table = weights_of(mode);
  Stored<regions> stored{};
  store<regions>(t, lines, mode, stored);
  const Segments<regions> logs = segments<regions>(stored.logs),
                          bc6h = transcoded<regions>(logs, has_short_indices(mode));
  const V last = number(mode.weights - 1);
  V inverse[regions][3];
  Squares sums[regions];
  for (int r = 0; r < regions; ++r) {
    inverse[r][0] = hn::Div(last, hn::Max(dot(logs.way[r], logs.way[r]), number(1e-20)));
    sums[r] = no_squares();
  }
  V error = hn::Zero(d), indices[block_texels];
  for (int k = 0; k < block_texels; ++k) {
    V from[3], way[3];
    for (int c = 0; c < 3; ++c) {
      way[c] = of_region<regions>(where, k, logs.way, c);
      from[c] = hn::Sub(t.at[k][c], hn::Sub(of_region<regions>(where, k, logs.start, c), t.middle[c]));
    }
    const V scale = of_region<regions>(where, k, inverse, 0);
    const V index = hn::Min(hn::Max(whole(hn::Mul(dot(from, way), scale)), hn::Zero(d)), last);
    const auto at = hn::ConvertTo(di, index);
    const V astc_weight = hn::GatherIndex(d, table.astc.data(), at);
    const V bc6h_weight = hn::GatherIndex(d, table.bc6h.data(), at);
    const auto between = [&](const Segments<regions>& s, int c, V w) {
      const V sum = hn::Add(hn::Mul(of_region<regions>(where, k, s.start, c), number(64)),
                            hn::Mul(of_region<regions>(where, k, s.way, c), w));
      return hn::Floor(hn::Mul(hn::Add(sum, number(32)), number(1.0 / 64)));
    };
    for (int c = 0; c < 3; ++c) {
      const V astc = hn::Sub(half_of(between(logs, c, astc_weight)), t.half[c][k]);
      const V other = hn::Sub(hn::Floor(hn::Mul(between(bc6h, c, bc6h_weight), number(31.0 / 64))), t.half[c][k]);
      error = hn::Add(error, hn::Mul(t.weight[k], hn::Add(hn::Mul(astc, astc), hn::Mul(other, other))));
    }
    indices[k] = index;
    add(sums, t, where, k, hn::Mul(astc_weight, number(1.0 / 64)));
  }
  keep<regions>(number_of_mode, where, error, indices, stored, first, found);
  for (int r = 0; r < regions; ++r) improve<slope>(lines[r], sums[r]);
}

// Tries modes with a choice of regions: the first from the fitted lines, and others from what it made of them.
template <Slope slope, int regions>
void attempt(const Texels& t, const Regions& where, std::span<const int> some, std::size_t first, Found& found) {
  Line lines[regions];
  for (int r = 0; r < regions; ++r) lines[r] = line_of<slope>(t, where, r == 1);
  round_of<slope, regions>(t, where, lines, some[0], first, found);
  for (const int mode : some) round_of<slope, regions>(t, where, lines, mode, first, found);
}

template <Slope slope>
void attempt_divided(const Texels& t, std::span<const int> some, std::size_t first, Found& found) {
  V ranked[tried];
  rank<slope>(t, common_partitions, ranked);
  for (const V partition : ranked) attempt<slope, 2>(t, regions_of(partition), some, first, found);
}

void Fit(const block::WeightedHalves& wanted, Found& found) {
  const D d;
  found.error.fill(1e30F);
  for (std::size_t lane = 0; lane < batch; lane += hn::Lanes(d)) {
    const Texels t = load(wanted, lane, log_of);
    attempt<Slope::free, 1>(t, whole_block(), whole_coloured, lane, found);
    attempt<Slope::grey, 1>(t, whole_block(), whole_scaled, lane, found);
    attempt_divided<Slope::grey>(t, divided_scaled, lane, found);
    attempt_divided<Slope::free>(t, divided_coloured, lane, found);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace envmap::uastc_hdr
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace envmap::uastc_hdr {

HWY_EXPORT(Fit);

void fit(const block::WeightedHalves& wanted, Found& found) { HWY_DYNAMIC_DISPATCH(Fit)(wanted, found); }

}  // namespace envmap::uastc_hdr
#endif  // HWY_ONCE

#include "envmap/prefilter/verify.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

#include "envmap/operate/measure.h"
#include "envmap/prefilter/exact.h"
#include "envmap/prefilter/hierarchical.h"

namespace envmap {
namespace {

// Texels worth looking at in a result: spread evenly, the darkest, the brightest, the steepest for their own radiance, and
// those of which the method itself is least sure, if it says so.
std::vector<Texel> hardest(const Level& level, std::span<const float> doubt) {
  constexpr std::size_t even = 112, each = 48;
  const std::vector<Texel> all = texels_of(level);
  if (all.size() <= even + 3 * each) return all;
  std::vector<Texel> found;
  for (std::size_t k = 0; k < even; ++k) found.push_back(all[(2 * k + 1) * all.size() / (2 * even)]);
  const auto least = [&](const Texel& t) {
    const Colour& c = *level.texel(t.face, t.i, t.j);
    return std::min({c.x, c.y, c.z});
  };
  const auto most = [&](const Texel& t) {
    const Colour& c = *level.texel(t.face, t.i, t.j);
    return std::max({c.x, c.y, c.z});
  };
  const auto slope = [&](const Texel& t) {
    const Colour& c = *level.texel(t.face, t.i, t.j);
    const Colour& beside = *level.texel(t.face, t.i > 0 ? t.i - 1 : t.i, t.j > 0 ? t.j - 1 : t.j);
    const Colour off = glm::abs(c - beside) / glm::max(c, Colour(1e-30F));
    return std::max({off.x, off.y, off.z});
  };
  const auto unsure = [&](const Texel& t) { return doubt[index_of(level, t)]; };
  std::array<std::vector<Texel>, 4> hard;
  const auto take = [&](std::vector<Texel>& into, auto key) {
    std::vector<std::pair<float, std::uint32_t>> order(all.size());
    for (std::uint32_t k = 0; k < all.size(); ++k) order[k] = {key(all[k]), k};
    std::ranges::nth_element(order, order.begin() + each);
    for (std::size_t k = 0; k < each; ++k) into.push_back(all[order[k].second]);
  };
  tbb::parallel_invoke([&] { take(hard[0], least); }, [&] { take(hard[1], [&](const Texel& t) { return -most(t); }); },
                       [&] { take(hard[2], [&](const Texel& t) { return -slope(t); }); },
                       [&] {
                         if (!doubt.empty()) take(hard[3], [&](const Texel& t) { return -unsure(t); });
                       });
  for (const std::vector<Texel>& texels : hard) found.insert(found.end(), texels.begin(), texels.end());
  return found;
}

// Texels side by side, which share the parts of their references: of squares that are small beside what tiles may be.
std::vector<std::vector<Texel>> neighbours(std::vector<Texel> texels, const Level& level, const Lobe& lobe) {
  const double count = static_cast<double>(level.faces()) * level.width() * level.height();
  const double across = 0.5 * tile_radius(lobe) / std::sqrt(4 * pi / count);
  const int side = static_cast<int>(std::bit_floor(static_cast<unsigned>(std::clamp(across, 1.0, 4.0))));
  const auto square = [side](const Texel& t) { return std::tuple(t.face, t.j / side, t.i / side); };
  std::ranges::stable_sort(texels, {}, square);
  std::vector<std::vector<Texel>> groups;
  for (const Texel& t : texels) {
    if (groups.empty() || square(groups.back().front()) != square(t)) groups.emplace_back();
    groups.back().push_back(t);
  }
  return groups;
}

// The integral in some directions; what is left out of it, as independent errors, below `bound` of it. @return whether it
// is; else the exact sum is quicker.
bool reference(const LightTree& tree, const Lobe& lobe, std::span<const Direction> d, double bound, std::span<Flux> out) {
  double light = 0.06 * bound;
  for (int round = 0; round < 20; ++round) {
    const std::optional<double> left = gather_directions(tree, lobe, {light}, d, out);
    if (!left) return false;
    if (*left <= bound) break;
    light *= std::clamp(0.8 * bound / *left, 0.01, 0.5);
  }
  return true;
}

// The largest difference from the truth, relative to that or the floor.
double largest(const Level& result, std::span<const Texel> texels, std::span<const Flux> truth, const Flux& floor) {
  double error = 0;
  for (std::size_t n = 0; n < texels.size(); ++n) {
    const Colour& c = *result.texel(texels[n].face, texels[n].i, texels[n].j);
    const Flux off = glm::abs(Flux(c) - truth[n]) / glm::max(truth[n], floor);
    error = std::max({error, off.x, off.y, off.z});
  }
  return error;
}

}  // namespace

Verified verify(const LightTree& tree, const Lobe& lobe, const Target& target, const Level& result,
                std::span<const float> doubt, double max_error) {
  const std::vector<Texel> texels = hardest(result, doubt);
  const std::vector<std::vector<Texel>> groups = neighbours(texels, result, lobe);
  const Flux floor(std::max(1e-3 * tree.mean(), std::numeric_limits<double>::min()));
  // Of a lobe that breaks off the remainders are less independent than they are taken to be; of others what references were
  // off by was at most 0.15 of these bounds (three probes, exponents 1 to 128).
  const double edge = at_horizon(lobe), trust = edge > steep ? 1 : 3;
  const double first = edge > broken ? 0.1 : edge > bent ? 0.25 : 0.5;
  const std::array bounds{first, std::min(first, 0.25)};
  std::vector<double> errors(groups.size(), 0);
  std::vector<char> exact(groups.size(), 0);
  tbb::parallel_for(std::size_t{0}, groups.size(), [&](std::size_t k) {
    const std::vector<Direction> d = directions_of(target, groups[k]);
    std::vector<Flux> truth(d.size());
    // Enough where what is off and what the reference leaves out come to no more than what was asked for.
    for (const double bound : bounds) {
      exact[k] = reference(tree, lobe, d, trust * bound * max_error, truth) ? 0 : 1;
      if (exact[k]) return;
      errors[k] = largest(result, groups[k], truth, floor);
      if (errors[k] <= (1 - bound) * max_error) break;
    }
  });
  std::vector<Texel> rest;
  for (std::size_t k = 0; k < groups.size(); ++k)
    if (exact[k]) rest.insert(rest.end(), groups[k].begin(), groups[k].end());
  errors.push_back(largest(result, rest, exact_prefilter(tree.source(), lobe, directions_of(target, rest)), floor));
  return {std::ranges::max(errors), static_cast<std::int64_t>(texels.size())};
}

}  // namespace envmap

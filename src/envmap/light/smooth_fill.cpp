#include "envmap/light/smooth_fill.h"

#include <algorithm>
#include <unordered_set>

#include "envmap/base/parallel.h"
#include "envmap/operate/brightest.h"

namespace envmap {
namespace {

struct RimTexel {
  Direction towards;
  Flux colour;
};

// The texels that touch a region; of very many every second, third ...
std::vector<RimTexel> rim_of(const TexelGeometry& geometry, std::span<const Texel> region,
                             const std::function<Colour(const Texel&)>& colour) {
  constexpr std::size_t most = 512;
  const Level& level = geometry.level();
  std::unordered_set<std::size_t> seen;
  for (const Texel& t : region) seen.insert(index_of(level, t));
  std::vector<Texel> rim;
  for (const Texel& t : region)
    for (int down = -1; down <= 1; ++down)
      for (int right = -1; right <= 1; ++right)
        if (const Texel other = texel_beside(level, t, right, down); seen.insert(index_of(level, other)).second)
          rim.push_back(other);
  std::vector<RimTexel> some;
  const std::size_t step = (rim.size() + most - 1) / most;
  for (std::size_t k = 0; k < rim.size(); k += step) some.push_back({geometry.centre(rim[k]), Flux(colour(rim[k]))});
  return some;
}

}  // namespace

std::vector<Colour> smooth_fill(const TexelGeometry& geometry, std::span<const Texel> region,
                                const std::function<Colour(const Texel&)>& colour) {
  const std::vector<RimTexel> rim = rim_of(geometry, region, colour);
  std::vector<Colour> filled(region.size());
  parallel_ranges(int(region.size()), 64, [&](int begin, int end) {
    for (int k = begin; k < end; ++k) {
      const Direction at = geometry.centre(region[std::size_t(k)]);
      Flux sum(0);
      double weights = 0;
      for (const RimTexel& r : rim) {
        const double d = glm::distance(at, r.towards), weight = 1 / std::max(1e-30, d * d * d);
        sum += weight * r.colour;
        weights += weight;
      }
      const Colour was = colour(region[std::size_t(k)]);
      filled[std::size_t(k)] = weights > 0 ? glm::min(was, Colour(sum / weights)) : Colour(0);
    }
  });
  return filled;
}

}  // namespace envmap

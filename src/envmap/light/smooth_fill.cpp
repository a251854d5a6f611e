#include "envmap/light/smooth_fill.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_set>

#include "envmap/base/parallel.h"
#include "envmap/operate/brightest.h"

namespace envmap {
namespace {

struct RimTexel {
  Direction towards;
  Flux colour;
};

// The texels that touch a region, then those that touch these, and so on.
std::vector<std::vector<Texel>> rings_round(const Level& level, std::span<const Texel> region, int count) {
  std::unordered_set<std::size_t> seen;
  for (const Texel& t : region) seen.insert(index_of(level, t));
  std::vector<std::vector<Texel>> rings;
  std::vector<Texel> inner(region.begin(), region.end());
  for (int k = 0; k < count; ++k) {
    std::vector<Texel> ring;
    for (const Texel& t : inner)
      for (int down = -1; down <= 1; ++down)
        for (int right = -1; right <= 1; ++right)
          if (const Texel other = texel_beside(level, t, right, down); seen.insert(index_of(level, other)).second)
            ring.push_back(other);
    rings.push_back(ring);
    inner = std::move(ring);
  }
  return rings;
}

// The texels of a ring; of a long one every second, third or further one, at most 512.
std::vector<RimTexel> some_of(const TexelGeometry& geometry, std::span<const Texel> ring,
                              const std::function<Colour(const Texel&)>& colour) {
  constexpr std::size_t most = 512;
  std::vector<RimTexel> some;
  const std::size_t step = (ring.size() + most - 1) / most;
  for (std::size_t k = 0; k < ring.size(); k += step) some.push_back({geometry.centre(ring[k]), Flux(colour(ring[k]))});
  return some;
}

double distance_to(const std::vector<RimTexel>& ring, const Direction& from) {
  double least = std::numeric_limits<double>::infinity();
  for (const RimTexel& r : ring) least = std::min(least, glm::distance(from, r.towards));
  return least;
}

// How much brighter it grows inwards from one ring to another, over the mean distance between them; 0 where it grows
// darker.
Flux rise(const std::vector<RimTexel>& inner, const std::vector<RimTexel>& outer) {
  if (inner.empty() || outer.empty()) return Flux(0);
  const auto mean = [](const std::vector<RimTexel>& ring) {
    Flux sum(0);
    for (const RimTexel& r : ring) sum += r.colour;
    return sum / double(ring.size());
  };
  double apart = 0;
  for (const RimTexel& r : outer) apart += distance_to(inner, r.towards);
  return apart > 0 ? glm::max(mean(inner) - mean(outer), 0.0) * (double(outer.size()) / apart) : Flux(0);
}

// As many rings as half of the region's radius has texels: where the slope is still that of the rim.
int ring_count(std::size_t texels) { return 2 + int(0.5 * std::sqrt(double(texels) / pi)); }

}  // namespace

std::vector<Colour> smooth_fill(const TexelGeometry& geometry, std::span<const Texel> region,
                                const std::function<Colour(const Texel&)>& colour) {
  const std::vector<std::vector<Texel>> rings = rings_round(geometry.level(), region, ring_count(region.size()));
  const std::vector<RimTexel> rim = some_of(geometry, rings.front(), colour);
  const Flux inwards = rise(rim, some_of(geometry, rings.back(), colour));
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
      filled[std::size_t(k)] =
          weights > 0 ? glm::min(was, Colour(sum / weights + distance_to(rim, at) * inwards)) : Colour(0);
    }
  });
  return filled;
}

}  // namespace envmap

#include "envmap/sample/filter.h"

#include <algorithm>
#include <array>

#include "envmap/sample/area.h"
#include "envmap/sample/bicubic.h"
#include "envmap/sample/probes.h"
#include "envmap/sample/pyramid.h"
#include "envmap/sample/sample.h"
#include "envmap/sample/settle.h"
#include "envmap/sample/summed_area.h"

namespace envmap {
namespace {

template <class Plan, class Probe>
Sampler probing(const Level& base, const Target& target, const Plan& plan, const Probe& probe, bool plain = false) {
  return [=, &base](int face, int row, int first, std::span<Colour> out) {
    const auto find = [&](std::span<const Direction> directions, std::span<Location<double>> at) {
      plain ? locate(base.projection(), directions, at)
            : locate_for_bilinear(base.projection(), base.height(), directions, at);
    };
    sample_probes(target, face, row, first, out, find, plan, probe);
  };
}

// Texels worked on at once: few enough that their directions and locations stay in the nearest cache.
constexpr std::size_t block = 256;

// One sample a texel, nearest or bilinear: directions of the texels, where they lie in the source, what is there.
Sampler point_sampler(const Level& base, const Target& target, bool bilinear) {
  return [=, &base](int face, int row, int first, std::span<Colour> out) {
    std::array<Direction, block> directions;
    std::array<Location<double>, block> locations;
    for (std::size_t start = 0; start < out.size(); start += block) {
      const std::span texels = out.subspan(start, std::min(block, out.size() - start));
      const std::span d = std::span(directions).first(texels.size());
      const std::span at = std::span(locations).first(texels.size());
      texel_directions(target.to, target.size, face, row, first + static_cast<int>(start), d);
      rotate(target.to_source, d);
      if (bilinear) {
        locate_for_bilinear(base.projection(), base.height(), d, at);
        sample_bilinear(base, at, texels);
      } else {
        locate(base.projection(), d, at);
        sample_nearest(base, at, texels);
      }
    }
  };
}

}  // namespace

Sampler make_sampler(const std::vector<Level>& levels, const Target& target, const FilterOptions& options) {
  const Level& base = levels.front();
  const auto grid = [n = options.samples](int, const Vec2<double>&) { return Probes{n, n}; };
  const auto all_of = [&base](auto sample) {
    return [&base, sample](std::span<const Location<double>> at, const Probes&, std::span<Colour> out) {
      sample(base, at, out);
    };
  };
  const auto by_plan = [&](auto plan) {
    return probing(
        base, target, [&base, target, plan](int face, const Vec2<double>& at) { return plan(target, base, face, at); },
        [&levels](std::span<const Location<double>> at, const Probes& p, std::span<Colour> out) {
          sample_trilinear(levels, at, p.lod, out);
        });
  };
  if (options.samples == 1 && (options.filter == Filter::nearest || options.filter == Filter::bilinear))
    return point_sampler(base, target, options.filter == Filter::bilinear);
  switch (options.filter) {
    case Filter::nearest: return probing(base, target, grid, all_of(sample_nearest), true);
    case Filter::bicubic: return probing(base, target, grid, all_of(sample_bicubic));
    case Filter::trilinear: return by_plan(trilinear_plan);
    case Filter::ewa: return by_plan(ewa_plan);
    case Filter::sat: return summed_area_sampler(base, target);
    case Filter::area: return area_sampler(base, target, options.area_tolerance, options.floor);
    case Filter::automatic:
    case Filter::bilinear: break;
  }
  return probing(base, target, grid, all_of(sample_bilinear));
}

}  // namespace envmap

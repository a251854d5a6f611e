/// @file
/// Means of probes: every filter that looks at a few places of the source for each texel.
#pragma once

#include <algorithm>
#include <vector>

#include "envmap/sample/target_grid.h"

namespace envmap {

/// A grid of places in a texel of the result, and the mip level at which each of them looks.
struct Probes {
  int across = 1, down = 1;
  double lod = 0;
};

/// The solid-angle weighted means of probes over texels [first, first + out.size()) of a row. They tile the texel in
/// (u,v) of the result and go through the direction map one by one, so that no footprint ever meets an edge.
/// @param find (directions, locations): locate() of the source, or locate_for_bilinear().
/// @param plan (face, place in it) -> Probes, or anything else with `across` and `down`.
/// @param probe (the probes' locations, what plan gave for the texel, colours to fill).
template <class Find, class Plan, class Probe>
void sample_probes(const Target& target, int face, int row, int first, std::span<Colour> out, const Find& find,
                   const Plan& plan, const Probe& probe) {
  constexpr std::size_t block = 32;  // Texels whose probes' places all stay in a near cache.
  if (out.size() > block) {
    for (std::size_t k = 0; k < out.size(); k += block)
      sample_probes(target, face, row, first + int(k), out.subspan(k, std::min(block, out.size() - k)), find, plan,
                    probe);
    return;
  }
  const double h = target.size, w = h * aspect(target.to);
  std::vector<Direction> directions(out.size());
  std::vector<decltype(plan(face, Point2()))> plans(out.size());
  std::vector<Point2> points;
  texel_directions(target.to, target.size, face, row, first, directions);
  const auto centre = [&](std::size_t k) { return Point2((first + double(k) + 0.5) / w, (row + 0.5) / h); };
  for (std::size_t k = 0; k < out.size(); ++k) {
    const auto& p = plans[k] = plan(face, centre(k));
    if (p.across * p.down == 1) continue;
    for (int b = 0; b < p.down; ++b)
      for (int a = 0; a < p.across; ++a)
        points.push_back(centre(k) + Point2(((a + 0.5) / p.across - 0.5) / w, ((b + 0.5) / p.down - 0.5) / h));
  }
  // Behind the centres of all texels come the places of those that have more than one.
  std::vector<double> weights(points.size());
  densities(target.to, points, weights);
  directions.resize(out.size() + points.size());
  envmap::directions(target.to, face, points, std::span(directions).subspan(out.size()));
  std::vector<Location<double>> locations(directions.size());
  target.bring_to_source(directions);
  find(directions, locations);

  std::vector<Colour> colours;
  std::size_t next = 0;
  for (std::size_t k = 0; k < out.size(); ++k) {
    const std::size_t count = std::size_t(plans[k].across) * std::size_t(plans[k].down);
    if (count > 1) {
      const std::span<const double> weight = std::span(weights).subspan(next, count);
      colours.resize(count);
      probe(std::span<const Location<double>>(locations).subspan(out.size() + next, count), plans[k],
            std::span(colours));
      next += count;
      Rgb<double> sum(0);
      double whole = 0;
      for (std::size_t n = 0; n < count; ++n) {
        sum += weight[n] * Rgb<double>(colours[n]);
        whole += weight[n];
      }
      if (whole > 0) {
        out[k] = Colour(sum / whole);
        continue;
      }
    }
    probe(std::span<const Location<double>>(&locations[k], 1), plans[k], out.subspan(k, 1));
  }
}

}  // namespace envmap

#include <algorithm>
#include <array>

#include "envmap/sample/area.h"
#include "envmap/sample/inverse_bilinear.h"
#include "envmap/sample/multi_sample.h"
#include "envmap/sample/point.h"
#include "envmap/sample/pyramid.h"
#include "envmap/sample/quad.h"
#include "envmap/sample/sampler.h"
#include "envmap/sample/summed_area.h"

namespace envmap {
namespace {

// Samples worked on at once: few enough that their directions and locations stay in the nearest cache.
constexpr std::size_t block = 256;

using Sample = void (*)(const PaddedLevel&, std::span<const Location<double>>, std::span<Colour>);

// A run of samples in a row of texels: their directions, where they lie in the source, what is there.
void sample_row(const PaddedLevel& base, const Target& target, bool inverse_bilinear, Sample sample, int size, int face,
                int row, int first, std::span<Colour> out) {
  std::array<Direction, block> all_directions;
  std::array<Location<double>, block> all_locations;
  const std::span directions = std::span(all_directions).first(out.size());
  const std::span locations = std::span(all_locations).first(out.size());
  texel_directions(target.to, size, face, row, first, directions);
  target.bring_to_source(directions);
  inverse_bilinear ? locate_for_bilinear(base.projection(), base.height(), directions, locations)
                   : locate(base.projection(), directions, locations);
  sample(base, locations, out);
}

// Solid angle of samples in a row, relative. What lies outside a disc counts where nothing lies inside, only.
void weigh(Projection p, int size, int row, int first, std::span<double> weights) {
  std::array<Point2, block> points;
  const double h = size, w = h * aspect(p);
  for (std::size_t k = 0; k < weights.size(); ++k) points[k] = {(first + double(k) + 0.5) / w, (row + 0.5) / h};
  densities(p, std::span(points).first(weights.size()), weights);
  for (double& weight : weights) weight = std::max(weight, 1e-30);
}

// n x n samples a texel: one in each texel of a map n times as fine, and their solid-angle weighted means.
Sampler grid_sampler(const PaddedLevel& base, const Target& target, int n, bool inverse_bilinear, Sample sample) {
  const auto fine = std::size_t(n), at_once = block / fine;
  return [=, &base](int face, int row, int first, std::span<Colour> out) {
    std::array<Colour, block> colours;
    std::array<double, block> weights;
    std::array<Rgb<double>, block> sums;
    std::array<double, block> wholes;
    for (std::size_t start = 0; start < out.size(); start += at_once) {
      const std::span texels = out.subspan(start, std::min(at_once, out.size() - start));
      const int column = n * (first + int(start));
      const std::size_t count = fine * texels.size();
      sums.fill(Rgb<double>(0));
      wholes.fill(0);
      for (int part = 0; part < n; ++part) {
        const int fine_row = n * row + part;
        sample_row(base, target, inverse_bilinear, sample, n * target.size, face, fine_row, column,
                   std::span(colours).first(count));
        weigh(target.to, n * target.size, fine_row, column, std::span(weights).first(count));
        for (std::size_t k = 0; k < texels.size(); ++k)
          for (std::size_t m = k * fine; m < (k + 1) * fine; ++m) {
            sums[k] += weights[m] * Rgb<double>(colours[m]);
            wholes[k] += weights[m];
          }
      }
      for (std::size_t k = 0; k < texels.size(); ++k) texels[k] = Colour(sums[k] / wholes[k]);
    }
  };
}

// The same for one sample, which needs no mean.
Sampler point_sampler(const PaddedLevel& base, const Target& target, bool inverse_bilinear, Sample sample) {
  return [=, &base](int face, int row, int first, std::span<Colour> out) {
    for (std::size_t k = 0; k < out.size(); k += block)
      sample_row(base, target, inverse_bilinear, sample, target.size, face, row, first + int(k),
                 out.subspan(k, std::min(block, out.size() - k)));
  };
}

using Levels = std::span<const PaddedLevel>;

Sampler make_points(Levels levels, const Target& target, const FilterOptions& o, bool inverse_bilinear, Sample sample) {
  const PaddedLevel& base = levels.front();
  return o.samples == 1 ? point_sampler(base, target, inverse_bilinear, sample)
                        : grid_sampler(base, target, o.samples, inverse_bilinear, sample);
}

// Probes of trilinear lookups. @param plan how many, and at which level.
Sampler make_probes(Levels levels, const Target& target,
                    Probes (*plan)(const Target&, const PaddedLevel&, int, const Point2&)) {
  return [=](int face, int row, int first, std::span<Colour> out) {
    const PaddedLevel& base = levels.front();
    sample_probes(
        target, face, row, first, out,
        [&](std::span<const Direction> directions, std::span<Location<double>> at) {
          locate_for_bilinear(base.projection(), base.height(), directions, at);
        },
        [&](int, const Point2& at) { return plan(target, base, face, at); },
        [&](std::span<const Location<double>> at, const Probes& p, std::span<Colour> colours) {
          sample_trilinear(levels, at, p.lod, colours);
        });
  };
}

constexpr std::array<FilterInfo, 8> all_filters{{
    {Filter::nearest, "nearest", "Source texel at the centre of each output texel", false, true},
    {Filter::bilinear, "bilinear", "Bilinear interpolation at this point", false, true},
    {Filter::bicubic, "bicubic", "Catmull-Rom interpolation, clamped to the range of the four nearest texels", false,
     true},
    {Filter::trilinear, "trilinear",
     "Interpolates between two mip levels. Never aliases, but blurs texels that are long and narrow in the source",
     true, false},
    {Filter::sat, "sat", "Mean over an axis-aligned box in the source, from a summed-area table", false, false},
    {Filter::ewa, "ewa", "Mean of several trilinear samples along an ellipse that covers the texel", true, false},
    {Filter::area, "area",
     "Solid-angle mean of the bilinearly reconstructed source over the exact footprint, to within the "
     "area error. The reference",
     false, false},
    {Filter::nearest_level, "nearest-level",
     "Bilinear interpolation in the mip level whose texels fit best (GL_LINEAR_MIPMAP_NEAREST). Shows the borders of "
     "levels",
     true, false},
}};

using Make = Sampler (*)(Levels, const Target&, const FilterOptions&);
constexpr std::array<Make, all_filters.size()> makers{
    [](Levels l, const Target& t, const FilterOptions& o) { return make_points(l, t, o, false, sample_nearest); },
    [](Levels l, const Target& t, const FilterOptions& o) { return make_points(l, t, o, true, sample_bilinear); },
    [](Levels l, const Target& t, const FilterOptions& o) { return make_points(l, t, o, true, sample_bicubic); },
    [](Levels l, const Target& t, const FilterOptions&) { return make_probes(l, t, trilinear_plan); },
    [](Levels l, const Target& t, const FilterOptions&) { return summed_area_sampler(l.front(), t); },
    [](Levels l, const Target& t, const FilterOptions&) { return make_probes(l, t, ewa_plan); },
    [](Levels l, const Target& t, const FilterOptions& o) {
      if (o.sides == AreaSides::outlines || !quads_suit(l.front(), t))
        return area_sampler(l.front(), t, o.area_error, o.floor);
      return quad_sampler(l.front(), t, o.area_error, o.floor, o.sides == AreaSides::quads);
    },
    [](Levels l, const Target& t, const FilterOptions&) { return make_probes(l, t, nearest_level_plan); },
};

}  // namespace

std::span<const FilterInfo> filters() { return all_filters; }

Sampler make_sampler(std::span<const PaddedLevel> levels, const Target& target, const FilterOptions& options) {
  return makers[std::size_t(options.filter)](levels, target, options);
}

}  // namespace envmap

#include "envmap/light/lights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <unordered_map>
#include <unordered_set>

#include "envmap/base/error.h"
#include "envmap/base/run_operation.h"
#include "envmap/light/bright_regions.h"
#include "envmap/light/disc_angles.h"
#include "envmap/light/disc_fit.h"
#include "envmap/light/smooth_fill.h"
#include "envmap/maths/portable.h"
#include "envmap/operate/brightest.h"
#include "envmap/operate/refuse_flaws.h"

namespace envmap {
namespace {

constexpr double degree = pi / 180;

// Half of the weight lies below it.
double weighted_median(std::vector<std::pair<double, double>>& values) {
  if (values.empty()) return 0;
  std::ranges::sort(values);
  double half = 0;
  for (const auto& [value, weight] : values) half += 0.5 * weight;
  for (const auto& [value, weight] : values)
    if ((half -= weight) <= 0) return value;
  return values.back().first;
}

// The mean distance of a texel's points from a direction, at most: means over the corners of its 16 parts, which of a
// convex function are no less than the mean over the parts.
double mean_distance(const Level& level, const Texel& t, const Direction& from) {
  constexpr int n = 4;
  std::array<Point2, std::size_t(n + 1) * (n + 1)> points;
  std::array<Direction, std::size_t(n + 1) * (n + 1)> d;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i)
      points[std::size_t(j * (n + 1) + i)] = {(t.i + double(i) / n) / level.width(),
                                              (t.j + double(j) / n) / level.height()};
  directions(level.projection(), t.face, points, d);
  double sum = 0;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i)
      sum += (i % n == 0 ? 0.5 : 1) * (j % n == 0 ? 0.5 : 1) * glm::distance(d[std::size_t(j * (n + 1) + i)], from);
  return sum / (n * n);
}

// A place where one light is, or a few that touch.
struct Place {
  Direction middle;
  double radius;
  double surroundings = 0;  // Luminance.
};

class Finder {
 public:
  Finder(const EnvironmentMap& map, const LightOptions& options, double luminous_flux)
      : level_(map.base()),
        geometry_(level_),
        options_(options),
        to_world_(image_to_world(map.forward)),
        luminous_flux_(luminous_flux) {}

  FoundLights run(const Progress& progress) {
    const double largest = solid_angle_of_disc(options_.max_radius_degrees * degree);
    // A source that is no larger and has its share is so bright in the mean.
    std::vector<BrightRegion> regions =
        bright_regions(geometry_, options_.min_share * luminous_flux_ / largest, largest);
    // The strongest texels of a source are a quarter of it, or more: what has less is no source.
    const auto end = std::ranges::find_if(regions, [&](const BrightRegion& r) {
      return r.luminous_flux < 0.25 * options_.min_share * luminous_flux_;
    });
    const std::size_t most_tried = std::size_t(8 * options_.most);
    const std::size_t count = std::min(most_tried, std::size_t(end - regions.begin()));
    // Of the strongest the brightest first: a sun beside a larger lamp is taken out before the lamp's surroundings are
    // looked at.
    std::ranges::stable_sort(regions.begin(), regions.begin() + std::min<std::ptrdiff_t>(count, options_.most),
                             std::ranges::greater(), &BrightRegion::peak);
    for (std::size_t k = 0; k < count && int(found_.lights.size()) < options_.most; ++k) {
      look_at(regions[k]);
      if (progress) progress(double(k) / double(count));
    }
    return finished();
  }

 private:
  [[nodiscard]] Colour colour(const Texel& t) const {
    const auto found = without_.find(index_of(level_, t));
    return found == without_.end() ? *level_.texel(t.face, t.i, t.j) : found->second;
  }

  void look_at(const BrightRegion& region) {
    if (without_.contains(index_of(level_, region.texels.front()))) return;
    Place place = place_of(region);
    for (int attempt = 0; attempt < 4; ++attempt) {
      const auto patch = patch_round(place, region);
      if (!patch) return;
      const DiscFit fit = best_fit(*patch, place);
      const Disc& first = fit.discs.front();
      // Where only the hottest texels were over half of the peak, the disc is larger than it seemed.
      if (fit.discs.size() == 1 && first.radius > 1.5 * place.radius && attempt < 3) {
        place = {first.towards, first.radius};
        continue;
      }
      const bool has_room = int(found_.lights.size() + fit.discs.size()) <= options_.most;
      if (has_room && is_light(fit, place, region)) take(*patch, fit, place);
      return;
    }
  }

  [[nodiscard]] Place place_of(const BrightRegion& region) {
    Direction sum(0);
    for (const Texel& t : region.texels)
      sum += geometry_.solid_angle(t) * luminance_of(colour(t)) * geometry_.centre(t);
    return {unit(sum, geometry_.centre(region.texels.front())), radius_of_disc(region.solid_angle)};
  }

  // The texels round a place, beyond what surrounds it. Nothing where that is too much of the map, or as bright.
  std::optional<Patch> patch_round(Place& place, const BrightRegion& region) {
    const double texel = geometry_.extent(region.texels.front()).longest();
    const double chord = 2.5 * place.radius + 4 * texel;
    if (chord > 0.7) return std::nullopt;
    std::vector<Texel> texels = texels_within(geometry_, region.texels, place.middle, chord);
    std::vector<double> luminance(texels.size());
    std::ranges::transform(texels, luminance.begin(), [&](const Texel& t) { return luminance_of(colour(t)); });
    std::vector<std::pair<double, double>> ring;
    for (std::size_t k = 0; k < texels.size(); ++k)
      if (glm::distance(geometry_.centre(texels[k]), place.middle) > 1.5 * place.radius + 1.5 * texel)
        ring.emplace_back(luminance[k], geometry_.solid_angle(texels[k]));
    if (ring.empty()) return std::nullopt;
    place.surroundings = weighted_median(ring);
    if (region.peak < options_.contrast * place.surroundings) return std::nullopt;
    for (double& y : luminance) y -= place.surroundings;
    return Patch(geometry_, std::move(texels), std::move(luminance), place.middle, place.radius);
  }

  // One disc, or two or three beside each other where these explain much more.
  static DiscFit best_fit(const Patch& patch, const Place& place) {
    constexpr double good = 0.1;
    std::vector<Disc> first{{place.middle, place.radius, 0}};
    DiscFit best = fit_discs(patch, first);
    // A disc of less than a texel, from the middle of its brightest texel alone, may get stuck beside the others.
    if (best.misfit > good) {
      const Disc centred{middle_of_light(patch), 0.5 * place.radius, 0};
      if (DiscFit other = fit_discs(patch, std::span(&centred, 1)); other.misfit < best.misfit) best = std::move(other);
    }
    while (best.misfit > good && best.discs.size() < 3) {
      first = best.discs;
      first.push_back(where_most_is_left(patch, best));
      for (Disc& d : first) d.radius = 0.7 * best.discs.front().radius;
      DiscFit more = fit_discs(patch, first);
      if (more.misfit > 0.6 * best.misfit || !are_apart(more.discs)) break;
      best = std::move(more);
    }
    return best;
  }

  static Direction middle_of_light(const Patch& patch) {
    Direction sum(0);
    for (std::size_t t = 0; t < patch.size(); ++t)
      sum += patch.weight()[t] * std::max(0.0, patch.luminance()[t]) * patch.centre()[t];
    return unit(sum, patch.middle());
  }

  static Disc where_most_is_left(const Patch& patch, const DiscFit& fit) {
    std::vector<double> left = patch.luminance();
    for (const Disc& d : fit.discs) {
      const std::vector<double> covered = patch.coverage(d.towards, d.radius);
      for (std::size_t t = 0; t < left.size(); ++t) left[t] -= d.luminance * covered[t];
    }
    for (std::size_t t = 0; t < left.size(); ++t) left[t] *= patch.weight()[t];
    const std::size_t most = std::size_t(std::ranges::max_element(left) - left.begin());
    return {patch.centre()[most], fit.discs.front().radius, 0};
  }

  static bool are_apart(const std::vector<Disc>& discs) {
    for (std::size_t a = 0; a < discs.size(); ++a)
      for (std::size_t b = 0; b < a; ++b)
        if (angle_between(discs[a].towards, discs[b].towards) < 0.7 * (discs[a].radius + discs[b].radius)) return false;
    return true;
  }

  // Whether what was fitted stands out, is small enough, and round where it is large enough to tell.
  [[nodiscard]] bool is_light(const DiscFit& fit, const Place& place, const BrightRegion& region) {
    constexpr double most_misfit = 0.6, most_of_several = 0.3;
    if (!(fit.misfit < (fit.discs.size() > 1 ? most_of_several : most_misfit))) return false;
    for (const Disc& d : fit.discs)
      if (d.radius > options_.max_radius_degrees * degree || d.luminance < (options_.contrast - 1) * place.surroundings)
        return false;
    return fit.discs.size() > 1 || is_round(region);
  }

  // Whether few of its texels lie outside of the disc of their solid angle: of a square it is 9% of it. Of few texels
  // nothing can be said.
  [[nodiscard]] bool is_round(const BrightRegion& region) {
    constexpr std::size_t few = 60;
    constexpr double most_outside = 0.075;
    if (region.texels.size() < few) return true;
    Direction sum(0);
    for (const Texel& t : region.texels) sum += geometry_.solid_angle(t) * geometry_.centre(t);
    const Direction middle = unit(sum, geometry_.centre(region.texels.front()));
    const double rim = 2 * portable::sin(0.5 * radius_of_disc(region.solid_angle));
    double outside = 0;
    for (const Texel& t : region.texels)
      if (glm::distance(geometry_.centre(t), middle) > rim) outside += geometry_.solid_angle(t);
    return outside <= most_outside * region.solid_angle;
  }

  // The texels that the discs cover, and the glow round them as far as it falls steeply, which optics and resampling
  // make of a disc's rim. @return indices of texels of the patch.
  [[nodiscard]] std::vector<std::size_t> texels_of_light(const Patch& patch, const std::vector<Disc>& discs,
                                                         const Place& place) const {
    constexpr double steep = 0.6, dim = 0.003;
    std::unordered_map<std::size_t, std::size_t> index;
    for (std::size_t t = 0; t < patch.size(); ++t) index[index_of(level_, patch.texels()[t])] = t;
    std::vector<bool> taken(patch.size());
    std::vector<std::size_t> all;
    double before = 0;
    for (const Disc& d : discs) {
      before = std::max(before, d.luminance);
      const std::vector<double> covered = patch.coverage(d.towards, d.radius);
      for (std::size_t t = 0; t < patch.size(); ++t)
        if (covered[t] > 0 && !taken[t]) taken[t] = true, all.push_back(t);
    }
    const double least = std::max(dim * before, 0.5 * place.surroundings);
    std::size_t inner = 0;
    // One ring always goes with the disc: a rim that is off by a hair would light up all that is filled from it.
    for (bool first = true;; first = false) {
      std::vector<std::size_t> ring;
      double light = 0, weight = 0;
      for (std::size_t k = inner; k < all.size(); ++k)
        for (int down = -1; down <= 1; ++down)
          for (int right = -1; right <= 1; ++right) {
            const auto found = index.find(index_of(level_, texel_beside(level_, patch.texels()[all[k]], right, down)));
            if (found == index.end() || taken[found->second] || !is_near(patch, found->second, discs)) continue;
            taken[found->second] = true;
            ring.push_back(found->second);
            light += patch.weight()[found->second] * patch.luminance()[found->second];
            weight += patch.weight()[found->second];
          }
      const bool is_glow = light >= least * weight && light <= steep * before * weight;
      if (ring.empty() || (!first && !is_glow)) return all;
      before = light / weight;
      inner = all.size();
      all.insert(all.end(), ring.begin(), ring.end());
      if (!is_glow) return all;
    }
  }

  static bool is_near(const Patch& patch, std::size_t t, const std::vector<Disc>& discs) {
    return std::ranges::any_of(discs, [&](const Disc& d) {
      return glm::distance(patch.centre()[t], d.towards) < std::max(3 * d.radius, d.radius + 3 * patch.texel());
    });
  }

  // Puts the discs into the result, and what stands in their place.
  void take(const Patch& patch, const DiscFit& fit, const Place& place) {
    std::vector<DiscLight> lights;
    std::vector<Disc> widest;
    for (std::size_t k = 0; k < fit.discs.size(); ++k) {
      const DiscDoubt doubt = doubt_of(patch, fit, k, sun_radius_degrees * degree);
      DiscLight& light = lights.emplace_back();
      light.towards = doubt.likely.towards;
      const double radius = doubt.radius_is_open ? doubt.largest_radius : doubt.likely.radius;
      light.radius_degrees = radius / degree;
      light.radius_is_bound = doubt.radius_is_open;
      light.radius_within_degrees =
          std::max(doubt.largest_radius - radius, doubt.radius_is_open ? 0 : radius - doubt.least_radius) / degree;
      light.within_degrees = doubt.within / degree;
      light.misfit = fit.misfit;
      widest.push_back({doubt.likely.towards, doubt.largest_radius, doubt.likely.luminance});
    }
    const std::vector<std::size_t> indices = texels_of_light(patch, widest, place);
    std::vector<Texel> texels;
    for (const std::size_t t : indices) texels.push_back(patch.texels()[t]);
    const std::vector<Colour> filled = smooth_fill(geometry_, texels, [&](const Texel& t) { return colour(t); });
    share_out(patch, indices, filled, widest, lights);
    double share = 0;
    for (DiscLight& light : lights) share += light.share, light.contrast = contrast(light, place);
    if (share < options_.min_share) return;
    count_peaks(texels, lights);
    for (std::size_t k = 0; k < texels.size(); ++k) without_[index_of(level_, texels[k])] = filled[k];
    found_.lights.insert(found_.lights.end(), lights.begin(), lights.end());
    taken_.insert(taken_.end(), texels.begin(), texels.end());
  }

  // What each texel loses goes to the discs in proportion to what they have there, or to the nearest.
  void share_out(const Patch& patch, std::span<const std::size_t> indices, std::span<const Colour> filled,
                 std::span<const Disc> discs, std::vector<DiscLight>& lights) {
    std::vector<std::vector<double>> covered;
    for (const Disc& d : discs) covered.push_back(patch.coverage(d.towards, d.radius));
    for (std::size_t n = 0; n < indices.size(); ++n) {
      const std::size_t t = indices[n];
      const Flux lost = patch.weight()[t] * (Flux(colour(patch.texels()[t])) - Flux(filled[n]));
      double all = 0;
      for (std::size_t k = 0; k < discs.size(); ++k) all += discs[k].luminance * covered[k][t];
      std::size_t nearest = 0;
      for (std::size_t k = 1; k < discs.size(); ++k)
        if (beyond(patch, t, discs[k]) < beyond(patch, t, discs[nearest])) nearest = k;
      for (std::size_t k = 0; k < discs.size(); ++k) {
        const double part = all > 0 ? discs[k].luminance * covered[k][t] / all : k == nearest ? 1 : 0;
        if (part == 0) continue;
        lights[k].flux += part * lost;
        lights[k].spread += part * mean_distance(level_, patch.texels()[t], discs[k].towards) * lost;
      }
    }
    for (DiscLight& light : lights) {
      const double radius = light.radius_degrees * degree;
      light.radiance = light.flux / solid_angle_of_disc(radius);
      light.irradiance = light.flux * irradiance_of_flux(radius);
      light.share = luminance_of(light.flux) / luminous_flux_;
      light.towards = to_world_ * light.towards;
    }
  }

  static double beyond(const Patch& patch, std::size_t t, const Disc& d) {
    return glm::distance(patch.centre()[t], d.towards) - d.radius;
  }

  static double contrast(const DiscLight& light, const Place& place) {
    return place.surroundings > 0 ? 1 + luminance_of(light.radiance) / place.surroundings
                                  : std::numeric_limits<double>::infinity();
  }

  // Texels with a channel as large as any of the light.
  void count_peaks(std::span<const Texel> texels, std::vector<DiscLight>& lights) const {
    float most = 0;
    const auto largest = [&](const Texel& t) {
      const Colour c = colour(t);
      return std::max({c.x, c.y, c.z});
    };
    for (const Texel& t : texels) most = std::max(most, largest(t));
    const auto count = std::ranges::count_if(texels, [&](const Texel& t) { return largest(t) >= most; });
    for (DiscLight& light : lights) light.texels_at_peak = int(count);
  }

  FoundLights finished() {
    std::ranges::stable_sort(found_.lights, std::ranges::greater(), &DiscLight::share);
    // A texel may have lost light twice: what it holds at last counts.
    std::unordered_set<std::size_t> listed;
    for (const Texel& t : taken_)
      if (listed.insert(index_of(level_, t)).second) found_.without.push_back({t, colour(t)});
    return std::move(found_);
  }

  const Level& level_;
  TexelGeometry geometry_;
  LightOptions options_;
  Rotation to_world_;
  double luminous_flux_;
  std::unordered_map<std::size_t, Colour> without_;
  std::vector<Texel> taken_;
  FoundLights found_;
};

void check(const LightOptions& o) {
  check_range(limits::min_share, o.min_share);
  check_range(limits::light_radius, o.max_radius_degrees);
  check_range(limits::contrast, o.contrast);
  check_range(limits::lights, o.most);
}

}  // namespace

FoundLights find_lights(const EnvironmentMap& map, const LightOptions& options, const Run& run) {
  check(options);
  return run_operation(run, [&](const Progress& progress) {
    const Flux all = flux(require_finite(map).base());
    const double luminous = luminance_of(all);
    return luminous > 0 ? Finder(map, options, luminous).run(progress) : FoundLights{};
  });
}

void take_out(EnvironmentMap& map, const FoundLights& found) {
  check_levels(map);
  const Level& level = map.base();
  for (const auto& [t, colour] : found.without)
    if (t.face < 0 || t.face >= level.faces() || t.i < 0 || t.i >= level.width() || t.j < 0 || t.j >= level.height())
      throw UsageError("the lights were found in a larger map");
  for (const auto& [t, colour] : found.without) *map.base().texel(t.face, t.i, t.j) = colour;
  map.levels.erase(map.levels.begin() + 1, map.levels.end());
}

}  // namespace envmap

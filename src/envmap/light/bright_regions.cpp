#include "envmap/light/bright_regions.h"

#include <algorithm>
#include <tuple>

#include "envmap/base/parallel.h"
#include "envmap/base/stop_point.h"
#include "envmap/operate/brightest.h"

namespace envmap {
namespace {

struct BrightTexel {
  Texel texel;
  double luminance;
};

double luminance_at(const Level& level, const Texel& t) { return luminance_of(*level.texel(t.face, t.i, t.j)); }

// All over a luminance, the brightest first, and of equal ones the first in the image.
std::vector<BrightTexel> texels_over(const Level& level, double luminance) {
  std::vector<BrightTexel> all;
  for (const auto& row :
       map_level<std::vector<BrightTexel>>(level, [&](std::vector<BrightTexel>&found, int face, int j) {
         const Columns in = level.weighted_columns(j);
         for (int i = in.first; i < in.end; ++i)
           if (const double y = luminance_of(*level.texel(face, i, j)); y > luminance)
             found.push_back({{face, i, j}, y});
       }))
    all.insert(all.end(), row.begin(), row.end());
  std::ranges::stable_sort(all, std::ranges::greater(), &BrightTexel::luminance);
  return all;
}

}  // namespace

std::vector<BrightRegion> bright_regions(TexelGeometry& geometry, double luminance, double max_solid_angle) {
  const Level& level = geometry.level();
  std::vector<bool> seen(std::size_t(level.faces()) * std::size_t(level.height()) * std::size_t(level.width()));
  std::vector<BrightRegion> regions;
  for (const BrightTexel& first : texels_over(level, luminance)) {
    if (seen[index_of(level, first.texel)]) continue;
    seen[index_of(level, first.texel)] = true;
    BrightRegion region{{first.texel}, first.luminance};
    for (std::size_t k = 0; k < region.texels.size(); ++k) {
      if (k % 4096 == 0) stop_point();
      const Texel t = region.texels[k];
      region.solid_angle += geometry.solid_angle(t);
      region.luminous_flux += geometry.solid_angle(t) * luminance_at(level, t);
      for (int down = -1; down <= 1; ++down)
        for (int right = -1; right <= 1; ++right) {
          const Texel other = texel_beside(level, t, right, down);
          if (seen[index_of(level, other)] || luminance_at(level, other) <= 0.5 * first.luminance) continue;
          seen[index_of(level, other)] = true;
          region.texels.push_back(other);
        }
    }
    if (region.solid_angle <= max_solid_angle) regions.push_back(std::move(region));
  }
  std::ranges::stable_sort(regions, std::ranges::greater(), &BrightRegion::luminous_flux);
  return regions;
}

}  // namespace envmap

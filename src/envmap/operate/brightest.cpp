#include "envmap/operate/brightest.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_map>
#include <vector>

#include "envmap/base/parallel.h"

namespace envmap {
namespace {

constexpr std::int64_t max_listed = 1 << 22;

struct Middle {
  Direction sum{0};
  double weight = 0;
  void add(const Direction& d, double w) { sum += w * d, weight += w; }
  [[nodiscard]] std::optional<Direction> direction() const {
    const double length = glm::length(sum);
    return length > 1e-6 * weight ? std::optional(sum / length) : std::nullopt;
  }
};

Point2 centre_of(const Level& level, const Texel& t) {
  return {(t.i + 0.5) / level.width(), (t.j + 0.5) / level.height()};
}

Direction direction_of(const Level& level, const Texel& t) {
  return direction_at(level.projection(), t.face, centre_of(level, t));
}

double weight_of(const Level& level, const Texel& t) { return density_at(level.projection(), centre_of(level, t)); }

bool is_inside(const Level& level, int i, int j) {
  if (j < 0 || j >= level.height()) return false;
  const Columns in = level.weighted_columns(j);
  return i >= in.first && i < in.end;
}

// All texels of the luminance, row by row.
std::vector<Texel> texels_of_luminance(const Level& level, double luminance) {
  const auto rows = map_level<std::vector<Texel>>(level, [&](std::vector<Texel>& found, int face, int j) {
    const Columns in = level.weighted_columns(j);
    for (int i = in.first; i < in.end; ++i)
      if (luminance_of(*level.texel(face, i, j)) == luminance) found.push_back({face, i, j});
  });
  std::vector<Texel> all;
  for (const std::vector<Texel>& row : rows) all.insert(all.end(), row.begin(), row.end());
  return all;
}

Middle middle_of(const Level& level, std::span<const Texel> texels) {
  Middle middle;
  for (const Texel& t : texels) middle.add(direction_of(level, t), weight_of(level, t));
  return middle;
}

// Takes the texels that touch `first`, and each other, out of those that are left.
std::vector<Texel> region_at(const Level& level, const Texel& first, std::unordered_map<std::size_t, bool>& left) {
  std::vector<Texel> region{first};
  for (std::size_t k = 0; k < region.size(); ++k)
    for (int down = -1; down <= 1; ++down)
      for (int right = -1; right <= 1; ++right) {
        const Texel other = texel_beside(level, region[k], right, down);
        const auto found = left.find(index_of(level, other));
        if (found == left.end() || !found->second) continue;
        found->second = false;
        region.push_back(other);
      }
  return region;
}

std::vector<Texel> largest_region(const Level& level, const std::vector<Texel>& all) {
  std::unordered_map<std::size_t, bool> left;
  for (const Texel& t : all) left[index_of(level, t)] = true;
  std::vector<Texel> largest;
  double most = -1;
  for (const Texel& t : all) {
    bool& is_left = left[index_of(level, t)];
    if (!is_left) continue;
    is_left = false;
    std::vector<Texel> region = region_at(level, t, left);
    if (const double weight = middle_of(level, region).weight; weight > most)
      most = weight, largest = std::move(region);
  }
  return largest;
}

// Of so many texels that they are not listed.
std::optional<Direction> middle_of_all(const Level& level, double luminance) {
  const auto rows = map_level<Middle>(level, [&](Middle& middle, int face, int j) {
    const Columns in = level.weighted_columns(j);
    for (int i = in.first; i < in.end; ++i)
      if (const Texel t{face, i, j}; luminance_of(*level.texel(face, i, j)) == luminance)
        middle.add(direction_of(level, t), weight_of(level, t));
  });
  Middle all;
  for (const Middle& row : rows) all.sum += row.sum, all.weight += row.weight;
  return all.direction();
}

}  // namespace

Texel texel_beside(const Level& level, const Texel& t, int right, int down) {
  const Texel wanted{t.face, t.i + right, t.j + down};
  if (is_inside(level, wanted.i, wanted.j)) return wanted;
  const Location<double> found = locate(level.projection(), direction_of(level, wanted));
  return {found.face, std::clamp(int(found.u * level.width()), 0, level.width() - 1),
          std::clamp(int(found.v * level.height()), 0, level.height() - 1)};
}

Region brightest_region(const Level& level, double luminance, std::int64_t count, const Texel& first) {
  const Region alone{first, direction_of(level, first), count};
  if (count <= 1) return alone;
  if (count > max_listed) return {first, middle_of_all(level, luminance).value_or(alone.direction), count};
  const std::vector<Texel> texels = largest_region(level, texels_of_luminance(level, luminance));
  const auto middle = middle_of(level, texels).direction();
  if (texels.size() == 1 || !middle)
    return {texels.front(), direction_of(level, texels.front()), std::int64_t(texels.size())};
  const Texel nearest =
      *std::ranges::max_element(texels, {}, [&](const Texel& t) { return glm::dot(direction_of(level, t), *middle); });
  return {nearest, *middle, std::int64_t(texels.size())};
}

}  // namespace envmap

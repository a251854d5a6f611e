#include "envmap/light/texel_patch.h"

#include <algorithm>
#include <array>
#include <unordered_set>

#include "envmap/base/stop_point.h"
#include "envmap/operate/brightest.h"

namespace envmap {

Direction TexelGeometry::centre(const Texel& t) const {
  return direction_at(level_.projection(), t.face, {(t.i + 0.5) / level_.width(), (t.j + 0.5) / level_.height()});
}

double TexelGeometry::solid_angle(const Texel& t) {
  std::vector<double>& row = rows_[t.j];
  if (row.empty()) {
    row.resize(std::size_t(level_.width()));
    solid_angles(level_.projection(), level_.height(), t.j, row);
  }
  return row[std::size_t(t.i)];
}

TexelGeometry::Extent TexelGeometry::extent(const Texel& t) const {
  const double w = level_.width(), h = level_.height();
  const double u0 = t.i / w, u1 = (t.i + 1) / w, v0 = t.j / h, v1 = (t.j + 1) / h;
  const double u = (t.i + 0.5) / w, v = (t.j + 0.5) / h;
  const std::array<Point2, 9> points{
      {{u, v}, {u0, v}, {u1, v}, {u, v0}, {u, v1}, {u0, v0}, {u1, v0}, {u0, v1}, {u1, v1}}};
  std::array<Direction, 9> d;
  directions(level_.projection(), t.face, points, d);
  double reach = 0;
  for (const Direction& corner : d) reach = std::max(reach, glm::distance(corner, d[0]));
  return {glm::distance(d[1], d[2]), glm::distance(d[3], d[4]), reach};
}

std::vector<Texel> texels_within(const TexelGeometry& geometry, std::span<const Texel> seeds, const Direction& middle,
                                 double chord) {
  const Level& level = geometry.level();
  std::vector<Texel> found;
  std::unordered_set<std::size_t> seen;
  const auto take = [&](const Texel& t) {
    if (glm::distance(geometry.centre(t), middle) <= chord && seen.insert(index_of(level, t)).second)
      found.push_back(t);
  };
  for (const Texel& t : seeds) take(t);
  for (std::size_t k = 0; k < found.size(); ++k) {
    if (k % 4096 == 0) stop_point();
    const Texel t = found[k];
    for (int down = -1; down <= 1; ++down)
      for (int right = -1; right <= 1; ++right) take(texel_beside(level, t, right, down));
  }
  return found;
}

}  // namespace envmap

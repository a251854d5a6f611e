#include "envmap/operate/edges_meet.h"

#include <algorithm>
#include <cmath>

#include "envmap/operate/brightest.h"

namespace envmap {
namespace {

// From 0 to 1: how much two texels differ, however bright they are.
double contrast(const Level& level, const Texel& a, const Texel& b) {
  const double x = luminance_of(*level.texel(a.face, a.i, a.j)), y = luminance_of(*level.texel(b.face, b.i, b.j));
  return x + y > 0 ? std::min(1.0, std::abs(x - y) / (x + y)) : 0;
}

struct Contrasts {
  double over_edges = 0, inside = 0;
  double count = 0;

  // Of a texel at an edge, `right` and `down` pointing out of the face.
  void add(const Level& level, const Texel& at, int right, int down) {
    over_edges += contrast(level, at, texel_beside(level, at, right, down));
    inside += contrast(level, at, {at.face, at.i - right, at.j - down});
    ++count;
  }
};

}  // namespace

bool edges_meet(const Level& level) {
  constexpr int least = 16;
  const bool cube = level.projection() == Projection::cube;
  if (level.height() < least || !(cube || level.projection() == Projection::latlong)) return true;
  Contrasts all;
  for (int face = 0; face < level.faces(); ++face) {
    for (int i = 0; i < level.width(); ++i)
      for (const int j : {0, level.height() - 1}) all.add(level, {face, i, j}, 0, j == 0 ? -1 : 1);
    for (int j = 0; j < level.height(); ++j)
      for (const int i : {0, level.width() - 1}) all.add(level, {face, i, j}, i == 0 ? -1 : 1, 0);
  }
  // What is drawn or photographed all round differs over an edge as it does beside it.
  return all.over_edges <= 3 * all.inside + 0.05 * all.count;
}

}  // namespace envmap

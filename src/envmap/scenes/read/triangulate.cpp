#include "envmap/scenes/read/triangulate.h"

#include <fmt/format.h>

#include <cmath>
#include <deque>

#include "envmap/base/error.h"

namespace envmap {
namespace {

using Point = glm::vec<2, double, glm::highp>;
using Triangle = std::array<std::uint32_t, 3>;

// Twice the area of a triangle, positive where it goes round counter-clockwise.
double area(const Point& a, const Point& b, const Point& c) {
  return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// Dropping the coordinate along which the polygon is thinnest keeps its shape best; counter-clockwise from then on.
std::vector<Point> flattened(std::span<const Direction> corners) {
  const Direction normal = area_vector(corners), size = glm::abs(normal);
  const int drop = size.x > size.y && size.x > size.z ? 0 : size.y > size.z ? 1 : 2;
  const int u = (drop + 1) % 3, v = (drop + 2) % 3;
  const double turn = normal[drop] < 0 ? -1 : 1;
  std::vector<Point> flat;
  for (const Direction& c : corners) flat.emplace_back(c[u], turn * c[v]);
  return flat;
}

// The corners that are left, each knowing its neighbours.
struct Ring {
  const std::vector<Point>& points;
  std::vector<std::uint32_t> before, after;

  explicit Ring(const std::vector<Point>& p) : points(p), before(p.size()), after(p.size()) {
    const auto n = std::uint32_t(p.size());
    for (std::uint32_t k = 0; k < n; ++k) before[k] = (k + n - 1) % n, after[k] = (k + 1) % n;
  }
  [[nodiscard]] double turn(std::uint32_t k) const { return area(points[before[k]], points[k], points[after[k]]); }

  // The first corner from `j` on that lies in the triangle of corner k; before[k] where there is none. One that lies
  // where a corner of the triangle does is not in there: bridges to holes are like that.
  [[nodiscard]] std::uint32_t inside(std::uint32_t k, std::uint32_t j) const {
    const Point a = points[before[k]], b = points[k], c = points[after[k]];
    for (; j != before[k]; j = after[j]) {
      const Point p = points[j];
      if (p == a || p == b || p == c) continue;
      if (area(a, b, p) >= 0 && area(b, c, p) >= 0 && area(c, a, p) >= 0) break;
    }
    return j;
  }
};

// Ears are cut off until three corners are left. A corner is looked at again where its triangle has become another, or
// what lay in there was cut: the search then goes on where it stopped, so that all takes time with the square of the
// corners.
class EarCutter {
 public:
  explicit EarCutter(const std::vector<Point>& points) : ring_(points), blocks_(points.size()), gone_(points.size()) {
    for (std::uint32_t k = 0; k < points.size(); ++k) look_at(k);
  }

  std::vector<Triangle> triangles() {
    std::vector<Triangle> found;
    std::uint32_t any = 0;
    for (std::size_t left = ring_.points.size(); left >= 3; --left) {
      while (!ears_.empty() && !is_there(ears_.front())) ears_.pop_front();
      while (gone_[any]) ++any;
      // A polygon that crosses itself may have none: any corner does then.
      found.push_back(ears_.empty() ? triangle(any) : ears_.front());
      cut(found.back()[1]);
    }
    return found;
  }

 private:
  [[nodiscard]] Triangle triangle(std::uint32_t k) const { return {ring_.before[k], k, ring_.after[k]}; }
  [[nodiscard]] bool is_there(const Triangle& t) const { return !gone_[t[1]] && triangle(t[1]) == t; }
  void look_at(std::uint32_t k) { look_from(k, ring_.after[ring_.after[k]]); }
  void look_from(std::uint32_t k, std::uint32_t first) {
    if (!(ring_.turn(k) > 0)) return;
    const std::uint32_t blocker = ring_.inside(k, first);
    if (blocker == ring_.before[k])
      ears_.push_back(triangle(k));
    else
      blocks_[blocker].push_back(triangle(k));
  }
  void cut(std::uint32_t k) {
    gone_[k] = true;
    const std::uint32_t before = ring_.before[k], after = ring_.after[k];
    ring_.after[before] = after;
    ring_.before[after] = before;
    look_at(before);
    look_at(after);
    for (const Triangle& t : blocks_[k])
      if (is_there(t)) look_from(t[1], after);
  }

  Ring ring_;
  std::vector<std::vector<Triangle>> blocks_;  // The triangles that a corner was found in.
  std::vector<char> gone_;
  std::deque<Triangle> ears_;
};

bool is_convex(const Ring& ring) {
  double around = 0;  // What the edges turn by: once round in a convex polygon, twice in a star.
  for (std::uint32_t k = 0; k < ring.points.size(); ++k) {
    if (ring.turn(k) < 0) return false;
    const Point in = ring.points[k] - ring.points[ring.before[k]], out = ring.points[ring.after[k]] - ring.points[k];
    around += std::atan2(in.x * out.y - in.y * out.x, glm::dot(in, out));
  }
  return around < 3 * pi;
}

}  // namespace

Direction area_vector(std::span<const Direction> corners) {
  Direction sum(0);
  for (std::size_t k = 2; k < corners.size(); ++k)
    sum += glm::cross(corners[k - 1] - corners[0], corners[k] - corners[0]);
  return sum;
}

std::vector<Triangle> triangulate(std::span<const Direction> corners) {
  const auto count = std::uint32_t(corners.size());
  std::vector<Triangle> found;
  if (count == 3) return {{0, 1, 2}};
  const std::vector<Point> flat = flattened(corners);
  if (is_convex(Ring(flat))) {
    for (std::uint32_t k = 1; k + 1 < count; ++k) found.push_back({0, k, k + 1});
    return found;
  }
  if (count > max_concave_corners)
    throw InputError(
        fmt::format("a polygon of {} corners is not convex; such ones have {} at most", count, max_concave_corners));
  return EarCutter(flat).triangles();
}

}  // namespace envmap

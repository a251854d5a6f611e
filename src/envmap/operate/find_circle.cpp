// Three edge points at a time make a circle, and the circle with the longest edge along it is refined at twice the
// resolution again and again. This work is based on Fischler and Bolles 1981, "Random sample consensus".
#include "envmap/operate/find_circle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "envmap/base/parallel.h"
#include "envmap/maths/portable.h"

namespace envmap {
namespace {

constexpr int longest_side = 640;  // Of the picture in which circles are looked for.
constexpr std::size_t most_edges = 40000;
constexpr int pairs = 500000, thirds = 20, arcs = 64;
constexpr std::size_t most_work = 200000000;  // Edges that are held against circles.

// What belongs to a circle.
struct Tolerance {
  double pixels;  // From an edge to the circle.
  double cosine;  // Least, between its gradient and the radius.
};
constexpr Tolerance rough{1.5, 0.9}, fine{1, 0.95};

// Tones from 0 to 1.
struct Tones {
  int width, height;
  std::vector<float> values;

  [[nodiscard]] float at(int i, int j) const {
    return values[std::size_t(std::clamp(j, 0, height - 1)) * std::size_t(width) +
                  std::size_t(std::clamp(i, 0, width - 1))];
  }
  // Linear between the centres of pixels.
  [[nodiscard]] double at(double x, double y) const {
    const double left = std::floor(x - 0.5), top = std::floor(y - 0.5), a = x - 0.5 - left, b = y - 0.5 - top;
    const int i = int(left), j = int(top);
    return (1 - b) * ((1 - a) * at(i, j) + a * at(i + 1, j)) + b * ((1 - a) * at(i, j + 1) + a * at(i + 1, j + 1));
  }
  [[nodiscard]] bool holds(double x, double y) const { return x >= 0 && y >= 0 && x < width && y < height; }
};

// Half where luminance is the median of what is not black: suns and shadows both keep their edges.
Tones tones_of(const Level& photo) {
  Tones t{photo.width(), photo.height(), std::vector<float>(std::size_t(photo.width()) * std::size_t(photo.height()))};
  for_each_row(1, t.height, {}, [&](int, int j) {
    const std::span<const Colour> row = photo.row(0, j);
    for (std::size_t i = 0; i < row.size(); ++i)
      t.values[std::size_t(j) * row.size() + i] =
          std::max(0.0F, 0.2126F * row[i].x + 0.7152F * row[i].y + 0.0722F * row[i].z);
    photo.trim();
  });
  std::vector<float> some;
  for (std::size_t k = 0; k < t.values.size(); k += t.values.size() / 65536 + 1)
    if (t.values[k] > 0) some.push_back(t.values[k]);
  if (some.empty()) return t;
  const auto middle = some.begin() + std::ptrdiff_t(some.size() / 2);
  std::ranges::nth_element(some, middle);
  for (float& v : t.values) v /= v + *middle;
  return t;
}

Tones halved(const Tones& t) {
  Tones half{(t.width + 1) / 2, (t.height + 1) / 2, {}};
  half.values.reserve(std::size_t(half.width) * std::size_t(half.height));
  for (int j = 0; j < half.height; ++j)
    for (int i = 0; i < half.width; ++i)
      half.values.push_back(
          0.25F * (t.at(2 * i, 2 * j) + t.at(2 * i + 1, 2 * j) + t.at(2 * i, 2 * j + 1) + t.at(2 * i + 1, 2 * j + 1)));
  return half;
}

struct Edge {
  double x, y, dx, dy, strength;  // (dx, dy): the gradient, of length 1.
};

// By Sobel's differences: where the slope is the largest across the edge.
std::vector<Edge> edges_of(const Tones& t) {
  constexpr double least_strength = 0.01;
  Tones strength{t.width, t.height, std::vector<float>(t.values.size())};
  const auto slope = [&](int i, int j) {
    const auto across = [&](int di, int dj) {
      return t.at(i + di - dj, j + dj - di) + 2 * t.at(i + di, j + dj) + t.at(i + di + dj, j + dj + di);
    };
    return Point2(across(1, 0) - across(-1, 0), across(0, 1) - across(0, -1)) / 8.0;
  };
  for_each_row(1, t.height, {}, [&](int, int j) {
    for (int i = 0; i < t.width; ++i)
      strength.values[std::size_t(j) * std::size_t(t.width) + std::size_t(i)] = float(glm::length(slope(i, j)));
  });
  std::vector<Edge> edges;
  for (int j = 1; j + 1 < t.height; ++j)
    for (int i = 1; i + 1 < t.width; ++i) {
      const double here = strength.at(i, j);
      if (here < least_strength) continue;
      const Point2 g = slope(i, j) / here;
      const int di = int(std::lround(g.x)), dj = int(std::lround(g.y));
      const double after = strength.at(i + di, j + dj), before = strength.at(i - di, j - dj);
      if (here <= after || here < before) continue;
      const double peak = 0.5 * (before - after) / (before - 2 * here + after);
      edges.push_back({i + 0.5 + peak * di, j + 0.5 + peak * dj, g.x, g.y, here});
    }
  if (edges.size() > most_edges) {
    std::ranges::stable_sort(edges, std::greater(), &Edge::strength);
    edges.resize(most_edges);
  }
  return edges;
}

// How well the gradient of an edge points to or from a place: the square of the cosine.
double alignment(const Edge& e, double x, double y) {
  const double dx = e.x - x, dy = e.y - y, across = dx * e.dx + dy * e.dy;
  return across * across / std::max(1e-9, dx * dx + dy * dy);
}

std::optional<Circle> circle_through(const Edge& a, const Edge& b, const Edge& c) {
  const double bx = b.x - a.x, by = b.y - a.y, cx = c.x - a.x, cy = c.y - a.y, twice = 2 * (bx * cy - by * cx);
  if (std::abs(twice) < 1) return std::nullopt;
  const double bb = bx * bx + by * by, cc = cx * cx + cy * cy;
  const double x = (cy * bb - by * cc) / twice, y = (bx * cc - cx * bb) / twice;
  return Circle{a.x + x, a.y + y, std::sqrt(x * x + y * y)};
}

// A measure of the angle that needs no arctangent, from 0 to `arcs`: places on a square instead of a circle.
double arc_of(double dx, double dy) {
  const double p = dx / (std::abs(dx) + std::abs(dy));
  return 0.25 * arcs * (dy < 0 ? 3 + p : 1 - p);
}

// The part of the circle that each arc takes.
std::array<double, arcs> arc_widths() {
  std::array<double, arcs> widths{};
  const auto turn = [](int arc) {
    const double p = 1 - 4.0 * (arc % (arcs / 2)) / arcs;
    return portable::atan2(1 - std::abs(p), p) / (2 * pi);
  };
  for (int k = 0; k < arcs; ++k)
    widths[std::size_t(k)] = (k % (arcs / 2) == arcs / 2 - 1 ? 0.5 : turn(k + 1)) - turn(k);
  return widths;
}

// Part of a circle along which edges run. Each arc counts for what an unbroken edge has at most.
double support_of(const Circle& c, std::span<const Edge> edges, const Tolerance& most) {
  static const std::array<double, arcs> widths = arc_widths();
  std::array<int, arcs> found{};
  for (const Edge& e : edges) {
    const double dx = e.x - c.x, dy = e.y - c.y, squared = dx * dx + dy * dy;
    const double across = dx * e.dx + dy * e.dy;
    if (std::abs(squared - c.radius * c.radius) > 2 * most.pixels * c.radius) continue;
    if (across * across < most.cosine * most.cosine * squared) continue;
    ++found[std::size_t(std::clamp(int(arc_of(dx, dy)), 0, arcs - 1))];
  }
  // A slanted edge has a pixel for each sqrt(2) pixels of its length.
  const double unbroken = 2 * pi * c.radius / std::numbers::sqrt2;
  double sum = 0;
  for (std::size_t k = 0; k < arcs; ++k) sum += widths[k] * std::min(1.0, found[k] / (widths[k] * unbroken));
  return sum;
}

struct Candidate {
  Circle circle;
  double support;
};

double apart(const Circle& a, const Circle& b) { return portable::hypot(a.x - b.x, a.y - b.y); }
bool alike(const Circle& a, const Circle& b) {
  return apart(a, b) + std::abs(a.radius - b.radius) < 0.1 * std::max(a.radius, b.radius);
}
bool contains(const Circle& outer, const Circle& inner) {
  return apart(outer, inner) + inner.radius < 1.05 * outer.radius;
}

struct Refined {
  Circle circle;
  double spread;
};

// Where a radius in the direction (x, y) crosses the outline: `out` pixels beyond the circle.
struct Crossing {
  double x, y, out, strength;
};

// Along a radius, from `window` pixels inside the circle to as many outside: where the slope is the largest.
std::optional<Crossing> crossing_at(const Tones& t, const Circle& c, double turn, double window) {
  constexpr double step = 0.25, blur = 0.8;
  constexpr int reach = 8;
  const double dx = portable::cos_pi(2 * turn), dy = portable::sin_pi(2 * turn);
  const double first = c.radius - window - reach * step, last = c.radius + window + reach * step;
  if (!t.holds(c.x + dx * last, c.y + dy * last)) return std::nullopt;
  std::vector<double> tones, slopes;
  for (double r = first; r <= last; r += step) tones.push_back(t.at(c.x + dx * r, c.y + dy * r));
  std::array<double, reach + 1> weights{};
  for (int k = 1; k <= reach; ++k) {
    const double x = k * step / blur;
    weights[std::size_t(k)] = step * x * portable::exp(-0.5 * x * x);
  }
  for (std::size_t m = reach; m + reach < tones.size(); ++m) {
    double slope = 0;
    for (std::size_t k = 1; k <= reach; ++k) slope += weights[k] * (tones[m + k] - tones[m - k]);
    slopes.push_back(std::abs(slope));
  }
  const auto peak = std::size_t(std::ranges::max_element(slopes) - slopes.begin());
  if (peak == 0 || peak + 1 == slopes.size() || slopes[peak] < 1e-4) return std::nullopt;
  const double before = slopes[peak - 1], here = slopes[peak], after = slopes[peak + 1];
  const double off = 0.5 * (before - after) / (before - 2 * here + after);
  return Crossing{dx, dy, (double(peak) + off) * step - window, here};
}

// Where the outline crosses radii all round.
std::vector<Crossing> crossings(const Tones& t, const Circle& c, double window) {
  std::vector<Crossing> all;
  const int looks = std::clamp(int(2 * pi * c.radius), 64, 4096);
  for (int k = 0; k < looks; ++k)
    if (const auto crossing = crossing_at(t, c, (k + 0.5) / looks, window)) all.push_back(*crossing);
  return all;
}

// The standard deviation of normally distributed errors, by the median of their sizes.
double spread_of(std::span<const double> errors) {
  std::vector<double> sizes;
  for (const double e : errors) sizes.push_back(std::abs(e));
  std::ranges::nth_element(sizes, sizes.begin() + std::ptrdiff_t(sizes.size() / 2));
  return 1.4826 * sizes[sizes.size() / 2];
}

// One step of weighted least squares: how the middle's x and y and the radius move. Crossings beyond `reach` count
// nothing, those further out less (Tukey's weights). Nothing where the crossings lie on too short an arc.
std::optional<Direction> least_squares(std::span<const Crossing> crossings, std::span<const double> off, double reach) {
  Rotation squares(0);
  Direction sums(0);
  for (std::size_t k = 0; k < crossings.size(); ++k) {
    const double x = off[k] / reach;
    if (std::abs(x) >= 1) continue;
    const double weight = (1 - x * x) * (1 - x * x) * std::min(crossings[k].strength, 0.1);
    const Direction way(crossings[k].x, crossings[k].y, 1);
    squares += weight * glm::outerProduct(way, way), sums += weight * off[k] * way;
  }
  if (glm::determinant(squares) < 1e-12) return std::nullopt;
  return glm::inverse(squares) * sums;
}

// A circle moved to the outline that lies within `window` pixels of it.
Refined refine(const Tones& t, Circle c, double window) {
  const std::vector<Crossing> outline = crossings(t, c, window);
  Refined best{c, window};
  if (outline.size() < 16) return best;
  Direction moved(0);  // The middle's x and y, and the radius.
  std::vector<double> off(outline.size());
  for (int round = 0; round < 20; ++round) {
    for (std::size_t k = 0; k < outline.size(); ++k)
      off[k] = outline[k].out - glm::dot(moved, Direction(outline[k].x, outline[k].y, 1));
    best.spread = spread_of(off);
    const auto step = least_squares(outline, off, std::clamp(3 * best.spread, 0.5, window));
    if (!step) return best;
    moved += *step;
  }
  best.circle = {c.x + moved.x, c.y + moved.y, c.radius + moved.z};
  return best;
}

// Whether the gradients of two edges may be radii of one circle: mirrored to each other about the chord's bisector.
bool on_one_circle(const Edge& a, const Edge& b) {
  constexpr double most_off = 0.25;
  const Point2 chord(b.x - a.x, b.y - a.y);
  const double length = glm::length(chord);
  if (length < 4) return false;
  const Point2 u = chord / length, n(-u.y, u.x), of_a(a.dx, a.dy), of_b(b.dx, b.dy);
  const double sign = glm::dot(of_a, n) * glm::dot(of_b, n) < 0 ? 1 : -1;
  return std::abs(glm::dot(of_a, u) - sign * glm::dot(of_b, u)) < most_off;
}

// Circles through three edges, all of which run along them.
template <class F>
void for_likely_circles(const Tones& t, std::span<const Edge> edges, const F& f) {
  std::mt19937 random(1981);
  const auto any = [&]() -> const Edge& { return edges[random() % edges.size()]; };
  constexpr double least = 6, aligned = 0.95 * 0.95;
  const double most = 0.6 * portable::hypot(t.width, t.height);
  for (int pair = 0; pair < pairs; ++pair) {
    const Edge &a = any(), &b = any();
    if (!on_one_circle(a, b)) continue;
    for (int third = 0; third < thirds; ++third) {
      const Edge& c = any();
      const std::optional<Circle> circle = circle_through(a, b, c);
      if (!circle || !(circle->radius > least && circle->radius < most) || !t.holds(circle->x, circle->y)) continue;
      const auto along = [&](const Edge& e) { return alignment(e, circle->x, circle->y) >= aligned; };
      if (along(a) && along(b) && along(c) && !f(*circle)) return;
    }
  }
}

void sort_by_support(std::vector<Candidate>& all) {
  std::ranges::stable_sort(all, std::greater(), &Candidate::support);
}

// Circles through edges that are unlike each other, the best first.
std::vector<Candidate> rough_candidates(const Tones& t, std::span<const Edge> edges) {
  constexpr double least_support = 0.2;
  std::vector<Candidate> best;
  std::size_t work = 0;
  for_likely_circles(t, edges, [&](const Circle& circle) {
    const Candidate found{circle, support_of(circle, edges, rough)};
    const auto like = std::ranges::find_if(best, [&](const Candidate& x) { return alike(x.circle, circle); });
    if (found.support >= least_support && like == best.end())
      best.push_back(found);
    else if (like != best.end() && like->support < found.support)
      *like = found;
    return (work += edges.size()) < most_work;
  });
  sort_by_support(best);
  return best;
}

std::vector<Candidate> candidates(const Tones& t, std::span<const Edge> edges) {
  constexpr std::size_t most_refined = 48;
  std::vector<Candidate> best = rough_candidates(t, edges);
  best.resize(std::min(best.size(), most_refined));
  for (Candidate& c : best) {
    c.circle = refine(t, refine(t, c.circle, 4).circle, 2).circle;
    c.support = support_of(c.circle, edges, fine);
  }
  sort_by_support(best);
  return best;
}

Circle scaled(const Circle& c, double k) { return {k * c.x, k * c.y, k * c.radius}; }

constexpr double almost = 0.75;  // Of the best support: a circle that may be meant as well.

// The best circle, or one around it that is almost as good: a ball's rim, not a reflection's.
Candidate outermost(std::span<const Candidate> found) {
  Candidate best = found.front();
  for (const Candidate& c : found)
    if (c.support > almost * found.front().support && contains(c.circle, best.circle)) best = c;
  return best;
}

// A circle elsewhere that is almost as good.
std::optional<Circle> rival_of(const Candidate& best, std::span<const Candidate> found) {
  for (const Candidate& c : found)
    if (c.support > almost * best.support && !alike(c.circle, best.circle) && !contains(c.circle, best.circle) &&
        !contains(best.circle, c.circle))
      return c.circle;
  return std::nullopt;
}

}  // namespace

bool FoundCircle::sure() const { return support >= 0.5 && spread <= std::max(0.6, 0.002 * circle.radius) && !rival; }

std::optional<FoundCircle> find_circle(const Level& photo) {
  std::vector<Tones> levels;
  levels.push_back(tones_of(photo));
  while (std::max(levels.back().width, levels.back().height) > longest_side) levels.push_back(halved(levels.back()));
  const std::vector<Edge> edges = edges_of(levels.back());
  if (edges.size() < 16) return std::nullopt;
  const std::vector<Candidate> found = candidates(levels.back(), edges);
  if (found.empty()) return std::nullopt;
  const Candidate best = outermost(found);
  FoundCircle result{.circle = best.circle, .support = best.support, .spread = 0, .rival = {}};
  if (const auto rival = rival_of(best, found)) result.rival = scaled(*rival, double(1 << (levels.size() - 1)));
  for (std::size_t k = levels.size(); k-- > 0;) {
    if (k + 1 < levels.size()) result.circle = scaled(result.circle, 2);
    const Refined refined = refine(levels[k], refine(levels[k], result.circle, 3).circle, 2);
    result.circle = refined.circle, result.spread = refined.spread;
  }
  return result;
}

}  // namespace envmap

#include "envmap/light/disc_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "envmap/base/stop_point.h"
#include "envmap/maths/portable.h"

namespace envmap {
namespace {

constexpr double nothing = std::numeric_limits<double>::infinity();

double chord_of(double angle) { return 2 * portable::sin(0.5 * angle); }

// Directions near the middle of a patch by two coordinates.
struct Tangent {
  Direction middle, across, up;

  explicit Tangent(const Direction& m)
      : middle(m),
        across(glm::normalize(glm::cross(std::abs(m.y) < 0.7 ? Direction(0, 1, 0) : Direction(1, 0, 0), m))),
        up(glm::cross(m, across)) {}

  [[nodiscard]] Direction at(double x, double y) const { return glm::normalize(middle + x * across + y * up); }
  [[nodiscard]] Point2 of(const Direction& d) const {
    const double z = glm::dot(d, middle);
    return {glm::dot(d, across) / z, glm::dot(d, up) / z};
  }
};

// Solves the normal equations of a few discs, or says that they have no solution. Gauss, largest pivot first.
bool solve(std::vector<std::vector<double>>& a, std::vector<double>& b) {
  const std::size_t n = b.size();
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t pivot = k;
    for (std::size_t j = k + 1; j < n; ++j)
      if (std::abs(a[j][k]) > std::abs(a[pivot][k])) pivot = j;
    if (!(std::abs(a[pivot][k]) > 1e-30)) return false;
    std::swap(a[k], a[pivot]), std::swap(b[k], b[pivot]);
    for (std::size_t j = k + 1; j < n; ++j) {
      const double f = a[j][k] / a[k][k];
      for (std::size_t i = k; i < n; ++i) a[j][i] -= f * a[k][i];
      b[j] -= f * b[k];
    }
  }
  for (std::size_t k = n; k-- > 0;) {
    for (std::size_t i = k + 1; i < n; ++i) b[k] -= a[k][i] * b[i];
    b[k] /= a[k][k];
  }
  return true;
}

// Discs as numbers that a search moves: x, y and radius of each.
class Search {
 public:
  Search(const Patch& patch, std::span<const Disc> first) : patch_(patch), tangent_(patch.middle()) {
    for (const Disc& d : first) {
      const Point2 at = tangent_.of(d.towards);
      now_.numbers.insert(now_.numbers.end(), {at.x, at.y, d.radius});
    }
    for (std::size_t t = 0; t < patch.size(); ++t)
      power_ += patch.weight()[t] * patch.luminance()[t] * patch.luminance()[t];
    evaluate(now_);
  }

  // Levenberg 1944 and Marquardt 1963: Gauss and Newton's steps, shorter where they do not help.
  // @param moves which numbers may move.
  void run(const std::vector<char>& moves) {
    constexpr int most = 60;
    double damping = 1e-3;
    Normal equations = normal_equations(moves);
    for (int step = 0; step < most && damping < 1e4; ++step) {
      stop_point();
      State next = now_;
      const double moved = move(next, equations, moves, damping);
      evaluate(next);
      if (!(next.misfit < now_.misfit)) {
        damping *= 8;
        continue;
      }
      const bool little = now_.misfit - next.misfit < 1e-9 + 1e-4 * next.misfit && moved < 1e-3 * patch_.texel();
      now_ = std::move(next), damping = std::max(1e-9, damping * 0.2);
      if (little) return;
      equations = normal_equations(moves);
    }
  }

  void set_radius(std::size_t disc, double radius) {
    now_.numbers[3 * disc + 2] = radius;
    evaluate(now_);
  }

  // What is left over, squared, once a disc is moved.
  [[nodiscard]] double misfit_beside(std::size_t disc, const Point2& by) const {
    State moved = now_;
    moved.numbers[3 * disc] += by.x, moved.numbers[3 * disc + 1] += by.y;
    evaluate(moved);
    return moved.misfit;
  }

  [[nodiscard]] double squared_misfit() const { return now_.misfit; }
  [[nodiscard]] Disc disc(std::size_t k) const {
    return {tangent_.at(now_.numbers[3 * k], now_.numbers[3 * k + 1]), now_.numbers[3 * k + 2], now_.luminance[k]};
  }
  [[nodiscard]] DiscFit result() const {
    DiscFit fit{.discs = {}, .misfit = std::sqrt(std::max(0.0, now_.misfit))};
    for (std::size_t k = 0; k < now_.covered.size(); ++k) fit.discs.push_back(disc(k));
    return fit;
  }

 private:
  using Numbers = std::vector<double>;
  struct State {
    Numbers numbers, luminance;
    std::vector<Numbers> covered;  // The part of each texel, by disc.
    double misfit = nothing;       // Squared.
  };
  struct Normal {
    std::vector<Numbers> products;
    Numbers right;
  };

  [[nodiscard]] Numbers covered(const Numbers& numbers, std::size_t disc) const {
    return patch_.coverage(tangent_.at(numbers[3 * disc], numbers[3 * disc + 1]), numbers[3 * disc + 2]);
  }

  // With the best luminances. Infinite where one of them is not above 0.
  void evaluate(State& state) const {
    const std::size_t n = state.numbers.size() / 3;
    state.misfit = nothing;
    state.luminance.assign(n, 0);
    state.covered.clear();
    for (std::size_t k = 0; k < n; ++k) {
      if (!(state.numbers[3 * k + 2] > 0)) return;
      state.covered.push_back(covered(state.numbers, k));
    }
    std::vector<Numbers> products(n, Numbers(n));
    Numbers sums(n);
    for (std::size_t t = 0; t < patch_.size(); ++t)
      for (std::size_t a = 0; a < n; ++a) {
        const double ca = patch_.weight()[t] * state.covered[a][t];
        if (ca == 0) continue;
        sums[a] += ca * patch_.luminance()[t];
        for (std::size_t b = 0; b < n; ++b) products[a][b] += ca * state.covered[b][t];
      }
    const Numbers right = sums;
    if (!solve(products, sums)) return;
    double explained = 0;
    for (std::size_t a = 0; a < n; ++a) {
      if (!(sums[a] > 0)) return;
      explained += sums[a] * right[a];
    }
    state.luminance = sums;
    if (power_ > 0) state.misfit = 1 - explained / power_;
  }

  // Of the numbers that move, and of the luminances after them. Slopes are differences over a part of a texel.
  [[nodiscard]] Normal normal_equations(const std::vector<char>& moves) const {
    const std::size_t discs = now_.covered.size();
    std::vector<Numbers> columns;
    for (std::size_t k = 0; k < now_.numbers.size(); ++k) {
      if (!moves[k]) continue;
      const double step = std::min(0.02 * patch_.texel(), 0.1 * now_.numbers[k / 3 * 3 + 2]);
      Numbers more = now_.numbers, less = now_.numbers;
      more[k] += step, less[k] -= step;
      Numbers slope = covered(more, k / 3);
      const Numbers before = covered(less, k / 3);
      for (std::size_t t = 0; t < slope.size(); ++t)
        slope[t] = now_.luminance[k / 3] * (slope[t] - before[t]) / (2 * step);
      columns.push_back(std::move(slope));
    }
    columns.insert(columns.end(), now_.covered.begin(), now_.covered.end());
    Normal normal{std::vector<Numbers>(columns.size(), Numbers(columns.size())), Numbers(columns.size())};
    for (std::size_t t = 0; t < patch_.size(); ++t) {
      double left = patch_.luminance()[t];
      for (std::size_t k = 0; k < discs; ++k) left -= now_.luminance[k] * now_.covered[k][t];
      for (std::size_t a = 0; a < columns.size(); ++a) {
        const double ca = patch_.weight()[t] * columns[a][t];
        if (ca == 0) continue;
        normal.right[a] += ca * left;
        for (std::size_t b = 0; b < columns.size(); ++b) normal.products[a][b] += ca * columns[b][t];
      }
    }
    return normal;
  }

  // @return the longest step of a number.
  double move(State& next, const Normal& normal, const std::vector<char>& moves, double damping) const {
    std::vector<Numbers> products = normal.products;
    Numbers steps = normal.right;
    for (std::size_t a = 0; a < steps.size(); ++a) products[a][a] *= 1 + damping;
    if (!solve(products, steps)) return 0;
    double longest = 0;
    for (std::size_t k = 0, a = 0; k < next.numbers.size(); ++k) {
      if (!moves[k]) continue;
      const double most = std::max(patch_.texel(), 0.5 * next.numbers[k / 3 * 3 + 2]);
      const double step = std::clamp(steps[a++], -most, most);
      next.numbers[k] += step;
      longest = std::max(longest, std::abs(step));
    }
    return longest;
  }

  const Patch& patch_;
  Tangent tangent_;
  State now_;
  double power_ = 0;
};

// How far a disc may move in one of eight ways before it explains less than is allowed.
double freedom(const Search& search, std::size_t disc, double allowed, double texel) {
  double farthest = 0;
  for (int way = 0; way < 8; ++way) {
    const Point2 along{portable::cos_pi(way / 4.0), portable::sin_pi(way / 4.0)};
    double step = texel / 256;
    while (step < 16 * texel && search.misfit_beside(disc, step * along) <= allowed) {
      farthest = std::max(farthest, step);
      step *= 1.4;
    }
  }
  return farthest;
}

}  // namespace

Patch::Patch(TexelGeometry& geometry, std::vector<Texel> texels, std::vector<double> luminance, const Direction& middle,
             double radius)
    : texels_(std::move(texels)), luminance_(std::move(luminance)), middle_(middle), texel_(0) {
  constexpr int most = 24;
  const Level& level = geometry.level();
  std::vector<Point2> points;
  std::vector<Direction> found;
  std::vector<double> density;
  double nearest = nothing;
  for (const Texel& t : texels_) {
    const TexelGeometry::Extent extent = geometry.extent(t);
    const auto cuts = [&](double side) { return std::clamp(int(std::ceil(12 * side / radius)), 1, most); };
    const int across = cuts(extent.u), down = cuts(extent.v);
    points.clear();
    for (int j = 0; j < down; ++j)
      for (int i = 0; i < across; ++i)
        points.push_back({(t.i + (i + 0.5) / across) / level.width(), (t.j + (j + 0.5) / down) / level.height()});
    found.resize(points.size()), density.resize(points.size());
    directions(level.projection(), t.face, points, found);
    densities(level.projection(), points, density);
    first_part_.push_back(parts_.size());
    for (std::size_t k = 0; k < points.size(); ++k)
      if (density[k] > 0) parts_.push_back({found[k], density[k]});
    weight_.push_back(geometry.solid_angle(t));
    centre_.push_back(geometry.centre(t));
    reach_.push_back(1.05 * extent.reach);
    const std::size_t count = std::max<std::size_t>(1, parts_.size() - first_part_.back());
    step_.push_back(std::sqrt(weight_.back() / double(count)));
    if (const double away = glm::distance(centre_.back(), middle_); away < nearest)
      nearest = away, texel_ = extent.longest();
  }
  first_part_.push_back(parts_.size());
}

std::vector<double> Patch::coverage(const Direction& towards, double radius) const {
  std::vector<double> covered(texels_.size());
  const double rim = chord_of(radius);
  for (std::size_t t = 0; t < texels_.size(); ++t) {
    const double away = glm::distance(centre_[t], towards);
    if (away > rim + reach_[t] + step_[t]) continue;
    if (away + reach_[t] + step_[t] < rim) {
      covered[t] = 1;
      continue;
    }
    double inside = 0, all = 0;
    for (std::size_t k = first_part_[t]; k < first_part_[t + 1]; ++k) {
      const Part& p = parts_[k];
      inside += p.weight * std::clamp(0.5 + (rim - glm::distance(p.towards, towards)) / step_[t], 0.0, 1.0);
      all += p.weight;
    }
    if (all > 0) covered[t] = inside / all;
  }
  return covered;
}

DiscFit fit_discs(const Patch& patch, std::span<const Disc> first) {
  Search search(patch, first);
  search.run(std::vector<char>(3 * first.size(), 1));
  return search.result();
}

DiscDoubt doubt_of(const Patch& patch, const DiscFit& fit, std::size_t k, double likely_radius) {
  // What rounding, cuts of texels and the light itself leave unexplained, and a little more, is no evidence.
  const double allowed = fit.misfit * fit.misfit * 1.05 + 1e-5;
  std::vector<char> moves(3 * fit.discs.size(), 0);
  moves[3 * k] = moves[3 * k + 1] = 1;
  const auto with_radius = [&](double radius) {
    Search search(patch, fit.discs);
    search.set_radius(k, radius);
    search.run(moves);
    return search;
  };
  const auto explains = [&](double radius) { return with_radius(radius).squared_misfit() <= allowed; };
  // The end of the radii that explain the texels, between one that does and one that does not.
  const auto end_between = [&](double does, double does_not) {
    for (int step = 0; step < 7; ++step) {
      const double middle = 0.5 * (does + does_not);
      (explains(middle) ? does : does_not) = middle;
    }
    return does;
  };
  const double best = fit.discs[k].radius, point = 0.05 * patch.texel();
  DiscDoubt doubt;
  double too_large = best + 0.25 * patch.texel(), least = best;
  for (double step = 0.25 * patch.texel(); explains(too_large) && too_large < 0.5; step *= 2) too_large += step;
  doubt.largest_radius = end_between(best, too_large);
  doubt.radius_is_open = explains(point);
  least = doubt.radius_is_open ? point : end_between(best, point);
  doubt.least_radius = doubt.radius_is_open ? 0 : least;
  const bool is_likely = likely_radius >= least && likely_radius <= doubt.largest_radius;
  const Search likely = with_radius(is_likely ? likely_radius : doubt.radius_is_open ? doubt.largest_radius : best);
  doubt.likely = likely.disc(k);
  for (const double radius : {least, doubt.likely.radius, doubt.largest_radius}) {
    const Search other = with_radius(radius);
    doubt.within = std::max(doubt.within, glm::distance(other.disc(k).towards, doubt.likely.towards) +
                                              freedom(other, k, allowed, patch.texel()));
  }
  return doubt;
}

}  // namespace envmap

// The integral along a border: sides are cut where they cross the horizon and graded where the lobe is steep, and each
// part is halved until Gauss's rule of five points agrees with that of its halves.
#include "envmap/prefilter/lobe_in_rectangle.h"

#include <algorithm>
#include <cmath>

#include "envmap/prefilter/lobe_formulas.h"

namespace envmap::prefiltering {
namespace {

// Whether a direction is outside a rectangle, and not by rounding.
template <class P>
bool is_outside(const Direction& r, int face, const Rect& rect) {
  constexpr double rounding = 1e-12;
  const auto beyond = [](double x, double low, double high, double margin) {
    return x < low - margin || x > high + margin;
  };
  if constexpr (std::is_same_v<P, Latlong>) {
    const Location<double> at = P::locate(r);
    const double margin = rounding / std::max(rounding, portable::sin_pi(at.v));
    const bool at_seam = at.u < margin || at.u > 1 - margin;
    return beyond(at.v, rect.v0, rect.v1, rounding) || (!at_seam && beyond(at.u, rect.u0, rect.u1, margin));
  } else {
    if (glm::dot(r, P::axes[std::size_t(face)].forward) <= 0) return true;
    const Location<double> at = P::continued(face, r);
    return beyond(at.u, rect.u0, rect.u1, rounding) || beyond(at.v, rect.v0, rect.v1, rounding);
  }
}

// One direction's integral round a border.
template <class P, class L>
class RoundBorder {
 public:
  RoundBorder(const L& lobe, const Direction& r, int face, const Rect& rect)
      : lobe_(lobe), r_(r), face_(face), near_(!is_outside<P>(r, face, rect)) {}

  [[nodiscard]] double operator()(const Border<P>& border, double solid_angle, double bounding_radius,
                                  double nearest) const {
    thread_local std::vector<Part> parts;
    parts.clear();
    for (const auto& edge : border.edges) add(edge, parts);
    // Where the horizon leaves only a corner, the points may see nothing. The most that can be there counts a little.
    double scale = 1e-3 * bounding_radius * (near_ ? 1 : lobe_.missing(nearest));
    for (const Part& part : parts) scale += std::abs(part.whole);
    // The sides may cancel: what is left counts beside the mean of the source, of which no texel holds more than 4 pi
    // steradians, and errors are counted from a thousandth of that. Below 1e-14 rounding takes over.
    const double tolerance = std::clamp(5e-11 * solid_angle, 1e-14 * scale, 1e-8 * scale);
    double sum = 0;
    for (const Part& part : parts) add_integral(part, tolerance, sum);
    return std::max(0.0, border.right_handed ? sum : -sum);
  }

 private:
  // A part of a side with its integral, and perhaps that of its halves.
  struct Part {
    Side side;
    double whole, first = 0, second = 0;
    bool halved = false;
  };

  // The integrand: S d(azimuth) = S / sin^2 x det(r, l, dl). Outside a rectangle the azimuths of its border add up to
  // 0, so that S - 1 does as well, and keeps its digits in the tail of a lobe.
  [[nodiscard]] double at(const BorderPoint& p) const {
    const double x = versine(r_, p.l);
    if (x < 1e-300) return 0;
    return (near_ ? lobe_.share(x) : -lobe_.missing(x)) / (2 * pi * x * (2 - x)) * glm::dot(r_, p.turn);
  }
  [[nodiscard]] double gauss(const Side& side, double from, double to) const {
    return quadrature::line<Border<P>::nodes>(from, to, [&](double w) { return at(border_point<P>(face_, side, w)); });
  }
  [[nodiscard]] double gauss(const typename Border<P>::Rule& points, double length) const {
    double sum = 0;
    for (std::size_t n = 0; n < points.size(); ++n)
      sum += quadrature::rule<Border<P>::nodes>().weight[n] * at(points[n]);
    return 0.5 * length * sum;
  }

  // Adds the parts of a side. They end where it crosses the horizon, as points could miss a short part above it.
  void add(const typename Border<P>::Edge& edge, std::vector<Part>& parts) const {
    const Side& side = edge.side;
    const auto above = [&](const Direction& l) { return glm::dot(r_, l) > 0; };
    const bool first = above(edge.along[0]);
    if (std::ranges::all_of(edge.along, [&](const Direction& l) { return above(l) == first; })) {
      const double length = side.to - side.from, nearest = first ? nearest_place(side) : side.from;
      if (first && (is_steep(side, nearest, side.from) || is_steep(side, nearest, side.to)))
        add_graded(side, nearest, parts);
      else if (first || near_)
        parts.push_back({side, gauss(edge.rules[0], length), gauss(edge.rules[1], 0.5 * length),
                         gauss(edge.rules[2], 0.5 * length), true});
      return;
    }
    Side rest = side;
    constexpr auto steps = Border<P>::steps;
    for (std::size_t k = 0; k < steps; ++k) {
      const bool before = above(edge.along[k]);
      if (above(edge.along[k + 1]) == before) continue;
      const double w = crossing(side, side.at(double(k) / steps), side.at((k + 1.0) / steps));
      // A crossing next to an end would leave a sliver.
      const double least = 1e-6 * std::abs(side.to - side.from);
      if (std::abs(w - rest.from) <= least || std::abs(w - side.to) <= least) continue;
      parts.push_back({{side.along_u, side.fixed, rest.from, w}, gauss(side, rest.from, w)});
      rest.from = w;
    }
    parts.push_back({rest, gauss(rest, rest.from, rest.to)});
  }
  // Adds parts that grow with their distance from the nearest place: points then resolve a lobe much narrower than the
  // side.
  void add_graded(const Side& side, double nearest, std::vector<Part>& parts) const {
    for (const bool forwards : {false, true}) {
      double far = forwards ? side.to : side.from;
      const auto add = [&](double from, double to) {
        const Side part{side.along_u, side.fixed, forwards ? from : to, forwards ? to : from};
        parts.push_back({part, gauss(part, part.from, part.to)});
      };
      for (int k = 0; k < 48 && is_steep(side, nearest, far); ++k) {
        const double middle = 0.5 * (nearest + far);
        add(middle, far);
        far = middle;
      }
      if (far != nearest) add(nearest, far);
    }
  }
  [[nodiscard]] double versine_at(const Side& side, double w) const {
    return versine(r_, side.template direction<P>(face_, w));
  }
  // Whether the lobe beyond a place is a small part of the lobe beyond a nearer place.
  [[nodiscard]] bool is_steep(const Side& side, double near, double far) const {
    return lobe_.missing(versine_at(side, far)) < 0.05 * lobe_.missing(versine_at(side, near));
  }
  // The place nearest to the lobe's middle: vertices of parabolas through three points, over less and less of the side.
  [[nodiscard]] double nearest_place(const Side& side) const {
    const double low = std::min(side.from, side.to), high = std::max(side.from, side.to);
    double at = 0.5 * (low + high), h = 0.5 * (high - low);
    for (int k = 0; k < 3; ++k, h /= 32) {
      const double before = versine_at(side, at - h), here = versine_at(side, at), after = versine_at(side, at + h);
      const double bend = before - 2 * here + after;
      if (bend > 0) at = std::clamp(at + 0.5 * h * (before - after) / bend, low, high);
    }
    return at;
  }
  // The place where a side crosses the horizon, by false position with halved weights of an end that stays (Illinois
  // method: Dowell and Jarratt 1971).
  [[nodiscard]] double crossing(const Side& side, double low, double high) const {
    const auto height = [&](double w) { return glm::dot(r_, side.template direction<P>(face_, w)); };
    double at_low = height(low), at_high = height(high);
    for (int step = 0; step < 45 && at_low != at_high; ++step) {
      const double w = high - at_high * (high - low) / (at_high - at_low), at = height(w);
      if (std::abs(at) < 1e-16) return w;
      if ((at > 0) == (at_high > 0)) {
        at_low *= 0.5;
      } else {
        low = high, at_low = at_high;
      }
      high = w, at_high = at;
    }
    return high;
  }
  void add_integral(const Part& p, double tolerance, double& sum) const {
    const Side& s = p.side;
    if (p.halved)
      add_halves(s, s.from, s.to, p.whole, p.first, p.second, tolerance, 16, sum);
    else
      add_integral(s, s.from, s.to, p.whole, tolerance, 16, sum);
  }
  void add_integral(const Side& side, double from, double to, double whole, double tolerance, int depth,
                    double& sum) const {
    const double middle = 0.5 * (from + to);
    add_halves(side, from, to, whole, gauss(side, from, middle), gauss(side, middle, to), tolerance, depth, sum);
  }
  void add_halves(const Side& side, double from, double to, double whole, double first, double second, double tolerance,
                  int depth, double& sum) const {
    const double middle = 0.5 * (from + to), change = std::abs(first + second - whole);
    if (depth == 0 || change <= tolerance) {
      sum += first + second;
      return;
    }
    add_integral(side, from, middle, first, tolerance, depth - 1, sum);
    add_integral(side, middle, to, second, tolerance, depth - 1, sum);
  }

  const L& lobe_;
  const Direction& r_;
  int face_;
  bool near_;
};

}  // namespace

template <class P, class L>
double integral_round(const Border<P>& border, const L& lobe, const Direction& r, int face, const Rect& rect,
                      double solid_angle, double bounding_radius, double nearest) {
  return RoundBorder<P, L>(lobe, r, face, rect)(border, solid_angle, bounding_radius, nearest);
}

#define ENVMAP_ROUND(P, L)                                                                                             \
  template double integral_round<P, L>(const Border<P>&, const L&, const Direction&, int, const Rect&, double, double, \
                                       double)
ENVMAP_ROUND(Latlong, Cosine);
ENVMAP_ROUND(Latlong, Phong);
ENVMAP_ROUND(Latlong, Ggx);
ENVMAP_ROUND(Latlong, BlinnPhong);
ENVMAP_ROUND(Latlong, Charlie);
ENVMAP_ROUND(Cube, Cosine);
ENVMAP_ROUND(Cube, Phong);
ENVMAP_ROUND(Cube, Ggx);
ENVMAP_ROUND(Cube, BlinnPhong);
ENVMAP_ROUND(Cube, Charlie);

}  // namespace envmap::prefiltering

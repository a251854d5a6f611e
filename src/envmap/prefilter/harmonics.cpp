// Projection of a map onto spherical harmonics: texels of cubes by Gauss points, rows of latlong maps by closed forms
// in longitude. Convolution and evaluation of the coefficients.
#include "envmap/prefilter/harmonics.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>

#include "envmap/base/error.h"
#include "envmap/base/parallel.h"
#include "envmap/base/run_operation.h"
#include "envmap/maths/check_direction.h"
#include "envmap/maths/compensated_sum.h"
#include "envmap/maths/portable.h"
#include "envmap/maths/quadrature.h"
#include "envmap/operate/refuse_flaws.h"
#include "envmap/prefilter/cell_moments.h"
#include "envmap/prefilter/lobe_formulas.h"
#include "envmap/prefilter/source_cube.h"
#include "envmap/prefilter/tabulated/table_lobe.h"
#include "envmap/projection/visit.h"

namespace envmap {
namespace {

struct Recursion {
  int order;
  std::vector<legendre::Step> steps;  // At l (l + 1) / 2 + m.

  explicit Recursion(int n) : order(n) {
    for (int l = 0; l <= n; ++l)
      for (int m = 0; m <= l; ++m) steps.push_back(l > m ? legendre::step(l, m) : legendre::Step{});
  }

  // f(index, value) for every harmonic. The sectoral functions carry sin^m with cos and sin of m times the longitude as
  // powers of (z + i x): nothing is divided by, at the poles neither.
  template <class F>
  void each(const Direction& d, F&& f) const {
    double cosine = 1, sine = 0, sectoral = legendre::first();
    for (int m = 0; m <= order; ++m) {
      double before = 0, now = sectoral;
      for (int l = m; l <= order; ++l) {
        if (l > m) {
          const auto [a, b] = steps[std::size_t(l * (l + 1) / 2 + m)];
          const double next = a * (d.y * now - b * before);
          before = now;
          now = next;
        }
        f(l * (l + 1) + m, now * cosine);
        if (m > 0) f(l * (l + 1) - m, now * sine);
      }
      const double c = cosine * d.z - sine * d.x;
      sine = cosine * d.x + sine * d.z;
      cosine = c;
      sectoral *= legendre::diagonal(m) * (m == 0 ? std::sqrt(2.0) : 1);
    }
  }
};

template <class P>
std::vector<Flux> row_of(const Level& level, const Recursion& recursion, const Rotation& to_world, int face, int row) {
  std::vector<Flux> sums(std::size_t((recursion.order + 1) * (recursion.order + 1)), Flux(0));
  const double w = level.width(), h = level.height();
  for (int i = 0; i < level.width(); ++i) {
    const Flux radiance(*level.texel(face, i, row));
    if (radiance == Flux(0)) continue;
    // Four Gauss points integrate harmonics of degree l over a texel to (l x side)^4 / 4320.
    prefiltering::for_points<P>(face, texel_rect(i, row, w, h), 0.4 / (1 + recursion.order),
                                [&](const Direction& d, double weight) {
                                  const Flux part = weight * radiance;
                                  recursion.each(to_world * d,
                                                 [&](int k, double y) { sums[std::size_t(k)] += y * part; });
                                });
  }
  return sums;
}

// Harmonics are products of a function of longitude and one of latitude, so a latlong row is summed along its
// longitudes first.
class LatlongRows {
 public:
  LatlongRows(const Level& level, const Recursion& recursion, const Rotation& to_world)
      : level_(level), recursion_(recursion), width_((std::size_t(level.width()) + lanes - 1) / lanes * lanes) {
    // Longitude from +Z to +X over pi: of the image's middle, and of the left edge of texel i.
    const double middle = portable::atan2(to_world[2].x, to_world[2].z) / pi;
    const auto edge = [&](int i) { return middle + 1 - 2.0 * i / level.width(); };
    for (int m = 0; m <= recursion.order; ++m) {
      std::vector<double> c(width_, 0), s(width_, 0);
      for (int i = 0; i < level.width(); ++i) {
        const double left = m * edge(i), right = m * edge(i + 1);
        c[i] = m == 0 ? 2 * pi / level.width() : (portable::sin_pi(left) - portable::sin_pi(right)) / m;
        s[i] = m == 0 ? 0 : (portable::cos_pi(right) - portable::cos_pi(left)) / m;
      }
      cosines_.push_back(std::move(c)), sines_.push_back(std::move(s));
    }
    for (int l = 0; l <= recursion.order; ++l)
      for (int m = -l; m <= l; ++m) sectors_.push_back(m);
  }

  [[nodiscard]] std::vector<Flux> operator()(int row) const {
    std::array<std::vector<double>, 3> channels;
    for (int c = 0; c < 3; ++c) {
      channels[c].assign(width_, 0);
      for (int i = 0; i < level_.width(); ++i) channels[c][i] = (*level_.texel(0, i, row))[c];
    }
    const auto along = [&](const std::vector<double>& f) {
      return Flux(product(channels[0], f), product(channels[1], f), product(channels[2], f));
    };
    std::vector<Flux> cosine, sine;
    for (int m = 0; m <= recursion_.order; ++m) cosine.push_back(along(cosines_[m])), sine.push_back(along(sines_[m]));

    std::vector<Flux> sums(sectors_.size(), Flux(0));
    across(row, [&](double latitude, double weight) {
      const Direction d(0, portable::sin_pi(latitude), portable::cos_pi(latitude));
      recursion_.each(d, [&](int k, double y) {
        if (const int m = sectors_[k]; m >= 0) {
          sums[k] += weight * y * cosine[m];
          if (m > 0) sums[k - 2 * m] += weight * y * sine[m];
        }
      });
    });
    return sums;
  }

 private:
  static constexpr std::size_t lanes = 8;

  // f(latitude over pi, weight) at Gauss points: 8 for each 1.5 radians of the highest harmonic.
  template <class F>
  void across(int row, F&& f) const {
    const double height = 1.0 / level_.height();
    const int parts = int(std::ceil((recursion_.order + 1) * pi * height / 1.5));
    const auto& rule = quadrature::rule<8>();
    for (int part = 0; part < parts; ++part)
      for (std::size_t n = 0; n < 8; ++n) {
        const double v = (row + (part + 0.5 + 0.5 * rule.node[n]) / parts) * height;
        f(0.5 - v, 0.5 * rule.weight[n] * pi * height / parts * portable::sin_pi(v));
      }
  }

  // In an order that vector instructions have, too.
  static double product(const std::vector<double>& a, const std::vector<double>& b) {
    double sums[lanes] = {};
    for (std::size_t i = 0; i < a.size(); i += lanes)
      for (std::size_t k = 0; k < lanes; ++k) sums[k] += a[i + k] * b[i + k];
    return ((sums[0] + sums[1]) + (sums[2] + sums[3])) + ((sums[4] + sums[5]) + (sums[6] + sums[7]));
  }

  const Level& level_;
  const Recursion& recursion_;
  std::size_t width_;                                 // In whole lanes.
  std::vector<std::vector<double>> cosines_, sines_;  // By m: integrals over the longitudes of each texel.
  std::vector<int> sectors_;                          // m by index of a coefficient.
};

std::size_t coefficient_count(int order) { return std::size_t(order + 1) * std::size_t(order + 1); }

void check_order(int order) { check_range(limits::order, order); }

void check_series(const Harmonics& h) {
  check_order(h.order);
  if (h.coefficients.size() != coefficient_count(h.order))
    throw UsageError(fmt::format("harmonics of order {} have {} coefficients, not {}", h.order,
                                 coefficient_count(h.order), h.coefficients.size()));
}

}  // namespace

void harmonics_at(int order, const Direction& towards, std::span<double> out) {
  check_order(order);
  if (out.size() < coefficient_count(order))
    throw UsageError(fmt::format("out must hold {} values, not {}", coefficient_count(order), out.size()));
  Recursion(order).each(checked_direction("d", towards), [&](int k, double y) { out[std::size_t(k)] = y; });
}

Harmonics project(const EnvironmentMap& map, int order, const Run& run) {
  check_order(order);
  return run_operation(run, [&](const Progress& progress) {
    const std::optional<EnvironmentMap> cube = prefiltering::source_cube(require_finite(map));
    const Level& level = cube ? cube->base() : map.base();
    const Recursion recursion(order);
    const Rotation to_world = image_to_world(cube ? cube->forward : map.forward);
    Harmonics found{order, std::vector<Flux>(std::size_t((order + 1) * (order + 1)), Flux(0))};
    std::vector<std::array<CompensatedSum, 3>> totals(found.coefficients.size());
    std::optional<LatlongRows> latlong;
    if (level.projection() == Projection::latlong) latlong.emplace(level, recursion, to_world);
    const int rows = level.faces() * level.height();
    constexpr int band = 64;  // Rows at once: their sums stay small however high the order.
    for (int start = 0; start < rows; start += band) {
      level.trim();
      const auto parts = map_rows<std::vector<Flux>>(std::min(band, rows - start), [&](int k) {
        if (latlong) return (*latlong)(start + k);
        return prefiltering::visit_source(level.projection(), [&](auto p) {
          return row_of<decltype(p)>(level, recursion, to_world, (start + k) / level.height(),
                                     (start + k) % level.height());
        });
      });
      for (const auto& part : parts)
        for (std::size_t k = 0; k < totals.size(); ++k)
          for (int c = 0; c < 3; ++c) totals[k][std::size_t(c)].add(part[k][c]);
      if (progress) progress(double(std::min(rows, start + band)) / rows);
    }
    for (std::size_t k = 0; k < totals.size(); ++k)
      found.coefficients[k] = {totals[k][0].value(), totals[k][1].value(), totals[k][2].value()};
    return found;
  });
}

Flux evaluate(const Harmonics& h, const Direction& d) {
  check_series(h);
  Flux sum(0);
  Recursion(h.order).each(checked_direction("d", d),
                          [&](int k, double y) { sum += y * h.coefficients[std::size_t(k)]; });
  return sum;
}

EnvironmentMap evaluate(const Harmonics& h, Projection to, int size, Forward forward, const Run& run) {
  check_series(h);
  check_range(limits::size, size);
  return run_operation(run, [&](const Progress& progress) {
    EnvironmentMap map = blank_map({to, forward}, size);
    Level& level = map.base();
    const Recursion recursion(h.order);
    const Rotation to_world = image_to_world(map.forward);
    for_each_row(level.faces(), size, progress, [&](int face, int row) {
      const Columns in = columns(to, size, row);
      std::vector<Direction> d(in.count());
      texel_directions(to, size, face, row, in.first, d);
      for (std::size_t k = 0; k < d.size(); ++k) {
        Flux sum(0);
        recursion.each(to_world * d[k], [&](int n, double y) { sum += y * h.coefficients[std::size_t(n)]; });
        *level.texel(face, in.first + int(k), row) = Colour(glm::max(sum, Flux(0)));
      }
    });
    return map;
  });
}

namespace {

// Integrals of a lobe times each P_l, by Gauss's points in panels of x = 1 - cosine. @param least value of the lobe
// that counts where a panel begins.
template <class Value>
std::vector<double> zonal_of(std::span<const double> breaks, int order, double least, const Value& value) {
  std::vector<double> cosine, weight;
  const auto add = [&](double lo, double hi) {
    if (value(lo) < least) return;
    const auto& rule = quadrature::rule<24>();
    for (std::size_t n = 0; n < 24; ++n) {
      const double x = 0.5 * (lo + hi) + 0.5 * (hi - lo) * rule.node[n];
      cosine.push_back(1 - x);
      weight.push_back(0.5 * (hi - lo) * rule.weight[n] * 2 * pi * value(x));
    }
  };
  for (std::size_t k = 0; k + 1 < breaks.size(); ++k) {
    // P_l turns over about every pi / l radians.
    const double lo = breaks[k], hi = breaks[k + 1];
    const int parts = 1 + int((portable::acos(1 - hi) - portable::acos(1 - lo)) * order / 10);
    for (int n = 0; n < parts; ++n) add(lo + (hi - lo) * n / parts, lo + (hi - lo) * (n + 1) / parts);
  }
  // Degree by degree, all points at once.
  std::vector<double> factors, now(cosine.size(), 1), before(cosine.size(), 0);
  for (int l = 0; l <= order; ++l) {
    std::array<double, 4> sums{};
    for (std::size_t n = 0; n < now.size(); ++n) sums[n % 4] += weight[n] * now[n];
    factors.push_back((sums[0] + sums[1]) + (sums[2] + sums[3]));
    const double rest = l / (l + 1.0);
    for (std::size_t n = 0; n < now.size(); ++n) {
      const double next = cosine[n] * now[n] + rest * (cosine[n] * now[n] - before[n]);
      before[n] = now[n];
      now[n] = next;
    }
  }
  return factors;
}

}  // namespace

std::vector<double> zonal(const Lobe& lobe, int order) {
  check_range({"order", 0, 100000}, order);
  if (lobe.shape() == LobeShape::table) {
    std::vector<double> breaks;
    for (const LobeSample& s : lobe.samples()) breaks.push_back(1 - s.cosine);
    std::ranges::reverse(breaks);
    const prefiltering::TableLobe table(lobe.samples());
    return zonal_of(breaks, order, 0, [&](double x) { return table.value(1 - x); });
  }
  const LobeFormula formula = formula_of(lobe);
  const auto value = [&](double x) { return std::visit([x](const auto& l) { return l.value(x); }, formula); };
  // Panels that halve towards the middle of the lobe, as far as it changes, and towards the horizon, where it may be
  // bent.
  const double width = std::visit([](const auto& l) { return l.width(); }, formula);
  std::vector<double> breaks{0};
  for (int k = std::min(-1, std::ilogb(width) - 8); k <= -1; ++k) breaks.push_back(std::ldexp(1.0, k));
  for (int k = -2; k >= -40; --k) breaks.push_back(1 - std::ldexp(1.0, k));
  breaks.push_back(1);
  return zonal_of(breaks, order, 1e-25 * value(0), value);
}

std::vector<double> irradiance_factors(int order) {
  check_order(order);
  std::vector<double> factors;
  double central = 1;  // l! / (2^l ((l/2)!)^2) of even l.
  for (int l = 0; l <= order; ++l) {
    if (l == 1) {
      factors.push_back(2 * pi / 3);
    } else if (l % 2 == 1) {
      factors.push_back(0);
    } else {
      if (l > 0) central *= (l - 1.0) / l;
      factors.push_back((l / 2 % 2 == 1 ? 2 * pi : -2 * pi) / ((l + 2.0) * (l - 1.0)) * central);
    }
  }
  return factors;
}

void scale_degrees(Harmonics& h, std::span<const double> factors) {
  check_series(h);
  if (factors.size() != std::size_t(h.order) + 1)
    throw UsageError(
        fmt::format("factors must hold {} values, one for each degree, not {}", h.order + 1, factors.size()));
  for (int l = 0; l <= h.order; ++l)
    for (int m = -l; m <= l; ++m) h.coefficients[std::size_t(l * (l + 1) + m)] *= factors[std::size_t(l)];
}

}  // namespace envmap

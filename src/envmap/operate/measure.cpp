#include "envmap/operate/measure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

#include "envmap/base/error.h"
#include "envmap/base/parallel.h"
#include "envmap/maths/compensated_sum.h"
#include "envmap/operate/brightest.h"
#include "envmap/operate/refuse_flaws.h"

namespace envmap {
namespace {

enum class Flaw { none, nan, infinite, negative };

Flaw flaw(const Colour& c) {
  if (std::isnan(c.x) || std::isnan(c.y) || std::isnan(c.z)) return Flaw::nan;
  if (std::isinf(c.x) || std::isinf(c.y) || std::isinf(c.z)) return Flaw::infinite;
  return c.x < 0 || c.y < 0 || c.z < 0 ? Flaw::negative : Flaw::none;
}

bool usable(const Colour& c) {
  const Flaw f = flaw(c);
  return f == Flaw::none || f == Flaw::negative;
}

struct FluxSum {
  CompensatedSum channel[3], weight;
  void add(const Flux& flux, double solid_angle) {
    for (int k = 0; k < 3; ++k) channel[k].add(flux[k]);
    weight.add(solid_angle);
  }
  void add(const FluxSum& o) {
    for (int k = 0; k < 3; ++k) channel[k].add(o.channel[k]);
    weight.add(o.weight);
  }
  [[nodiscard]] Flux value() const { return {channel[0].value(), channel[1].value(), channel[2].value()}; }
};

// x / 0 is infinite, 0 / 0 is agreement.
double ratio(double x, double y) { return x == 0 ? 0 : x / y; }

// Solid angles of row j of every face: computed once, used for all faces.
std::vector<double> weights(const Level& level, int j) {
  std::vector<double> w(std::size_t(level.width()));
  solid_angles(level.projection(), level.height(), j, w);
  return w;
}

FluxSum flux_sum(const Level& level) {
  FluxSum total;
  for (const FluxSum& row : map_rows<FluxSum>(level.height(), [&](int j) {
         FluxSum sum;
         level.trim();
         const std::vector<double> w = weights(level, j);
         for (int face = 0; face < level.faces(); ++face) {
           // Plain sums along a row lose 1e-14 at most; the rows' are compensated.
           const std::span<const Colour> texels = level.row(face, j);
           Flux row(0);
           double weight = 0;
           for (std::size_t i = 0; i < texels.size(); ++i)
             if (w[i] > 0 && usable(texels[i])) row += w[i] * Flux(texels[i]), weight += w[i];
           sum.add(row, weight);
         }
         return sum;
       }))
    total.add(row);
  return total;
}

const Colour& at(const Level& level, const Texel& t) { return *level.texel(t.face, t.i, t.j); }

// f(texel) for a texel and its up to eight neighbours on the face.
template <class F>
void for_each_around(const Level& level, const Texel& t, F&& f) {
  for (int j = std::max(0, t.j - 1); j <= std::min(level.height() - 1, t.j + 1); ++j) {
    const Columns in = level.columns(j);
    for (int i = std::max(in.first, t.i - 1); i <= std::min(in.end - 1, t.i + 1); ++i) f(Texel{t.face, i, j});
  }
}

}  // namespace

Flaws find_flaws(const Level& level) {
  const auto rows = map_level<Flaws>(level, [&](Flaws& found, int face, int j) {
    const Columns in = level.columns(j);
    for (int i = in.first; i < in.end; ++i) {
      const Flaw f = flaw(*level.texel(face, i, j));
      if (f == Flaw::none) continue;
      if (!found.first) found.first = Texel{face, i, j};
      ++(f == Flaw::nan ? found.nan : f == Flaw::infinite ? found.infinite : found.negative);
    }
  });
  Flaws all;
  for (const Flaws& row : rows) {
    if (!all.first) all.first = row.first;
    all.nan += row.nan;
    all.infinite += row.infinite;
    all.negative += row.negative;
  }
  return all;
}

std::int64_t repair(Level& level) {
  std::vector<Texel> holes;
  std::int64_t changed = 0;
  for (int face = 0; face < level.faces(); ++face)
    for (int j = 0; j < level.height(); ++j) {
      level.trim();
      const Columns in = level.columns(j);
      for (int i = in.first; i < in.end; ++i) {
        Colour& c = *level.texel(face, i, j);
        const Flaw f = flaw(c);
        changed += f != Flaw::none;
        if (f == Flaw::negative) c = glm::max(c, Colour(0));
        if (f == Flaw::nan || f == Flaw::infinite) holes.push_back({face, i, j});
      }
    }
  // Ring by ring from the rim of each hole inwards; all of a ring is read before any of it is written. After the first
  // only texels beside the ring before are looked at, or a map of nothing but NaN would take hours.
  std::size_t left = holes.size();
  for (std::vector<Texel> ring = std::move(holes); left > 0;) {
    std::vector<std::pair<Texel, Colour>> filled;
    for (const Texel& t : ring) {
      Rgb<double> sum(0);
      int count = 0;
      for_each_around(level, t, [&](const Texel& beside) {
        if (const Colour& c = at(level, beside); usable(c)) sum += Rgb<double>(c), ++count;
      });
      if (count > 0) filled.emplace_back(t, Colour(sum / double(count))), --left;
    }
    if (filled.empty()) throw InputError("no texel to repair from: a whole face is NaN or infinite");
    for (const auto& [t, colour] : filled) *level.texel(t.face, t.i, t.j) = colour;
    ring.clear();
    for (const auto& [t, colour] : filled)
      for_each_around(level, t, [&](const Texel& beside) {
        if (!usable(at(level, beside))) ring.push_back(beside);
      });
    const auto place = [](const Texel& t) { return std::tuple(t.face, t.j, t.i); };
    std::ranges::sort(ring, {}, place);
    const auto same = [&](const Texel& a, const Texel& b) { return place(a) == place(b); };
    ring.erase(std::unique(ring.begin(), ring.end(), same), ring.end());  // Clang 14 lacks std::ranges::unique.
  }
  return changed;
}

Measures measure(const EnvironmentMap& map) {
  const Level& level = map.base();
  constexpr double inf = std::numeric_limits<double>::infinity();
  struct Row {
    Rgb<double> low{inf}, high{-inf};
    double darkest = inf, brightest = -inf;
    Texel texel{0, 0, 0};
    std::int64_t texels = 0;  // As bright as the brightest.
    void add(const Row& o) {
      low = glm::min(low, o.low);
      high = glm::max(high, o.high);
      darkest = std::min(darkest, o.darkest);
      if (o.brightest == brightest) texels += o.texels;
      if (o.brightest > brightest) brightest = o.brightest, texel = o.texel, texels = o.texels;
    }
  };
  const auto rows = map_level<Row>(level, [&](Row& r, int face, int j) {
    const Columns in = level.weighted_columns(j);
    for (int i = in.first; i < in.end; ++i) {
      const Colour c = *level.texel(face, i, j);
      if (!usable(c)) continue;
      const double y = luminance_of(c);
      r.add({Rgb<double>(c), Rgb<double>(c), y > 0 ? y : inf, y, {face, i, j}, 1});
    }
  });
  Row all;
  for (const Row& r : rows) all.add(r);
  if (all.brightest == -inf) all = Row{Rgb<double>(0), Rgb<double>(0), 0, 0, {0, 0, 0}, 0};  // Not one sound texel.

  const FluxSum sum = flux_sum(level);
  const Region region = brightest_region(level, all.brightest, all.texels, all.texel);
  return {.minimum = all.low,
          .maximum = all.high,
          .mean = sum.weight.value() > 0 ? sum.value() / sum.weight.value() : Rgb<double>(0),
          .flux = sum.value(),
          .solid_angle = sum.weight.value(),
          .darkest = std::isinf(all.darkest) ? 0 : all.darkest,
          .brightest = all.brightest,
          .brightest_texel = region.texel,
          .brightest_direction = image_to_world(map.forward) * region.direction,
          .brightest_texels = region.texels,
          .brightest_value = *level.texel(region.texel.face, region.texel.i, region.texel.j)};
}

std::vector<Texel> texels_of(const Level& level) {
  std::vector<Texel> all;
  for (int face = 0; face < level.faces(); ++face)
    for (int j = 0; j < level.height(); ++j) {
      const Columns in = level.columns(j);
      for (int i = in.first; i < in.end; ++i) all.push_back({face, i, j});
    }
  return all;
}

std::size_t index_of(const Level& level, const Texel& texel) {
  return std::size_t((std::ptrdiff_t(texel.face) * level.height() + texel.j) * level.width() + texel.i);
}

Totals totals(const Level& level) {
  const FluxSum sum = flux_sum(level);
  const Flux f = sum.value();
  return {f, sum.weight.value() > 0 ? (f.x + f.y + f.z) / (3 * sum.weight.value()) : 0};
}

Flux flux(const Level& level) { return totals(level).flux; }
double mean_radiance(const Level& level) { return totals(level).mean; }

Flux flux_difference(const Level& a, const Level& b) {
  const Flux fa = flux(a), fb = flux(b);
  return {ratio(fa.x - fb.x, fb.x), ratio(fa.y - fb.y, fb.y), ratio(fa.z - fb.z, fb.z)};
}

double Difference::largest_flux() const { return std::max({std::abs(flux.x), std::abs(flux.y), std::abs(flux.z)}); }

namespace {

void check_same_shape(const Level& a, const Level& b) {
  if (a.projection() != b.projection() || a.width() != b.width() || a.height() != b.height())
    throw UsageError(fmt::format("maps to compare must have one projection and size, not {} {}x{} and {} {}x{}",
                                 name(a.projection()), a.width(), a.height(), name(b.projection()), b.width(),
                                 b.height()));
}

// One result a row: add(result, weight, texel, colour of a, colour of b) for every texel that carries weight.
template <class Row, class Add>
std::vector<Row> map_pairs(const Level& a, const Level& b, const Add& add) {
  check_same_shape(a, b);
  require_finite(a);
  require_finite(b);
  return map_rows<Row>(b.height(), [&](int j) {
    Row r;
    const std::vector<double> w = weights(b, j);
    for (int face = 0; face < b.faces(); ++face)
      for (int i = 0; i < b.width(); ++i)
        if (w[i] > 0)
          add(r, w[i], Texel{face, i, j}, Rgb<double>(*a.texel(face, i, j)), Rgb<double>(*b.texel(face, i, j)));
    return r;
  });
}

}  // namespace

double best_exposure(const Level& a, const Level& b) {
  struct Row {
    CompensatedSum product, power;
  };
  const auto rows =
      map_pairs<Row>(a, b, [](Row& r, double w, const Texel&, const Rgb<double>& ca, const Rgb<double>& cb) {
        r.product.add(w * glm::dot(ca, cb));
        r.power.add(w * glm::dot(ca, ca));
      });
  Row all;
  for (const Row& r : rows) all.product.add(r.product), all.power.add(r.power);
  return all.power.value() > 0 && all.product.value() > 0 ? all.product.value() / all.power.value() : 1;
}

MapDifference compare(const EnvironmentMap& a, const EnvironmentMap& b) {
  if (a.frame().forward != b.frame().forward)
    throw UsageError("maps to compare must have one forward axis: convert() one of them");
  if (a.levels.size() != b.levels.size())
    throw UsageError(fmt::format("maps to compare must have the same number of levels, not {} and {}: compare single "
                                 "levels, or make the missing ones by add_levels()",
                                 a.levels.size(), b.levels.size()));
  MapDifference all{};
  all.maximum = -1;
  for (std::size_t k = 0; k < a.levels.size(); ++k) {
    const Difference& d = all.levels.emplace_back(compare(a.levels[k], b.levels[k]));
    for (int c = 0; c < 3; ++c)
      if (!(std::abs(d.flux[c]) <= std::abs(all.flux[c]))) all.flux[c] = d.flux[c];
    all.rms = std::max(all.rms, d.rms);
    if (d.maximum > all.maximum) all.maximum = d.maximum, all.worst = d.worst, all.worst_level = int(k);
  }
  return all;
}

Difference compare(const Level& a, const Level& b, Level* shown) {
  check_same_shape(a, b);
  if (shown) check_same_shape(*shown, b);
  const double floor = 1e-3 * mean_radiance(b);
  struct Row {
    CompensatedSum error, power;
    double maximum = -1;
    Texel worst{0, 0, 0};
  };
  const auto rows =
      map_pairs<Row>(a, b, [&](Row& r, double w, const Texel& t, const Rgb<double>& ca, const Rgb<double>& cb) {
        const Rgb<double> d = glm::abs(ca - cb);
        if (shown) *shown->texel(t.face, t.i, t.j) = Colour(d);
        r.error.add(w * glm::dot(d, d));
        r.power.add(w * glm::dot(cb, cb));
        for (int k = 0; k < 3; ++k)
          if (const double m = ratio(d[k], std::max(std::abs(cb[k]), floor)); m > r.maximum) r.maximum = m, r.worst = t;
      });
  Row all;
  for (const Row& r : rows) {
    all.error.add(r.error);
    all.power.add(r.power);
    if (r.maximum > all.maximum) all.maximum = r.maximum, all.worst = r.worst;
  }
  Difference out{};
  out.flux = flux_difference(a, b);
  out.rms = std::sqrt(ratio(all.error.value(), all.power.value()));
  out.maximum = all.maximum;
  out.worst = all.worst;
  return out;
}

}  // namespace envmap

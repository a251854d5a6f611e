#include "envmap/prefilter/on_rings.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "envmap/operate/measure.h"
#include "envmap/base/parallel.h"
#include "envmap/maths/portable.h"
#include "envmap/prefilter/cell.h"
#include "envmap/projection/visit.h"
#include "envmap/sample/target.h"

namespace envmap::prefiltering {
namespace {

// Texels that are each other's images under quarter turns about the axis of the rings, and so share their points: of a
// cube with an even number of columns four, the sides' or one face's own; else each is alone.
struct Orbit {
  std::array<const Colour*, most_turns> texels;
  std::size_t count;
};

// A row of texels, from each of which an orbit is made.
struct OrbitRow {
  int face, row, first, end;
};

bool has_orbits(const Level& source) { return source.projection() == Projection::cube && source.width() % 2 == 0; }

int orbit_rows(const Level& source) {
  return has_orbits(source) ? 2 * source.height() : source.faces() * source.height();
}

// The side +Z, and a quarter of +Y and -Y.
OrbitRow orbit_row(const Level& source, int k) {
  const int n = source.height();
  if (has_orbits(source)) {
    if (k < n) return {4, k, 0, n};
    return {2 + (k - n) / (n / 2), (k - n) % (n / 2), 0, n / 2};
  }
  return {k / n, k % n, 0, source.width()};
}

// Each turn adds a quarter to the longitude's u: x, z to -z, x.
Orbit orbit_of(const Level& source, int face, int i, int j) {
  if (!has_orbits(source)) return {{source.texel(face, i, j)}, 1};
  Orbit found{{}, most_turns};
  const int last = source.height() - 1;
  for (std::size_t turn = 0; turn < most_turns; ++turn) {
    constexpr std::array<int, most_turns> sides{4, 1, 5, 0};
    found.texels[turn] = source.texel(face == 4 ? sides[turn] : face, i, j);
    if (face == 2) std::tie(i, j) = std::pair(j, last - i);
    if (face == 3) std::tie(i, j) = std::pair(last - j, i);
  }
  return found;
}

// The spots of a row of texels, in the order of the stripes of rings that they are spread to.
struct Row {
  std::vector<Spot> spots;
  std::vector<std::size_t> starts;
};

constexpr int stripe = 16;  // Rings; more than a stencil has.

// Makes spots of points as they come: up to four in one, if they lie so near each other that they share a stencil.
class Spots {
 public:
  explicit Spots(const RingGrid& grid) : grid_(grid) {}
  void add(std::span<const Location<double>> places, std::span<const double> weights, const RingLight& light) {
    for (std::size_t n = 0; n < places.size(); ++n) {
      const bool first = n % Spot::most == 0;
      const double down = places[n].v * grid_.rings - 0.5;
      double across = places[n].u * grid_.columns;
      if (!first) {
        const Spot& spot = all_.back();
        across -= grid_.columns * std::round((across - spot.across[0]) / grid_.columns);
        if (std::abs(across - spot.across[0]) < 1 && std::abs(down - spot.down[0]) < 1) {
          all_.back().add(down, across, weights[n]);
          continue;
        }
      }
      all_.push_back({.light = light});
      all_.back().add(down, across, weights[n]);
    }
  }
  [[nodiscard]] Row sorted() const {
    Row row{std::vector<Spot>(all_.size()),
            std::vector<std::size_t>(std::size_t((grid_.rings + stripe - 1) / stripe) + 1, 0)};
    const auto stripe_of = [&](const Spot& s) {
      return std::size_t(std::clamp(int(s.down[0]), 0, grid_.rings - 1) / stripe);
    };
    for (const Spot& s : all_) ++row.starts[stripe_of(s) + 1];
    for (std::size_t k = 1; k < row.starts.size(); ++k) row.starts[k] += row.starts[k - 1];
    std::vector<std::size_t> next = row.starts;
    for (const Spot& s : all_) row.spots[next[stripe_of(s)]++] = s;
    return row;
  }

 private:
  const RingGrid& grid_;
  std::vector<Spot> all_;
};

template <class P>
Row spots_of(const Level& source, const OrbitRow& in, int order, double error, double mean, const RingGrid& grid) {
  const int size = source.height();
  const double w = source.width(), h = size;
  const auto count = std::size_t(std::max(0, in.end - in.first));
  std::vector<Direction> d(count), beside(count), points;
  std::vector<double> omega, weights;
  texel_directions(source.projection(), size, in.face, in.row, in.first, d);
  texel_directions(source.projection(), size, in.face, in.row > 0 ? in.row - 1 : std::min(in.row + 1, size - 1),
                   in.first, beside);
  struct Texel {
    RingLight light;
    std::size_t end;  // Of its points.
  };
  std::vector<Texel> texels;
  for (std::size_t k = 0; k < count; ++k) {
    const int i = in.first + int(k);
    const Orbit orbit = orbit_of(source, in.face, i, in.row);
    RingLight light{{}, orbit.count};
    float brightest = 0;
    for (std::size_t n = 0; n < orbit.count; ++n) {
      const Colour& c = *orbit.texels[n];
      light.colours[n] = {c.x, c.y, c.z};
      brightest = std::max({brightest, c.x, c.y, c.z});
    }
    if (brightest <= 0) continue;
    const Reaches most = reaches(order, error, brightest > 10 * mean);
    const Rect rect{i / w, in.row / h, (i + 1) / w, (in.row + 1) / h};
    const double reach = 1.1 * std::max(glm::length(d[k] - d[k > 0 ? k - 1 : std::min(count - 1, k + 1)]),
                                        glm::length(d[k] - beside[k]));
    if (count > 1 && size > 1 && reach < most.one) {
      if (omega.empty()) {
        omega.resize(std::size_t(source.width()));
        solid_angles(source.projection(), size, in.row, omega);
      }
      points.push_back(d[k]), weights.push_back(omega[std::size_t(i)]);
    } else {
      for_points<P>(in.face, rect, most.four,
                    [&](const Direction& at, double weight) { points.push_back(at), weights.push_back(weight); });
    }
    texels.push_back({light, points.size()});
  }
  std::vector<Location<double>> places(points.size());
  locate(Projection::latlong, points, places);
  Spots spots(grid);
  std::size_t start = 0;
  for (const Texel& t : texels) {
    spots.add(std::span(places).subspan(start, t.end - start), std::span(weights).subspan(start, t.end - start),
              t.light);
    start = t.end;
  }
  return spots.sorted();
}

}  // namespace

Reaches reaches(int order, double error, bool bright) {
  if (bright) return {0, 1.4 * portable::pow(650 * error, 0.25) / order};
  return {std::sqrt(16 * error) / order, 3.2 * portable::pow(6200 * error, 0.25) / order};
}

// Stripes are filled every other at a time: no two at work share a ring.
RingGrid on_rings(const Level& source, int order, int columns, double error, const Progress& progress) {
  RingGrid grid(columns);
  const double mean = mean_radiance(source);
  const int rows = orbit_rows(source), stripes = (grid.rings + stripe - 1) / stripe;
  const int band = std::max(8, (1 << 15) / source.width());
  for (int start = 0; start < rows; start += band) {
    const auto found = map_rows<Row>(std::min(band, rows - start), [&](int k) {
      return visit_source(source.projection(), [&](auto p) {
        return spots_of<decltype(p)>(source, orbit_row(source, start + k), order, error, mean, grid);
      });
    });
    for (int parity = 0; parity < 2; ++parity)
      tbb::parallel_for(0, (stripes - parity + 1) / 2, [&](int k) {
        const auto s = std::size_t(2 * k + parity);
        for (const Row& row : found)
          spread(grid, std::span(row.spots).subspan(row.starts[s], row.starts[s + 1] - row.starts[s]));
      });
    if (progress) progress(0.8 * std::min(rows, start + band) / rows);
  }
  for (int ring = 0; ring < grid.rings; ++ring)
    for (std::size_t c = 0; c < 3; ++c) {
      double* row = grid.row(ring, c);
      for (std::size_t k = 0; k < taps; ++k) row[k] += row[std::size_t(grid.columns) + k];
    }
  return grid;
}

}  // namespace envmap::prefiltering

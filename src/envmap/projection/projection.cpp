#include "envmap/projection/projection.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "envmap/base/bounds.h"
#include "envmap/base/check_length.h"
#include "envmap/projection/visit.h"

namespace envmap {
namespace {

// Of a finer grid than any map's: filters sample n x n places a texel.
void check_row(int size, int row) {
  check_range({"size", 1, 1e9}, size);
  check_range({"row", 0, size - 1.0}, row);
}

void check_face(Projection p, int face) { check_range({"face", 0, faces(p) - 1.0}, face); }

}  // namespace

const char* name(Projection p) {
  return visit(p, [](auto q) { return decltype(q)::name; });
}

std::string identifier(Projection p) {
  std::string word = name(p);
  std::ranges::replace(word, '-', '_');
  return word;
}

int faces(Projection p) {
  return visit(p, [](auto q) { return decltype(q)::faces; });
}

int aspect(Projection p) {
  return visit(p, [](auto q) { return decltype(q)::aspect; });
}

double texel_count(Projection p, int size) { return 1.0 * faces(p) * aspect(p) * size * size; }

bool on_disc(Projection p) {
  return visit(p, [](auto q) { return decltype(q)::on_disc; });
}

bool is_octahedral(Projection p) {
  return visit(p, [](auto q) { return Faceted<decltype(q)> && decltype(q)::faces == 1; });
}

bool has_forward(Projection p) {
  return visit(p, [](auto q) { return decltype(q)::has_forward; });
}

std::optional<Projection> projection_named(std::string_view wanted) {
  // What other programs call them.
  static constexpr std::pair<std::string_view, Projection> aliases[] = {{"equirect", Projection::latlong},
                                                                        {"equirectangular", Projection::latlong},
                                                                        {"cubemap", Projection::cube},
                                                                        {"mirrorball", Projection::sphere},
                                                                        {"lightprobe", Projection::angular}};
  for (const Projection p : all_projections)
    if (wanted == name(p)) return p;
  for (const auto& [alias, p] : aliases)
    if (wanted == alias) return p;
  return std::nullopt;
}

Columns columns(Projection p, int size, int row) {
  check_row(size, row);
  return visit(p, [&](auto q) -> Columns {
    using P = decltype(q);
    return P::filled ? Columns{0, size * P::aspect} : disc_columns(size, row);
  });
}

Columns disc_columns(int size, int row) {
  check_row(size, row);
  // Nearest |t| of the row, in texels from the middle; the disc's half width there, widened to whole texels.
  const double middle = 0.5 * size, near = std::max({0.0, row - middle, middle - row - 1});
  const double half = std::sqrt(middle * middle - near * near);
  return {int(std::floor(middle - half)), int(std::ceil(middle + half))};
}

int facet(Projection p, const Location<double>& at) {
  check_face(p, at.face);
  return visit(p, [&](auto q) {
    using P = decltype(q);
    if constexpr (Faceted<P>)
      return P::facet(at);
    else
      return at.face;
  });
}

void facet_densities(Projection p, int facet, std::span<const Point2> points, std::span<double> out) {
  check_length("out", out.size(), points.size());
  visit(p, [&](auto q) {
    using P = decltype(q);
    constexpr int facets = [] {
      if constexpr (Faceted<P>)
        return int(P::facets);
      else
        return int(P::faces);
    }();
    check_range({"facet", 0, facets - 1.0}, facet);
    if constexpr (Faceted<P>)
      std::ranges::transform(points, out.begin(),
                             [facet](const Point2& at) { return P::continued_density(facet, at.x, at.y); });
    else
      densities(p, points, out);
  });
}

void densities(Projection p, std::span<const Point2> points, std::span<double> out) {
  check_length("out", out.size(), points.size());
  visit(p, [&](auto q) {
    using P = decltype(q);
    for (std::size_t k = 0; k < points.size(); ++k)
      // On a latlong map the points of a row have one density, and its sine is what costs.
      out[k] = std::is_same_v<P, Latlong> && k > 0 && points[k].y == points[k - 1].y
                   ? out[k - 1]
                   : P::density(points[k].x, points[k].y);
  });
}

void solid_angles(Projection p, int size, int row, std::span<double> out) {
  check_row(size, row);
  visit(p, [&](auto q) {
    using P = decltype(q);
    const double width = double(out.size()), v0 = double(row) / size, v1 = (row + 1.0) / size;
    if constexpr (std::is_same_v<P, Latlong>) {
      std::fill(out.begin(), out.end(), P::solid_angle({0, v0, 1, v1}) / width);
    } else if constexpr (std::is_same_v<P, EqualArea>) {
      std::fill(out.begin(), out.end(), 4 * pi / (width * size));
    } else {
      // The right half of every projection mirrors the left one.
      for (std::size_t i = 0, j = out.size(); i < j--; ++i)
        out[i] = out[j] = P::solid_angle({double(i) / width, v0, (double(i) + 1) / width, v1});
    }
  });
}

void solid_angles(Projection p, std::span<const double> edges, double v0, double v1, std::span<double> out) {
  check_length("edges", edges.size(), out.size() + 1);
  visit(p, [&](auto q) {
    using P = decltype(q);
    if constexpr (std::is_same_v<P, Latlong>) {
      const double row = P::solid_angle({0, v0, 1, v1});
      for (std::size_t i = 0; i < out.size(); ++i) out[i] = row * (edges[i + 1] - edges[i]);
    } else {
      for (std::size_t i = 0; i < out.size(); ++i) out[i] = P::solid_angle({edges[i], v0, edges[i + 1], v1});
    }
  });
}

Derivative derivative(Projection p, const Location<double>& at, double step) {
  check_face(p, at.face);
  return visit(p, [&](auto q) -> Derivative {
    using P = decltype(q);
    const Location<double> in = [&] {
      if constexpr (requires { P::inset(at, step); })
        return P::inset(at, 2.01 * step);
      else
        return at;
    }();
    const auto d = [&](double du, double dv) { return P::direction(in.face, in.u + du, in.v + dv); };
    return {(d(step, 0) - d(-step, 0)) / (2 * step), (d(0, step) - d(0, -step)) / (2 * step)};
  });
}

}  // namespace envmap

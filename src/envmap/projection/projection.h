/// @file
/// The list of projections, the one dispatch, and what operations ask of a projection: rows and spans at a time.
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include "envmap/projection/angular.h"
#include "envmap/projection/cube.h"
#include "envmap/projection/latlong.h"
#include "envmap/projection/paraboloid.h"
#include "envmap/projection/sphere.h"

namespace envmap {

enum class Projection { latlong, cube, sphere, paraboloid, angular };

inline constexpr Projection all_projections[] = {Projection::latlong, Projection::cube, Projection::sphere,
                                                 Projection::paraboloid, Projection::angular};

/// Calls f with the type of a projection: the only switch over projections there is.
template <class F>
decltype(auto) visit(Projection p, F&& f) {
  switch (p) {
    case Projection::latlong: return f(Latlong{});
    case Projection::cube: return f(Cube{});
    case Projection::sphere: return f(Sphere{});
    case Projection::paraboloid: return f(Paraboloid{});
    case Projection::angular: break;
  }
  return f(Angular{});
}

inline const char* name(Projection p) {
  return visit(p, [](auto q) { return decltype(q)::name; });
}
inline int faces(Projection p) {
  return visit(p, [](auto q) { return decltype(q)::faces; });
}
inline int aspect(Projection p) {
  return visit(p, [](auto q) { return decltype(q)::aspect; });
}
inline bool on_disc(Projection p) {
  return visit(p, [](auto q) { return decltype(q)::on_disc; });
}
/// @return the projection of that name, or nothing.
std::optional<Projection> projection_named(std::string_view name);

/// Height of a face of `to` with the degrees per texel of a `from` face `size` high, along the height of each
/// (latlong 2N high, cube N, paraboloid 2N, sphere and angular 4N); at least 1.
int matching_size(Projection from, int size, Projection to);

/// The columns of a row whose texels hold an image: all of them, or those that touch the disc.
struct Columns {
  int first, end;
};
Columns columns(Projection p, int size, int row);

/// Unit vectors (image frame) at the centres of texels [first, first + out.size()) of a row of a face `size` high.
/// A texel whose centre lies outside the disc but which reaches into it is sampled inside: half way between its
/// innermost corner and the rim.
void texel_directions(Projection p, int size, int face, int row, int first, std::span<Direction> out);

/// Unit vectors at points of one face.
void directions(Projection p, int face, std::span<const Vec2<double>> points, std::span<Direction> out);

/// Where each direction lies. Sizes must agree.
void locate(Projection p, std::span<const Direction> directions, std::span<Location<double>> out);

/// Solid angle per du dv at points of a face; 0 outside the disc.
void densities(Projection p, std::span<const Vec2<double>> points, std::span<double> out);

/// Steradians of each texel of a row of `out.size()` texels; every face has the same. Outside the disc 0, on the rim the
/// part inside.
void solid_angles(Projection p, int size, int row, std::span<double> out);

/// Steradians of the rectangles between neighbouring `edges` across (ascending u) and v0 and v1; out.size() is one less than
/// edges.size().
void solid_angles(Projection p, std::span<const double> edges, double v0, double v1, std::span<double> out);

/// How the direction moves with u and v; infinite nowhere: differences over `step` (in units of the face) either way.
struct Derivative {
  Direction du, dv;
};
Derivative derivative(Projection p, const Location<double>& at, double step);

}  // namespace envmap

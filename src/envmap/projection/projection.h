/// @file
/// The list of projections, the one dispatch, and what operations ask of a projection: rows and spans at a time.
#pragma once

#include <array>
#include <concepts>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include "envmap/base/export.h"
#include "envmap/projection/angular.h"
#include "envmap/projection/cube.h"
#include "envmap/projection/latlong.h"
#include "envmap/projection/paraboloid.h"
#include "envmap/projection/sphere.h"

namespace ENVMAP_EXPORT envmap {

/// What a projection is: a type of pure functions and constants. `direction` and `locate` take and give float or double
/// and are evaluated in double: a float result is off by its own rounding alone, 2^-23 rad for a direction and 2^-24 of the
/// face for a location (tested).
template <class P>
concept ProjectionType = requires(int face, double u, double v, const Direction& d, const Rect& rect) {
  { P::id } -> std::convertible_to<Projection>;
  { P::name } -> std::convertible_to<const char*>;      // As users type it.
  { P::faces } -> std::convertible_to<int>;
  { P::aspect } -> std::convertible_to<int>;            // Width over height of a face.
  { P::span } -> std::convertible_to<double>;           // Degrees of arc along the height of a face.
  { P::on_disc } -> std::convertible_to<bool>;          // Only the unit disc of a face carries weight.
  { P::filled } -> std::convertible_to<bool>;           // Texels outside the disc are written all the same.
  { P::has_forward } -> std::convertible_to<bool>;      // The image has a centre that --forward can choose.
  { P::direction(face, u, v) } -> std::same_as<Direction>;  // Unit; beyond the face its smooth continuation.
  { P::locate(d) } -> std::same_as<Location<double>>;       // Of any unit vector.
  { P::density(u, v) } -> std::same_as<double>;             // Solid angle per du dv; 0 outside the disc.
  { P::solid_angle(rect) } -> std::same_as<double>;         // Of a rectangle in u and v: its part inside the disc.
};

template <ProjectionType... P>
struct ProjectionList {
  static constexpr std::array<Projection, sizeof...(P)> ids{P::id...};

  /// f of the projection's type.
  template <class First, class... Rest, class F>
  static constexpr decltype(auto) visit(Projection p, F&& f) {
    if constexpr (sizeof...(Rest) > 0)
      if (p != First::id) return visit<Rest...>(p, std::forward<F>(f));
    return f(First{});
  }
  template <class F>
  static constexpr decltype(auto) visit_all(Projection p, F&& f) {
    return visit<P...>(p, std::forward<F>(f));
  }
};

/// The one list of projections, in the order of their enumerators.
using Projections = ProjectionList<Latlong, Cube, Sphere, Paraboloid, Angular>;

inline constexpr auto all_projections = Projections::ids;
static_assert([] {
  for (std::size_t k = 0; k < all_projections.size(); ++k)
    if (static_cast<std::size_t>(all_projections[k]) != k) return false;
  return true;
}());

/// Calls f with the type of a projection: the only dispatch over projections there is.
template <class F>
constexpr decltype(auto) visit(Projection p, F&& f) {
  return Projections::visit_all(p, std::forward<F>(f));
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
inline bool has_forward(Projection p) {
  return visit(p, [](auto q) { return decltype(q)::has_forward; });
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
void directions(Projection p, int face, std::span<const Point2> points, std::span<Direction> out);

/// Where each direction lies. Sizes must agree.
void locate(Projection p, std::span<const Direction> directions, std::span<Location<double>> out);

/// Solid angle per du dv at points of a face; 0 outside the disc.
void densities(Projection p, std::span<const Point2> points, std::span<double> out);

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

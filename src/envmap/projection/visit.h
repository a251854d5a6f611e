/// @file
/// The list of projections and the one dispatch over their types.
#pragma once

#include <concepts>
#include <iterator>
#include <utility>

#include "envmap/projection/angular.h"
#include "envmap/projection/cube.h"
#include "envmap/projection/equal_area.h"
#include "envmap/projection/latlong.h"
#include "envmap/projection/octahedral.h"
#include "envmap/projection/paraboloid.h"
#include "envmap/projection/sphere.h"

namespace envmap {

/// What a projection is: a type of pure functions and constants. `direction` and `locate` take and give float or double
/// and are evaluated in double: a float result is off by its own rounding alone, 2^-23 rad for a direction and 2^-24 of
/// the face for a location (tested).
template <class P>
concept ProjectionType = requires(int face, double u, double v, const Direction& d, const Rect& rect) {
  { P::id } -> std::convertible_to<Projection>;
  { P::name } -> std::convertible_to<const char*>;  // As users type it.
  { P::faces } -> std::convertible_to<int>;
  { P::aspect } -> std::convertible_to<int>;   // Width over height of a face.
  { P::span } -> std::convertible_to<double>;  // Degrees of arc along the height of a face.
  // No direction moves faster for a step in s, t; infinite of a disc.
  { P::stretch } -> std::convertible_to<double>;
  { P::on_disc } -> std::convertible_to<bool>;              // Only the unit disc of a face carries weight.
  { P::filled } -> std::convertible_to<bool>;               // Texels outside the disc are written all the same.
  { P::has_forward } -> std::convertible_to<bool>;          // The image has a centre that --forward can choose.
  { P::direction(face, u, v) } -> std::same_as<Direction>;  // Unit; beyond the face its continuation.
  { P::locate(d) } -> std::same_as<Location<double>>;       // Of any unit vector.
  { P::density(u, v) } -> std::same_as<double>;             // Solid angle per du dv; 0 outside the disc.
  { P::solid_angle(rect) } -> std::same_as<double>;         // Of a rectangle in u and v: its part inside the disc.
};

/// What those have whose faces fall into facets with creases between them: parts of the sphere cut out by planes, on
/// which the map is smooth, and the projection of each goes on a little beyond its sides.
template <class P>
concept Faceted = ProjectionType<P> && requires(int facet, const Direction& d, double u, double v) {
  { P::facets } -> std::convertible_to<int>;
  { P::facet(d) } -> std::same_as<int>;
  { P::facet(P::locate(d)) } -> std::same_as<int>;
  { P::sides(facet).front() } -> std::convertible_to<Direction>;  // It lies where dot(side, d) >= 0 for all of these.
  { P::continued(facet, d) } -> std::same_as<Location<double>>;
  { P::continued_density(facet, u, v) } -> std::same_as<double>;
};

template <ProjectionType... P>
struct ProjectionList {
  /// Whether these are all, each in the place of its enumerator.
  static constexpr bool is_complete() {
    std::size_t k = 0;
    return sizeof...(P) == std::size(all_projections) &&
           ((P::id == all_projections[k] && std::size_t(P::id) == k++) && ...);
  }

  template <class F>
  static constexpr decltype(auto) visit(Projection p, F&& f) {
    return visit_first<F, P...>(p, std::forward<F>(f));
  }

 private:
  template <class F, class First, class... Rest>
  static constexpr decltype(auto) visit_first(Projection p, F&& f) {
    if constexpr (sizeof...(Rest) > 0) {
      if (p != First::id) return visit_first<F, Rest...>(p, std::forward<F>(f));
    } else {
      check_enumerator("projection", p);
    }
    return f(First{});
  }
};

using Projections = ProjectionList<Latlong, Cube, Sphere, Paraboloid, Angular, Octahedral, EqualArea>;
static_assert(Projections::is_complete());

/// Calls f with the type of a projection: the only dispatch over projections there is.
template <class F>
constexpr decltype(auto) visit(Projection p, F&& f) {
  return Projections::visit(p, std::forward<F>(f));
}

}  // namespace envmap

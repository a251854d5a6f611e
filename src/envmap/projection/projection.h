/// @file
/// The projections: how an image, or several faces, shows all directions; and what operations ask of one, rows and
/// spans at a time.
#pragma once

#include <iterator>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "envmap/base/enumerators.h"
#include "envmap/base/export.h"
#include "envmap/maths/vector.h"

namespace ENVMAP_EXPORT envmap {

enum class Projection { latlong, cube, sphere, paraboloid, angular, octahedral, equal_area };

/// In the order of the enumerators.
inline constexpr Projection all_projections[] = {Projection::latlong,    Projection::cube,    Projection::sphere,
                                                 Projection::paraboloid, Projection::angular, Projection::octahedral,
                                                 Projection::equal_area};
template <>
inline constexpr std::size_t enumerators<Projection> = std::size(all_projections);

/// A point of a face: u runs right and v down, both [0,1]; texel (i,j) of W x H has its centre at ((i+.5)/W, (j+.5)/H).
template <class T>
struct Location {
  int face;
  T u, v;
};

const char* name(Projection p);        ///< As users type it.
std::string identifier(Projection p);  ///< The same as a name in GLSL or C: equal_area.
int faces(Projection p);
int aspect(Projection p);  ///< Width over height of a face.
/// Texels of a map whose faces are `size` high, as an image of all of them holds: outside of discs, too.
double texel_count(Projection p, int size);
bool on_disc(Projection p);        ///< Only the unit disc of a face carries weight.
bool is_octahedral(Projection p);  ///< A square folded onto itself: octahedron.h.
bool has_forward(Projection p);    ///< The image has a centre that can be chosen.
/// @return the projection of that name, or nothing.
std::optional<Projection> projection_named(std::string_view name);

/// The columns of a row whose texels hold an image: all of them, or those that touch the disc.
struct Columns {
  int first, end;

  [[nodiscard]] std::size_t count() const { return std::size_t(end - first); }
  /// Those of a row.
  template <class T>
  [[nodiscard]] std::span<T> of(std::span<T> row) const {
    return row.subspan(std::size_t(first), count());
  }
};
Columns columns(Projection p, int size, int row);
/// Those that touch the disc, also where the corners beside it are filled.
Columns disc_columns(int size, int row);

/// Unit vectors (image frame) at the centres of texels [first, first + out.size()) of a row of a face `size` high.
/// A texel whose centre lies outside the disc but which reaches into it is sampled inside: half way between its
/// innermost corner and the rim. @throws UsageError where the projection has no such face or the face no such row.
void texel_directions(Projection p, int size, int face, int row, int first, std::span<Direction> out);

/// Unit vectors at points of one face. Here and below `out` is as long as what it is computed from.
/// @throws UsageError where it is not, or where there is no such face.
void directions(Projection p, int face, std::span<const Point2> points, std::span<Direction> out);

/// Where each direction lies. Directions may be of any length.
/// @throws UsageError where `out` is not as long as `directions`, or a direction is 0, NaN or infinite.
void locate(Projection p, std::span<const Direction> directions, std::span<Location<double>> out);

/// The part of a face that holds a place and within which a map is smooth: the face itself, or of octahedral maps an
/// eighth of the sphere. The facets of a face are face, face + faces(p), face + 2 faces(p) ...
int facet(Projection p, const Location<double>& at);

/// Solid angle per du dv at points of a facet, beyond its sides what it goes on with; 0 outside the disc.
void facet_densities(Projection p, int facet, std::span<const Point2> points, std::span<double> out);

/// The same in whatever facet they lie.
void densities(Projection p, std::span<const Point2> points, std::span<double> out);

/// The same of one place, or of one direction.
inline Direction direction_at(Projection p, int face, const Point2& at) {
  Direction d;
  directions(p, face, {&at, 1}, {&d, 1});
  return d;
}
inline Location<double> locate(Projection p, const Direction& d) {
  Location<double> at;
  locate(p, {&d, 1}, {&at, 1});
  return at;
}
inline double density_at(Projection p, const Point2& at) {
  double density;
  densities(p, {&at, 1}, {&density, 1});
  return density;
}

/// Steradians of each texel of a row of `out.size()` texels; every face has the same. Outside the disc 0, on the rim
/// the part inside.
void solid_angles(Projection p, int size, int row, std::span<double> out);

/// Steradians of the rectangles between neighbouring `edges` across (ascending u) and v0 and v1; out.size() is one less
/// than edges.size().
void solid_angles(Projection p, std::span<const double> edges, double v0, double v1, std::span<double> out);

/// How the direction moves with u and v; infinite nowhere: differences over `step` (in units of the face) either way,
/// which never reach over a crease.
struct Derivative {
  Direction du, dv;
};
Derivative derivative(Projection p, const Location<double>& at, double step);

}  // namespace envmap

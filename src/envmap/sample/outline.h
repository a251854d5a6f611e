/// @file
/// The outline of a texel of a result as the source sees it.
#pragma once

#include <vector>

#include "envmap/sample/padded_level.h"
#include "envmap/sample/target_grid.h"

namespace envmap {

/// The sides of neighbouring texels in a row of the result, each followed by `pieces` straight pieces: `pieces` + 1
/// rows of points. The first and the last hold `pieces` points a texel,
/// those between them only the points on upright sides.
struct Sides {
  int face = 0, row = 0, first = 0;  ///< The texels' place in the result.
  std::size_t pieces = 0, texels = 0;
  bool folded = false;   ///< The result is an octahedral map.
  bool clipped = false;  ///< The rim of a disc cuts the texel.
  std::vector<Point2> points;
  std::vector<Direction> directions;     ///< In the frame of the source.
  std::vector<Location<double>> places;  ///< In the source.

  /// For texels [first, first + texels) of a row: fills the rest.
  /// @param inside of one texel that a disc's rim cuts, the sides of what is inside; `pieces` is a multiple of 4.
  void find(const Target& target, Projection source, bool inside);

  /// Whether the outline may turn at a point, the `n`th round its texel: at a texel's corner, on a disc's rim, or on a
  /// crease of the result, which meets sides in texels' corners or (where the size is odd) in their middles.
  [[nodiscard]] bool is_corner(std::size_t point, std::size_t n) const;

  /// Calls f with the indices of the points round a texel, from its upper left corner and back to it.
  template <class F>
  void around(std::size_t texel, F&& f) const {
    const std::size_t across = pieces * texels + 1, between = texels + 1, below = across + (pieces - 1) * between;
    const auto upright = [&](std::size_t side, std::size_t r) { return across + (r - 1) * between + side; };
    for (std::size_t k = 0; k <= pieces; ++k) f(texel * pieces + k);
    for (std::size_t r = 1; r < pieces; ++r) f(upright(texel + 1, r));
    for (std::size_t k = pieces + 1; k-- > 0;) f(below + texel * pieces + k);
    for (std::size_t r = pieces; r-- > 1;) f(upright(texel, r));
    f(texel * pieces);
  }
};

/// A texel's outline on one facet of the source, in source texels with their centres at whole numbers. Beyond the sides
/// of a latlong map its x goes on.
struct Outline {
  int facet = -1;
  std::vector<Point2> points;  ///< The last is the first again.
  std::vector<char> corners;   ///< Where the outline may turn.
  /// Of the piece that ends at a point; rows of a latlong map count as narrow as on the sphere.
  std::vector<double> lengths;
  int latlong_rows = 0;  ///< Of a source that is a latlong map.

  /// Begins anew. @param rows of a source that is a latlong map, else 0.
  void begin(int on_facet, int rows) {
    points.clear(), corners.clear(), lengths.clear();
    facet = on_facet, latlong_rows = rows;
  }
  void add(const Point2& p, bool corner);

  /// Follows the outline of texel `first` + k. False where it is none on one facet, or where bilinear interpolation
  /// would not show the directions themselves.
  bool follow(const PaddedLevel& source, const Target& target, const Sides& sides, std::size_t k);

  /// How far the sides bend away from their pieces, how far off they count as once the points are moved out, and how
  /// thick the outline is, all in texels.
  struct Shape {
    double bend, error, thickness;
  };
  [[nodiscard]] Shape shape() const;

  /// Moves the points between corners out, so that the straight pieces enclose as much as the curve through the points.
  void move_out();

 private:
  bool follow_on_octahedron(const PaddedLevel& source, const Sides& sides, std::size_t texel);
  // How long a step along a row of the source is, over one at the equator of a latlong map.
  [[nodiscard]] double narrowing(double y) const;
};

/// Whether the rim of a disc cuts a texel. Some maps are filled beyond it.
bool is_cut_by_rim(const Target& target, int row, int column);

/// A location in source texels with their centres at whole numbers.
inline Point2 in_texels(const PaddedLevel& source, const Location<double>& at) {
  return {at.u * source.width() - 0.5, at.v * source.height() - 0.5};
}

}  // namespace envmap

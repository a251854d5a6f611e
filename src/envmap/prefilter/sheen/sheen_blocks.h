/// @file
/// A source for sheen: blocks of texels in a tree, and the light of each block as points.
///
/// The points of a block are the nodes of Chebyshev interpolation over it, and their light is its adjoint: the sum of a
/// kernel over the points is the sum over the texels of the interpolated kernel. All points lie inside their block, so
/// the horizon cuts the points of a block only where it cuts the block.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "envmap/map/environment_map.h"

namespace envmap::prefiltering {

class SheenBlocks {
 public:
  static constexpr int nodes = 8;  ///< Nodes of an interpolation along one axis.
  static constexpr int points = nodes * nodes;
  static constexpr int unit_side = 8;

  /// The geometry of a block in its own frame, see in_block().
  struct Shape {
    Direction centre;
    double radius;  ///< No place of the block is farther from the centre.
    alignas(64) float offset[3][points];
  };
  struct Points {
    alignas(64) float light[3][points];
  };
  /// Blocks of equal sides, in texels. Four of a layer make a block of the next.
  struct Layer {
    int side, across, down;
    std::vector<Shape> shapes;
    std::vector<Points> light;
    std::vector<char> lit;
    std::vector<Direction> columns;  ///< Latlong: cosine and sine of the longitude of the middle of each column.

    [[nodiscard]] std::size_t index(int face, int row, int column) const {
      return (std::size_t(face) * std::size_t(down) + std::size_t(row)) * std::size_t(across) + std::size_t(column);
    }
  };

  /// @param source a cube or latlong map. @param unit that radiance is counted in, above 0.
  /// @param min_radiance of each channel, which blocks leave out (source_cube.h).
  SheenBlocks(const Level& source, double unit, const Colour& min_radiance = Colour(0));

  [[nodiscard]] bool is_latlong() const { return latlong_; }
  [[nodiscard]] int faces() const { return latlong_ ? 1 : 6; }
  [[nodiscard]] const Flux& min_radiance() const { return min_radiance_; }  ///< Left out of the blocks.
  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  /// The longest side of a texel, as an angle.
  [[nodiscard]] double texel() const { return latlong_ ? std::max(pi / height_, 2 * pi / width_) : 2.0 / height_; }
  /// Layers from the smallest blocks on.
  [[nodiscard]] const std::vector<Layer>& layers() const { return layers_; }
  [[nodiscard]] const Shape& shape(const Layer& layer, int row, int column) const {
    return layer.shapes[latlong_ ? std::size_t(row) : layer.index(0, row, column)];
  }
  /// Light of a row of texels of a block of the first layer: `side` texels of each channel.
  [[nodiscard]] const float* texels(std::size_t block, int row, int channel) const {
    const auto side = std::size_t(layers_.front().side);
    return &texels_[((block * side + std::size_t(row)) * 3 + std::size_t(channel)) * side];
  }

  /// A direction in the frame of a face, see FaceDirection of horizon_cells.h.
  [[nodiscard]] Direction in_face(int face, const Direction& n) const;
  /// The direction in the frame of a block: on a latlong map longitudes start at its middle.
  [[nodiscard]] Direction in_block(const Direction& n, const Layer& layer, int column) const {
    if (!latlong_) return n;
    const Direction& c = layer.columns[std::size_t(column)];
    return {n.x * c.x + n.y * c.y, n.y * c.x - n.x * c.y, n.z};
  }

 private:
  void add_layer(int side);
  [[nodiscard]] Shape shape_of(const Layer& layer, int row, int column) const;
  void take_texels(const Level& source, double unit, const Colour& min_radiance);
  void sum_texels(int face, int row);
  void sum_blocks(const Layer& from, Layer& to, int face, int row) const;

  bool latlong_;
  int width_, height_;
  Flux min_radiance_;
  std::vector<Layer> layers_;
  std::vector<float> texels_;
};

}  // namespace envmap::prefiltering

/// @file
/// The source as a quad-tree of lights: every block of 2^k x 2^k texels of a face with its moments.
#pragma once

#include <optional>
#include <vector>

#include "envmap/map/environment_map.h"
#include "envmap/prefilter/quad.h"

namespace envmap {

/// Texels of a block: columns from left to right - 1, rows from top to bottom - 1.
struct Span {
  int left, top, right, bottom;
  [[nodiscard]] int width() const { return right - left; }
  [[nodiscard]] int height() const { return bottom - top; }
};

/// Blocks above a size are stored; smaller ones are few where a lobe is wide and are made as they are wanted: the texels
/// of a block, and below a texel its quarters.
class LightTree {
 public:
  struct Blocks {
    int width, height;  ///< Blocks across and down a face.
    std::vector<Light> lights;
    std::vector<Quad> quads;  ///< The same in fours, by where they lie in the level above.

    [[nodiscard]] std::size_t index(int face, int i, int j) const {
      const auto w = static_cast<std::size_t>(width), h = static_cast<std::size_t>(height);
      return (static_cast<std::size_t>(face) * h + static_cast<std::size_t>(j)) * w + static_cast<std::size_t>(i);
    }
    [[nodiscard]] const Light& light(int face, int i, int j) const { return lights[index(face, i, j)]; }
    Light& light(int face, int i, int j) { return lights[index(face, i, j)]; }
    /// Blocks 2i, 2i + 1 of rows 2j, 2j + 1.
    [[nodiscard]] const Quad& quad(int face, int i, int j) const {
      const auto w = static_cast<std::size_t>((width + 1) / 2), h = static_cast<std::size_t>((height + 1) / 2);
      return quads[(static_cast<std::size_t>(face) * h + static_cast<std::size_t>(j)) * w + static_cast<std::size_t>(i)];
    }
    void set_quads(int faces);
  };

  /// @param source must outlive the tree.
  explicit LightTree(const Level& source);

  [[nodiscard]] const Level& source() const { return source_; }
  [[nodiscard]] double mean() const { return mean_; }  ///< Radiance that fluxes are in units of; 0 if all is black.
  [[nodiscard]] int first() const { return first_; }   ///< log2 of the texels across the smallest block stored.
  [[nodiscard]] int last() const { return first_ + static_cast<int>(blocks_.size()) - 1; }
  /// A block smaller than those that are stored; nothing where a rim cuts or stretches it, or it has one row or column.
  [[nodiscard]] std::optional<Light> block(int face, const Span& in) const;
  [[nodiscard]] const Blocks& blocks(int k) const { return blocks_[static_cast<std::size_t>(k - first_)]; }

 private:
  const Level& source_;
  double mean_;
  int first_ = 0;
  std::vector<Blocks> blocks_;
};

}  // namespace envmap

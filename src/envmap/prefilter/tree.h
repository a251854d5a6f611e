/// @file
/// The source as a quad-tree of nodes: every block of 2^k x 2^k texels of a face with its moments.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "envmap/map/environment_map.h"
#include "envmap/prefilter/traverse.h"

namespace envmap::prefiltering {

/// TexelBatch of a block: columns from left to right - 1, rows from top to bottom - 1.
struct Span {
  int left, top, right, bottom;
  [[nodiscard]] int width() const { return right - left; }
  [[nodiscard]] int height() const { return bottom - top; }
  [[nodiscard]] std::size_t count() const {
    return std::size_t(width()) * std::size_t(height());
  }
  /// Of a texel, by row and column.
  [[nodiscard]] std::size_t index(int i, int j) const {
    return std::size_t(j - top) * std::size_t(width()) + std::size_t(i - left);
  }
  [[nodiscard]] std::array<Span, 4> quarters() const {
    const int middle = (left + right) / 2, centre = (top + bottom) / 2;
    return {{{left, top, middle, centre},
             {middle, top, right, centre},
             {left, centre, middle, bottom},
             {middle, centre, right, bottom}}};
  }
};

/// Least radiance of each channel.
Colour darkest_of(const Level& source);

/// Blocks above a size are stored; smaller ones are few where a lobe is wide and are made as they are wanted: the
/// texels of a block, and below a texel its quarters.
class Tree {
 public:
  struct Blocks {
    int faces, width, height;         ///< Blocks across and down a face.
    std::unique_ptr<Node[]> nodes;  ///< By face, row and column.
    std::unique_ptr<NodeQuad[]> quads;    ///< The same in fours, by where they lie in the level above.

    Blocks(int count, int across, int down);
    [[nodiscard]] Node* row(int face, int j) const { return &nodes[place(width, height, face, j)]; }
    [[nodiscard]] const Node& node(int face, int i, int j) const { return row(face, j)[i]; }
    /// Blocks 2i, 2i + 1 of rows 2j, 2j + 1.
    [[nodiscard]] const NodeQuad& quad(int face, int i, int j) const {
      return quads[place((width + 1) / 2, (height + 1) / 2, face, j) + std::size_t(i)];
    }
    /// Sets the quads of rows 2j and 2j + 1.
    void set_quads(int face, int j);

   private:
    static std::size_t place(int across, int down, int face, int j) {
      return std::size_t(face * down + j) * std::size_t(across);
    }
  };

  /// @param source must outlive the tree. @param mean of its radiance. @param parts of larger texels that its own are,
  /// each way: see refined().
  Tree(const Level& source, double mean, int parts);

  [[nodiscard]] const Level& source() const { return source_; }
  [[nodiscard]] int parts() const { return parts_; }
  /// Least radiance of each channel, in units of the mean. It falls from everywhere, which makes as much of every
  /// result: only what is beyond() it, in the same units, is left to the nodes.
  [[nodiscard]] const Flux& darkest() const { return darkest_; }
  [[nodiscard]] Flux beyond(const Colour& radiance) const {
    return mean_ > 0 ? glm::max(Flux(0), Flux(radiance) / mean_ - darkest_) : Flux(0);
  }
  [[nodiscard]] double mean() const { return mean_; }  ///< Radiance that fluxes are in units of; 0 if all is black.
  [[nodiscard]] int first() const { return first_; }   ///< log2 of the texels across the smallest block stored.
  [[nodiscard]] int last() const { return first_ + int(blocks_.size()) - 1; }
  /// The quarters of a block of those that are stored, or smaller; nothing where a rim cuts or stretches one, or one
  /// has a single row or column.
  [[nodiscard]] std::optional<std::array<Node, 4>> quarters(int face, const Span& in) const;
  [[nodiscard]] const Blocks& blocks(int k) const { return blocks_[std::size_t(k - first_)]; }

 private:
  const Level& source_;
  int parts_;
  double mean_;
  Flux darkest_;
  int first_ = 0;
  std::vector<Blocks> blocks_;
};

}  // namespace envmap::prefiltering

/// @file
/// The source as a quad-tree of nodes: every block of 2^k x 2^k texels of a face with its moments.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "envmap/map/environment_map.h"
#include "envmap/prefilter/treecode/moments.h"

namespace envmap::prefiltering {

/// Least radiance of each channel.
Colour darkest_of(const Level& source);

/// What is judged of nodes, side by side.
template <std::size_t N>
struct alignas(4 * N) NodeHeads {
  using Lanes = std::array<float, N>;
  std::array<Lanes, 3> axis;
  Lanes cosine, sine, tangent2, tangent4, tangent3, radial2, radial4;
  std::array<Lanes, channels> flux;

  void set(std::size_t lane, const TreeNode& node) {
    for (std::size_t n = 0; n < 3; ++n) axis[n][lane] = float(node.axis[int(n)]);
    cosine[lane] = node.cosine, sine[lane] = node.sine;
    tangent2[lane] = node.tangent2, tangent4[lane] = node.tangent4, tangent3[lane] = node.tangent3;
    radial2[lane] = node.radial2, radial4[lane] = node.radial4;
    for (std::size_t c = 0; c < channels; ++c) flux[c][lane] = node.flux[c];
  }
};
using NodeQuad = NodeHeads<4>;    ///< The four parts of a block.
using NodeGroup = NodeHeads<16>;  ///< What is judged at once.

/// Blocks above a size are stored. Texels and parts of texels are made as they are wanted, which is seldom.
class Tree {
 public:
  /// One size of blocks.
  struct Blocks {
    int faces, width, height;           ///< Blocks across and down a face.
    std::unique_ptr<TreeNode[]> nodes;  ///< By face, row and column.
    std::unique_ptr<NodeQuad[]> quads;  ///< The same in fours, by where they lie in the level above.

    Blocks(int of_faces, int across, int down);
    [[nodiscard]] const TreeNode& node(int face, int i, int j) const {
      return nodes[place(width, height, face, j) + std::size_t(i)];
    }
    /// Blocks 2i, 2i + 1 of rows 2j, 2j + 1; without flux where there is none.
    [[nodiscard]] const NodeQuad& quad(int face, int i, int j) const {
      return quads[place((width + 1) / 2, (height + 1) / 2, face, j) + std::size_t(i)];
    }
    void set(int face, int i, int j, const TreeNode& node);

   private:
    static std::size_t place(int across, int down, int face, int j) {
      return std::size_t(face * down + j) * std::size_t(across);
    }
  };

  /// @param source a cube or latlong map of texels of 1.5 degrees or less, which must outlive the tree.
  /// @param mean of its radiance.
  Tree(const Level& source, double mean);

  [[nodiscard]] const Level& source() const { return source_; }
  [[nodiscard]] double mean() const { return mean_; }  ///< Radiance that fluxes are in units of; 0 if all is black.
  /// Least radiance of each channel, in units of the mean. It falls from everywhere, so its part of a result is known:
  /// nodes hold what is beyond() it, in the same units.
  [[nodiscard]] const Flux& darkest() const { return darkest_; }
  [[nodiscard]] Flux beyond(const Colour& radiance) const {
    return mean_ > 0 ? glm::max(Flux(0), Flux(radiance) / mean_ - darkest_) : Flux(0);
  }
  [[nodiscard]] int first() const { return first_; }  ///< log2 of the texels across the smallest block stored.
  [[nodiscard]] int last() const { return first_ + int(blocks_.size()) - 1; }
  [[nodiscard]] const Blocks& blocks(int k) const { return blocks_[std::size_t(k - first_)]; }

 private:
  const Level& source_;
  double mean_;
  Flux darkest_;
  int first_ = 0;
  std::vector<Blocks> blocks_;
};

}  // namespace envmap::prefiltering

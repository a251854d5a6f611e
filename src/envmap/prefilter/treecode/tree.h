/// @file
/// The source as a quadtree of nodes: every block of 2^k x 2^k texels of a face has its moments (moments.h).
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "envmap/map/environment_map.h"
#include "envmap/prefilter/treecode/moments.h"

namespace envmap::prefiltering {

/// The numbers of N nodes that bound_nodes() reads, side by side.
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
using NodeGroup = NodeHeads<16>;  ///< The nodes that are bounded at once.

/// Blocks from a size on are stored. Nodes of texels and of parts of texels are made on demand, which is seldom.
class Tree {
 public:
  /// One size of blocks.
  struct Blocks {
    int faces, width, height;           ///< Blocks across and down a face.
    std::unique_ptr<TreeNode[]> nodes;  ///< Ordered by face, row and column.
    std::unique_ptr<NodeQuad[]> quads;  ///< The same nodes in fours, by their block of the level above.

    Blocks(int of_faces, int across, int down);
    [[nodiscard]] const TreeNode& node(int face, int i, int j) const {
      return nodes[place(width, height, face, j) + std::size_t(i)];
    }
    /// Blocks 2i, 2i + 1 of rows 2j, 2j + 1. A block outside the level has no flux.
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
  /// @param mean of its radiance. @param flux totals() of the source. @param min_radiance of each channel.
  Tree(const Level& source, double mean, const Flux& flux, const Colour& min_radiance);

  [[nodiscard]] const Level& source() const { return source_; }
  [[nodiscard]] double mean() const { return mean_; }  ///< The unit of fluxes; 0 if all is black.
  /// Least radiance of each channel, in units of the mean. Nodes hold the excess() over it, in the same units.
  [[nodiscard]] const Flux& min_radiance() const { return min_radiance_; }
  [[nodiscard]] Flux excess(const Colour& radiance) const {
    return mean_ > 0 ? glm::max(Flux(0), Flux(radiance) / mean_ - min_radiance_) : Flux(0);
  }
  [[nodiscard]] int first() const { return first_; }  ///< log2 of the texels across the smallest block stored.
  [[nodiscard]] int last() const { return first_ + int(blocks_.size()) - 1; }
  [[nodiscard]] const Blocks& blocks(int k) const { return blocks_[std::size_t(k - first_)]; }

 private:
  const Level& source_;
  double mean_;
  Flux min_radiance_;
  int first_ = 0;
  std::vector<Blocks> blocks_;
};

}  // namespace envmap::prefiltering

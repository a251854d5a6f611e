/// @file
/// A level with an apron: what filters read.
#pragma once

#include "envmap/map/environment_map.h"

namespace envmap {

/// A copy of a level whose faces go on beyond their edges: `Level::apron` more texels on every side and, where a disc
/// carries the weight, as far outside the disc. Each holds the bilinear value of the map in the direction that the
/// projection continues to, so that filters are seamless over edges, corners, poles and rims with no special case.
///
/// An apron texel beside an edge is interpolated between texels some of which are apron themselves (with a weight of
/// about half a texel / size on a cube): the values are found by iteration, which contracts. Beyond a rim they come
/// from a moving least-squares fit to the texels of both sides. Octahedral maps are folded onto themselves: texels of
/// the apron are texels of the image.
class PaddedLevel {
 public:
  /// Copies the texels.
  explicit PaddedLevel(const Level& level);
  /// Takes the texels over: nothing is copied, since every level is stored with room for its apron.
  explicit PaddedLevel(Level&& level);

  [[nodiscard]] Projection projection() const { return level_.projection(); }
  [[nodiscard]] int faces() const { return level_.faces(); }
  [[nodiscard]] int width() const { return level_.width(); }
  [[nodiscard]] int height() const { return level_.height(); }
  [[nodiscard]] std::ptrdiff_t stride() const { return level_.stride(); }
  [[nodiscard]] std::size_t max_memory() const { return level_.max_memory(); }
  void trim() const { level_.trim(); }

  /// Texel (i,j) of a face; i and j may reach `Level::apron` beyond the face.
  [[nodiscard]] const Colour* texel(int face, int i, int j) const { return level_.stored(face, i, j); }

 private:
  void fill_by_bilinear();
  void fill_by_fit();
  void fill_by_folding();

  Level level_;
};

}  // namespace envmap

/// @file
/// Discs of even radiance that explain the texels of a place, by least squares.
#pragma once

#include <span>
#include <vector>

#include "envmap/light/texel_patch.h"

namespace envmap {

/// In the frame of the image.
struct Disc {
  Direction towards;
  double radius;     ///< In radians.
  double luminance;  ///< Beyond the surroundings.
};

/// Texels round a place, divided finely enough to tell which part of each lies in a disc.
class Patch {
 public:
  /// @param luminance of each texel beyond the surroundings. @param middle of the place.
  /// @param radius of a disc there, about, in radians: texels are cut into parts of a twelfth of it.
  Patch(TexelGeometry& geometry, std::vector<Texel> texels, std::vector<double> luminance, const Direction& middle,
        double radius);

  /// The part of each texel that lies in a disc. @param towards image frame. @param radius radians.
  [[nodiscard]] std::vector<double> coverage(const Direction& towards, double radius) const;

  [[nodiscard]] std::size_t size() const { return texels_.size(); }
  [[nodiscard]] const std::vector<Texel>& texels() const { return texels_; }
  [[nodiscard]] const std::vector<double>& luminance() const { return luminance_; }
  [[nodiscard]] const std::vector<double>& weight() const { return weight_; }
  [[nodiscard]] const std::vector<Direction>& centre() const { return centre_; }
  [[nodiscard]] const Direction& middle() const { return middle_; }
  [[nodiscard]] double texel() const { return texel_; }  ///< The longest chord across one in the middle.

 private:
  struct Part {
    Direction towards;
    double weight;
  };

  std::vector<Texel> texels_;
  std::vector<double> luminance_, weight_, reach_, step_;  // Step: across a part of a texel.
  std::vector<Direction> centre_;
  std::vector<Part> parts_;
  std::vector<std::size_t> first_part_;  // Of each texel, and the end of all.
  Direction middle_;
  double texel_;
};

struct DiscFit {
  std::vector<Disc> discs;
  double misfit = 1;  ///< rms of what is left over, over that of the light.
};

/// The best discs near those that are given. @param first where to begin; luminances have no meaning.
DiscFit fit_discs(const Patch& patch, std::span<const Disc> first);

/// What the texels leave open of one disc: all that explains them about as well as the best.
struct DiscDoubt {
  bool radius_is_open = false;  ///< Also a point does.
  Disc likely;  ///< That of the likely radius if it does, else the best, or the largest if that is open.
  double least_radius = 0, largest_radius = 0;
  double within = 0;  ///< Radians that the direction may be off.
};

/// @param k the disc of the fit; the others stay as they are.
DiscDoubt doubt_of(const Patch& patch, const DiscFit& fit, std::size_t k, double likely_radius);

}  // namespace envmap

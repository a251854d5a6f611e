/// @file
/// Facts about a map and the difference of two: all means and sums weighted by solid angle.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "envmap/base/export.h"
#include "envmap/map/environment_map.h"

namespace ENVMAP_EXPORT envmap {

/// A texel by face and position.
struct Texel {
  int face, i, j;
};

/// All of a level that touch the disc, by face, row and column.
std::vector<Texel> texels_of(const Level& level);

/// The place of a texel among all of a level in that order, those beside the disc among them.
std::size_t index_of(const Level& level, const Texel& texel);

/// What is wrong with the values of a map; texels without solid angle are not looked at.
struct Flaws {
  /// Texels; one with several flaws counts once, as the first of these.
  std::int64_t nan = 0, infinite = 0, negative = 0;
  std::optional<Texel> first;  ///< In reading order: by face, row, column.
  [[nodiscard]] std::int64_t count() const { return nan + infinite + negative; }
};
Flaws find_flaws(const Level& level);

/// Replaces flawed texels by the mean of their sound neighbours (of the 8 around; further out as holes fill up), NaN
/// and infinities alike; a negative channel is set to 0 where only it is at fault. @return texels changed.
/// Throws InputError where no texel is sound.
std::int64_t repair(Level& level);

/// Radiance of sound texels only, luminance by Rec. 709.
struct Measures {
  Rgb<double> minimum, maximum, mean;  ///< Per channel, W/(sr m^2) or whatever the pixels hold.
  Flux flux;                           ///< Per channel: sum of radiance x solid angle.
  double solid_angle;                  ///< 4 pi, as a check.
  double darkest, brightest;           ///< Luminance: least above 0, and largest; 0 if all is black.
  Texel brightest_texel;          ///< Of the largest region of texels as bright as any, the one nearest to its middle.
  Direction brightest_direction;  ///< The middle of that region, weighted by solid angle, in the world frame.
  std::int64_t brightest_texels;  ///< That the region has: many where a light was clipped.
  Colour brightest_value;
};
Measures measure(const EnvironmentMap& map);

/// Sum of radiance x solid angle of the sound texels.
Flux flux(const Level& level);

/// Mean of the three channels over the sphere, of the sound texels.
double mean_radiance(const Level& level);

/// Both at once.
struct Totals {
  Flux flux;
  double mean;
};
Totals totals(const Level& level);

/// Of a against the reference b: the metrics of every command. Infinite where b is black and a is not.
struct Difference {
  Flux flux;       ///< (flux a - flux b) / flux b, per channel.
  double rms;      ///< sqrt(sum w |a-b|^2 / sum w |b|^2), over texels and channels.
  double maximum;  ///< Largest |a-b| / max(|b|, 0.001 x mean of b), per channel.
  Texel worst;     ///< Where.
  [[nodiscard]] double largest_flux() const;
};

/// (flux a - flux b) / flux b, per channel. The two need not be of one size.
Flux flux_difference(const Level& a, const Level& b);

/// The factor on a that brings it nearest to b: the least rms. 1 where no factor above 0 does. @throws as compare().
double best_exposure(const Level& a, const Level& b);

/// @param shown if given, is set to |a-b| per texel. @throws UsageError where the levels, or `shown`, differ in
/// projection or size, InputError where one holds NaN or infinity.
Difference compare(const Level& a, const Level& b, Level* shown = nullptr);

/// Of all levels of two maps. The figures of the base class are the largest of any level, so that a limit which they
/// keep is kept by every level; of `flux` the largest of each channel in size, with its sign.
struct MapDifference : Difference {
  std::vector<Difference> levels;  ///< One for each, level 0 first.
  int worst_level = 0;             ///< The level of `maximum` and `worst`.
};

/// Level by level. @throws UsageError where the maps differ in their forward axis or in how many levels they have, too.
MapDifference compare(const EnvironmentMap& a, const EnvironmentMap& b);

}  // namespace envmap

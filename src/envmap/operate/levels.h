/// @file
/// Mip levels that keep the light: every texel is the solid-angle weighted mean of what it covers in the level before.
#pragma once

#include <iterator>
#include <string_view>

#include "envmap/base/enumerators.h"
#include "envmap/base/export.h"
#include "envmap/map/environment_map.h"

namespace ENVMAP_EXPORT envmap {

/// What a texel counts for in a mean: the light it stands for, or what plain mipmaps of an image give it (as
/// glGenerateMipmap does; kept to measure the difference).
enum class Weights { solid_angle, uniform };

inline constexpr std::string_view weight_names[] = {"solid-angle", "uniform"};
template <>
inline constexpr std::size_t enumerators<Weights> = std::size(weight_names);

/// Whether there is a level after: a face has more than one texel.
bool has_next(const Level& level);

/// The level after: each side half as long, rounded down, at least 1. Where a size is odd, texels that straddle two of
/// the result count for each by the part. Flux is kept to the rounding of float32. Texels outside the disc are 0 on
/// sphere and angular maps; on paraboloid maps they show what the other half does there, as a PaddedLevel finds it
/// (with uniform weights: plain means).
Level half_level(const Level& fine, Weights weights = Weights::solid_angle);

/// The same of any smaller size: texels count for each texel of the result by the part that lies in it.
Level coarser_level(const Level& fine, int width, int height, Weights weights = Weights::solid_angle);

/// Adds the levels of an octahedral map that lies inside a border, as wide in all levels (map/octahedral_border.h): the
/// textures halve, and the levels in them are smaller by twice the border; as long as a texel is left.
void add_levels_with_border(std::vector<Level>& levels, int border, Weights weights = Weights::solid_angle,
                            int count = 0);

/// Adds the levels after the last one, down to one texel a face, or until there are `count`.
/// @param count 0: no limit. @throws UsageError where there is no level, InputError where a texel is NaN or infinite.
void add_levels(std::vector<Level>& levels, Weights weights = Weights::solid_angle, int count = 0);
void add_levels(EnvironmentMap& map, Weights weights = Weights::solid_angle, int count = 0);

}  // namespace envmap

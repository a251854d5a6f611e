/// @file
/// The rule for texels that are no radiance: operations refuse NaN and infinity, prefiltering negative radiance, too;
/// measures leave texels of NaN and infinity out.
#pragma once

#include <string>

#include "envmap/map/environment_map.h"
#include "envmap/operate/measure.h"

namespace envmap {

/// "3 of 512 texels of level 1 are no radiance (2 NaN, 1 infinite), the first at (5,3) of face 0".
/// @param flaws of which count() is not 0. @param shown what stands after "texels": " of level 1".
std::string flaw_words(const Flaws& flaws, const Level& level, const std::string& shown = {});

/// Whether no texel is NaN or infinite, also of those that carry no weight.
bool all_finite(const Level& level);

/// Throws InputError where a texel that carries weight is NaN or infinite. @return the level, or the map.
const Level& require_finite(const Level& level, const std::string& shown = {});
/// Checks level 0.
const EnvironmentMap& require_finite(const EnvironmentMap& map);
/// Refuses negative radiance, too.
const EnvironmentMap& require_radiance(const EnvironmentMap& map);

/// Throws UsageError where a factor has made radiance infinite. @param factor "2 stops". @param field to lower.
void require_no_overflow(const Level& scaled, const std::string& factor, const std::string& field);

}  // namespace envmap

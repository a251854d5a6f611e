// Colour spaces, and what is done to the light of a probe before anything else.
#pragma once

#include <optional>
#include <string>

#include "maps/map_options.h"

namespace tools {

/// Makes the linear space of the output the working space, so that no colour is lost. To be called before reading.
void choose_working_space(envmap::ReadOptions& read, envmap::WriteOptions& write);

/// --gain, --white, --saturation, --scale-to, --towards.
struct GradeOptions {
  std::optional<envmap::Direction> gain, towards;
  std::string white;
  double saturation = 1;
  std::string scale_to;
};
void add_grade(Options& o, GradeOptions& grade);

/// A direction, (0, 1, 0) where nothing is said. @throws UsageError of (0, 0, 0).
envmap::Direction unit_or_up(const std::optional<envmap::Direction>& direction, const char* option);

/// @param option that was applied. @throws UsageError where a texel is beyond the largest float.
void check_finite(const envmap::Level& level, const std::string& option, const std::string& remedy);

/// Changes the map that was read. @param working its space, and the config of that.
void grade(envmap::Source& source, const GradeOptions& options, const envmap::ColourOptions& working);

}  // namespace tools

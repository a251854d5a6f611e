// Colour spaces, and what is done to the light of a probe before anything else.
#pragma once

#include <optional>
#include <string>

#include "command.h"

namespace tools {

/// --input-space and --ocio: part of add_read_options().
void add_input_space(CLI::App& app, envmap::ReadOptions& options);
/// --output-space and --encoded.
void add_output_space(CLI::App& app, envmap::WriteOptions& options);

/// Reads into the linear space of the output, so that what it holds is not lost on the way. To be called before reading.
void choose_working_space(envmap::ReadOptions& read, envmap::WriteOptions& write);

/// --gain, --white, --saturation, --scale-to, --towards.
struct GradeOptions {
  std::optional<envmap::Direction> gain, towards;
  std::string white;
  double saturation = 1;
  std::string scale_to;
};
void add_grade(CLI::App& app, GradeOptions& options);

/// A direction, (0, 1, 0) where nothing is said. @throws UsageError of (0, 0, 0).
envmap::Direction unit_or_up(const std::optional<envmap::Direction>& direction, const char* option);

/// Changes the map that was read. @param working its space, and the config of that.
void grade(envmap::Source& source, const GradeOptions& options, const envmap::ColourOptions& working, const Common& common);

}  // namespace tools

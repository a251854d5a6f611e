// --restore-sun, and what is said of suns that were clipped.
#pragma once

#include <optional>
#include <string>

#include "cli/options.h"
#include "cli/report.h"
#include "envmap/io/read.h"

namespace tools {

struct SunOptions {
  std::string restore;  // lux=E, irradiance=R,G,B or atmosphere; empty: nothing.
  std::optional<double> radius;
};
void add_restore_sun(Options& o, SunOptions& sun);

/// Adds the missing light to the map, and says how much. Nothing where it was not asked for.
/// @throws UsageError of words that are none of the forms.
void restore(envmap::Source& source, const std::string& input, const SunOptions& options, Report& report);

}  // namespace tools

// Options of JPEG files with a gain map, and what is reported of them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "cli/options.h"
#include "cli/report.h"
#include "envmap/io/write_gain_map.h"

namespace tools {

struct GainMapRequest {
  bool wanted = false;
  int channels = 3;
  std::uint64_t max_bytes = 0;  // 0: no limit.
  std::optional<envmap::Display> display;
};

void add_gain_map(Options& o, GainMapRequest& request);   ///< --gain-map, --gain-map-channels.
void add_max_bytes(Options& o, GainMapRequest& request);  ///< --max-bytes.

envmap::GainMapOptions gain_map_options(const GainMapRequest& request);

/// Writes it, the depfile and the report. @param asked --max-error, of which `how` has what is left.
/// @return false, with a warning, where a limit cannot be met.
bool write_gain_map(const std::string& path, const envmap::Rows& rows, const envmap::GainMapOptions& how,
                    std::optional<double> asked, const envmap::WriteOptions& options, Report& report);

}  // namespace tools

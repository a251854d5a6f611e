// What there is to say of a map and its file.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/report.h"
#include "envmap/io/read.h"
#include "envmap/light/lights.h"
#include "envmap/operate/measure.h"

namespace tools {

struct MapFacts {
  const envmap::Source& source;
  std::string file, space;
  envmap::Direction towards;  // What the plane of the illuminance faces.
  double illuminance;         // In lux.
  envmap::Flaws flaws;
  envmap::Measures measures;
  double range, stops;  // NaN where nothing is brighter than 0.
  std::int64_t texels_at_maximum;
  std::vector<envmap::DiscLight> suns;  // By find_lights(); of a map with NaN or infinity none.
};

// @param source must outlive the result. @param space of --input-space, or empty. @param towards up if absent.
MapFacts facts_of(const envmap::Source& source, const std::string& file, const std::string& space = {},
                  const std::optional<envmap::Direction>& towards = {});

// The keys of `info --json`.
void add(Report& report, const MapFacts& facts);

// The same as text: a name, which is empty where a line continues the one before, and a value.
using FactLines = std::vector<std::pair<std::string, std::string>>;
FactLines lines_of(const MapFacts& facts);

// Degrees about +Y from +Z towards +X, as --rotate counts them, and above the horizon.
struct Angles {
  double azimuth, elevation;
};
Angles angles_of(const envmap::Direction& direction);

}  // namespace tools

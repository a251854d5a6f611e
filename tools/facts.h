// What there is to say of a map and its file.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "envmap/io/read.h"

namespace tools {

// With the keys of `info --json`. @param space what --input-space said, or nothing. @param towards of the illuminance; up if absent.
nlohmann::ordered_json facts(const envmap::Source& source, const std::string& file, const std::string& space = {},
                             const std::optional<envmap::Direction>& towards = {});

// The same for people: a name, empty where the line goes on, and a text.
using FactLines = std::vector<std::pair<std::string, std::string>>;
FactLines lines_of(const nlohmann::ordered_json& facts);

// Degrees about +Y from +Z towards +X, as --rotate counts them, and above the horizon.
struct Angles {
  double azimuth, elevation;
};
Angles angles_of(const envmap::Direction& direction);

}  // namespace tools

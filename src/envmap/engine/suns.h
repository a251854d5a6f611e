/// @file
/// The lights of a probe in the words and units of engines.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "envmap/base/export.h"
#include "envmap/engine/engines.h"
#include "envmap/light/lights.h"

namespace ENVMAP_EXPORT envmap {

/// KHR_lights_punctual: directional lights in a scene of nothing else, as the text of a .gltf file.
/// @param lux of irradiance 1: what radiance 1 is in cd/m^2.
std::string gltf_lights(std::span<const DiscLight> lights, double lux = 1);

/// A file's name and its text.
using NamedText = std::pair<std::string, std::string>;

/// The file of an engine's folder that brings the lights: its script or stage with them, or a file of its own.
/// Intensities are in the unit of the maps: where the engine multiplies these, it does the same to the lights.
NamedText suns_file(const Engine& engine, std::span<const DiscLight> lights);

/// The name of that file alone.
std::string suns_file_name(const Engine& engine);

/// What the engine calls the intensity, and the source of its unit. A sentence or two.
std::string_view suns_unit(const Engine& engine);

}  // namespace envmap

/// @file
/// The folder of files that an engine loads, made of a probe.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "envmap/base/export.h"
#include "envmap/base/run.h"
#include "envmap/engine/engines.h"
#include "envmap/io/write.h"
#include "envmap/light/lights.h"
#include "envmap/map/environment_map.h"

namespace ENVMAP_EXPORT envmap {

/// Doublings of the sizes that maps have by default, -8 to 8, and the largest error of a lobe's texels before the
/// file's depth rounds them.
struct Quality {
  std::string_view name;
  int environment, chain;
  double max_error;
};
inline constexpr std::array<Quality, 3> qualities{
    {{"draft", -1, -1, 1e-2}, {"normal", 0, 0, 1e-3}, {"high", 0, 1, 1e-4}}};

struct BakeOptions {
  std::optional<int> size = {};        ///< Of maps of one level. Absent: the probe's degrees per texel, by the quality.
  std::optional<int> chain_size = {};  ///< Of the first level of chains. Absent: the engine's, by the quality.
  Quality quality = qualities[1];
  std::optional<double> max_error = {};  ///< Of all maps, as they are read from their files.
  double exposure = 0;                   ///< In stops: radiance is multiplied by 2^exposure.
  /// How the maps are written: depth (absent: the engine's, else that of `source_depth`), clamp, provenance, commit.
  /// Other fields have no meaning.
  WriteOptions write = {};
  /// Lights of the probe, by find_lights(), that the maps leave out. A file of the folder brings them (suns.h).
  std::optional<FoundLights> suns = {};
};

/// A map of the folder.
struct BakedFile {
  std::string name;
  Frame frame;
  int width, size, levels;  ///< Of the image and of a face, in texels.
  Written written;
  std::string accuracy;  ///< What is known of its errors, and the roughness of its levels, for people.
};

/// The files of the folder: maps, README.txt, and the text that loads them where the engine has one.
std::vector<std::string> files_of(const Engine& engine);
/// With the file of the suns, where the options have some.
std::vector<std::string> files_of(const Engine& engine, const BakeOptions& options);

/// Makes the folder, which appears whole or not at all. One is replaced that holds no other files than these and those
/// that an earlier bake for this engine wrote, by the last line of its README.txt.
/// @throws UsageError where a field is out of its range or the folder holds other files, InputError where a texel is
/// NaN or infinite, or negative and the engine has rough or diffuse light, OutputError where a file cannot be written,
/// AccuracyError where `max_error` cannot be met.
std::vector<BakedFile> bake(EnvironmentMap probe, const Engine& engine, const std::string& folder,
                            const BakeOptions& options = {}, const Run& run = {});

}  // namespace envmap

/// @file
/// What engines load: one row for each.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "envmap/base/enumerators.h"
#include "envmap/base/export.h"
#include "envmap/io/images/depth.h"
#include "envmap/map/environment_map.h"
#include "envmap/prefilter/lobe.h"

namespace ENVMAP_EXPORT envmap {

/// A file of text beside the map, and what is in it.
struct TextFile {
  std::string_view name = {}, text = {};
};

/// How the irradiance stands in the file beside the levels: Filament's pair `sh`, the polynomial of Babylon.js' .env,
/// the coefficients of EXT_lights_image_based. irradiance.h writes them.
enum class IrradianceForm { none, filament, babylon, gltf };
template <>
inline constexpr std::size_t enumerators<IrradianceForm> = std::size_t(IrradianceForm::gltf) + 1;

/// Levels of the environment as surfaces of rising roughness reflect it (the split sum), for a shader that picks one.
struct EngineChain {
  int size;    ///< Height of a face of the first level, unless another is asked for.
  int levels;  ///< 0: down to faces of `last` texels.
  /// Perceptual roughness that the engine's shader looks for in level k of n; 0 is the environment itself.
  double (*roughness)(int k, int n, int size);
  IrradianceForm irradiance = IrradianceForm::none;
  int last = 1;
  LobeShape lobe = LobeShape::ggx;  ///< Or charlie, the sheen of cloth.
};

struct EngineMap {
  std::string_view file;
  Frame frame = {Projection::cube};
  std::optional<Depth> depth = {};           ///< That its loader or the cards behind it want; else the source's.
  MirroredAxis mirror = MirroredAxis::none;  ///< x or z, of cubes that are looked up in a left-handed frame.
  std::optional<EngineChain> chain = {};     ///< Else the environment itself, one level;
  int diffuse = 0;                           ///< or the irradiance over pi, with faces so high.
  bool only_depth = false;                   ///< The loader takes no other than `depth`.
  bool zstd = false;                         ///< Its loader unpacks levels.
};

struct Engine {
  std::string_view name;        ///< As users type it; "babylon-env" are other files for the engine of "babylon".
  std::string_view title;       ///< As its makers write it.
  std::string_view version;     ///< What was read of it, and whether it was run.
  std::vector<EngineMap> maps;  ///< The first shows the environment.
  double largest = 0;           ///< That the engine's loader keeps; 0: any, or what the depth says.
  /// Where +X, +Y and +Z of the probe lie in the engine's world: "-X +Y +Z".
  std::string_view axes = "+X +Y +Z";
  std::string_view mirrored = "no";  ///< What mirrors the map for a left-handed world or lookup: "file" or "engine".
  std::string_view turns = {};       ///< More about the orientation, in sentences.
  std::string_view light = {};       ///< How diffuse and rough light is made.
  TextFile text = {};                ///< What loads the map, or nothing.
  std::string_view steps = {};       ///< What to do with the folder.
  std::string_view table = {};       ///< A file for the split-sum table of brdf_table.h, or nothing;
  std::string_view sheen = {};       ///< and one for its table of the albedo of sheen.
  std::string_view irradiance = {};  ///< A file for the irradiance as nine colours, or nothing.
};

/// All of them, by name.
std::span<const Engine> engines();

/// @param name such as "filament". @return null where there is no such engine.
const Engine* find_engine(std::string_view name);

/// The row of an engine that takes its environment as a panorama, too. @return null where there is none.
const Engine* find_latlong(const Engine& engine);

/// The part of an engine's name that the rows of its other files share: "three" of "three-latlong".
std::string_view family_of(const Engine& engine);

/// The same as find_engine(). @throws UsageError where there is no such engine.
const Engine& engine_named(std::string_view name);

/// The map of an engine that has levels of rising roughness. @throws UsageError where it takes none.
const EngineMap& chain_of(const Engine& engine);

/// The orientation of a map in the engine's world, in sentences.
std::string turns_of(const Engine& engine);
/// "latlong, +x at the centre".
std::string frame_words(const Frame& frame);

}  // namespace envmap

// The maps of an engine, made of a probe.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engines.h"
#include "envmap/map/rows.h"
#include "envmap/prefilter/prefilter.h"
#include "error_in_file.h"

namespace tools {

/// Sizes as powers of two of what they are else, and what texels of lobes may err by before the file's depth rounds them.
struct Quality {
  std::string_view name;
  int environment, chain;
  double max_error;
};
inline constexpr std::array<Quality, 3> qualities{{{"draft", -1, -1, 1e-2}, {"normal", 0, 0, 1e-3}, {"high", 0, 1, 1e-4}}};

struct MapOptions {
  std::optional<int> size;        ///< Of maps of one level. Absent: the probe's degrees per texel, by the quality.
  std::optional<int> chain_size;  ///< Of the first level of chains. Absent: the engine's, by the quality.
  Quality quality = qualities[1];
  std::optional<double> max_error;  ///< Of all maps, as they are read from their files.
  envmap::Costs costs = {};         ///< That methods are chosen by.
};

/// A map as it goes into its file. The rows may read `levels`.
struct MadeMap {
  envmap::EnvironmentMap levels;
  std::vector<envmap::Rows> rows;
  std::map<std::string, std::string> pairs;  ///< For WriteOptions::pairs.
  envmap::Facts facts;
  std::string accuracy;  ///< What is known of its errors.
};

/// The roughness of each level of a chain, `levels` of them or as many as the engine takes. @param option that says `size`.
/// @throws UsageError where the size does not have so many.
std::vector<double> roughnesses_of(const EngineMap& map, int size, std::optional<int> levels, std::string_view option);

/// The irradiance that goes beside a chain, for WriteOptions::pairs; nothing where the engine wants none.
std::map<std::string, std::string> irradiance_pairs(const EngineMap& map, const envmap::EnvironmentMap& source);

/// The engine's frame where that is left-handed: X or Z negated.
std::vector<envmap::Rows> mirrored(std::vector<envmap::Rows> levels, Mirror mirror);
/// Of levels that are not yet mirrored, what their file makes of them when they are: blocks see another order of texels.
std::optional<envmap::Rounding> mirrored(const std::optional<envmap::Rounding>& rounding, Mirror mirror);

/// Makes the maps of engines out of one probe; what several want of it is prepared once.
class MapMaker {
 public:
  /// @param source must outlive this.
  MapMaker(const envmap::EnvironmentMap& source, const MapOptions& options);

  /// @param rounding of the map's file, by rounding_of(). @throws NotReached where max_error is not.
  [[nodiscard]] MadeMap make(const EngineMap& wanted, const std::optional<envmap::Rounding>& rounding);

 private:
  [[nodiscard]] MadeMap environment(const EngineMap& wanted, const FileError& error) const;
  [[nodiscard]] MadeMap chain(const EngineMap& wanted, const FileError& error);
  [[nodiscard]] MadeMap diffuse(const EngineMap& wanted, const FileError& error);
  [[nodiscard]] MadeLevel lobe(const envmap::Prefilter& wanted, const FileError& error);

  const envmap::EnvironmentMap& source_;
  MapOptions options_;
  std::unique_ptr<envmap::PrefilterSource> prepared_;
};

}  // namespace tools

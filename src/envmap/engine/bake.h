// The maps of an engine, made of a probe.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "envmap/base/costs.h"
#include "envmap/engine/engines.h"
#include "envmap/engine/file_error.h"
#include "envmap/map/rows.h"
#include "envmap/prefilter/prefilter.h"

namespace envmap {

/// Sizes as powers of two of what they are else, and what texels of lobes may err by before the file's depth rounds
/// them.
struct Quality {
  std::string_view name;
  int environment, chain;
  double max_error;
};
inline constexpr std::array<Quality, 3> qualities{
    {{"draft", -1, -1, 1e-2}, {"normal", 0, 0, 1e-3}, {"high", 0, 1, 1e-4}}};

struct BakeOptions {
  std::optional<int> size;        ///< Of maps of one level. Absent: the probe's degrees per texel, by the quality.
  std::optional<int> chain_size;  ///< Of the first level of chains. Absent: the engine's, by the quality.
  Quality quality = qualities[1];
  std::optional<double> max_error;  ///< Of all maps, as they are read from their files.
  Costs costs = {};         ///< That methods are chosen by.
  std::string chain_size_name = "chain size";  ///< Names `chain_size` in errors.
  /// Makes the progress of one map out of its name. Optional.
  std::function<Progress(const std::string&)> progress = {};
};

/// A map as it goes into its file. The rows may read `levels`.
struct BakedMap {
  EnvironmentMap levels;
  std::vector<Rows> rows;
  std::map<std::string, std::string> pairs;  ///< For WriteOptions::pairs.
  Facts facts;
  std::string accuracy;  ///< What is known of its errors.
};

/// The roughness of each level of a chain, `levels` of them or as many as the engine takes. @param size_name names
/// `size` in the error.
/// @throws UsageError where the size does not have so many.
std::vector<double> roughnesses_of(const EngineMap& map, int size, std::optional<int> levels,
                                   std::string_view size_name);

/// The irradiance that goes beside a chain, for WriteOptions::pairs; nothing where the engine wants none.
std::map<std::string, std::string> irradiance_pairs(const EngineMap& map, const EnvironmentMap& source,
                                                    const Progress& progress);

/// The engine's frame where that is left-handed: X or Z negated.
std::vector<Rows> mirrored(std::vector<Rows> levels, MirroredAxis mirror);
/// Of levels that are not yet mirrored, what their file makes of them when they are:
/// blocks see another order of texels.
std::optional<Rounding> mirrored(const std::optional<Rounding>& rounding, MirroredAxis mirror);

/// Makes the maps of engines out of one probe; what several want of it is prepared once.
class Baker {
 public:
  /// @param source must outlive this.
  Baker(const EnvironmentMap& source, const BakeOptions& options);

  /// @param rounding of the map's file, by rounding_of(). @throws NotReached where max_error is not.
  [[nodiscard]] BakedMap make(const EngineMap& wanted, const std::optional<Rounding>& rounding);

 private:
  [[nodiscard]] BakedMap environment(const EngineMap& wanted, const FileError& error) const;
  [[nodiscard]] BakedMap chain(const EngineMap& wanted, const FileError& error);
  [[nodiscard]] BakedMap diffuse(const EngineMap& wanted, const FileError& error);
  [[nodiscard]] BakedLevel lobe(const Prefilter& wanted, const FileError& error);

  [[nodiscard]] Progress progress(const std::string& work) const {
    return options_.progress ? options_.progress(work) : Progress();
  }

  const EnvironmentMap& source_;
  BakeOptions options_;
  std::unique_ptr<PrefilterSource> prepared_;
};

}  // namespace envmap

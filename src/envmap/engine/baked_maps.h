// The maps of an engine in memory, made of a probe.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "envmap/engine/bake.h"
#include "envmap/io/error_budget.h"
#include "envmap/map/rows.h"
#include "envmap/prefilter/prefilter.h"

namespace envmap {

/// A map as it goes into its file. The rows may read `levels`.
struct BakedMap {
  EnvironmentMap levels;
  std::vector<Rows> rows;
  std::map<std::string, std::string> pairs;  ///< For WriteOptions::pairs.
  Facts facts;
  std::string accuracy;  ///< What is known of its errors, and the roughness of its levels.
};

/// The irradiance that goes beside a chain, for WriteOptions::pairs; nothing where the engine wants none.
/// @param prepared of `source`.
std::map<std::string, std::string> irradiance_pairs(const EngineMap& map, const EnvironmentMap& source,
                                                    const Prefilterer& prepared, const Progress& progress);

/// The engine's frame where that is left-handed: X or Z negated.
std::vector<Rows> mirrored(std::vector<Rows> levels, MirroredAxis mirror);
/// Of levels that are not yet mirrored, what their file makes of them when they are:
/// blocks see another order of texels.
std::optional<Rounding> mirrored(const std::optional<Rounding>& rounding, MirroredAxis mirror);

/// Says in the facts of a file that it is mirrored, so that read() turns it back (map/mirrored_rows.h).
void record_mirror(Facts& facts, MirroredAxis mirror);

/// Makes the maps of engines out of one probe; what several want of it is prepared once.
class Baker {
 public:
  /// @param source must outlive this.
  Baker(const EnvironmentMap& source, const BakeOptions& options);

  /// @param rounding of the map's file, by rounding_of(). @throws AccuracyError where max_error is not met.
  [[nodiscard]] BakedMap make(const EngineMap& wanted, const std::optional<Rounding>& rounding,
                              const Progress& progress = {});

 private:
  [[nodiscard]] BakedMap environment(const EngineMap& wanted, const ErrorBudget& budget) const;
  [[nodiscard]] BakedMap chain(const EngineMap& wanted, const ErrorBudget& budget, const Progress& progress);
  [[nodiscard]] BakedMap diffuse(const EngineMap& wanted, const ErrorBudget& budget, const Progress& progress);
  [[nodiscard]] const Prefilterer& prepared();
  [[nodiscard]] LevelInFile lobe(const PrefilterOptions& wanted, const ErrorBudget& budget, const Progress& progress);

  const EnvironmentMap& source_;
  BakeOptions options_;
  std::unique_ptr<Prefilterer> prepared_;
};

}  // namespace envmap

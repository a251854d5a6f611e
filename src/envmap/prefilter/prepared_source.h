/// @file
/// A source, and the pyramids of it that the methods sum over. Each pyramid is made when a method first asks for it.
/// No result depends on the lobes that were made before.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <optional>

#include "envmap/operate/measure.h"
#include "envmap/prefilter/multilevel/multilevel.h"
#include "envmap/prefilter/sheen/sheen_blocks.h"
#include "envmap/prefilter/treecode/tree.h"

namespace envmap::prefiltering {

class PreparedSource {
  const std::shared_ptr<const EnvironmentMap> held_;

 public:
  const EnvironmentMap& map;  ///< A cube or latlong map. A map of another projection is converted to a cube.
  const Totals light;
  std::timed_mutex in_use;  ///< Held while a map is made: one at a time.

  /// @throws UsageError where there is no map, InputError where a texel is no radiance.
  PreparedSource(std::shared_ptr<const EnvironmentMap> given, const Progress& progress);

  [[nodiscard]] const Level& texels() const { return map.base(); }
  [[nodiscard]] const Tree& tree();
  /// @param order highest power of t+. @param error of the sums.
  [[nodiscard]] const PrefixSums& prefix_sums(int order, double error);
  [[nodiscard]] MultilevelSource multilevel(const MultilevelPlan& plan, double error);
  /// @param texel an angle that the texels of the blocks do not exceed.
  [[nodiscard]] const SheenBlocks& sheen(double texel);

 private:
  [[nodiscard]] const Level& small_texels() const { return fine_ ? *fine_ : texels(); }
  [[nodiscard]] const Colour& min_radiance();

  const std::optional<Level> fine_;  // The map in texels of 1.4 degrees, where its own are larger.
  std::optional<Colour> min_radiance_;
  std::optional<Tree> tree_;
  std::optional<PrefixSums> prefix_sums_;  // For the order and error that were asked for last.
  std::map<int, SourceGrids> grids_;       // By rows of the finest grid.
  std::map<int, SheenBlocks> blocks_;      // By rows of texels.
};

}  // namespace envmap::prefiltering

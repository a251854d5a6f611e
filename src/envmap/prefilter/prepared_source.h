/// @file
/// A source and what the methods sum over, each made when it is wanted first.
#pragma once

#include <map>
#include <mutex>
#include <optional>

#include "envmap/operate/measure.h"
#include "envmap/prefilter/multilevel/multilevel.h"
#include "envmap/prefilter/sheen/sheen_blocks.h"
#include "envmap/prefilter/treecode/tree.h"

namespace envmap::prefiltering {

class PreparedSource {
  const std::optional<EnvironmentMap> taken_, cube_;

 public:
  const EnvironmentMap& map;  ///< A cube or latlong map: of another projection, the cube of it.
  const Totals light;
  std::timed_mutex in_use;  ///< By the one map that is made.

  /// @param given a map to keep; else `lent` must outlive this. @throws InputError where a texel is no radiance.
  PreparedSource(std::optional<EnvironmentMap>&& given, const EnvironmentMap* lent, const Progress& progress);

  [[nodiscard]] const Level& texels() const { return map.base(); }
  [[nodiscard]] const Tree& tree();
  /// @param order of the powers of t+, at most. @param error of the sums.
  [[nodiscard]] const Hinges& hinges(int order, double error);
  [[nodiscard]] MultilevelSource multilevel(const MultilevelPlan& plan, double error);
  /// @param texel an angle: blocks are of texels that are no larger.
  [[nodiscard]] const SheenBlocks& sheen(double texel);

 private:
  [[nodiscard]] const Level& small_texels() const { return fine_ ? *fine_ : texels(); }
  [[nodiscard]] const Colour& darkest();

  const std::optional<Level> fine_;  // In texels of 1.4 degrees, where those of the map are larger.
  std::optional<Colour> darkest_;
  std::optional<Tree> tree_;
  std::optional<Hinges> hinges_;       // Of the order and error wanted last.
  std::map<int, SourceGrids> grids_;   // By the rows of the finest: no result depends on earlier ones.
  std::map<int, SheenBlocks> blocks_;  // By rows of texels.
};

}  // namespace envmap::prefiltering

#include "envmap/prefilter/prepared_source.h"

#include <utility>

#include "envmap/operate/refuse_flaws.h"
#include "envmap/prefilter/source_cube.h"

namespace envmap::prefiltering {

PreparedSource::PreparedSource(std::optional<EnvironmentMap>&& given, const EnvironmentMap* lent,
                               const Progress& progress)
    : taken_(std::move(given)),
      cube_(source_cube(require_radiance(taken_ ? *taken_ : *lent), progress)),
      map(cube_    ? *cube_
          : taken_ ? *taken_
                   : *lent),
      light(totals(map.base())),
      fine_(refined(map.base())) {}

const Colour& PreparedSource::darkest() {
  if (!darkest_) darkest_ = darkest_of(texels());
  return *darkest_;
}

const Tree& PreparedSource::tree() {
  if (!tree_) tree_.emplace(small_texels(), light.mean);
  return *tree_;
}

const Hinges& PreparedSource::hinges(int order, double error) {
  if (!hinges_ || !hinges_->fits(order, error)) hinges_.emplace(small_texels(), light.mean, darkest(), order, error);
  return *hinges_;
}

MultilevelSource PreparedSource::multilevel(const MultilevelPlan& plan, double error) {
  const SourceGrids& grids =
      grids_.try_emplace(plan.finest(), texels(), light.mean, darkest(), plan.finest()).first->second;
  return {small_texels(), grids, plan.has_hinges() ? &hinges(plan.hinges.order(), error) : nullptr, light.mean,
          darkest()};
}

const SheenBlocks& PreparedSource::sheen(double texel) {
  const std::optional<Level> finer = refined(texels(), texel);
  const Level& fine = finer ? *finer : texels();
  return blocks_.try_emplace(fine.height(), fine, light.mean, darkest()).first->second;
}

}  // namespace envmap::prefiltering

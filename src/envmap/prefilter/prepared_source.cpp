// Makes each pyramid of a source on first use.
#include "envmap/prefilter/prepared_source.h"

#include <utility>

#include "envmap/operate/refuse_flaws.h"
#include "envmap/prefilter/source_cube.h"

namespace envmap::prefiltering {

namespace {

// The map, or its cube in its place.
std::shared_ptr<const EnvironmentMap> prepared(std::shared_ptr<const EnvironmentMap> given, const Progress& progress) {
  if (!given) throw UsageError("a prefilter needs a map: the pointer is null");
  auto cube = source_cube(require_radiance(*given), progress);
  return cube ? std::make_shared<const EnvironmentMap>(*std::move(cube)) : given;
}

}  // namespace

PreparedSource::PreparedSource(std::shared_ptr<const EnvironmentMap> given, const Progress& progress)
    : held_(prepared(std::move(given), progress)), map(*held_), light(totals(map.base())), fine_(refined(map.base())) {}

const Colour& PreparedSource::min_radiance() {
  if (!min_radiance_) min_radiance_ = min_radiance_of(texels());
  return *min_radiance_;
}

const Tree& PreparedSource::tree() {
  if (!tree_) tree_.emplace(small_texels(), light.mean, (fine_ ? totals(*fine_) : light).flux, min_radiance());
  return *tree_;
}

const PrefixSums& PreparedSource::prefix_sums(int order, double error) {
  if (!prefix_sums_ || !prefix_sums_->fits(order, error))
    prefix_sums_.emplace(small_texels(), light.mean, min_radiance(), order, error);
  return *prefix_sums_;
}

MultilevelSource PreparedSource::multilevel(const MultilevelPlan& plan, double error) {
  const SourceGrids& grids =
      grids_.try_emplace(plan.finest(), texels(), light.mean, min_radiance(), plan.finest()).first->second;
  return {small_texels(), grids, plan.has_horizon_terms() ? &prefix_sums(plan.horizon_terms.order(), error) : nullptr,
          light.mean, min_radiance()};
}

const SheenBlocks& PreparedSource::sheen(double texel) {
  const std::optional<Level> finer = refined(texels(), texel);
  const Level& fine = finer ? *finer : texels();
  return blocks_.try_emplace(fine.height(), fine, light.mean, min_radiance()).first->second;
}

}  // namespace envmap::prefiltering

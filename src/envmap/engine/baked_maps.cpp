#include "envmap/engine/baked_maps.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

#include "envmap/base/error.h"
#include "envmap/base/part_progress.h"
#include "envmap/engine/babylon_irradiance.h"
#include "envmap/engine/irradiance.h"
#include "envmap/engine/level_roughness.h"
#include "envmap/map/mirrored_rows.h"
#include "envmap/operate/convert.h"
#include "envmap/projection/matching_size.h"

namespace envmap {
namespace {

int scaled(int size, int doublings) { return std::max(1, doublings < 0 ? size >> -doublings : size << doublings); }

std::string of_lobes(const ErrorBudget& budget, double max_error) {
  return budget.asked ? fmt::format("every texel read from it within {:g}", *budget.asked)
                      : fmt::format("every texel within {:g} before its depth rounds it", max_error);
}

}  // namespace

std::vector<Rows> mirrored(std::vector<Rows> levels, MirroredAxis mirror) {
  for (Rows& rows : levels) rows = mirrored_rows(rows, mirror);
  return levels;
}

std::optional<Rounding> mirrored(const std::optional<Rounding>& rounding, MirroredAxis mirror) {
  if (mirror == MirroredAxis::none || !rounding || !rounding->read_back) return rounding;
  const auto turn = [mirror](const Level& level) {
    return level_of(mirrored_rows(rows_of(level, Forward::plus_z), mirror));
  };
  Rounding turned = *rounding;
  turned.read_back = [turn, read_back = rounding->read_back](const Level& level) {
    return turn(read_back(turn(level)));
  };
  return turned;
}

void record_mirror(Facts& facts, MirroredAxis mirror) {
  if (mirror != MirroredAxis::none) facts[std::string(mirrored_fact)] = mirrored_axis_names[std::size_t(mirror)];
}

std::map<std::string, std::string> irradiance_pairs(const EngineMap& map, const EnvironmentMap& source,
                                                    const Prefilterer& prepared, const Progress& progress) {
  if (!map.chain || map.chain->irradiance == IrradianceForm::none) return {};
  const Harmonics radiance = project(source, 2, {.progress = progress});
  std::map<std::string, std::string> pairs{harmonics_pair(map.chain->irradiance, irradiance_polynomial(radiance))};
  if (map.chain->irradiance == IrradianceForm::babylon) pairs.merge(babylon_irradiance(prepared, radiance));
  return pairs;
}

Baker::Baker(const EnvironmentMap& source, const BakeOptions& options) : source_(source), options_(options) {}

BakedMap Baker::environment(const EngineMap& wanted, const ErrorBudget& budget) const {
  const Projection to = wanted.frame.projection;
  const int dense = matching_size(source_.projection(), source_.base().height(), to);
  const int size = options_.size.value_or(scaled(dense, options_.quality.environment));
  BakedMap made;
  if (!budget.asked) {
    made.rows.push_back(Resampler(source_, {.to = wanted.frame, .size = size}).rows());
    made.accuracy = "resampled as 'envmap convert' does by itself";
    return made;
  }
  LevelInFile level = resample_level(source_, wanted.frame, size, budget, true);
  made.levels = std::move(level.done.map);
  made.rows = all_rows_of(made.levels);
  made.accuracy = fmt::format("read from it within {:g}, by {} and its depth, in the texels where that was measured",
                              *budget.asked, method_name(level.done));
  return made;
}

BakedMap Baker::chain(const EngineMap& wanted, const ErrorBudget& budget, const Progress& progress) {
  const int base = options_.chain_size.value_or(scaled(wanted.chain->size, options_.quality.chain));
  const std::vector<double> roughnesses = level_roughnesses(wanted, base, {}, "chain_size");
  const LobeShape shape = wanted.chain->lobe;
  BakedMap made{.facts = {{"lobe", std::string(lobe_shape_names[std::size_t(shape)])}}};
  std::string by_level;
  for (std::size_t k = 0; k < roughnesses.size(); ++k) {
    made.facts["roughness"] += fmt::format("{}{:g}", k == 0 ? "" : ",", roughnesses[k]);
    by_level += fmt::format("{}{:.3g}", k == 0 ? "" : ", ", roughnesses[k]);
    const int size = base >> k;
    const double share = 1 / double(roughnesses.size());
    const PrefilterOptions wanted_level{.lobe = Lobe(shape, roughnesses[k]),
                                        .to = wanted.frame.projection,
                                        .size = size};
    LevelInFile level = wanted_level.lobe.is_mirror()
                            ? resample_level(source_, wanted.frame, size, budget, false)
                            : lobe(wanted_level, budget, part_progress(progress, share * double(k), share));
    made.levels.levels.push_back(std::move(level.done.map.base()));
  }
  made.rows = all_rows_of(made.levels);
  made.pairs = irradiance_pairs(wanted, source_, prepared(), {});
  made.accuracy = of_lobes(budget, options_.quality.max_error) + "; roughness by level: " + by_level;
  return made;
}

BakedMap Baker::diffuse(const EngineMap& wanted, const ErrorBudget& budget, const Progress& progress) {
  BakedMap made{.facts = {{"lobe", "diffuse"}}};
  const int size = scaled(wanted.diffuse, options_.quality.chain);
  const PrefilterOptions diffuse{.to = wanted.frame.projection, .size = size, .forward = wanted.frame.forward};
  made.levels = std::move(lobe(diffuse, budget, progress).done.map);
  made.rows = all_rows_of(made.levels);
  made.accuracy = of_lobes(budget, options_.quality.max_error);
  return made;
}

const Prefilterer& Baker::prepared() {
  if (!prepared_) prepared_ = std::make_unique<Prefilterer>(borrowed(source_));
  return *prepared_;
}

LevelInFile Baker::lobe(const PrefilterOptions& wanted, const ErrorBudget& budget, const Progress& progress) {
  PrefilterOptions within = wanted;
  within.max_error = budget.asked ? left_to_prefilter(budget) : options_.quality.max_error;
  return make_level(prepared(), within, budget, false, progress);
}

BakedMap Baker::make(const EngineMap& wanted, const std::optional<Rounding>& rounding, const Progress& progress) {
  const ErrorBudget budget{options_.max_error, mirrored(rounding, wanted.mirror)};
  BakedMap made = wanted.chain         ? chain(wanted, budget, progress)
                  : wanted.diffuse > 0 ? diffuse(wanted, budget, progress)
                                       : environment(wanted, budget);
  made.rows = mirrored(std::move(made.rows), wanted.mirror);
  record_mirror(made.facts, wanted.mirror);
  return made;
}

}  // namespace envmap

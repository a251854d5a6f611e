#include "envmap/io/error_budget.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "envmap/base/error.h"
#include "envmap/io/texels/value_range.h"
#include "envmap/map/atlas.h"
#include "envmap/operate/measure.h"

namespace envmap {
namespace {

[[noreturn]] void refuse(const ErrorBudget& budget) {
  throw AccuracyError(budget.rounding ? rounding_words(*budget.rounding, *budget.rounding->largest)
                                      : "integers, lossy compression and OpenEXR's envmap layout have no bound");
}

// A value beyond a depth's range has no bound: more error, as was asked for, does not help.
void require_range(const Rounding& rounding, const Level& level) {
  const double most = range_of(rounding.depth, std::numeric_limits<double>::infinity()).largest;
  float brightest = 0;
  for (int face = 0; face < level.faces(); ++face)
    for (int j = 0; j < level.height(); ++j)
      for (const Colour& c : level.row(face, j)) brightest = std::max({brightest, c.x, c.y, c.z});
  if (brightest > most)
    throw AccuracyError(fmt::format("the largest value is {:g}, and {} holds values up to {:g}", brightest,
                                    name(rounding), most),
                        Remedy::clamp_or_dim);
}

void check(const LevelInFile& made, const ErrorBudget& budget) {
  if (budget.asked && made.in_file() > *budget.asked && budget.rounding->read_back)
    require_range(*budget.rounding, made.done.map.base());
  if (budget.asked && made.in_file() > *budget.asked)
    throw AccuracyError(budget.rounding->read_back ? rounding_words(*budget.rounding, made.rounded)
                                                   : fmt::format("the error is {:.1e}", made.done.error));
}

}  // namespace

std::string rounding_words(const Rounding& rounding, double rounded) {
  if (!std::isfinite(rounded)) return fmt::format("{} does not hold the largest value", name(rounding));
  return fmt::format("{} rounds by up to {:.1e}", name(rounding), rounded);
}

double left_to_prefilter(const ErrorBudget& budget) {
  const double rounded = budget.rounding ? budget.rounding->largest.value_or(0) : *budget.asked;
  if (rounded >= *budget.asked) refuse(budget);
  return std::max(0.1 * *budget.asked, *budget.asked - rounded);
}

double left_to_filter(const ErrorBudget& budget) {
  const double rounded = budget.rounding ? budget.rounding->largest.value_or(0.5 * *budget.asked) : *budget.asked;
  if (rounded >= *budget.asked) refuse(budget);
  return (*budget.asked - rounded) / (1 + rounded);
}

LevelInFile make_level(const Prefilterer& source, const PrefilterOptions& wanted, const ErrorBudget& budget,
                       bool measure, const Progress& progress) {
  LevelInFile made{source.make(wanted, {.progress = progress})};
  if (!budget.rounding || !(budget.asked || measure)) return made;
  const auto rounded = [&] { return rounding_error(*budget.rounding, made.done.map.base(), made.done.floor); };
  made.rounded = rounded();
  if (budget.asked && made.in_file() > *budget.asked && made.rounded < *budget.asked) {
    PrefilterOptions closer = wanted;
    closer.max_error = 0.9 * (*budget.asked - made.rounded);
    made.done = source.make(closer, {.progress = progress});
    made.rounded = rounded();
  }
  check(made, budget);
  return made;
}

LevelInFile resample_level(const EnvironmentMap& source, const Frame& frame, std::optional<int> size,
                           const ErrorBudget& budget, bool measure, const std::vector<char>& rows) {
  ConvertOptions how{.to = frame, .size = size};
  if (budget.asked) how.max_error = left_to_filter(budget);
  const Resampler resampler(source, how);
  LevelInFile made{.done = {.map = {}, .method = Method::exact, .resampled = resampler.filter().filter},
                   .sampled = true};
  if (const auto& choice = resampler.choice()) {
    made.done.error = choice->trials.back().maximum;
    if (!choice->reached)
      throw AccuracyError(fmt::format("the error of the filter area is at least {:.1e}", made.done.error));
  }
  made.done.map.forward = frame.forward;
  made.done.map.levels.push_back(level_of(some_rows(resampler.rows(), rows)));
  if (budget.rounding && (measure || budget.asked)) {
    const Level& level = made.done.map.base();
    made.rounded = rounding_error(*budget.rounding, level, 0.001 * mean_radiance(level));
    check(made, budget);
  }
  return made;
}

}  // namespace envmap

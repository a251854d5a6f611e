#include "envmap/io/error_budget.h"

#include <fmt/format.h>

#include <algorithm>

#include "envmap/base/error.h"
#include "envmap/map/atlas.h"
#include "envmap/operate/measure.h"

namespace envmap {
namespace {

[[noreturn]] void refuse(const FileError& error) {
  throw AccuracyError(error.rounding ? rounding_words(*error.rounding, *error.rounding->largest)
                                     : "integers, lossy compression and OpenEXR's envmap layout have no bound");
}

void check(const BakedLevel& made, const FileError& error) {
  if (error.asked && made.in_file() > *error.asked)
    throw AccuracyError(error.rounding->read_back ? rounding_words(*error.rounding, made.rounded)
                                                  : fmt::format("the error is {:.1e}", made.done.error));
}

}  // namespace

std::string rounding_words(const Rounding& rounding, double rounded) {
  return fmt::format("{} rounds by up to {:.1e}", name(rounding), rounded);
}

double left_to_prefilter(const FileError& error) {
  const double rounded = error.rounding ? error.rounding->largest.value_or(0) : *error.asked;
  if (rounded >= *error.asked) refuse(error);
  return std::max(0.1 * *error.asked, *error.asked - rounded);
}

double left_to_filter(const FileError& error) {
  const double rounded = error.rounding ? error.rounding->largest.value_or(0.5 * *error.asked) : *error.asked;
  if (rounded >= *error.asked) refuse(error);
  return (*error.asked - rounded) / (1 + rounded);
}

BakedLevel make_level(const PrefilterSource& source, const Prefilter& wanted, const FileError& error, bool measure,
                      const Progress& progress) {
  BakedLevel made{source.make(wanted, {.progress = progress})};
  if (!error.rounding || !(error.asked || measure)) return made;
  const auto rounded = [&] { return rounding_error(*error.rounding, made.done.map.base(), made.done.floor); };
  made.rounded = rounded();
  if (error.asked && made.in_file() > *error.asked && made.rounded < *error.asked) {
    Prefilter closer = wanted;
    closer.max_error = 0.9 * (*error.asked - made.rounded);
    made.done = source.make(closer, {.progress = progress});
    made.rounded = rounded();
  }
  check(made, error);
  return made;
}

BakedLevel resample_level(const EnvironmentMap& source, const Frame& frame, std::optional<int> size,
                          const FileError& error, bool measure, const std::vector<char>& rows) {
  ConvertOptions how{.to = frame, .size = size};
  if (error.asked) how.max_error = left_to_filter(error);
  const Resampler resampler(source, how);
  BakedLevel made{.done = {.map = {}, .method = Method::exact, .resampled = resampler.filter().filter},
                  .sampled = true};
  if (const auto& choice = resampler.choice()) {
    made.done.error = choice->trials.back().maximum;
    if (!choice->reached)
      throw AccuracyError(fmt::format("the error of the filter area is at least {:.1e}", made.done.error));
  }
  made.done.map.forward = frame.forward;
  made.done.map.levels.push_back(level_of(some_rows(resampler.rows(), rows)));
  if (error.rounding && (measure || error.asked)) {
    const Level& level = made.done.map.base();
    made.rounded = rounding_error(*error.rounding, level, 0.001 * mean_radiance(level));
    check(made, error);
  }
  return made;
}

}  // namespace envmap

/// @file
/// The error budget of a file: --max-error holds for what readers find in it. A part of it is what the depth rounds by;
/// the rest is left to prefiltering, or to the filter of a conversion.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "envmap/io/texels/rounding.h"
#include "envmap/operate/convert.h"
#include "envmap/prefilter/prefilter.h"

namespace envmap {

/// The error that a file may have.
struct ErrorBudget {
  /// Of all; else what is made errs by its own default, and rounding comes on top.
  std::optional<double> asked;
  std::optional<Rounding> rounding;  ///< Of its depth; nothing where that has no bound.
};

/// What is left for making a map. Half of what is asked where rounding is known of the result alone.
/// @throws AccuracyError where the depth rounds by more than was asked: what rounds, and by how much.
double left_to_prefilter(const ErrorBudget& budget);
double left_to_filter(const ErrorBudget& budget);

/// A level that was made for a file, and its error there.
struct LevelInFile {
  Prefiltered done;
  double rounded = 0;    ///< What the file's depth takes from it; 0 where that was not asked for.
  bool sampled = false;  ///< `done.error` was measured in some texels: of resample_level().

  /// What readers find it to be off: what it was made with, over the truth, and what was lost since,
  /// over what was made.
  [[nodiscard]] double in_file() const { return done.error + rounded * (1 + done.error); }
};

/// A lobe's map, made again closer where the file's depth takes more of it than was left to it: dark channels under a
/// shared exponent.
/// @param wanted its max_error is left_to_prefilter(). @param measure whether `rounded` is wanted where nothing was
/// asked.
/// @throws AccuracyError where the file errs by more than was asked.
LevelInFile make_level(const Prefilterer& source, const PrefilterOptions& wanted, const ErrorBudget& budget,
                       bool measure, const Progress& progress);

/// The environment itself, resampled as `envmap convert` does. @param rows which to make, as Prefilter::rows.
/// @throws AccuracyError as make_level().
LevelInFile resample_level(const EnvironmentMap& source, const Frame& frame, std::optional<int> size,
                           const ErrorBudget& budget, bool measure, const std::vector<char>& rows = {});

/// "half, which rounds by up to 4.9e-04".
std::string rounding_words(const Rounding& rounding, double rounded);

}  // namespace envmap

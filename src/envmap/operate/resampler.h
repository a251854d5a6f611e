/// @file
/// A conversion, prepared once: what it will do, and its rows.
#pragma once

#include <optional>
#include <vector>

#include "envmap/base/export.h"
#include "envmap/map/rows.h"
#include "envmap/operate/choose_filter.h"
#include "envmap/operate/convert.h"

namespace ENVMAP_EXPORT envmap {

/// Resamples a map into another frame, size and density. Made from a source and options, const ever after; it holds what
/// the filter reads, so the source need not outlive it.
class Resampler {
 public:
  /// Copies the source's texels.
  Resampler(const EnvironmentMap& source, const ConvertOptions& options) : Resampler(source.clone(), options) {}
  /// Takes the source's texels over: no more memory than the map itself.
  Resampler(EnvironmentMap&& source, const ConvertOptions& options);
  Resampler(const Resampler&) = delete;
  Resampler& operator=(const Resampler&) = delete;

  [[nodiscard]] const Frame& frame() const { return frame_; }
  [[nodiscard]] int size() const { return target_.size; }
  /// As it was asked for or chosen.
  [[nodiscard]] const FilterOptions& filter() const { return filter_; }
  /// How the filter was chosen, where `max_error` was given.
  [[nodiscard]] const std::optional<FilterChoice>& choice() const { return choice_; }

  /// The result row by row, the same at any number of threads. The resampler must outlive them.
  [[nodiscard]] Rows rows() const;

 private:
  Frame frame_;
  Target target_;
  FilterOptions filter_;
  double gain_;
  std::optional<FilterChoice> choice_;
  std::optional<Level> unchanged_;   // The source, where its texels are the result's own and nothing is resampled.
  std::vector<PaddedLevel> levels_;  // Else what the filter reads.
  Sampler sampler_;
  std::size_t texels_between_trims_ = 0;
};

}  // namespace envmap

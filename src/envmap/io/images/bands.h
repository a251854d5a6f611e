/// @file
/// An image in bands of rows, so that no image need be in memory whole.
#pragma once

#include <functional>
#include <span>
#include <utility>
#include <vector>

#include "envmap/base/part_progress.h"
#include "envmap/base/run.h"
#include "envmap/io/images/image_writer.h"
#include "envmap/map/atlas.h"

namespace envmap {

/// Enough rows that every core has some, few enough that they stay small beside the source; whole tiles in files that
/// have them.
inline constexpr int band_rows = tile_size;

using WriteBand = std::function<void(int begin, int end, std::vector<Colour>& band)>;

/// Bands of these rows from the top; the next one is made while one is written. @param progress may be empty.
void for_each_band(const Atlas& atlas, const RowRange& rows, const Progress& progress, const WriteBand& write_band);
/// Of all rows.
void for_each_band(const Atlas& atlas, const Progress& progress, const WriteBand& write_band);

/// The progress of images one after another: each has the share of its texels in those of all levels.
class PartsOfProgress {
 public:
  /// @param whole must outlive this; it may be empty.
  PartsOfProgress(const Progress& whole, std::span<const Atlas> levels) : whole_(whole) {
    for (const Atlas& level : levels) all_ += level.texels();
  }
  Progress next(const Atlas& image) {
    const double first = std::exchange(done_, done_ + image.texels());
    return part_progress(whole_, first / all_, image.texels() / all_);
  }

 private:
  const Progress& whole_;
  double all_ = 0, done_ = 0;
};

}  // namespace envmap

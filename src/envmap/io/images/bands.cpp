#include "envmap/io/images/bands.h"

#include <algorithm>

#include "envmap/base/parallel.h"

namespace envmap {

void for_each_band(const Atlas& atlas, const Progress& progress, const WriteBand& write_band) {
  for_each_band(atlas, {0, atlas.height()}, progress, write_band);
}

void for_each_band(const Atlas& atlas, const RowRange& rows, const Progress& progress, const WriteBand& write_band) {
  const auto make = [&](int begin, std::vector<Colour>& band) {
    const int end = std::min(begin + band_rows, rows.end);
    band.resize(std::size_t(end - begin) * std::size_t(atlas.width()));
    atlas.gather(begin, end, band);
  };
  std::vector<Colour> band, next;
  make(rows.begin, band);
  for (int begin = rows.begin; begin < rows.end; begin += band_rows) {
    const int end = std::min(begin + band_rows, rows.end);
    const auto make_next = [&] {
      if (end < rows.end) make(end, next);
    };
    overlap(make_next, [&] { write_band(begin, end, band); });
    std::swap(band, next);
    if (progress) progress(double(end - rows.begin) / (rows.end - rows.begin));
  }
}

}  // namespace envmap

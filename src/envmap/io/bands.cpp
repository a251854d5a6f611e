#include "envmap/io/bands.h"

#include <tbb/task_group.h>

#include <algorithm>

namespace envmap {

void for_each_band(const Page& page, const Progress& progress, const WriteBand& write_band) {
  const auto make = [&](int begin, std::vector<Colour>& band) {
    const int end = std::min(begin + band_rows, page.height());
    band.resize(static_cast<std::size_t>(end - begin) * static_cast<std::size_t>(page.width()));
    page.gather(begin, end, band);
  };
  std::vector<Colour> band, next;
  make(0, band);
  for (int begin = 0; begin < page.height(); begin += band_rows) {
    const int end = std::min(begin + band_rows, page.height());
    tbb::task_group ahead;
    if (end < page.height()) ahead.run([&] { make(end, next); });
    try {
      write_band(begin, end, band);
    } catch (...) {
      ahead.wait();
      throw;
    }
    ahead.wait();
    std::swap(band, next);
    if (progress) progress(static_cast<double>(end) / page.height());
  }
}

}  // namespace envmap

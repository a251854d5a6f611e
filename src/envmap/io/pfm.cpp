#include "envmap/io/pfm.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <vector>

namespace envmap {

void write_pfm(OutputFile& file, const Atlas& atlas) {
  constexpr int band_rows = 64;
  // The sign of the scale tells the byte order.
  constexpr bool little = std::endian::native == std::endian::little;
  const std::string header = fmt::format("PF\n{} {}\n{}\n", atlas.width(), atlas.height(), little ? "-1.0" : "1.0");
  file.put(header.data(), header.size());
  const auto width = std::size_t(atlas.width());
  std::vector<Colour> band;
  for (int end = atlas.height(); end > 0; end -= band_rows) {
    const int begin = std::max(0, end - band_rows);
    band.resize(std::size_t(end - begin) * width);
    atlas.gather(begin, end, band);
    for (auto row = std::size_t(end - begin); row-- > 0;) file.put(band.data() + row * width, width * sizeof(Colour));
  }
}

}  // namespace envmap

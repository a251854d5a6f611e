#include "envmap/io/pfm.h"

#include <fmt/format.h>

#include <bit>
#include <vector>

namespace envmap {

void write_pfm(OutputFile& file, int width, int height, const std::function<void(int y, std::span<Colour>)>& row) {
  // The sign of the scale tells the byte order.
  constexpr bool little = std::endian::native == std::endian::little;
  const std::string header = fmt::format("PF\n{} {}\n{}\n", width, height, little ? "-1.0" : "1.0");
  file.write(header.data(), header.size());
  std::vector<Colour> line(static_cast<std::size_t>(width));
  for (int y = height - 1; y >= 0; --y) {
    row(y, line);
    file.write(line.data(), line.size() * sizeof(Colour));
  }
}

}  // namespace envmap

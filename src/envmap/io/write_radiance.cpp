#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "envmap/base/parallel.h"
#include "envmap/io/radiance.h"

namespace envmap {
namespace {

using Rgbe = std::array<unsigned char, 4>;

// To the nearest value that shares an exponent among its channels (Ward 1991). What is below them all is 0.
Rgbe to_rgbe(const Colour& c) {
  const float most = std::max({c.x, c.y, c.z});
  int exponent = 0;
  if (std::frexp(most, &exponent) * 256 >= 255.5F) ++exponent;
  if (!(most > 0) || exponent < -127) return {0, 0, 0, 0};
  const auto mantissa = [&](float x) { return static_cast<unsigned char>(std::ldexp(x, 8 - exponent) + 0.5F); };
  return {mantissa(c.x), mantissa(c.y), mantissa(c.z), static_cast<unsigned char>(exponent + 128)};
}

// One channel of a row: runs of four and more as 128 + count and the byte, what is between as count and bytes.
void add_runs(std::span<const Rgbe> row, std::size_t channel, std::string& out) {
  constexpr std::size_t longest_run = 127, longest_dump = 128, worth = 4;
  const auto at = [&](std::size_t k) { return static_cast<char>(row[k][channel]); };
  const auto run_from = [&](std::size_t k) {
    std::size_t n = 1;
    while (n < longest_run && k + n < row.size() && at(k + n) == at(k)) ++n;
    return n;
  };
  for (std::size_t k = 0; k < row.size();) {
    std::size_t end = k, run = 0;
    while (end < row.size() && end - k < longest_dump && (run = run_from(end)) < worth) end += run;
    end = std::min(end, k + longest_dump);
    if (end > k) {
      out += static_cast<char>(end - k);
      for (; k < end; ++k) out += at(k);
    } else {
      out += static_cast<char>(128 + run);
      out += at(k);
      k += run;
    }
  }
}

void add_row(std::span<const Colour> from, std::string& out) {
  std::vector<Rgbe> row(from.size());
  std::ranges::transform(from, row.begin(), to_rgbe);
  if (row.size() < 8 || row.size() > 0x7fff) {
    out.append(reinterpret_cast<const char*>(row.data()), 4 * row.size());
    return;
  }
  out += {2, 2, static_cast<char>(row.size() >> 8), static_cast<char>(row.size() & 255)};
  for (std::size_t c = 0; c < 4; ++c) add_runs(row, c, out);
}

}  // namespace

ImageWriter create_radiance(OutputFile& file, const ImagePlan& plan) {
  const Size size = plan.levels[0];
  std::string header = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n";
  if (const auto& xy = plan.provenance.chromaticities) header += fmt::format("PRIMARIES={}\n", fmt::join(*xy, " "));
  header += fmt::format("\n-Y {} +X {}\n", size.height, size.width);
  file.put(header.data(), header.size());
  return {.write =
              [&file, size](int, int begin, int end, std::span<const Colour> pixels) {
                const auto width = std::size_t(size.width);
                std::vector<std::string> rows(std::size_t(end - begin));
                parallel_for(end - begin, [&](int k) {
                  add_row(pixels.subspan(std::size_t(k) * width, width), rows[std::size_t(k)]);
                });
                for (const std::string& row : rows) file.put(row.data(), row.size());
              },
          .close = [] {}};
}

void round_to_radiance(std::span<Colour> texels) {
  for (Colour& c : texels) {
    const Rgbe stored = to_rgbe(c);
    for (int k = 0; k < 3; ++k) c[k] = stored[3] == 0 ? 0 : std::ldexp(float(stored[std::size_t(k)]), stored[3] - 136);
  }
}

}  // namespace envmap

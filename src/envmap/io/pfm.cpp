#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <string>
#include <type_traits>
#include <vector>

#include "envmap/base/error.h"
#include "envmap/io/row_readers.h"

namespace envmap {
namespace {

struct PfmHeader {
  int channels = 0, width = 0, height = 0;
  float scale = 0;
  std::uint64_t texels = 0;  // Where they begin.
};

// "PF" or "Pf", width, height and scale between spaces, and the end of a line. Nothing where it is something else.
std::optional<PfmHeader> read_pfm_header(const InputFile& file) {
  std::string text(128, '\0');
  text.resize(file.pread(text.data(), text.size(), 0));
  std::size_t at = 2;
  const auto read = [&](auto& number) {
    at = std::min(text.find_first_not_of(" \n", at), text.size());
    const std::size_t begin = at;
    at = std::min(text.find_first_of(" \n", at), text.size());
    const auto [end, error] = std::from_chars(text.data() + begin, text.data() + at, number);
    if (std::is_integral_v<std::remove_reference_t<decltype(number)>> && error == std::errc::result_out_of_range)
      throw InputError(fmt::format("the size {} in its header is out of range", text.substr(begin, at - begin)));
    return error == std::errc() && end == text.data() + at;
  };
  PfmHeader h{.channels = text.starts_with("PF") ? 3 : 1};
  if (text.size() < 3 || (text[2] != ' ' && text[2] != '\n')) return std::nullopt;
  if (!read(h.width) || !read(h.height) || !read(h.scale) || at == text.size() || text[at] != '\n') return std::nullopt;
  if (h.width < 1 || h.height < 1 || h.scale == 0 || !std::isfinite(h.scale)) return std::nullopt;
  h.texels = at + 1;
  return h;
}

// Rows [begin, end) from the top.
void read_pfm_rows(const InputFile& file, const PfmHeader& h, int begin, int end, int first, int count, float* to) {
  const bool swapped = (h.scale < 0) != (std::endian::native == std::endian::little);
  const float scale = std::abs(h.scale);
  std::vector<std::uint32_t> row(std::size_t(h.width) * std::size_t(h.channels));
  const std::size_t bytes = row.size() * sizeof(float);
  for (int y = begin; y < end; ++y) {
    if (file.pread(row.data(), bytes, h.texels + std::uint64_t(h.height - 1 - y) * bytes) != bytes)
      throw InputError("it ends too early");
    for (std::size_t k = std::size_t(first); k < row.size(); k += std::size_t(h.channels))
      for (std::size_t c = k; c < k + std::size_t(count); ++c)
        *to++ = std::bit_cast<float>(swapped ? __builtin_bswap32(row[c]) : row[c]) * scale;
  }
}

}  // namespace

std::optional<ImageReader> open_pfm(const InputFile& file) {
  const std::optional<PfmHeader> h = read_pfm_header(file);
  if (!h) return std::nullopt;
  const std::vector<std::string> grey{"Y"}, rgb{"R", "G", "B"};
  const ImageFacts facts{.width = h->width,
                         .height = h->height,
                         .names = false,
                         .channels = h->channels == 1 ? grey : rgb};
  return ImageReader{.format = "pnm",
                     .facts = facts,
                     .read = [&file, h = *h](int, int begin, int end, int first, int count, std::span<float> out) {
                       read_pfm_rows(file, h, begin, end, first, count, out.data());
                     }};
}

void write_pfm(OutputFile& file, std::span<const Atlas> levels, const TexturePlan& /*plan*/,
               const Progress& /*progress*/) {
  const Atlas& atlas = levels[0];
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

#include "envmap/io/formats/pfm.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "envmap/base/error.h"

namespace envmap {
namespace {

struct PfmHeader {
  int channels = 0, width = 0, height = 0;
  float scale = 0;
  std::uint64_t texels = 0;  // Where they begin.
};

// The words of a header, between spaces, ends of lines and comments.
class HeaderWords {
 public:
  explicit HeaderWords(const InputFile& file) : text_(4096, '\0') {
    text_.resize(file.pread(text_.data(), text_.size(), 0));
  }

  std::string_view word() {
    for (skip_spaces(); std::string_view(text_).substr(at_).starts_with('#'); skip_spaces())
      at_ = std::min(text_.find_first_of("\r\n", at_), text_.size());
    const std::size_t begin = at_;
    at_ = std::min(text_.find_first_of(spaces, at_), text_.size());
    return std::string_view(text_).substr(begin, at_ - begin);
  }
  template <class Number>
  Number number(const char* what) {
    std::string_view text = word();
    const std::string_view all = text;
    if (text.starts_with('+')) text.remove_prefix(1);
    Number value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error == std::errc::result_out_of_range)
      throw InputError(fmt::format("the {} {} in its header is out of range", what, all));
    if (error != std::errc() || end != text.data() + text.size() || at_ == text_.size())
      throw InputError(fmt::format("damaged: the {} in its header is no number", what));
    return value;
  }
  /// Where the texels begin: after the end of the line, which may be CR LF. The size of the file tells a texel's first
  /// byte that looks like LF.
  [[nodiscard]] std::uint64_t end(std::uint64_t file_size, std::uint64_t texels) const {
    const bool two = std::string_view(text_).substr(at_).starts_with("\r\n") && file_size != at_ + 1 + texels;
    return at_ + (two ? 2 : 1);
  }

 private:
  static constexpr const char* spaces = " \t\r\n";
  void skip_spaces() { at_ = std::min(text_.find_first_not_of(spaces, at_), text_.size()); }

  std::string text_;
  std::size_t at_ = 0;
};

PfmHeader read_pfm_header(const InputFile& file) {
  HeaderWords header(file);
  const std::string_view kind = header.word();
  if (kind != "PF" && kind != "Pf")
    throw InputError(
        fmt::format("not supported: a portable float map of kind {}: PF and Pf are read", kind.substr(0, 8)));
  PfmHeader h{.channels = kind == "PF" ? 3 : 1};
  h.width = header.number<int>("width"), h.height = header.number<int>("height");
  h.scale = header.number<float>("scale");
  if (h.width < 1 || h.height < 1) throw InputError(fmt::format("damaged: its size is {}x{}", h.width, h.height));
  if (h.scale == 0 || !std::isfinite(h.scale))
    throw InputError(fmt::format("damaged: its scale is {}, whose sign tells the byte order", h.scale));
  const std::uint64_t bytes =
      std::uint64_t(h.width) * std::uint64_t(h.height) * std::uint64_t(h.channels) * sizeof(float);
  h.texels = header.end(file.size(), bytes);
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

ImageReader open_pfm(const InputFile& file) {
  const PfmHeader h = read_pfm_header(file);
  const std::vector<std::string> grey{"Y"}, rgb{"R", "G", "B"};
  ImageFacts facts{.width = h.width, .height = h.height, .names = false, .channels = h.channels == 1 ? grey : rgb};
  if (std::abs(h.scale) != 1) facts.claims.push_back({.name = "scale", .value = fmt::format("{}", h.scale)});
  return ImageReader{.format = "pnm",
                     .facts = facts,
                     .read = [&file, h](int, int begin, int end, int first, int count, std::span<float> out) {
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

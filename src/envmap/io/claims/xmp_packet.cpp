#include "envmap/io/claims/xmp_packet.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>

#include "envmap/base/error.h"
#include "envmap/io/formats/jpeg_parts.h"
#include "envmap/io/formats/png.h"

namespace envmap {
namespace {

// Longer ones are no packets of cameras.
constexpr std::uint64_t longest = 1 << 24;
// More parts than that a file in use does not have before its packet.
constexpr int most_parts = 1 << 20;

// Bytes [at, at + size), or fewer at the end of the file.
std::string bytes_at(const InputFile& file, std::uint64_t at, std::uint64_t size) {
  if (at >= file.size()) return {};
  std::string bytes(std::min({size, file.size() - at, longest}), '\0');
  bytes.resize(file.pread(bytes.data(), bytes.size(), at));
  return bytes;
}

// 0 where the file ends.
std::uint64_t number_at(const InputFile& file, std::uint64_t at, std::size_t size, bool little) {
  std::array<unsigned char, 8> bytes = {};
  if (file.pread(bytes.data(), size, at) != size) return 0;
  if (little) std::reverse(bytes.begin(), bytes.begin() + std::ptrdiff_t(size));
  std::uint64_t number = 0;
  for (std::size_t k = 0; k < size; ++k) number = number << 8U | bytes[k];
  return number;
}

std::vector<std::string> packets_of_jpeg(const InputFile& file) {
  constexpr unsigned app1 = 0xe1;
  std::vector<std::string> found;
  for (const JpegSegment& s : jpeg_segments(file, 0))
    if (s.marker == app1 && s.text.starts_with(jpeg_xmp_mark)) found.push_back(s.text.substr(jpeg_xmp_mark.size()));
  return found;
}

// Keyword, whether it is packed, how, language and translated keyword, then the text (PNG, section 11.3.3.4).
std::string packet_of_text(const std::string& chunk) {
  constexpr std::string_view keyword("XML:com.adobe.xmp\0", 18);
  if (!chunk.starts_with(keyword) || chunk.size() < keyword.size() + 4) return {};
  const std::size_t language = chunk.find('\0', keyword.size() + 2),
                    translated = language == chunk.npos ? language : chunk.find('\0', language + 1);
  if (translated == chunk.npos) throw InputError("damaged: its iTXt chunk of XMP has no text");
  const std::string text = chunk.substr(translated + 1);
  return chunk[keyword.size()] == 0 ? text : inflated("iTXt", std::as_bytes(std::span(text)));
}

std::vector<std::string> packets_of_png(const InputFile& file) {
  std::vector<std::string> found;
  std::uint64_t at = 8;
  for (int k = 0; k < most_parts && at + 8 <= file.size(); ++k) {
    const std::uint64_t size = number_at(file, at, 4, false);
    if (bytes_at(file, at + 4, 4) == "iTXt")
      if (std::string packet = packet_of_text(bytes_at(file, at + 8, size)); !packet.empty())
        found.push_back(std::move(packet));
    at += 12 + size;
  }
  return found;
}

// TIFF 6.0, section 2, and BigTIFF, whose counts and offsets have eight bytes.
std::vector<std::string> packets_of_tiff(const InputFile& file) {
  constexpr unsigned xmp_tag = 700, big_version = 43;
  const bool little = bytes_at(file, 0, 1) == "I", big = number_at(file, 2, 2, little) == big_version;
  const std::size_t wide = big ? 8 : 4, count_size = big ? 8 : 2, entry = 4 + 2 * wide;
  const std::uint64_t directory = number_at(file, big ? 8 : 4, wide, little),
                      entries = number_at(file, directory, count_size, little);
  for (std::uint64_t k = 0; k < std::min<std::uint64_t>(entries, most_parts); ++k) {
    const std::uint64_t at = directory + count_size + k * entry;
    if (number_at(file, at, 2, little) != xmp_tag) continue;
    const std::uint64_t size = number_at(file, at + 4, wide, little);
    return {bytes_at(file, size <= wide ? at + 4 + wide : number_at(file, at + 4 + wide, wide, little), size)};
  }
  return {};
}

// RIFF: chunks of a name, a length and bytes, which begin at even places.
std::vector<std::string> packets_of_webp(const InputFile& file) {
  std::vector<std::string> found;
  std::uint64_t at = 12;
  for (int k = 0; k < most_parts && at + 8 <= file.size(); ++k) {
    const std::uint64_t size = number_at(file, at + 4, 4, true);
    if (bytes_at(file, at, 4) == "XMP ") found.push_back(bytes_at(file, at + 8, size));
    at += 8 + size + size % 2;
  }
  return found;
}

// Packets are text, not packed: ISO 16684-3 has programs look for them where they do not know the format.
std::vector<std::string> packets_in(const std::string& bytes) {
  constexpr std::string_view open = "<rdf:RDF", close = "</rdf:RDF>";
  std::vector<std::string> found;
  for (std::size_t begin = bytes.find(open); begin != bytes.npos; begin = bytes.find(open, begin + 1)) {
    const std::size_t end = bytes.find(close, begin);
    if (end == bytes.npos) break;
    found.push_back(bytes.substr(begin, end + close.size() - begin));
  }
  return found;
}

std::vector<std::string> packets_anywhere(const InputFile& file) {
  constexpr std::uint64_t part = 1 << 20;
  std::vector<std::string> found = packets_in(bytes_at(file, 0, part));
  if (found.empty() && file.size() > part) found = packets_in(bytes_at(file, file.size() - part, part));
  return found;
}

}  // namespace

std::vector<std::string> xmp_packets(const InputFile& file, std::string_view format) {
  if (format == "jpeg") return packets_of_jpeg(file);
  if (format == "png") return packets_of_png(file);
  if (format == "tiff") return packets_of_tiff(file);
  if (format == "webp") return packets_of_webp(file);
  if (format == "heif") return packets_anywhere(file);
  return {};
}

}  // namespace envmap

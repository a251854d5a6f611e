#include "envmap/io/formats/jpeg_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "envmap/base/error.h"
#include "envmap/io/claims/tiff_numbers.h"

namespace envmap {
namespace {

constexpr unsigned app1 = 0xe1, app2 = 0xe2;
constexpr std::string_view icc_mark("ICC_PROFILE\0", 12), mpf_mark("MPF\0", 4),
    iso_mark("urn:iso:std:iso:ts:21496:-1\0", 28);

std::span<const unsigned char> bytes_of(std::string_view text) {
  return {reinterpret_cast<const unsigned char*>(text.data()), text.size()};
}

// ---- MPF ------------------------------------------------------------------------------------------------------------

// Where the further images of a file begin, by its index (DC-007, section 5.2.3.3).
std::vector<std::uint64_t> further_images(const JpegSegment& mpf) {
  constexpr std::uint32_t entries_tag = 0xb002;
  constexpr std::size_t entry_size = 12, image_size = 16, most_images = 64;  // Cameras write some five.
  const std::string_view text = std::string_view(mpf.text).substr(mpf_mark.size());
  const TiffNumbers n{bytes_of(text), text.starts_with("II")};
  std::vector<std::uint64_t> found;
  const std::size_t directory = n.get(4, 4), count = n.get(directory, 2);
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t at = directory + 2 + k * entry_size;
    if (at + entry_size > text.size()) break;
    if (n.get(at, 2) != entries_tag) continue;
    const std::size_t size = n.get(at + 4, 4), begin = n.get(at + 8, 4);
    for (std::size_t image = 0; image + image_size <= size && begin + image + image_size <= text.size();
         image += image_size)
      if (const std::uint32_t offset = n.get(begin + image + 8, 4); offset > 0 && found.size() < most_images)
        found.push_back(mpf.at + mpf_mark.size() + offset);
  }
  return found;
}

// ---- GContainer -----------------------------------------------------------------------------------------------------

// The items of a container end the file, each of the length that it is said to have.
std::vector<std::uint64_t> further_items(const std::vector<XmpNode>& xmp, std::uint64_t file_size) {
  constexpr std::string_view item = "http://ns.google.com/photos/1.0/container/item/";
  std::vector<std::uint64_t> lengths;
  for (const XmpNode& node : xmp)
    for (const XmpNode& a : node.attributes)
      if (a.space == item && a.name == "Length")
        if (const std::optional<double> length = number_of(a.text); length && *length >= 1 && *length < 0x1p40)
          lengths.push_back(std::uint64_t(*length));
  std::vector<std::uint64_t> found;
  std::uint64_t at = file_size;
  for (auto length = lengths.rbegin(); length != lengths.rend() && *length < at; ++length)
    found.push_back(at -= *length);
  std::ranges::reverse(found);
  return found;
}

const JpegSegment* find(const std::vector<JpegSegment>& segments, unsigned marker, std::string_view mark) {
  const auto found = std::ranges::find_if(segments, [&](const JpegSegment& s) {
    return s.marker == marker && s.text.starts_with(mark);
  });
  return found == segments.end() ? nullptr : &*found;
}

// The standard comes before what it was made of.
std::optional<GainMap> gain_map_in(const std::vector<JpegSegment>& segments) {
  if (const JpegSegment* iso = find(segments, app2, iso_mark))
    if (auto map = gain_map_of_iso(bytes_of(std::string_view(iso->text).substr(iso_mark.size())))) return map;
  const std::vector<XmpNode> xmp = xmp_of(segments);
  // Apple's own kind: its headroom is in the maker's notes of EXIF.
  constexpr std::string_view apple = "urn:com:apple:photo:2020:aux:hdrgainmap";
  for (const XmpNode& node : xmp) {
    const auto is_apple = [&](const XmpNode& n) { return n.text == apple; };
    if (is_apple(node) || std::ranges::any_of(node.attributes, is_apple))
      throw InputError("not supported: a gain map of Apple's kind, without ISO 21496-1", Remedy::take_base);
  }
  return gain_map_of_xmp(xmp);
}

}  // namespace

std::vector<JpegSegment> jpeg_segments(const InputFile& file, std::uint64_t at) {
  std::vector<JpegSegment> found;
  std::array<unsigned char, 4> head = {};
  if (file.pread(head.data(), 2, at) != 2 || head[0] != 0xff || head[1] != 0xd8) return found;
  constexpr unsigned start_of_scan = 0xda, end_of_image = 0xd9, comment = 0xfe;
  for (at += 2; file.pread(head.data(), 4, at) == 4 && head[0] == 0xff;) {
    const unsigned marker = head[1];
    if (marker == 0xff) {  // Filling.
      ++at;
      continue;
    }
    const std::size_t size = std::size_t{head[2]} << 8U | head[3];
    if (marker == start_of_scan || marker == end_of_image || size < 2) break;
    if ((marker >= 0xe0 && marker <= 0xef) || marker == comment) {
      JpegSegment segment{marker, at + 4, std::string(size - 2, '\0')};
      if (file.pread(segment.text.data(), size - 2, at + 4) != size - 2) break;
      found.push_back(std::move(segment));
    }
    at += 2 + size;
  }
  return found;
}

std::vector<XmpNode> xmp_of(const std::vector<JpegSegment>& segments) {
  const JpegSegment* xmp = find(segments, app1, jpeg_xmp_mark);
  return xmp ? parse_xmp(std::string_view(xmp->text).substr(jpeg_xmp_mark.size())) : std::vector<XmpNode>();
}

std::string icc_profile_of(const std::vector<JpegSegment>& segments) {
  std::vector<std::string_view> chunks;  // Numbered from 1 (ICC.1, annex B.4).
  for (const JpegSegment& s : segments) {
    if (s.marker != app2 || !s.text.starts_with(icc_mark)) continue;
    const auto damaged = [] {
      return InputError("damaged: an ICC profile in chunks that do not fit", Remedy::choose_space);
    };
    if (s.text.size() < icc_mark.size() + 2) throw damaged();
    const auto number = std::size_t{static_cast<unsigned char>(s.text[icc_mark.size()])},
               count = std::size_t{static_cast<unsigned char>(s.text[icc_mark.size() + 1])};
    if (chunks.empty()) chunks.resize(count);
    if (number < 1 || number > count || count != chunks.size() || !chunks[number - 1].empty()) throw damaged();
    chunks[number - 1] = std::string_view(s.text).substr(icc_mark.size() + 2);
  }
  std::string profile;
  for (const std::string_view chunk : chunks) {
    if (chunk.empty()) throw InputError("damaged: an ICC profile of which chunks are missing", Remedy::choose_space);
    profile += chunk;
  }
  return profile;
}

std::optional<FoundGainMap> find_gain_map(const InputFile& file, const std::vector<JpegSegment>& segments) {
  const JpegSegment *mpf = find(segments, app2, mpf_mark), *xmp_segment = find(segments, app1, jpeg_xmp_mark);
  const bool by_iso = find(segments, app2, iso_mark) != nullptr;
  const bool may_be_xmp = xmp_segment && xmp_segment->text.find("hdr-gain-map") != std::string::npos;
  if (!mpf && !by_iso && !may_be_xmp) return std::nullopt;
  const std::vector<XmpNode> xmp = may_be_xmp ? xmp_of(segments) : std::vector<XmpNode>();
  // Some writers count the offsets of an index from another place than the format has it: what lies there decides.
  std::vector<std::uint64_t> places = mpf ? further_images(*mpf) : std::vector<std::uint64_t>();
  for (const std::uint64_t at : further_items(xmp, file.size())) places.push_back(at);
  for (const std::uint64_t at : places) {
    const std::vector<JpegSegment> beside = jpeg_segments(file, at);
    if (auto map = gain_map_in(beside)) return FoundGainMap{*map, at, icc_profile_of(beside)};
  }
  if (by_iso || announces_gain_map(xmp))
    throw InputError("damaged: it announces a gain map that is not there", Remedy::take_base);
  return std::nullopt;
}

}  // namespace envmap

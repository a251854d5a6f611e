#include "envmap/io/formats/gain_map_jpeg.h"

#include <fmt/format.h>

#include <cmath>
#include <string_view>
#include <utility>

#include "envmap/io/formats/jpeg_encoder.h"
#include "envmap/io/formats/jpeg_parts.h"

namespace envmap {
namespace {

constexpr unsigned app1 = 0xe1, app2 = 0xe2, comment_marker = 0xfe;

// Big-endian.
std::string number(std::uint64_t value, int bytes) {
  std::string text;
  for (int k = bytes - 1; k >= 0; --k) text += static_cast<char>(value >> (8U * unsigned(k)));
  return text;
}

// ---- ISO 21496-1, annex C -------------------------------------------------------------------------------------------

std::string iso_segment(const std::string& metadata) {
  const std::string versions = number(0, 2) + number(0, 2);  // That readers must know, and that of the writer.
  return jpeg_segment(app2, std::string("urn:iso:std:iso:ts:21496:-1\0", 28) + versions + metadata);
}

// A number of gain_map_of() over 2^16 is exact.
std::string fraction(double value) {
  constexpr double below = 1 << 16;
  return number(std::uint64_t(std::int64_t(std::llround(value * below))), 4) + number(std::uint64_t(below), 4);
}

std::string iso_metadata(const GainMap& map) {
  constexpr unsigned of_three_channels = 0x80, of_base_colours = 0x40;
  const int channels = map.channels == 1 ? 1 : 3;
  std::string text = number(of_base_colours | (channels == 3 ? of_three_channels : 0), 1) +
                     fraction(map.base_headroom) + fraction(map.headroom);
  for (int c = 0; c < channels; ++c) {
    const GainMap::Channel& of = map.of[std::size_t(c)];
    text +=
        fraction(of.least) + fraction(of.most) + fraction(of.gamma) + fraction(of.base_offset) + fraction(of.offset);
  }
  return text;
}

// ---- XMP ------------------------------------------------------------------------------------------------------------

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    const std::string_view entity = c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : std::string_view();
    out += entity.empty() ? std::string(1, c) : std::string(entity);
  }
  return out;
}

std::string xmp_segment(const std::string& attributes, const std::string& elements) {
  return jpeg_segment(
      app1, std::string(jpeg_xmp_mark) +
                fmt::format("<x:xmpmeta xmlns:x=\"adobe:ns:meta/\">\n"
                            "<rdf:RDF xmlns:rdf=\"http://www.w3.org/1999/02/22-rdf-syntax-ns#\">\n"
                            "<rdf:Description rdf:about=\"\" xmlns:hdrgm=\"http://ns.adobe.com/hdr-gain-map/1.0/\" "
                            "hdrgm:Version=\"1.0\"{}>\n{}</rdf:Description>\n</rdf:RDF>\n</x:xmpmeta>",
                            attributes, elements));
}

std::string xmp_of_gains(const GainMap& map) {
  const GainMap::Channel& of = map.of[0];
  std::string attributes;
  for (const auto& [name, value] :
       {std::pair("GainMapMin", of.least), std::pair("GainMapMax", of.most), std::pair("Gamma", of.gamma),
        std::pair("OffsetSDR", of.base_offset), std::pair("OffsetHDR", of.offset),
        std::pair("HDRCapacityMin", map.base_headroom), std::pair("HDRCapacityMax", map.headroom)})
    attributes += fmt::format(" hdrgm:{}=\"{}\"", name, value);
  return xmp_segment(attributes + " hdrgm:BaseRenditionIsHDR=\"False\"", "");
}

std::string xmp_of_picture(const std::string& owner, std::size_t gain_bytes) {
  const auto item = [](const char* semantic, const std::string& more) {
    return fmt::format(
        "<rdf:li rdf:parseType=\"Resource\"><Container:Item Item:Semantic=\"{}\" "
        "Item:Mime=\"image/jpeg\"{}/></rdf:li>\n",
        semantic, more);
  };
  std::string elements = "<Container:Directory>\n<rdf:Seq>\n" + item("Primary", "") +
                         item("GainMap", fmt::format(" Item:Length=\"{}\"", gain_bytes)) +
                         "</rdf:Seq>\n</Container:Directory>\n";
  std::string spaces =
      " xmlns:Container=\"http://ns.google.com/photos/1.0/container/\""
      " xmlns:Item=\"http://ns.google.com/photos/1.0/container/item/\"";
  if (!owner.empty()) {
    spaces += " xmlns:dc=\"http://purl.org/dc/elements/1.1/\"";
    elements += fmt::format("<dc:rights><rdf:Alt><rdf:li xml:lang=\"x-default\">{}</rdf:li></rdf:Alt></dc:rights>\n",
                            escaped(owner));
  }
  return xmp_segment(spaces, elements);
}

// ---- MPF ------------------------------------------------------------------------------------------------------------

// An index of two images. Readers of gain maps look for its numbers where they lie here: three entries, and the list of
// images right behind them.
// @param size of the picture with all its segments. @param from where the index's own byte order mark lies in it.
std::string index_segment(std::size_t size, std::size_t from, std::size_t gain_bytes) {
  constexpr unsigned version_tag = 0xb000, count_tag = 0xb001, images_tag = 0xb002, long_type = 4, undefined_type = 7;
  constexpr unsigned primary = 0x00030000;  // A baseline image that others belong to (table 4).
  constexpr unsigned first_directory = 8, list = first_directory + 2 + 3 * 12 + 4;
  const auto entry = [](unsigned tag, unsigned type, unsigned count, const std::string& value) {
    return number(tag, 2) + number(type, 2) + number(count, 4) + value;
  };
  const auto image = [](unsigned attributes, std::size_t bytes, std::size_t at) {
    return number(attributes, 4) + number(bytes, 4) + number(at, 4) + number(0, 4);
  };
  return jpeg_segment(app2, std::string("MPF\0MM\0*", 8) + number(first_directory, 4) + number(3, 2) +
                                entry(version_tag, undefined_type, 4, "0100") +
                                entry(count_tag, long_type, 1, number(2, 4)) +
                                entry(images_tag, undefined_type, 32, number(list, 4)) + number(0, 4) +
                                image(primary, size, 0) + image(0, gain_bytes, size - from));
}

std::string icc_segment(const std::string& profile) {
  return profile.empty() ? "" : jpeg_segment(app2, std::string("ICC_PROFILE\0\1\1", 14) + profile);
}

}  // namespace

std::string gain_map_jpeg(const GainMapParts& parts) {
  const std::string gains = with_segments(parts.gains, xmp_of_gains(parts.map) + iso_segment(iso_metadata(parts.map)));
  const std::string before =
                        xmp_of_picture(parts.owner, gains.size()) + iso_segment("") + icc_segment(parts.icc_profile),
                    after = parts.comment.empty() ? "" : jpeg_segment(comment_marker, parts.comment);
  const auto picture = [&](std::size_t size, std::size_t from) {
    return with_segments(parts.picture, before + index_segment(size, from, gains.size()) + after);
  };
  const std::string unfinished = picture(0, 0);
  constexpr std::size_t byte_order = 4;  // Behind the index's mark.
  const std::size_t from = unfinished.find(std::string_view("MPF\0MM", 6)) + byte_order;
  return picture(unfinished.size(), from) + gains;
}

}  // namespace envmap

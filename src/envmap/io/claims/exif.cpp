#include "envmap/io/claims/exif.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <string>

#include "envmap/io/claims/tiff_numbers.h"

namespace envmap {
namespace {

using Bytes = std::span<const unsigned char>;

// Of a directory's entry at `at`, up to the first zero.
std::string text_of(const TiffNumbers& n, std::size_t at) {
  const std::size_t size = n.get(at + 4, 4), begin = size <= 4 ? at + 8 : n.get(at + 8, 4);
  if (begin > n.bytes.size() || size > n.bytes.size() - begin) return {};
  const std::string text(n.bytes.begin() + std::ptrdiff_t(begin), n.bytes.begin() + std::ptrdiff_t(begin + size));
  return text.substr(0, text.find('\0'));
}

}  // namespace

// The three tags belong into the first directory (TIFF 6.0, sections 2 and 8; EXIF 2.3, table 4).
void read_exif(Bytes exif, ImageFacts& facts) {
  enum : unsigned { tag_description = 0x10e, tag_orientation = 0x112, tag_copyright = 0x8298 };
  enum : unsigned { type_byte = 1, type_text = 2, type_short = 3, type_long = 4 };
  if (exif.size() < 8 || exif[0] != exif[1] || (exif[0] != 'I' && exif[0] != 'M')) return;
  const TiffNumbers n{exif, exif[0] == 'I'};
  const std::size_t directory = n.get(4, 4), entry_size = 12, count = n.get(directory, 2);
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t at = directory + 2 + k * entry_size;
    if (at + entry_size > exif.size()) return;
    const unsigned tag = n.get(at, 2), type = n.get(at + 2, 2);
    if (type == type_text && tag == tag_description) facts.attributes.emplace(description, text_of(n, at));
    if (type == type_text && tag == tag_copyright) facts.attributes.emplace(copyright, text_of(n, at));
    if (tag != tag_orientation || n.get(at + 4, 4) != 1 || facts.orientation != Orientation::upright) continue;
    const unsigned way = n.get(at + 8, type == type_byte ? 1 : type == type_short ? 2 : type == type_long ? 4 : 0);
    if (way >= 1 && way <= 8) facts.orientation = static_cast<Orientation>(way);
  }
}

bool tells_facts(std::string_view xmp) {
  std::string lower(xmp);
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return std::tolower(c); });
  constexpr const char* names[] = {"orientation", "imagedescription", "dc:description", "rights", "copyright",
                                   "envmap:",     "textureformat",    "acesimage",      "oiio:"};
  return std::ranges::any_of(names, [&](const char* name) { return lower.find(name) != lower.npos; });
}

}  // namespace envmap

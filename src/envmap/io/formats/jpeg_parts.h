/// @file
/// The marker segments of a JPEG file, and the JPEG images that follow the first. Sources: ITU-T T.81, annex B; CIPA
/// DC-007 ("Multi-Picture Format"); Android, "Ultra HDR Image Format" 1.1, section "GContainer".
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "envmap/io/claims/gain_map.h"
#include "envmap/io/files/input_file.h"

namespace envmap {

/// APP0 to APP15 and comments.
struct JpegSegment {
  unsigned marker;   ///< 0xe0 to 0xef, 0xfe.
  std::uint64_t at;  ///< Where its text begins in the file.
  std::string text;
};

/// The start of an XMP packet's segment, an APP1.
inline constexpr std::string_view jpeg_xmp_mark("http://ns.adobe.com/xap/1.0/\0", 29);

/// Those of the image that begins at `at`, up to its texels; none where there is no JPEG image.
std::vector<JpegSegment> jpeg_segments(const InputFile& file, std::uint64_t at);

/// The XMP in segments; of extended XMP the main packet.
std::vector<XmpNode> xmp_of(const std::vector<JpegSegment>& segments);
/// The ICC profile in segments, put together of its chunks; empty where there is none.
/// @throws InputError where a chunk is missing.
std::string icc_profile_of(const std::vector<JpegSegment>& segments);

/// A gain map without its texels, and where its image begins.
struct FoundGainMap {
  GainMap map;
  std::uint64_t at;
  std::string icc_profile;
};

/// The gain map of a file; nothing where it neither has nor announces one. @throws InputError where it announces one
/// that is not there, or has one of a kind that is not supported.
std::optional<FoundGainMap> find_gain_map(const InputFile& file, const std::vector<JpegSegment>& segments);

}  // namespace envmap

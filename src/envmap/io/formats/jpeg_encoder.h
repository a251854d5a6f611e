/// @file
/// JPEG images in memory, as they are written.
#pragma once

#include <span>
#include <string>

namespace envmap {

/// 1 or 3 channels, sRGB encoded or plain.
struct JpegTexels {
  int width, height, channels;
  std::span<const unsigned char> values;
};

/// Baseline, colours at full resolution. @param quality of libjpeg, 1 to 100.
/// @throws OutputError without a file's name, where a side is longer than JPEG holds.
std::string encode_jpeg(const JpegTexels& image, int quality);

/// A marker segment. @param marker 0xe0 to 0xef, 0xfe. @throws OutputError where the text is too long for one.
std::string jpeg_segment(unsigned marker, const std::string& text);

/// An image of encode_jpeg() with segments behind its JFIF header, which comes first.
std::string with_segments(const std::string& jpeg, const std::string& segments);

}  // namespace envmap

/// @file
/// The table of what files state: a row for each format and claim. Rows make their files here, from the formats'
/// specifications, and know the right values by closed form.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace command_tests {

enum class Becomes { honoured, refused, ignored };

struct ClaimRow {
  std::string format;  ///< The title in envmap-files(7): "PNG".
  std::string claim;   ///< As `info` names it.
  Becomes becomes;
  std::string name, bytes;              ///< Of the file. Its texels are all of one colour, unless `minimum` is set.
  std::array<double, 3> value = {};     ///< Mean; where the claim is refused nothing.
  std::vector<std::string> words = {};  ///< In the message of a refusal, or in the claim's value.
  double tolerance = 1e-4;              ///< Of a value, relative.
  std::vector<std::string> options = {};
};

std::vector<ClaimRow> claims_of_colour();
std::vector<ClaimRow> claims_of_place();

// ---- bytes ----------------------------------------------------------------------------------------------------------

std::string big(std::uint64_t number, int bytes);
std::string little(std::uint64_t number, int bytes);
/// IEEE 754 single.
std::string little_float(float value);

struct TiffTag {
  unsigned tag, type;  ///< TIFF 6.0, section 2: 2 ASCII, 3 SHORT, 4 LONG, 5 RATIONAL, 7 UNDEFINED, 11 FLOAT.
  std::uint64_t count;
  std::string value;  ///< Little-endian.
};

/// A TIFF of one strip. @param tags beside those of size, strip and planes; they replace tags of the same number.
std::string tiff(int width, int height, int samples, int bits, const std::string& strip,
                 const std::vector<TiffTag>& tags);

/// A chunk with its length and its checksum.
std::string png_chunk(const std::string& type, const std::string& data);
/// RGB. @param chunks between IHDR and IDAT.
std::string png(int width, int height, int bits, const std::array<unsigned, 3>& colour, const std::string& chunks);

/// A zlib stream without compression.
std::string stored_zlib(const std::string& bytes);

/// Big-endian, in 65536ths (ICC.1, section 4.6).
std::string fixed(double value);
/// A profile (ICC.1, section 7). @param space "RGB ", "GRAY" or "CMYK". @param tags signature and element, in turn.
std::string icc(const std::string& space, const std::string& name,
                const std::vector<std::pair<std::string, std::string>>& tags);
/// The element of a colorant.
std::string icc_xyz(const std::array<double, 3>& xyz);

/// One colour at the best quality, in the format of the name; empty where OpenImageIO does not write it.
std::string written_by_openimageio(const std::string& name, int width, int height, const std::array<int, 3>& colour,
                                   int channels);
/// Baseline JPEG of one colour. @param segments after SOI. @param channels 1 or 3.
std::string jpeg(int width, int height, const std::array<int, 3>& colour, const std::string& segments,
                 int channels = 3);
/// APP0 + k.
std::string jpeg_segment(int app, const std::string& text);

/// RGBE texels of one value, all in a row without run lengths. @param header lines, each ended.
std::string radiance(const std::string& header, int width, int height, const std::array<int, 4>& rgbe);

}  // namespace command_tests

// Files of one colour, byte by byte.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <bit>
#include <cmath>
#include <map>

#include "claims.h"

namespace command_tests {

std::string big(std::uint64_t number, int bytes) {
  std::string text;
  for (int k = bytes - 1; k >= 0; --k) text += static_cast<char>(number >> (8 * k));
  return text;
}

std::string little(std::uint64_t number, int bytes) {
  std::string text;
  for (int k = 0; k < bytes; ++k) text += static_cast<char>(number >> (8 * k));
  return text;
}

std::string little_float(float value) { return little(std::bit_cast<std::uint32_t>(value), 4); }

// ---- TIFF 6.0 -------------------------------------------------------------------------------------------------------

std::string tiff(int width, int height, int samples, int bits, const std::string& strip,
                 const std::vector<TiffTag>& tags) {
  std::map<unsigned, TiffTag> all;
  const auto add = [&](unsigned tag, unsigned type, std::uint64_t count, const std::string& value) {
    all[tag] = {tag, type, count, value};
  };
  std::string all_bits;
  for (int k = 0; k < samples; ++k) all_bits += little(std::uint64_t(bits), 2);
  add(256, 4, 1, little(std::uint64_t(width), 4));
  add(257, 4, 1, little(std::uint64_t(height), 4));
  add(258, 3, std::uint64_t(samples), all_bits);
  add(259, 3, 1, little(1, 2));
  add(262, 3, 1, little(samples == 1 ? 1 : 2, 2));
  add(273, 4, 1, little(8, 4));
  add(277, 3, 1, little(std::uint64_t(samples), 2));
  add(278, 4, 1, little(std::uint64_t(height), 4));
  add(279, 4, 1, little(strip.size(), 4));
  for (const TiffTag& t : tags) all[t.tag] = t;
  const std::string padded = strip + std::string(strip.size() % 2, '\0');
  const std::uint64_t directory = 8 + padded.size();
  std::uint64_t next = directory + 2 + 12 * all.size() + 4;
  std::string entries, values;
  for (const auto& [number, t] : all) {
    entries += little(number, 2) + little(t.type, 2) + little(t.count, 4);
    if (t.value.size() <= 4) {
      entries += t.value + std::string(4 - t.value.size(), '\0');
      continue;
    }
    entries += little(next, 4);
    values += t.value + std::string(t.value.size() % 2, '\0');
    next = directory + 2 + 12 * all.size() + 4 + values.size();
  }
  return "II*" + std::string(1, '\0') + little(directory, 4) + padded + little(all.size(), 2) + entries + little(0, 4) +
         values;
}

// ---- PNG, section 5, and RFC 1950 -----------------------------------------------------------------------------------

std::string png_chunk(const std::string& type, const std::string& data) {
  std::uint32_t crc = 0xffffffff;
  for (const char c : type + data) {
    crc ^= static_cast<unsigned char>(c);
    for (int k = 0; k < 8; ++k) crc = crc & 1U ? 0xedb88320U ^ crc >> 1U : crc >> 1U;
  }
  return big(data.size(), 4) + type + data + big(crc ^ 0xffffffffU, 4);
}

std::string stored_zlib(const std::string& bytes) {
  std::uint32_t a = 1, b = 0;
  for (const char c : bytes) a = (a + static_cast<unsigned char>(c)) % 65521, b = (b + a) % 65521;
  std::string out = "\x78\x01";
  std::size_t at = 0;
  do {
    const std::size_t size = std::min<std::size_t>(bytes.size() - at, 0xffff);
    out += std::string(1, at + size == bytes.size() ? '\1' : '\0') + little(size, 2) + little(~size, 2);
    out += bytes.substr(at, size);
    at += size;
  } while (at < bytes.size());
  return out + big(b << 16 | a, 4);
}

std::string png(int width, int height, int bits, const std::array<unsigned, 3>& colour, const std::string& chunks) {
  std::string rows;
  for (int y = 0; y < height; ++y) {
    rows += '\0';
    for (int x = 0; x < width; ++x)
      for (const unsigned c : colour) rows += big(c, bits / 8);
  }
  return "\x89PNG\r\n\x1a\n" +
         png_chunk("IHDR", big(std::uint64_t(width), 4) + big(std::uint64_t(height), 4) + big(std::uint64_t(bits), 1) +
                               std::string("\2\0\0\0", 4)) +
         chunks + png_chunk("IDAT", stored_zlib(rows)) + png_chunk("IEND", "");
}

// ---- ICC.1:2022 -----------------------------------------------------------------------------------------------------

std::string fixed(double value) { return big(std::uint64_t(std::int64_t(std::llround(value * 65536))), 4); }

std::string icc_xyz(const std::array<double, 3>& xyz) {
  return "XYZ " + big(0, 4) + fixed(xyz[0]) + fixed(xyz[1]) + fixed(xyz[2]);
}

std::string icc(const std::string& space, const std::string& name,
                const std::vector<std::pair<std::string, std::string>>& tags) {
  std::string utf16;
  for (const char c : name) utf16 += std::string(1, '\0') + c;
  std::vector<std::pair<std::string, std::string>> all = tags;
  all.emplace_back("desc",
                   "mluc" + big(0, 4) + big(1, 4) + big(12, 4) + "enUS" + big(utf16.size(), 4) + big(28, 4) + utf16);
  all.emplace_back("wtpt", icc_xyz({0.9642, 1, 0.8249}));
  std::string table = big(all.size(), 4), elements;
  for (const auto& [signature, element] : all) {
    table += signature + big(128 + 4 + 12 * all.size() + elements.size(), 4) + big(element.size(), 4);
    elements += element + std::string((4 - element.size() % 4) % 4, '\0');
  }
  std::string header = big(128 + table.size() + elements.size(), 4) + big(0, 4) + big(0x04300000, 4) +
                       (space == "CMYK" ? "prtr" : "mntr") + space + "XYZ ";
  header.resize(36);
  header += "acsp";
  header.resize(68);
  header += fixed(0.9642) + fixed(1) + fixed(0.8249);
  header.resize(128);
  return header + table + elements;
}

// ---- JPEG (T.81, annex B) -------------------------------------------------------------------------------------------

std::string jpeg_segment(int app, const std::string& text) {
  return "\xff" + std::string(1, static_cast<char>(0xe0 + app)) + big(text.size() + 2, 2) + text;
}

std::string written_by_openimageio(const std::string& name, int width, int height, const std::array<int, 3>& colour,
                                   int channels) {
  std::vector<unsigned char> bytes, texels;
  for (int k = 0; k < width * height; ++k)
    for (int c = 0; c < channels; ++c) texels.push_back(static_cast<unsigned char>(colour[std::size_t(c)]));
  OIIO::Filesystem::IOVecOutput file(bytes);
  const auto writer = OIIO::ImageOutput::create(name);
  if (!writer) return {};
  OIIO::ImageSpec spec(width, height, channels, OIIO::TypeDesc::UINT8);
  void* proxy = &file;
  spec.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
  spec.attribute("CompressionQuality", 100);
  spec.attribute("jpeg:subsampling", "4:4:4");
  if (!writer->open(name, spec) || !writer->write_image(OIIO::TypeDesc::UINT8, texels.data()) || !writer->close())
    return {};
  return {bytes.begin(), bytes.end()};
}

std::string jpeg(int width, int height, const std::array<int, 3>& colour, const std::string& segments, int channels) {
  const std::string whole = written_by_openimageio("a.jpg", width, height, colour, channels);
  return whole.substr(0, 2) + segments + whole.substr(2);
}

// ---- Radiance -------------------------------------------------------------------------------------------------------

std::string radiance(const std::string& header, int width, int height, const std::array<int, 4>& rgbe) {
  std::string out = "#?RADIANCE\n" + header + "\n-Y " + std::to_string(height) + " +X " + std::to_string(width) + "\n";
  for (int k = 0; k < width * height; ++k)
    for (const int c : rgbe) out += static_cast<char>(c);
  return out;
}

}  // namespace command_tests

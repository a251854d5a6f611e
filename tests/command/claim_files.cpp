// Files of one colour, byte by byte.
#include <bit>
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

// ---- Radiance -------------------------------------------------------------------------------------------------------

std::string radiance(const std::string& header, int width, int height, const std::array<int, 4>& rgbe) {
  std::string out = "#?RADIANCE\n" + header + "\n-Y " + std::to_string(height) + " +X " + std::to_string(width) + "\n";
  for (int k = 0; k < width * height; ++k)
    for (const int c : rgbe) out += static_cast<char>(c);
  return out;
}

}  // namespace command_tests

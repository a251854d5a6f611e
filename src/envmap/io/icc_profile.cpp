#include "envmap/io/icc_profile.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

namespace envmap {
namespace {

// Numbers are big-endian.
std::string number(std::uint32_t n) {
  return {static_cast<char>(n >> 24), static_cast<char>(n >> 16), static_cast<char>(n >> 8), static_cast<char>(n)};
}

std::string fixed(double x) { return number(std::uint32_t(std::int32_t(std::lround(x * 65536)))); }

std::string xyz(const Flux& c) { return "XYZ " + number(0) + fixed(c.x) + fixed(c.y) + fixed(c.z); }

// One text, in English: 12 bytes a record, which begin 28 bytes into the element.
std::string text(const std::string& ascii) {
  std::string utf16;
  for (const char c : ascii) utf16 += {'\0', c};
  return "mluc" + number(0) + number(1) + number(12) + "enUS" + number(std::uint32_t(utf16.size())) + number(28) +
         utf16;
}

// IEC 61966-2-1 as a parametric curve of type 3, or the identity, a curve without entries.
std::string tone(Curve curve) {
  if (curve == Curve::linear) return "curv" + number(0) + number(0);
  return "para" + number(0) + number(3 << 16) + fixed(2.4) + fixed(1 / 1.055) + fixed(0.055 / 1.055) +
         fixed(1 / 12.92) + fixed(0.04045);
}

// The illuminant of the connection space, as the header rounds it.
constexpr Flux d50{0.9642, 1, 0.8249};

using Tag = std::pair<std::string, std::string>;

std::vector<Tag> tags_of(const std::string& name, const Primaries& p, Curve curve) {
  // XYZ values are relative to D65: the primaries of CIE XYZ have no white of their own.
  const Point2 white = same(p, cie_xyz) ? rec709.white : p.white;
  const double sum = d50.x + d50.y + d50.z;
  const ColourMatrix adapt = adaptation(white, {d50.x / sum, d50.y / sum}), colours = adapt * to_xyz(p);
  std::string chad = "sf32" + number(0);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) chad += fixed(adapt[column][row]);
  return {{"desc", text(name)},      {"cprt", text("CC0")},     {"wtpt", xyz(d50)},        {"chad", chad},
          {"rXYZ", xyz(colours[0])}, {"gXYZ", xyz(colours[1])}, {"bXYZ", xyz(colours[2])}, {"rTRC", tone(curve)},
          {"gTRC", tone(curve)},     {"bTRC", tone(curve)}};
}

}  // namespace

std::string icc_profile(const std::string& name, const Primaries& primaries, Curve curve) {
  constexpr std::size_t header_size = 128;
  const std::vector<Tag> tags = tags_of(name, primaries, curve);
  std::string table = number(std::uint32_t(tags.size())), elements;
  const std::size_t start = header_size + 4 + 12 * tags.size();
  for (const auto& [signature, element] : tags) {
    table += signature + number(std::uint32_t(start + elements.size())) + number(std::uint32_t(element.size()));
    elements += element;
    elements.resize((elements.size() + 3) / 4 * 4);
  }
  const std::string size = number(std::uint32_t(start + elements.size()));
  std::string header = size + number(0) + number(0x04300000) + "mntrRGB XYZ ";
  header.resize(36);  // No date.
  header += "acsp";
  header.resize(68);  // No platform, maker or model; perceptual intent.
  header += fixed(d50.x) + fixed(d50.y) + fixed(d50.z);
  header.resize(header_size);
  return header + table + elements;
}

}  // namespace envmap

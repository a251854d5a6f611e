// DDS files of any texels, made here byte by byte (Microsoft, "Programming Guide for DDS"), show what Direct3D shows.
#include <cmath>
#include <functional>

#include "claims.h"
#include "picture.h"
#include "run.h"

namespace command_tests::dds_test {
namespace {

class Dds : public CommandTest {};

// Direction of a place of a face from -1 to 1, s to the right and t down (OpenGL 4.6, table 8.19; Direct3D has the
// same).
Vec direction(int face, double s, double t) {
  const Vec all[] = {{1, -t, -s}, {-1, -t, s}, {s, 1, t}, {s, -1, -t}, {s, -t, 1}, {-s, -t, -1}};
  return all[face];
}

// IEC 61966-2-1.
double encoded(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

struct Header {
  unsigned size = 4, levels = 1, pitch = 0;
  unsigned flags = 0, four_cc = 0, bits = 0;
  std::array<unsigned, 4> masks = {};
  unsigned caps2 = 0xfe00;
  int dxgi = -1;
  unsigned misc = 4, dimension = 3, array = 1, misc2 = 0;
  unsigned height = 0;

  [[nodiscard]] std::string bytes() const {
    const auto word = [](unsigned n) { return little(n, 4); };
    std::string all = "DDS " + word(124) + word(0x1007) + word(height ? height : size) + word(size) + word(pitch) +
                      word(0) + word(levels) + std::string(44, '\0') + word(32) + word(dxgi >= 0 ? 4 : flags) +
                      (dxgi >= 0 ? "DX10" : word(four_cc)) + word(bits);
    for (const unsigned m : masks) all += word(m);
    all += word(0x1000) + word(caps2) + std::string(12, '\0');
    if (dxgi >= 0) all += word(unsigned(dxgi)) + word(dimension) + word(misc) + word(array) + word(misc2);
    return all;
  }
};

using Encode = std::function<std::string(const std::array<float, 3>& colour)>;

// The map of directions. @param align of rows, in bytes.
std::string cube(const Header& header, const Encode& encode, std::size_t align = 1) {
  std::string all = header.bytes();
  for (int face = 0; face < 6; ++face)
    for (unsigned level = 0; level < header.levels; ++level) {
      const unsigned n = header.size >> level;
      for (unsigned j = 0; j < n; ++j) {
        std::string row;
        for (unsigned i = 0; i < n; ++i)
          row += encode(colour_of(direction(face, (2.0 * i + 1) / n - 1, (2.0 * j + 1) / n - 1)));
        all += row + std::string((align - row.size() % align) % align, '\x55');
      }
    }
  return all;
}

unsigned quantised(double value, unsigned most) { return unsigned(std::lround(value * most)); }

// Channels of so many bits from the lowest on: c[order[0]] comes first. What is left over is ones.
Encode packed(std::array<int, 3> order, std::array<int, 3> bits, int bytes, bool srgb) {
  return [=](const std::array<float, 3>& c) {
    std::uint64_t word = 0;
    int at = 0;
    for (std::size_t k = 0; k < 3; at += bits[k++]) {
      const double v = c[std::size_t(order[k])];
      word |= std::uint64_t{quantised(srgb ? encoded(v) : v, (1U << bits[k]) - 1)} << at;
    }
    for (; at < 8 * bytes; ++at) word |= std::uint64_t{1} << at;
    return little(word, bytes);
  };
}

constexpr std::array<int, 3> rgb{0, 1, 2}, bgr{2, 1, 0}, eights{8, 8, 8}, tens{10, 10, 10}, sixteens{16, 16, 16};

TEST_F(Dds, CubesOfIntegersAreSeenAsDirect3DSeesThem) {
  struct Row {
    const char* name;
    Header header;
    Encode encode;
    double tolerance;
    std::size_t align = 1;
  };
  const std::vector<Row> rows{
      {"24 bits",
       {.flags = 0x40, .bits = 24, .masks = {0xff0000, 0xff00, 0xff, 0}},
       packed(bgr, eights, 3, true),
       5e-3},
      {"32 bits, one byte of them nothing",
       {.flags = 0x40, .bits = 32, .masks = {0xff0000, 0xff00, 0xff, 0}},
       packed(bgr, eights, 4, true),
       5e-3},
      {"32 bits with alpha",
       {.flags = 0x41, .bits = 32, .masks = {0xff, 0xff00, 0xff0000, 0xff000000}},
       packed(rgb, eights, 4, true),
       5e-3},
      {"5-6-5", {.flags = 0x40, .bits = 16, .masks = {0xf800, 0x7e0, 0x1f, 0}}, packed(bgr, {5, 6, 5}, 2, true), 5e-2},
      {"10-10-10-2",
       {.flags = 0x41, .bits = 32, .masks = {0x3ff, 0xffc00, 0x3ff00000, 0xc0000000}},
       packed(rgb, tens, 4, true),
       1.5e-3},
      {"rows of words",
       {.size = 3, .pitch = 12, .flags = 0x40, .bits = 24, .masks = {0xff0000, 0xff00, 0xff, 0}},
       packed(bgr, eights, 3, true),
       5e-3,
       4},
      {"rows that are tight, whatever the pitch",
       {.size = 3, .pitch = 12, .flags = 0x40, .bits = 24, .masks = {0xff0000, 0xff00, 0xff, 0}},
       packed(bgr, eights, 3, true),
       5e-3},
      {"three levels",
       {.levels = 3, .flags = 0x40, .bits = 24, .masks = {0xff0000, 0xff00, 0xff, 0}},
       packed(bgr, eights, 3, true),
       5e-3},
      {"A16B16G16R16", {.flags = 4, .four_cc = 36}, packed(rgb, sixteens, 8, true), 2e-5},
      {"R8G8B8A8_UNORM_SRGB", {.dxgi = 29}, packed(rgb, eights, 4, true), 5e-3},
      {"B8G8R8A8_UNORM_SRGB, misc flag alone", {.caps2 = 0, .dxgi = 91}, packed(bgr, eights, 4, true), 5e-3},
      {"B8G8R8X8_UNORM_SRGB, caps2 alone", {.dxgi = 93, .misc = 0}, packed(bgr, eights, 4, true), 5e-3},
      {"B8G8R8A8_UNORM", {.dxgi = 87}, packed(bgr, eights, 4, false), 2e-3},
      {"B8G8R8X8_UNORM", {.dxgi = 88}, packed(bgr, eights, 4, false), 2e-3},
      {"R8G8B8A8_UNORM", {.dxgi = 28}, packed(rgb, eights, 4, false), 2e-3},
      {"R10G10B10A2_UNORM", {.dxgi = 24}, packed(rgb, tens, 4, false), 5e-4},
      {"R16G16B16A16_UNORM", {.dxgi = 11}, packed(rgb, sixteens, 8, false), 8e-6},
      {"B5G6R5_UNORM", {.dxgi = 85}, packed(bgr, {5, 6, 5}, 2, false), 1.7e-2},
      {"B5G5R5A1_UNORM", {.dxgi = 86}, packed(bgr, {5, 5, 5}, 2, false), 1.7e-2},
      {"B4G4R4A4_UNORM", {.dxgi = 115}, packed(bgr, {4, 4, 4}, 2, false), 3.4e-2}};
  for (const Row& row : rows) {
    SCOPED_TRACE(row.name);
    write("a.dds", cube(row.header, row.encode, row.align));
    const Result run = envmap({"convert", "a.dds", "a.pfm", "--layout", "column"});
    ASSERT_EQ(run.status, 0) << run.err;
    EXPECT_LT(difference(load(path("a.pfm")), cube_directions("column", int(row.header.size))), row.tolerance);
  }
}

TEST_F(Dds, LevelsAreThoseOfTheFile) {
  const Header header{.levels = 3, .flags = 0x40, .bits = 24, .masks = {0xff0000, 0xff00, 0xff, 0}};
  write("a.dds", cube(header, packed(bgr, eights, 3, true)));
  EXPECT_EQ(report({"info", "a.dds"})["levels"], 3);
  succeeds({"convert", "a.dds", "a.pfm", "--level", "1", "--layout", "column"});
  EXPECT_LT(difference(load(path("a.pfm")), cube_directions("column", 2)), 5e-3);
}

// The first texel of the first face is white. OpenImageIO decodes the blocks, but not where they lie.
TEST_F(Dds, BlocksHaveTheOrientationOfOtherTexels) {
  const std::string white_first = little(0xffff, 2) + little(0, 2) + std::string("\x54\x55\x55\x55", 4);
  const std::string black = little(0, 2) + little(0, 2) + std::string(4, '\0'), opaque(8, '\xff');
  const std::string grey_first = std::string("\xff\0", 2) + std::string("\x48\x92\x24\x49\x92\x24", 6);
  struct Row {
    const char* name;
    Header header;
    std::string first, other;
  };
  const std::vector<Row> rows{{"DXT1", {.flags = 4, .four_cc = 0x31545844}, white_first, black},
                              {"DXT5", {.flags = 4, .four_cc = 0x35545844}, opaque + white_first, opaque + black},
                              {"BC1_UNORM_SRGB", {.dxgi = 72}, white_first, black},
                              {"BC3_UNORM", {.dxgi = 77}, opaque + white_first, opaque + black},
                              {"BC4_UNORM", {.dxgi = 80}, grey_first, std::string(8, '\0')}};
  for (const Row& row : rows) {
    SCOPED_TRACE(row.name);
    std::string bytes = row.header.bytes() + row.first;
    for (int face = 1; face < 6; ++face) bytes += row.other;
    write("a.dds", bytes);
    const Result run = envmap({"info", "a.dds", "--json"});
    ASSERT_EQ(run.status, 0) << run.err;
    const nlohmann::json told = nlohmann::json::parse(run.out);
    EXPECT_EQ(told["texels_at_maximum"], 1);
    EXPECT_EQ(told["maximum"], (std::vector<double>{1, 1, 1}));
    const Vec expected = direction(0, -0.75, -0.75);
    const double length = std::sqrt(1 + 2 * 0.75 * 0.75);
    for (std::size_t k = 0; k < 3; ++k)
      EXPECT_NEAR(told["brightest"]["direction"][k].get<double>(), expected[k] / length, 1e-6);
  }
}

TEST_F(Dds, OneChannelIsGrey) {
  const std::string texels = little(0, 2) + little(0x8000, 2);
  write("r16.dds", Header{.size = 2, .caps2 = 0, .dxgi = 56, .misc = 0, .height = 1}.bytes() + texels);
  EXPECT_NEAR(report({"info", "r16.dds"})["maximum"][2].get<double>(), 0x8000 / 65535.0, 1e-7);
  write("l8.dds",
        Header{.size = 2, .flags = 0x20000, .bits = 8, .masks = {0xff, 0, 0, 0}, .caps2 = 0, .height = 1}.bytes() +
            std::string("\0\x80", 2));
  EXPECT_NEAR(report({"info", "l8.dds"})["maximum"][0].get<double>(), std::pow((128 / 255.0 + 0.055) / 1.055, 2.4),
              1e-5);
}

TEST_F(Dds, LegacyBytesAreSrgbUnlessTheUserSaysSo) {
  const Header header{.flags = 0x40, .bits = 24, .masks = {0xff0000, 0xff00, 0xff, 0}};
  write("a.dds", cube(header, packed(bgr, eights, 3, false)));
  succeeds({"convert", "a.dds", "a.pfm", "--layout", "column", "--input-space", "lin_rec709"});
  EXPECT_LT(difference(load(path("a.pfm")), cube_directions("column", 4)), 2e-3);
}

TEST_F(Dds, WhatIsNotReadIsNamed) {
  const auto refuse = [&](const Header& header, const std::vector<std::string>& words) {
    write("a.dds", header.bytes() + std::string(4096, '\0'));
    fails(3, {"info", "a.dds"}, words);
  };
  refuse({.dxgi = 49}, {"not supported", "R8G8_UNORM"});
  refuse({.dxgi = 83}, {"not supported", "BC5_UNORM"});
  refuse({.dxgi = 81}, {"not supported", "BC4_SNORM"});
  refuse({.dxgi = 31}, {"not supported", "R8G8B8A8_SNORM"});
  refuse({.dxgi = 200}, {"not supported", "DXGI_FORMAT 200"});
  refuse({.flags = 4, .four_cc = 0x42475852}, {"not supported", "FourCC 'RXGB'"});
  refuse({.flags = 4, .four_cc = 110}, {"not supported", "FourCC 110"});
  refuse({.flags = 0x80000, .bits = 16, .masks = {0xff, 0xff00, 0, 0}}, {"not supported", "0x80000"});
  refuse({.caps2 = 0x200, .dxgi = 29, .dimension = 4}, {"not supported", "volume"});
  refuse({.dxgi = 29, .array = 2}, {"not supported", "array of 2"});
  refuse({.caps2 = 0x7e00, .dxgi = 29}, {"not supported", "some faces"});
  refuse({.flags = 0x40, .bits = 24, .masks = {0xff0000, 0xff00, 0xff00ff00, 0}}, {"damaged", "0xff00ff00"});
  write("a.dds", Header{.dxgi = 29}.bytes() + std::string(6 * 64 - 1, '\0'));
  fails(3, {"info", "a.dds"}, {"truncated or damaged", "384", "383"});
}

TEST_F(Dds, NotesSayWhatElseIsThere) {
  write("a.dds", Header{.dxgi = 87, .misc2 = 2}.bytes() + std::string(6 * 64 + 5, '\xff'));
  const Result run = envmap({"info", "a.dds", "--json"});
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_NE(run.err.find("5 bytes after its last texel are not read"), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("linear, as B8G8R8A8_UNORM says"), std::string::npos) << run.err;
  EXPECT_NE(run.out.find("premultiplied"), std::string::npos) << run.out;
}

}  // namespace
}  // namespace command_tests::dds_test

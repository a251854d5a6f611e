// Packed pixels, decoded here: with the APIs' rules for cube textures a lookup in direction d returns the radiance
// from d.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <vector>

#include "envmap/envmap.h"

namespace pack_test {
namespace {

using namespace envmap;

template <class T>
T at(const PackedMap& map, std::size_t offset) {
  T value;
  std::memcpy(&value, map.bytes.data() + offset, sizeof(T));
  return value;
}

double half(std::uint16_t bits) {
  const int exponent = bits >> 10 & 31, mantissa = bits & 1023;
  return (bits >> 15 ? -1 : 1) *
         (exponent == 0 ? std::ldexp(mantissa, -24) : std::ldexp(1024 + mantissa, exponent - 25));
}

Rgb<double> texel(const PackedMap& map, int level, int face, int i, int j) {
  const PackedMap::Part& part = map.part(level, face);
  const std::size_t row = part.offset + std::size_t(j) * part.row_bytes, k = std::size_t(i);
  switch (map.format) {
    case PixelFormat::rgba16f:
    case PixelFormat::rgb16f: {
      const std::size_t bytes = map.format == PixelFormat::rgba16f ? 8 : 6;
      return {half(at<std::uint16_t>(map, row + bytes * k)), half(at<std::uint16_t>(map, row + bytes * k + 2)),
              half(at<std::uint16_t>(map, row + bytes * k + 4))};
    }
    case PixelFormat::rgba32f:
    case PixelFormat::rgb32f: {
      const std::size_t bytes = map.format == PixelFormat::rgba32f ? 16 : 12;
      return {at<float>(map, row + bytes * k), at<float>(map, row + bytes * k + 4),
              at<float>(map, row + bytes * k + 8)};
    }
    case PixelFormat::rgb9e5: {
      const auto word = at<std::uint32_t>(map, row + 4 * k);
      const double scale = std::ldexp(1.0, int(word >> 27) - 24);
      return {(word & 511) * scale, (word >> 9 & 511) * scale, (word >> 18 & 511) * scale};
    }
    case PixelFormat::bc6h: break;
  }
  return Rgb<double>(NAN);
}

// Table 8.19 of OpenGL 4.6, "Cube Map Face Selection" of Vulkan 1.3; Direct3D has the same: the major axis picks the
// face, sc and tc run right and down.
struct Place {
  int face, i, j;
};
Place texel_of(const Direction& d, int size) {
  const Direction a = glm::abs(d);
  int face = 0;
  double sc = 0, tc = 0, ma = 0;
  if (a.x >= a.y && a.x >= a.z)
    face = d.x > 0 ? 0 : 1, sc = d.x > 0 ? -d.z : d.z, tc = -d.y, ma = a.x;
  else if (a.y >= a.z)
    face = d.y > 0 ? 2 : 3, sc = d.x, tc = d.y > 0 ? d.z : -d.z, ma = a.y;
  else
    face = d.z > 0 ? 4 : 5, sc = d.z > 0 ? d.x : -d.x, tc = -d.y, ma = a.z;
  const auto index = [&](double c) { return std::min(size - 1, int((c / ma + 1) / 2 * size)); };
  return {face, index(sc), index(tc)};
}

class EachPixelFormat : public testing::TestWithParam<PixelFormat> {};
INSTANTIATE_TEST_SUITE_P(, EachPixelFormat,
                         testing::Values(PixelFormat::rgba16f, PixelFormat::rgba32f, PixelFormat::rgb16f,
                                         PixelFormat::rgb32f, PixelFormat::rgb9e5),
                         [](const auto& p) { return std::string(pixel_format_names[std::size_t(p.param)]); });

TEST_P(EachPixelFormat, AnswersByWorldDirection) {
  EnvironmentMap map = generate(Directions{}, Projection::cube, 32);
  add_levels(map);
  const PackedMap packed = pack(map, {.format = GetParam()});
  ASSERT_EQ(packed.levels, 6);
  ASSERT_EQ(packed.faces, 6);
  for (int level = 0; level < 3; ++level) {
    const int size = 32 >> level;
    for (int k = 0; k < 500; ++k) {
      const double z = 1 - (2 * k + 1) / 500.0, turn = 2.4 * k, r = std::sqrt(1 - z * z);
      const Direction d(r * std::cos(turn), z, r * std::sin(turn));
      const Place p = texel_of(d, size);
      const Rgb<double> found = texel(packed, level, p.face, p.i, p.j);
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c], (d[c] + 1) / 2, 1.0 / size + 2e-3) << level << " " << k;
    }
  }
}

TEST_P(EachPixelFormat, IsTightInOrderAndOpaque) {
  EnvironmentMap map = generate(Directions{}, Projection::latlong, 8);
  add_levels(map);
  const PackedMap packed = pack(map, {.format = GetParam()});
  std::size_t end = 0;
  for (const PackedMap::Part& part : packed.parts) {
    EXPECT_EQ(part.offset, end);
    EXPECT_EQ(part.size, part.row_bytes * std::size_t(part.height));
    end += part.size;
  }
  EXPECT_EQ(end, packed.bytes.size());
  for (int j = 0; j < 8; ++j)
    for (int i = 0; i < 16; ++i)
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(texel(packed, 0, 0, i, j)[c], (*map.base().texel(0, i, j))[c], 2e-3);
  if (GetParam() == PixelFormat::rgba16f) {
    EXPECT_EQ(at<std::uint16_t>(packed, 6), 0x3c00);
  } else if (GetParam() == PixelFormat::rgba32f) {
    EXPECT_EQ(at<float>(packed, 12), 1);
  }
  const PackedMap aligned = pack(map, {.format = GetParam(), .row_alignment = 256});
  for (std::size_t k = 0; k < aligned.parts.size(); ++k) {
    EXPECT_EQ(aligned.parts[k].offset % 256, 0U);
    EXPECT_EQ(aligned.parts[k].row_bytes % 256, 0U);
    EXPECT_EQ(texel(aligned, int(k), 0, 0, 0), texel(packed, int(k), 0, 0, 0));
  }
}

// The blocks are those of the KTX2 file, whose decoder is another program's in tests/ktx2_check.py.
TEST(Pack, BlocksAreThoseOfTheFile) {
  EnvironmentMap map = generate(Sun{.radius_degrees = 20}, Projection::cube, 16);
  add_levels(map);
  const PackedMap packed = pack(map, {.format = PixelFormat::bc6h, .clamp = true});
  const std::vector<std::byte> file = encode(map, {.format = "dds", .depth = Depth::bc6h, .clamp = true});
  // DDS holds face by face, each with all its levels, after 148 bytes of header.
  std::size_t offset = 148;
  for (int face = 0; face < 6; ++face)
    for (int level = 0; level < packed.levels; ++level) {
      const PackedMap::Part& part = packed.part(level, face);
      ASSERT_LE(offset + part.size, file.size());
      EXPECT_EQ(std::memcmp(file.data() + offset, packed.bytes.data() + part.offset, part.size), 0)
          << face << " " << level;
      offset += part.size;
    }
  EXPECT_EQ(offset, file.size());
}

TEST(Pack, FacesAsInMemory) {
  const EnvironmentMap map = generate(Directions{}, Projection::cube, 4);
  const PackedMap packed = pack(map, {.format = PixelFormat::rgb32f, .orientation = FaceOrientation::seen_from_inside});
  for (int face = 0; face < 6; ++face)
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 4; ++i) EXPECT_EQ(texel(packed, 0, face, i, j), Rgb<double>(*map.base().texel(face, i, j)));
}

TEST(Pack, RefusesWhatDoesNotFit) {
  const EnvironmentMap bright = generate(Constant{Rgb<double>(1e6)}, Projection::cube, 4);
  EXPECT_THROW((void)pack(bright), UsageError);
  EXPECT_NEAR(pack(bright, {.clamp = true}).flux_lost, 1 - 65504e-6, 1e-6);
  EXPECT_NO_THROW((void)pack(bright, {.format = PixelFormat::rgba32f}));
  EnvironmentMap dark = generate(Constant{}, Projection::cube, 4);
  dark.base().texel(0, 0, 0)->x = -1;
  EXPECT_NO_THROW((void)pack(dark));
  EXPECT_THROW((void)pack(dark, {.format = PixelFormat::rgb9e5}), UsageError);
  EXPECT_THROW((void)pack(dark, {.format = PixelFormat::bc6h}), UsageError);
}

TEST(Encode, RefusesNegativeRadianceWhereThereIsNoSign) {
  EnvironmentMap map = generate(Constant{}, Projection::cube, 4);
  map.base().texel(0, 1, 2)->x = -1;
  for (WriteOptions o : {WriteOptions{.format = "hdr"},
                         {.format = "ktx2", .depth = Depth::rgb9e5},
                         {.format = "ktx2", .depth = Depth::bc6h}}) {
    EXPECT_THROW((void)encode(map, o), OutputError) << o.format;
    o.clamp = true;
    const Colour found = *read(encode(map, o), {}).map.base().texel(0, 1, 2);
    EXPECT_NEAR(found.x, 0, 0.3) << o.format;
    EXPECT_NEAR(found.y, 1, 0.3) << o.format;
  }
  EXPECT_NO_THROW((void)encode(map, {.format = "ktx2", .depth = Depth::half}));
  map.base().texel(0, 1, 2)->x = -1e-9F;  // Less than a step.
  EXPECT_NO_THROW((void)encode(map, {.format = "hdr"}));
}

}  // namespace
}  // namespace pack_test

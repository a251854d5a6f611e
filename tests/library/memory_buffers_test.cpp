// Maps from and into the caller's memory: every channel type, strides, layouts, against values computed here.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

#include "envmap/envmap.h"

namespace memory_buffers_test {
namespace {

using namespace envmap;

// A value for each texel of an image and each channel, all of them exact in half.
float value(int x, int y, int c) { return float(x + 8 * y + 64 * c) / 256; }

template <class T>
void put(std::byte* to, T v) {
  std::memcpy(to, &v, sizeof v);
}

std::uint16_t half_of(float v) {  // Of normal numbers that half holds.
  std::uint32_t bits;
  std::memcpy(&bits, &v, sizeof bits);
  return v == 0 ? 0 : std::uint16_t(((bits >> 23) - 112) << 10 | ((bits >> 13) & 0x3ff));
}

// An 8x4 image as such channels, with gaps of `pixel_gap` and `row_gap` channels.
struct Image {
  Image(ChannelType type, int channels, int pixel_gap, int row_gap, bool bottom_up) {
    const std::ptrdiff_t size = type == ChannelType::float32 ? 4 : type == ChannelType::uint8 ? 1 : 2;
    const std::ptrdiff_t pixel = (channels + pixel_gap) * size, row = 8 * pixel + row_gap * size;
    bytes.resize(std::size_t(4 * row), std::byte{0x7f});
    for (int y = 0; y < 4; ++y)
      for (int x = 0; x < 8; ++x)
        for (int c = 0; c < channels; ++c) {
          std::byte* const at = bytes.data() + (bottom_up ? 3 - y : y) * row + x * pixel + c * size;
          if (type == ChannelType::float32) put(at, value(x, y, c));
          if (type == ChannelType::float16) put(at, half_of(value(x, y, c)));
          if (type == ChannelType::uint8) put(at, std::uint8_t(x + 8 * y + 64 * c));
          if (type == ChannelType::uint16) put(at, std::uint16_t(257 * (x + 8 * y + 64 * c)));
        }
    buffer = {.pixels = bytes.data() + (bottom_up ? 3 * row : 0),
              .width = 8,
              .height = 4,
              .channels = channels,
              .type = type,
              .pixel_stride = pixel,
              .row_stride = bottom_up ? -row : row};
    if (type == ChannelType::uint8 || type == ChannelType::uint16) buffer.transfer = Transfer::linear;
  }
  std::vector<std::byte> bytes;
  PixelBuffer buffer;
};

TEST(Buffers, OfEveryTypeAndStrideBecomeMaps) {
  for (const ChannelType type : {ChannelType::float32, ChannelType::float16, ChannelType::uint8, ChannelType::uint16})
    for (const int channels : {1, 3, 4})
      for (const int gap : {0, 2})
        for (const bool bottom_up : {false, true}) {
          const Image image(type, channels, gap, gap, bottom_up);
          const EnvironmentMap map = map_of(image.buffer);
          ASSERT_EQ(map.projection(), Projection::latlong);
          const bool integers = type == ChannelType::uint8 || type == ChannelType::uint16;
          for (int y = 0; y < 4; ++y)
            for (int x = 0; x < 8; ++x)
              for (int c = 0; c < 3; ++c) {
                const float wanted = value(x, y, channels == 1 ? 0 : c) * (integers ? 256.0F / 255 : 1);
                ASSERT_NEAR((*map.base().texel(0, x, y))[c], wanted, 1e-7)
                    << int(type) << " " << channels << " " << gap << " " << bottom_up;
              }
        }
}

TEST(Buffers, OfSrgbBecomeLinear) {
  Image image(ChannelType::uint8, 3, 0, 0, false);
  image.buffer.transfer = Transfer::srgb;
  const EnvironmentMap map = map_of(image.buffer);
  for (const int x : {0, 1, 5, 7}) {
    const double v = (x + 8 + 64) / 255.0, wanted = v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
    EXPECT_NEAR(map.base().texel(0, x, 1)->y, wanted, 1e-5 * wanted + 1e-7);
  }
}

TEST(Buffers, ComeBackAsTheyWere) {
  for (const Projection p : all_projections) {
    const EnvironmentMap map = generate(Directions{}, p, 12);
    for (const Layout layout : {Layout::column, Layout::row, Layout::cross, Layout::vcross, Layout::grid3x2}) {
      if (p != Projection::cube && layout != Layout::column) continue;
      const std::optional<Layout> chosen = p == Projection::cube ? std::optional(layout) : std::nullopt;
      const bool cube = p == Projection::cube;
      const int across = !cube                      ? (p == Projection::latlong || p == Projection::paraboloid ? 2 : 1)
                         : layout == Layout::column ? 1
                         : layout == Layout::row    ? 6
                         : layout == Layout::cross  ? 4
                                                    : 3;
      const int down = !cube                      ? 1
                       : layout == Layout::column ? 6
                       : layout == Layout::row    ? 1
                       : layout == Layout::cross  ? 3
                       : layout == Layout::vcross ? 4
                                                  : 2;
      std::vector<float> floats(std::size_t(4 * 12 * across * 12 * down));
      const MutablePixelBuffer out{.pixels = reinterpret_cast<std::byte*>(floats.data()),
                                   .width = 12 * across,
                                   .height = 12 * down,
                                   .channels = 4};
      copy_to(map, out, {.layout = chosen});
      const PixelBuffer in{.pixels = out.pixels, .width = out.width, .height = out.height, .channels = 4};
      const EnvironmentMap back = map_of(in, {.projection = p, .layout = chosen, .forward = map.forward});
      EXPECT_EQ(compare(back, map).maximum, 0) << name(p) << " " << int(layout);
      EXPECT_EQ(floats[3], 1);
    }
  }
}

TEST(Buffers, HoldWhatTheyCanOrRefuse) {
  EnvironmentMap map = generate(Constant{Rgb<double>(0.25, 0.5, 1)}, Projection::latlong, 2);
  std::vector<std::uint8_t> bytes(4 * 2 * 3);
  const MutablePixelBuffer out{.pixels = reinterpret_cast<std::byte*>(bytes.data()),
                               .width = 4,
                               .height = 2,
                               .type = ChannelType::uint8,
                               .transfer = Transfer::linear};
  copy_to(map, out);
  EXPECT_EQ(bytes[0], 64);
  EXPECT_EQ(bytes[1], 128);
  EXPECT_EQ(bytes[2], 255);
  *map.base().texel(0, 1, 1) = Colour(3);
  EXPECT_THROW(copy_to(map, out), UsageError);
  copy_to(map, out, {.clamp = true});
  EXPECT_EQ(bytes[(4 + 1) * 3], 255);
  *map.base().texel(0, 1, 1) = Colour(std::numeric_limits<float>::quiet_NaN());
  EXPECT_THROW(copy_to(map, out, {.clamp = true}), UsageError);
}

TEST(Buffers, ThatCannotBeAreRefused) {
  const Image image(ChannelType::uint8, 3, 0, 0, false);
  const auto refused = [&](auto change) {
    PixelBuffer b = image.buffer;
    change(b);
    EXPECT_THROW((void)map_of(b), Error);
  };
  refused([](PixelBuffer& b) { b.pixels = nullptr; });
  refused([](PixelBuffer& b) { b.transfer.reset(); });
  refused([](PixelBuffer& b) { b.width = 0; });
  refused([](PixelBuffer& b) { b.height = -4; });
  refused([](PixelBuffer& b) { b.channels = 2; });
  refused([](PixelBuffer& b) { b.type = ChannelType(9); });
  refused([](PixelBuffer& b) { b.transfer = Transfer(9); });
  refused([](PixelBuffer& b) { b.pixel_stride = 2; });
  refused([](PixelBuffer& b) { b.row_stride = 23; });
  refused([](PixelBuffer& b) { b.row_stride = -23; });
  refused([](PixelBuffer& b) { b.width = 7; });  // No map has that shape.
  EXPECT_THROW((void)map_of(image.buffer, {.projection = Projection(99)}), UsageError);
  const EnvironmentMap map = generate(Constant{}, Projection::latlong, 2);
  std::vector<std::byte> memory(1000);
  for (const auto& [width, height, level] : {std::tuple{5, 2, 0}, {4, 1, 0}, {4, 2, 1}, {4, 2, -1}})
    EXPECT_THROW(copy_to(map, {.pixels = memory.data(), .width = width, .height = height}, {.level = level}),
                 UsageError);
  EXPECT_THROW(copy_to(map, {.pixels = memory.data(), .width = 4, .height = 2}, {.layout = Layout::row}), UsageError);
}

TEST(PackedMaps, NameTheBytesOfALevel) {
  EnvironmentMap cube = generate(Directions{}, Projection::cube, 8);
  add_levels(cube);
  const PackedMap packed = pack(cube, {.format = PixelFormat::rgb32f});
  std::size_t all = 0;
  for (int level = 0; level < packed.levels; ++level) {
    const int side = 8 >> level;
    EXPECT_EQ(packed.level(level).size(), std::size_t(6 * side * side * 12));
    EXPECT_EQ(packed.level(level).data(), packed.bytes.data() + all);
    all += packed.level(level).size();
  }
  EXPECT_EQ(all, packed.bytes.size());
  EXPECT_THROW((void)packed.level(packed.levels), UsageError);
}

}  // namespace
}  // namespace memory_buffers_test

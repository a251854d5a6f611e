// BC6H against OpenImageIO's decoder, and against blocks worked out by hand.
#include "envmap/io/bc6h.h"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cstring>
#include <random>

#include "envmap/io/bc6h_block.h"
#include "envmap/io/formats.h"
#include "envmap/io/image.h"

namespace envmap {
namespace {

using Bytes16 = std::array<std::byte, bc6h::bytes>;

// A flat DDS image of these blocks. @param dxgi 95: UF16; 96: SF16.
std::vector<char> dds(std::span<const Bytes16> blocks, std::uint32_t dxgi, std::uint32_t width, std::uint32_t height) {
  const auto size = static_cast<std::uint32_t>(blocks.size_bytes());
  std::array<std::uint32_t, 37> header{0x20534444, 124, 0x81007, height, width, size, 0, 1};
  const std::uint32_t format[] = {32, 4, 0x30315844, 0, 0, 0, 0, 0, 0x1000, 0, 0, 0, 0, dxgi, 3, 0, 1, 0};
  std::ranges::copy(format, header.begin() + 19);
  std::vector<char> file(sizeof header + size);
  std::memcpy(file.data(), header.data(), sizeof header);
  std::memcpy(file.data() + sizeof header, blocks.data(), size);
  return file;
}

// Random bits of every mode in turn, and of the four that are reserved.
std::vector<Bytes16> random_blocks(std::size_t count) {
  std::vector<unsigned> numbers{0x13, 0x17, 0x1b, 0x1f};
  for (const bc6h::Mode& m : bc6h::modes) numbers.push_back(m.number);
  std::mt19937 random(1);
  std::vector<Bytes16> blocks(count);
  for (std::size_t k = 0; k < count; ++k) {
    for (std::byte& b : blocks[k]) b = static_cast<std::byte>(random());
    const unsigned number = numbers[k % numbers.size()], bits = number < 2 ? 3 : 31;
    blocks[k][0] = (blocks[k][0] & std::byte(~bits)) | std::byte(number);
  }
  return blocks;
}

TEST(Bc6h, OfEveryModeDecodesAsOpenImageIoDecodesIt) {
  constexpr std::uint32_t width = 1018, height = 509;  // Neither a multiple of 4.
  const std::vector<Bytes16> blocks = random_blocks(std::size_t{(width + 3) / 4} * ((height + 3) / 4));
  for (const std::uint32_t dxgi : {95U, 96U}) {
    const std::vector<char> file = dds(blocks, dxgi, width, height);
    std::vector<float> theirs(std::size_t{3} * width * height);
    formats().open("dds", "blocks.dds", file, false).read(0, 0, height, 0, 3, theirs);
    Image image;
    open_bytes(image, "blocks.dds", file);
    ASSERT_TRUE(image.texture);
    const Level ours = read_texture(*image.file, *image.texture, 0, {Projection::latlong, Layout::single, height}, 0, true);
    int wrong = 0;
    for (int j = 0; j < ours.height(); ++j)
      for (int i = 0; i < ours.width(); ++i)
        for (int c = 0; c < 3; ++c)
          wrong += (*ours.texel(0, i, j))[c] != theirs[3 * (static_cast<std::size_t>(j) * width + static_cast<std::size_t>(i)) + static_cast<std::size_t>(c)];
    EXPECT_EQ(wrong, 0) << dxgi;
  }
}

TEST(Bc6h, PacksWhatItUnpacks) {
  for (const Bytes16& bytes : random_blocks(1800)) {
    const auto block = bc6h::unpack(bytes);
    if (!block) continue;
    Bytes16 again;
    bc6h::pack(*block, again);
    EXPECT_EQ(again, bytes) << "mode " << block->mode + 1;
  }
}

// Mode 11: endpoints 0 and the largest of 10 bits, which are 0 and 65504; index 8 lies 34/64 between them in the half's bits.
TEST(Bc6h, DecodesABlockWorkedOutByHand) {
  bc6h::Block block{.mode = 10};
  block.endpoints[1] = {1023, 0, 1023};
  block.indices = {0, 15, 8};
  Bytes16 bytes;
  bc6h::pack(block, bytes);
  std::array<Colour, bc6h::texels> texels;
  decode_bc6h(bytes, false, bc6h::side, texels);
  EXPECT_EQ(texels[0], Colour(0));
  EXPECT_EQ(texels[1], Colour(65504, 0, 65504));
  // (65535 x 34 + 32) / 64 = 34815; x 31 / 64 = 16863 = 0x41df: 2 (1 + 479/1024).
  EXPECT_EQ(texels[2], Colour(2 * (1 + 479.0F / 1024), 0, 2 * (1 + 479.0F / 1024)));
}

}  // namespace
}  // namespace envmap

// UASTC HDR against ASTC's own formulae, against astcenc where it is installed, and against blocks worked out by hand.
#include "envmap/io/block/uastc_hdr.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>

#include "envmap/base/error.h"
#include "envmap/io/block/bc6h.h"
#include "envmap/io/block/bits.h"
#include "envmap/io/block/uastc_hdr_block.h"
#include "envmap/io/read.h"
#include "envmap/io/texels/rounding.h"
#include "envmap/io/texels/texels.h"
#include "envmap/io/write.h"
#include "envmap/operate/generate.h"
#include "envmap/operate/measure.h"

namespace envmap::uastc_hdr_test {
namespace {

using uastc_hdr::Block;
using Bytes16 = std::array<std::byte, uastc_hdr::block_bytes>;

// Blocks of every mode in turn, whose ends are finite.
std::vector<Block> random_blocks(std::size_t count) {
  std::mt19937 random(1);
  const auto below = [&random](int n) { return int(random() % std::uint32_t(n)); };
  std::vector<Block> blocks;
  while (blocks.size() < count) {
    Block b{.mode = int(blocks.size() % (uastc_hdr::modes.size() + 1)) - 1};
    if (b.mode == uastc_hdr::one_colour) {
      for (std::uint16_t& half : b.colour) half = std::uint16_t(below(0x7c00));
      blocks.push_back(b);
      continue;
    }
    const uastc_hdr::Mode& mode = uastc_hdr::modes[std::size_t(b.mode)];
    if (mode.regions == 2) do
        b.partition = below(32);
      while (!(uastc_hdr::common_partitions >> b.partition & 1));
    bool finite = true;
    for (int r = 0; r < mode.regions; ++r) {
      for (int k = 0; k < bytes_of(mode.ends); ++k)
        b.endpoints[std::size_t(r)][std::size_t(k)] = uastc_hdr::byte_levels(mode.bytes).value(below(mode.bytes));
      for (const auto& end : ends_of(mode.ends, b.endpoints[std::size_t(r)]))
        finite = finite && std::ranges::max(end) <= uastc_hdr::largest_end;
    }
    for (std::uint8_t& index : b.indices) index = std::uint8_t(below(mode.weights));
    if (finite) blocks.push_back(b);
  }
  return blocks;
}

Bytes16 packed(const Block& block) {
  Bytes16 bytes;
  uastc_hdr::pack(block, bytes);
  return bytes;
}

TEST(UastcHdr, UnpacksWhatItPacks) {
  for (const Block& b : random_blocks(4800)) {
    const auto again = uastc_hdr::unpack(packed(b));
    ASSERT_TRUE(again) << b.mode;
    EXPECT_EQ(again->mode, b.mode);
    EXPECT_EQ(again->colour, b.colour) << b.mode;
    EXPECT_EQ(again->partition, b.partition) << b.mode;
    EXPECT_EQ(again->endpoints, b.endpoints) << b.mode;
    EXPECT_EQ(again->indices, b.indices) << b.mode;
  }
}

// Which region a texel is of, by ASTC's formula ("Partition pattern generation"), of blocks so small.
int astc_region(std::uint32_t seed, int x, int y) {
  x <<= 1, y <<= 1;
  std::uint32_t n = seed + 1024;  // Two regions.
  n ^= n >> 15, n -= n << 17, n += n << 7, n += n << 4, n ^= n >> 5, n += n << 16, n ^= n >> 7, n ^= n >> 3;
  n ^= n << 6, n ^= n >> 17;
  std::array<std::uint32_t, 4> s;
  for (std::uint32_t k = 0; k < 4; ++k) s[k] = (n >> 4 * k & 15) * (n >> 4 * k & 15);
  const std::uint32_t odd = seed & 2 ? 4 : 5, even = 5;
  if (seed & 1)
    s[0] >>= odd, s[1] >>= even, s[2] >>= odd, s[3] >>= even;
  else
    s[0] >>= even, s[1] >>= odd, s[2] >>= even, s[3] >>= odd;
  const std::uint32_t a = s[0] * std::uint32_t(x) + s[1] * std::uint32_t(y) + (n >> 14);
  const std::uint32_t b = s[2] * std::uint32_t(x) + s[3] * std::uint32_t(y) + (n >> 10);
  return (a & 63) >= (b & 63) ? 0 : 1;
}

// A partition's number in the block, and ASTC's formula with it, give BC6H's regions, or those with their names changed
// and then the endpoints, too.
TEST(UastcHdr, PartitionsAreThoseOfBothFormats) {
  constexpr int scaled = 20;
  for (int p = 0; p < 32; ++p) {
    if (!(uastc_hdr::common_partitions >> p & 1)) continue;
    Block b{.mode = scaled, .partition = p};
    b.endpoints[0][3] = uastc_hdr::byte_levels(80).value(1), b.endpoints[1][3] = uastc_hdr::byte_levels(80).value(2);
    const block::Bits bits(packed(b));
    int same = 0;
    for (int k = 0; k < 16; ++k)
      same += astc_region(bits.at(13, 10), k % 4, k / 4) == int(block::partitions[std::size_t(p)].second >> k & 1);
    EXPECT_TRUE(same == 16 || same == 0) << p << ": " << same;
    Block other = b;
    std::swap(other.endpoints[0], other.endpoints[1]);
    EXPECT_NE(packed(b), packed(other));
  }
}

// Sixteen blocks a row, as an .astc file of astcenc, which writes them as halves.
TEST(UastcHdr, OfEveryModeDecodesAsAstcencDecodesIt) {
  const std::string stem = testing::TempDir() + "uastc_hdr_test_" + std::to_string(::getpid());
  const std::string command = "astcenc -dH " + stem + ".astc " + stem + ".ktx > /dev/null 2>&1";
  constexpr std::size_t across = 16, down = 150, width = across * 4, height = down * 4;
  const std::vector<Block> blocks = random_blocks(across * down);
  {
    std::ofstream file(stem + ".astc", std::ios::binary);
    const unsigned char head[16] = {0x13, 0xab, 0xa1,         0x5c,        4, 4, 1, width,
                                    0,    0,    height & 255, height >> 8, 0, 1, 0, 0};
    file.write(reinterpret_cast<const char*>(head), sizeof head);
    for (const Block& b : blocks) file.write(reinterpret_cast<const char*>(packed(b).data()), 16);
  }
  const int status = std::system(command.c_str());
  std::filesystem::remove(stem + ".astc");
  if (status != 0) GTEST_SKIP() << "no astcenc here";
  std::ifstream file(stem + ".ktx", std::ios::binary);
  const std::vector<char> ktx{std::istreambuf_iterator<char>(file), {}};
  std::filesystem::remove(stem + ".ktx");
  std::uint32_t pairs = 0, internal = 0;
  ASSERT_GT(ktx.size(), 64U);
  std::memcpy(&internal, ktx.data() + 28, 4), std::memcpy(&pairs, ktx.data() + 60, 4);
  const std::size_t channels = internal == 0x881b ? 3 : 4;
  ASSERT_EQ(ktx.size(), 64 + pairs + 4 + 2 * channels * width * height);
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    const auto ours = halves_of(blocks[k]);
    for (std::size_t t = 0; t < 16; ++t)
      for (std::size_t c = 0; c < 3; ++c) {
        const std::size_t x = k % across * 4 + t % 4, y = k / across * 4 + t / 4;
        std::uint16_t theirs = 0;
        std::memcpy(&theirs, ktx.data() + 68 + pairs + 2 * (channels * (y * width + x) + c), 2);
        ASSERT_EQ(ours[3 * t + c], theirs) << "mode " << blocks[k].mode << ", texel " << t;
      }
  }
}

// Direct endpoints of mode 11 with 8 weights: 0, and 240 x 16 = 120 x 32 = 3840 of 12 bits.
TEST(UastcHdr, DecodesABlockWorkedOutByHand) {
  constexpr int eight_weights = 4;
  Block b{.mode = eight_weights};
  b.endpoints[0] = {0, 240, 0, 240, 128, 128 | 120};
  b.indices = {0, 7, 4};
  std::array<Colour, 16> texels;
  decode_uastc_hdr(packed(b), 4, texels);
  EXPECT_EQ(texels[0], Colour(0));
  EXPECT_EQ(texels[1], Colour(32768));  // 3840 x 16 = 30 x 2048: 2^(30 - 15).
  // Weight 37 of 64: 61440 x 37 / 64 = 35520 = 17 x 2048 + 704; (4 x 704 - 512) / 8 = 288 of 1024: 4 (1 + 288 / 1024).
  EXPECT_EQ(texels[2], Colour(4 * (1 + 288.0F / 1024)));
}

TEST(UastcHdr, OtherBlocksOfAstcAreRefused) {
  Bytes16 bytes{};  // A reserved block mode.
  std::array<Colour, 16> texels;
  EXPECT_THROW(decode_uastc_hdr(bytes, 4, texels), InputError);
  EXPECT_THROW(transcode_to_bc6h(bytes), InputError);
}

// A map with what is hard for blocks: edges, a range of 2^10, hues that turn.
EnvironmentMap scene(int size) {
  EnvironmentMap map = generate(Directions{}, Projection::cube, size);
  for (int f = 0; f < 6; ++f)
    for (int j = 0; j < size; ++j)
      for (Colour& c : map.base().row(f, j)) {
        const float bands = std::sin(20 * c.x + 3 * c.y) > 0.6F ? 30.0F : 1.0F;
        c = bands * (Colour(0.02F) + c * c) *
            (Colour(1) + 0.3F * Colour(std::sin(12 * c.y), std::sin(10 * c.z), std::cos(14 * c.x)));
      }
  return map;
}

// As rounding_of() says it, the worse of both ways to read it.
Level rounded(const EnvironmentMap& map) {
  return rounding_of("x.ktx2", {.depth = Depth::uastc_hdr})->read_back(map.base());
}

TEST(UastcHdr, KeepsNearToTheTexelsAtEverySizeInBothWaysOfReading) {
  for (const auto& [size, limit] : {std::pair{13, 0.12}, {64, 4e-2}, {150, 2e-2}}) {
    const EnvironmentMap map = scene(size);
    const Difference off = compare(rounded(map), map.base());
    std::printf("%d: rms %g flux %g\n", size, off.rms, off.largest_flux());
    EXPECT_LT(off.rms, limit) << size;
  }
}

TEST(UastcHdr, AFileOfItIsReadBack) {
  const EnvironmentMap map = scene(32);
  const std::string file = testing::TempDir() + "uastc_hdr_test_" + std::to_string(::getpid()) + ".ktx2";
  for (const bool zstd : {false, true}) {
    write(file, all_rows_of(map), {.depth = Depth::uastc_hdr, .zstd = zstd});
    const Source back = read(file);
    EXPECT_EQ(back.depth, Depth::uastc_hdr);
    // Cards read it in two ways, and read() as one of them.
    EXPECT_LE(compare(back.map.base(), map.base()).rms, compare(rounded(map), map.base()).rms);
  }
  std::filesystem::remove(file);
}

TEST(UastcHdr, OfOneColourIsExact) {
  for (const Colour& c : {Colour(0), Colour(1), Colour(65504), Colour(0.5F, 0.125F, 3), Colour(0x1p-14F, 20, 500)}) {
    const EnvironmentMap map = generate(Constant{c}, Projection::cube, 4);
    EXPECT_EQ(*rounded(map).texel(2, 1, 3), c);
  }
}

// One texel of the sun, 60,000 times the sky: the flux of both is kept.
TEST(UastcHdr, KeepsTheFluxOfASun) {
  EnvironmentMap map = generate(Constant{{0.5F, 0.7F, 1}}, Projection::cube, 32);
  *map.base().texel(2, 13, 14) = {60000, 50000, 20000};
  *map.base().texel(2, 14, 14) = {6000, 5000, 2000};
  const double flux = compare(rounded(map), map.base()).largest_flux();
  std::printf("flux %g\n", flux);
  EXPECT_LT(flux, 0.05);
}

}  // namespace
}  // namespace envmap::uastc_hdr_test

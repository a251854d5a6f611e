// Portable float maps, read by OpenImageIO, too, which is another reader.
#include "envmap/io/formats/pfm.h"

#include <gtest/gtest.h>

#include "envmap/base/error.h"
#include "envmap/io/formats/openimageio_module.h"
#include "unit/texels_read.h"

namespace envmap::pfm_test {
namespace {

constexpr int width = 5, height = 4;

// @param order in which the four bytes of a float are stored, the lowest being 0.
std::string pfm_file(const std::string& header, int channels, const std::array<unsigned, 4>& order) {
  std::string file = header;
  for (int k = 0; k < width * height * channels; ++k) {
    const auto bits = std::bit_cast<std::uint32_t>(float(k) / 7 + 0.1F);
    for (const unsigned byte : order) file += char(bits >> (8 * byte) & 0xFFU);
  }
  return file;
}

TEST(Pfm, IsReadAsOpenImageIoReadsIt) {
  for (const int channels : {1, 3})
    for (const std::string scale : {"-1.0", "1.0", "-2.5", "0.3"}) {
      SCOPED_TRACE(fmt::format("{} {}", channels, scale));
      const std::array<unsigned, 4> little{0, 1, 2, 3}, big{3, 2, 1, 0};
      const std::string bytes = pfm_file(fmt::format("P{}\n5 4\n{}\n", channels == 3 ? 'F' : 'f', scale), channels,
                                         scale[0] == '-' ? little : big);
      const InputFile file{std::span<const char>(bytes)};
      const ImageReader reader = open_pfm(file), judge = formats().open("pnm", "a.pfm", bytes, false, false);
      expect_same_facts(reader.facts, judge.facts);
      EXPECT_EQ(texels(reader, 0, height, 0, channels), texels(judge, 0, height, 0, channels));
      EXPECT_EQ(texels(reader, 1, 3, channels - 1, 1), texels(judge, 1, 3, channels - 1, 1));
      // The bottom row comes first.
      EXPECT_FLOAT_EQ(texels(reader, 3, 4, 0, 1)[0], 0.1F * std::abs(std::stof(scale)));
    }
}

TEST(Pfm, DamagedHeadersAreRefused) {
  for (const std::string header :
       {"PF\n5 4\n0\n", "PF\n-5 4\n-1\n", "PF\n5 4\nnan\n", "PF\n5 4\n-1", "PF", "PF\n5 x\n-1\n", "PF4\n5 4\n-1\n"}) {
    const InputFile file{std::span<const char>(header)};
    EXPECT_THROW(open_pfm(file), InputError) << header;
  }
}

TEST(Pfm, SizesBeyondAnIntAreRefused) {
  const std::string header = "PF\n99999999999 4\n-1\n";
  const InputFile file{std::span<const char>(header)};
  EXPECT_THROW(open_pfm(file), InputError);
}

TEST(Pfm, CutFilesAreRefused) {
  const std::string whole = pfm_file("PF\n5 4\n-1\n", 3, {0, 1, 2, 3});
  const InputFile file{std::span(whole).first(whole.size() - 1)};
  EXPECT_THROW(texels(open_pfm(file), 0, height, 0, 3), InputError);
}

}  // namespace
}  // namespace envmap::pfm_test

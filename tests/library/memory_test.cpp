// Files in memory: the bytes that files have, and what is read back.
#include <gtest/gtest.h>

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "envmap/envmap.h"

namespace memory_test {
namespace {

using namespace envmap;

std::vector<std::byte> bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const auto* const first = reinterpret_cast<const std::byte*>(text.data());
  return {first, first + text.size()};
}

EnvironmentMap chain(Projection p) {
  EnvironmentMap map = generate(Sun{.radius_degrees = 20}, p, 16);
  add_levels(map);
  return map;
}

class EachFormat : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(, EachFormat, testing::Values("exr", "hdr", "pfm", "ktx", "ktx2", "dds", "png", "tif"),
                         [](const auto& p) { return p.param; });

TEST_P(EachFormat, HasTheBytesOfAFile) {
  const std::string path = "memory." + GetParam();
  const bool levels = GetParam() == "exr" || GetParam().starts_with("ktx") || GetParam() == "dds";
  EnvironmentMap map = chain(Projection::cube);
  if (!levels) map.levels.erase(map.levels.begin() + 1, map.levels.end());
  WriteOptions options{.format = GetParam(), .clamp = true};
  const std::vector<std::byte> made = encode(map, options);
  write(path, map, options);
  EXPECT_EQ(made, bytes_of(path));
  const Source from_memory = read(made, {.all_levels = levels}), from_file = read(path, {.all_levels = levels});
  std::filesystem::remove(path);
  ASSERT_EQ(from_memory.map.levels.size(), map.levels.size());
  EXPECT_EQ(from_memory.format, from_file.format);
  EXPECT_EQ(from_memory.layout, from_file.layout);
  for (std::size_t k = 0; k < map.levels.size(); ++k)
    EXPECT_EQ(compare(from_memory.map.levels[k], from_file.map.levels[k]).maximum, 0) << k;
}

TEST(Memory, ErrorsNameNoFile) {
  const std::vector<std::byte> made = encode(chain(Projection::latlong), {.format = "exr"});
  for (const std::size_t length : {std::size_t{0}, std::size_t{3}, made.size() / 2}) {
    try {
      (void)read(std::span(made).first(length), {});
      ADD_FAILURE() << length;
    } catch (const InputError& e) {
      EXPECT_EQ(e.file(), "");
      EXPECT_NE(std::string(e.what()).front(), ':') << e.what();
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
    }
  }
  try {
    (void)encode(generate(Constant{Rgb<double>(1e6)}, Projection::cube, 4), {.format = "exr", .depth = Depth::half});
    ADD_FAILURE();
  } catch (const OutputError& e) {
    EXPECT_EQ(e.file(), "");
    EXPECT_EQ(std::string(e.what()).find("96 texels exceed 65504"), 0U) << e.what();
  }
}

TEST(Memory, ReadingTakesTheOptionsOfFiles) {
  const EnvironmentMap map = chain(Projection::latlong);
  const std::vector<std::byte> made = encode(map, {.format = "exr"});
  EXPECT_EQ(read(made, {.level = 2}).map.base().height(), 4);
  EXPECT_THROW((void)read(made, {.level = 20}), InputError);
  EXPECT_THROW((void)read(made, {.max_pixels = 10}), InputError);
  EXPECT_THROW((void)read(made, {.choice = {.layer = "none"}}), InputError);
}

}  // namespace
}  // namespace memory_test

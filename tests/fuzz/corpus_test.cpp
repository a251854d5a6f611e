// The corpus of the repository through the fuzz targets, in every build: what fuzzing found once stays away. Another
// one, such as libFuzzer grew, is named in ENVMAP_CORPUS. And some damage to each input, of chance but the same in
// every run: where no clang is, it finds what lies near.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "targets.h"

namespace {

namespace fs = std::filesystem;

// Those that go through files take the formats' corpora, too.
std::vector<std::string> folders(const std::string& target) {
  if (target == "read") return {"read", "hdr", "exr", "ktx2", "ktx", "dds", "env", "glb", "png", "jpg", "tif", "pfm"};
  if (target == "scene") return {"scene", "obj", "mtl", "gltf"};
  return {target};
}

fs::path corpus() {
  const char* const other = std::getenv("ENVMAP_CORPUS");
  return fs::absolute(other ? other : ENVMAP_CORPUS);
}

// Damage as it happens to files: bits, bytes, numbers, what is missing, and what is there twice.
std::vector<char> damaged(std::vector<char> bytes, std::mt19937& random) {
  const auto below = [&](std::size_t n) { return random() % n; };
  constexpr std::uint32_t numbers[] = {0,       1,          255,        0x7fff,     0xffff,
                                       0x10000, 0x7fffffff, 0x80000000, 0xffffffff, 0x7f800000};
  for (std::size_t k = below(3) + 1; k > 0 && !bytes.empty(); --k) {
    // Headers are where it counts.
    const std::size_t at = below(below(2) == 0 ? std::min<std::size_t>(bytes.size(), 200) : bytes.size());
    const std::size_t length = std::min(std::size_t{1} << below(7), bytes.size() - at);
    const auto place = bytes.begin() + std::ptrdiff_t(at), end = place + std::ptrdiff_t(length);
    switch (below(6)) {
      case 0: *place ^= static_cast<char>(1U << below(8)); break;
      case 1: *place = static_cast<char>(below(256)); break;
      case 2: std::memcpy(&*place, &numbers[below(std::size(numbers))], std::min<std::size_t>(length, 4)); break;
      case 3: bytes.erase(place, end); break;
      case 4: bytes.resize(at); break;
      default: {
        const std::vector<char> twice(place, end);
        bytes.insert(place, twice.begin(), twice.end());
      }
    }
  }
  return bytes;
}

std::vector<char> bytes_of(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

class Corpus : public testing::TestWithParam<const char*> {};

TEST_P(Corpus, IsReadOrRefusedInOneLine) {
  // Some targets write files where they run.
  const fs::path all = corpus(), before = fs::current_path(), here = testing::TempDir() + "envmap-corpus-" + GetParam();
  fs::create_directories(here);
  fs::current_path(here);

  for (const std::string& folder : folders(GetParam())) {
    int inputs = 0;
    for (const auto& file : fs::directory_iterator(all / folder)) {
      const std::vector<char> bytes = bytes_of(file.path());
      std::fprintf(stderr, "%s\n", file.path().c_str());  // An input that ends the process is the last one named.
      fuzz(GetParam(), std::as_bytes(std::span(bytes)));
      ++inputs;
    }
    EXPECT_GT(inputs, 0) << folder;
  }

  fs::current_path(before);
  fs::remove_all(here);
}

INSTANTIATE_TEST_SUITE_P(Targets, Corpus,
                         testing::Values("hdr", "exr", "ktx2", "ktx", "dds", "env", "glb", "png", "jpg", "tif", "pfm",
                                         "bc6h", "obj", "mtl", "gltf", "words", "icc", "gain", "colours", "part",
                                         "manifest", "read", "scene", "command", "library"),
                         [](const auto& target) { return std::string(target.param); });

// Readers that are ours alone: others' libraries are fuzzed by hand.
class DamagedCorpus : public testing::TestWithParam<const char*> {};

TEST_P(DamagedCorpus, IsReadOrRefusedInOneLine) {
  const std::string last = testing::TempDir() + "envmap-damaged-" + GetParam();  // What it holds ended the process.
  std::vector<fs::path> files;
  for (const auto& file : fs::directory_iterator(corpus() / GetParam())) files.push_back(file.path());
  ASSERT_FALSE(files.empty());
  std::ranges::sort(files);
  std::fprintf(stderr, "%s\n", last.c_str());
  const auto start = std::chrono::steady_clock::now();
  std::mt19937 random(1);
  for (int k = 0; k < 20000 && std::chrono::steady_clock::now() - start < std::chrono::milliseconds(300); ++k) {
    const std::vector<char> bytes = damaged(bytes_of(files[random() % files.size()]), random);
    std::ofstream(last, std::ios::binary).write(bytes.data(), std::streamsize(bytes.size()));
    fuzz(GetParam(), std::as_bytes(std::span(bytes)));
  }
  fs::remove(last);
}

INSTANTIATE_TEST_SUITE_P(Targets, DamagedCorpus,
                         testing::Values("hdr", "ktx2", "ktx", "dds", "env", "glb", "png", "jpg", "tif", "pfm", "bc6h",
                                         "obj", "mtl", "gltf", "words", "icc", "gain", "library"),
                         [](const auto& target) { return std::string(target.param); });

}  // namespace

// The corpus of the repository through the fuzz targets, in every build: what fuzzing found once stays away. Another one, such
// as libFuzzer grew, is named in ENVMAP_CORPUS.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "targets.h"

namespace {

namespace fs = std::filesystem;

// Those that go through files take the formats' corpora, too.
std::vector<std::string> folders(const std::string& target) {
  if (target == "read") return {"read", "hdr", "exr", "ktx2", "ktx", "dds"};
  if (target == "scene") return {"scene", "obj", "mtl", "gltf"};
  return {target};
}

fs::path corpus() {
  const char* const other = std::getenv("ENVMAP_CORPUS");
  return fs::absolute(other ? other : ENVMAP_CORPUS);
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
      std::ifstream stream(file.path(), std::ios::binary);
      const std::vector<char> bytes{std::istreambuf_iterator<char>(stream), {}};
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
                         testing::Values("hdr", "exr", "ktx2", "ktx", "dds", "obj", "mtl", "gltf", "words", "read", "scene"),
                         [](const auto& target) { return std::string(target.param); });

}  // namespace

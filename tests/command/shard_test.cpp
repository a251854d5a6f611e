// Large jobs in parts: whatever the command, the projection and the order, the parts join to the bytes of the whole.
#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "run.h"

namespace command_tests {
namespace {

struct Job {
  std::string name;
  std::vector<std::string> command;  ///< Without the output.
  std::string output = "whole.exr";
  std::vector<std::string> of_file{};  ///< What is said to the whole, and to merge.
};

class Shards : public CommandTest {
 protected:
  Shards() {
    succeeds(
        {"generate", "sun", "sun.exr", "--to", "latlong", "--size", "24", "--direction", "1,2,3", "--radius", "4"});
  }

  static std::string part(int k) { return "part-" + std::to_string(k) + ".exr"; }

  void make_parts(const Job& job, int count) const {
    for (int k = 1; k <= count; ++k) {
      std::vector<std::string> run = job.command;
      run.insert(run.end(), {part(k), "-q", "--threads", std::to_string(1 + k % 3), "--shard",
                             std::to_string(k) + "/" + std::to_string(count)});
      succeeds(run);
    }
  }

  // Seven parts, joined in an order of chance, against the whole.
  void check(const Job& job) const {
    SCOPED_TRACE(job.name);
    std::vector<std::string> whole = job.command;
    whole.insert(whole.end(), {job.output, "-q"});
    whole.insert(whole.end(), job.of_file.begin(), job.of_file.end());
    succeeds(whole);
    const std::string wanted = read(job.output);
    constexpr int count = 7;
    make_parts(job, count);
    std::vector<std::string> merge;
    for (int k = 1; k <= count; ++k) merge.push_back(part(k));
    std::ranges::shuffle(merge, std::mt19937(unsigned(job.name.size())));
    merge.insert(merge.begin(), "merge");
    merge.push_back(job.output);
    merge.insert(merge.end(), job.of_file.begin(), job.of_file.end());
    succeeds(merge);
    EXPECT_TRUE(read(job.output) == wanted) << "other bytes than the whole run's";
  }
};

TEST_F(Shards, OfConvertJoinToTheBytesOfTheWhole) {
  for (const std::string to : {"latlong", "cube", "sphere", "paraboloid", "angular", "octahedral", "equal-area"})
    check({to, {"convert", "sun.exr", "--to", to, "--size", "18", "--rotate", "10,20,30"}});
  check({"cross, standing, as halves",
         {"convert", "sun.exr", "--to", "cube", "--size", "9", "--layout", "vcross", "--depth", "half", "--compression",
          "zip:9"}});
  check({"area", {"convert", "sun.exr", "--to", "cube", "--size", "7", "--max-error", "1e-2"}});
  check(
      {"texture", {"convert", "sun.exr", "--to", "cube", "--size", "8"}, "whole.ktx2", {"--depth", "half", "--zstd"}});
  check({"border", {"convert", "sun.exr", "--to", "octahedral", "--size", "20", "--border", "2"}});
  check({"samples on the border", {"convert", "sun.exr", "--size", "20", "--openexr-envmap"}});
  check({"colours", {"convert", "sun.exr", "--size", "20", "--output-space", "ACEScg", "--forward", "-x"}});
}

TEST_F(Shards, OfPrefilterJoinToTheBytesOfTheWhole) {
  check({"multilevel", {"prefilter", "sun.exr", "--lobe", "phong", "--exponent", "300", "--size", "24"}});
  check(
      {"a core", {"prefilter", "sun.exr", "--lobe", "ggx", "--roughness", "0.04", "--size", "11", "--to", "latlong"}});
  check({"hierarchical", {"prefilter", "sun.exr", "--lobe", "charlie", "--roughness", "0.4", "--size", "11"}});
  check({"diffuse", {"prefilter", "sun.exr", "--size", "9", "--to", "paraboloid"}});
  check({"exact", {"prefilter", "sun.exr", "--method", "exact", "--size", "3"}});
  check({"close",
         {"prefilter", "sun.exr", "--lobe", "phong", "--exponent", "50", "--size", "9", "--to", "octahedral",
          "--max-error", "2e-5", "--depth", "float"}});
  check({"mirror", {"prefilter", "sun.exr", "--lobe", "ggx", "--roughness", "0", "--size", "8", "--layout", "cross"}});
}

TEST_F(Shards, OfMipmapJoinToTheBytesOfTheWhole) {
  for (const std::string p : {"cube", "latlong", "sphere", "octahedral"}) {
    succeeds({"convert", "sun.exr", "from.exr", "--to", p, "--size", "13"});
    check({p, {"mipmap", "from.exr"}});
  }
  succeeds({"convert", "sun.exr", "from.exr", "--to", "cube", "--size", "16"});
  check({"plain means, three levels", {"mipmap", "from.exr", "--weights", "uniform", "--levels", "3"}, "whole.ktx2"});
}

TEST_F(Shards, MayComeThroughAPipeWhichIsReadOnce) {
  make_parts({"", {"convert", "sun.exr", "--to", "cube", "--size", "6"}}, 3);
  succeeds({"merge", part(1), part(2), part(3), "joined.exr"});
  const Result r = shell("cat part-2.exr | \"$ENVMAP\" merge part-3.exr - part-1.exr piped.exr");
  EXPECT_EQ(r.status, 0) << r.err;
  EXPECT_TRUE(read("piped.exr") == read("joined.exr"));
  EXPECT_EQ(shell("cat sun.exr | \"$ENVMAP\" merge part-3.exr - part-1.exr no.exr").status, 3);
}

TEST_F(Shards, ThatAreMissingTwiceThereOrOfAnotherMapAreRefused) {
  const Job job{"", {"convert", "sun.exr", "--to", "cube", "--size", "6"}};
  make_parts(job, 3);
  fails(3, {"merge", part(3), part(1), "out.exr"}, {"of 3 parts these are missing: 2"});
  fails(3, {"merge", part(1), part(2), part(3), part(2), "out.exr"}, {"part-2.exr", "part 2 of 3", "name each once"});
  fails(3, {"merge", part(1), "sun.exr", "out.exr"}, {"sun.exr", "no part of a map"});
  succeeds({"convert", "sun.exr", "other.exr", "--to", "cube", "--size", "6", "--exposure", "1", "--shard", "2/3"});
  fails(3, {"merge", part(1), "other.exr", part(3), "out.exr"},
        {"other.exr", "another map or command than part-1.exr"});
  succeeds({"convert", "sun.exr", "darker.exr", "--exposure", "-1"});
  succeeds({"convert", "darker.exr", "other.exr", "--to", "cube", "--size", "6", "--shard", "2/3"});
  fails(3, {"merge", part(1), "other.exr", part(3), "out.exr"},
        {"other.exr", "another map or command than part-1.exr"});
  const std::string whole = read(part(2));
  write(part(2), whole.substr(0, whole.size() - 40));
  fails(3, {"merge", part(1), part(2), part(3), "out.exr"}, {"part-2.exr"});
}

// What parts say of the whole is not believed beyond what they hold, and no memory is taken for it.
TEST_F(Shards, OfStrangersAreRefused) {
  succeeds(
      {"convert", "sun.exr", "part.exr", "--to", "octahedral", "--size", "6", "--border", "1", "--shard", "1/1", "-q"});
  succeeds({"merge", "part.exr", "whole.exr"});
  const Setting little{.memory = std::uint64_t{1} << 30};
  const auto refused = [&](const std::string& attribute, const std::string& value,
                           const std::vector<std::string>& words) {
    SCOPED_TRACE(attribute);
    ASSERT_EQ(shell("exrstdattr -string envmap:" + attribute + " " + value + " part.exr odd.exr").status, 0);
    fails(3, {"merge", "odd.exr", "out.exr"}, words, little);
  };
  refused("part", "1/2147483647", {"of 2147483647 parts these are missing: 2, 3", "..."});
  refused("part-size", "65536", {"odd.exr", "damaged"});
  refused("layout", "cross", {"odd.exr", "damaged"});
  refused("whole-layout", "cross", {"octahedral", "damaged"});
  refused("whole-border", "1073741824", {"octahedral", "damaged"});
  refused("whole-border", "32000", {"octahedral", "damaged"});
  fails(3, {"merge", "part.exr", "out.exr", "--max-pixels", "15"}, {"part.exr", "4x4", "--max-pixels"});

  // Channels that are not those of a map, and values that are no radiance.
  ASSERT_EQ(shell("oiiotool part.exr --ch R,G -o odd.exr && oiiotool part.exr --ch R,G,B,A=1 -o more.exr && "
                  "oiiotool part.exr --addc 1 --mulc 1e38 --mulc 1e38 -o bright.exr")
                .status,
            0);
  fails(3, {"merge", "odd.exr", "out.exr"}, {"odd.exr", "other channels"}, little);
  fails(3, {"merge", "more.exr", "out.exr"}, {"more.exr", "other channels"}, little);
  fails(3, {"merge", "bright.exr", "out.exr"}, {"16 infinite", "damaged"});
}

TEST_F(Shards, ThatCannotBeAreRefusedBeforeAnyWork) {
  for (const std::string odd : {"0/3", "4/3", "2", "a/b", "1/", "-1/3", "1/99999999999"})
    fails(2, {"convert", "sun.exr", "out.exr", "--shard", odd}, {"--shard", odd});
  fails(2, {"convert", "sun.exr", "out.exr", "--size", "4", "--shard", "1/5"}, {"5 parts", "4 rows"});
  fails(2, {"convert", "sun.exr", "out.hdr", "--shard", "1/2"}, {"out.hdr", ".exr"});
  fails(2, {"convert", "sun.exr", "{face}.exr", "--to", "cube", "--shard", "1/2"}, {".exr"});
  fails(2, {"convert", "sun.exr", "out.exr", "--output-space", "sRGB", "--shard", "1/2"}, {"linear"});
  fails(2, {"prefilter", "sun.exr", "out.exr", "--lobe", "ggx", "--levels", "3", "--shard", "1/2"},
        {"one command per level"});
  fails(2, {"prefilter", "sun.exr", "out.exr", "--max-error", "1e-2", "--depth", "half", "--shard", "1/2"},
        {"--depth float"});
  fails(2, {"mipmap", "sun.exr", "out.exr", "--keep", "--shard", "1/2"}, {"--keep"});
  succeeds({"convert", "sun.exr", part(1), "--size", "8", "--max-error", "1e-2", "--shard", "1/2", "-q"});
  succeeds({"convert", "sun.exr", part(2), "--size", "8", "--max-error", "1e-2", "--shard", "2/2", "-q"});
  fails(2, {"merge", part(1), part(2), "out.hdr"}, {"--max-error"});
}

}  // namespace
}  // namespace command_tests

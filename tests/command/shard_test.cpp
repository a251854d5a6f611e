// Large jobs in parts: whatever the command, the projection and the order, the parts join to the bytes of the whole.
#include <algorithm>
#include <filesystem>
#include <map>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "run.h"

namespace command_tests::shard_test {
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

  // Within what every format holds.
  void dim_sun() const {
    succeeds({"generate", "sun", "dim.exr", "--to", "latlong", "--size", "24", "--direction", "1,2,3", "--radius", "4",
              "--value", "200"});
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

  // The files that a name with marks stands for.
  std::set<std::string> outputs(const std::string& output) const {
    if (output.find('{') == std::string::npos) return {output};
    std::set<std::string> names;
    for (int level = 0; level < 8; ++level)
      for (const std::string face : {"px", "nx", "py", "ny", "pz", "nz"}) {
        std::string name = output;
        for (const auto& [mark, text] : {std::pair{"{level}", std::to_string(level)}, std::pair{"{face}", face}})
          if (const auto at = name.find(mark); at != std::string::npos)
            name.replace(at, std::string(mark).size(), text);
        if (std::filesystem::exists(path(name))) names.insert(name);
      }
    return names;
  }

  // The parts, joined in an order of chance, against the whole.
  void check(const Job& job, int count = 7) const {
    SCOPED_TRACE(job.name + " in " + std::to_string(count));
    std::vector<std::string> whole = job.command;
    whole.insert(whole.end(), {job.output, "-q"});
    whole.insert(whole.end(), job.of_file.begin(), job.of_file.end());
    succeeds(whole);
    std::map<std::string, std::string> wanted;
    for (const std::string& file : outputs(job.output)) wanted[file] = read(file), std::filesystem::remove(path(file));
    ASSERT_FALSE(wanted.empty());
    make_parts(job, count);
    std::vector<std::string> merge;
    for (int k = 1; k <= count; ++k) merge.push_back(part(k));
    std::ranges::shuffle(merge, std::mt19937(unsigned(job.name.size())));
    merge.insert(merge.begin(), count % 2 == 0 ? "join" : "merge");  // Two names of one command.
    merge.push_back(job.output);
    merge.insert(merge.end(), job.of_file.begin(), job.of_file.end());
    succeeds(merge);
    EXPECT_EQ(outputs(job.output).size(), wanted.size());
    for (const auto& [file, bytes] : wanted)
      EXPECT_TRUE(read(file) == bytes) << file << " has other bytes than the whole run's";
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
  check({"treecode", {"prefilter", "sun.exr", "--lobe", "charlie", "--roughness", "0.4", "--size", "11"}});
  check({"sheen", {"prefilter", "sun.exr", "--lobe", "charlie", "--roughness", "0.2", "--size", "11"}});
  check({"diffuse", {"prefilter", "sun.exr", "--size", "9", "--to", "paraboloid"}});
  check({"exact", {"prefilter", "sun.exr", "--method", "exact", "--size", "3"}});
  check({"close",
         {"prefilter", "sun.exr", "--lobe", "phong", "--exponent", "50", "--size", "9", "--to", "octahedral",
          "--max-error", "2e-5", "--depth", "float"}});
  check({"mirror", {"prefilter", "sun.exr", "--lobe", "ggx", "--roughness", "0", "--size", "8", "--layout", "cross"}});
}

TEST_F(Shards, OfChainsJoinToTheBytesOfTheWhole) {
  dim_sun();
  const std::vector<std::string> ggx{"prefilter", "dim.exr", "--lobe", "ggx", "--levels", "4", "--size", "32"};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), ggx.begin(), ggx.end());
    return more;
  };
  for (const int count : {2, 3, 7}) check({"ktx", ggx, "whole.ktx"}, count);
  check({"ktx2", ggx, "whole.ktx2", {"--depth", "rgb9e5", "--zstd"}});
  check({"dds", ggx, "whole.dds", {"--depth", "half"}});
  check({"halves", with({"--depth", "half", "--compression", "piz", "--layout", "cross"})});
  check({"a file for each level", ggx, "whole-{level}.hdr"});
  check({"a file for each level and face", ggx, "whole-{level}-{face}.exr"}, 3);
  for (const std::string to : {"latlong", "cube", "sphere", "paraboloid", "angular", "octahedral", "equal-area"})
    check({to, with({"--to", to})}, to == "cube" ? 7 : 3);
  check({"border", with({"--to", "equal-area", "--border", "1"}), "whole.ktx2"}, 3);
  check({"odd sizes, down to one texel",
         {"prefilter", "dim.exr", "--lobe", "phong", "--exponent", "900", "--levels", "4", "--size", "13"}});
  check({"within an error",
         {"prefilter", "dim.exr", "--lobe", "charlie", "--roughnesses", "0.5,0.9", "--size", "9", "--max-error", "1e-2",
          "--depth", "float"}});
}

// Their maps are mirrored, and have key/value pairs beside their texels.
TEST_F(Shards, OfEnginesJoinToTheBytesOfTheWhole) {
  dim_sun();
  const auto of = [&](const std::string& command, const std::string& engine, const std::string& file) {
    return Job{engine, {command, "dim.exr", "--for", engine}, file};
  };
  for (const auto& [engine, file] : {std::pair{"babylon", "whole.dds"},
                                     {"babylon-env", "whole.env"},
                                     {"bevy", "whole.ktx2"},
                                     {"filament", "whole.ktx"},
                                     {"gltf", "whole.glb"}}) {
    Job job = of("prefilter", engine, file);
    job.command.insert(job.command.end(), {"--size", "32"});
    check(job, 3);
  }
  check({"diffuse", {"prefilter", "dim.exr", "--for", "bevy", "--lobe", "diffuse", "--size", "9"}, "whole.ktx2"}, 3);
  succeeds({"generate", "directions", "dim.exr", "--to", "cube", "--size", "12"});
  check(of("mipmap", "babylon", "whole.dds"), 3);
  check(of("mipmap", "bevy", "whole.ktx2"), 3);
  check(of("convert", "babylon", "whole.dds"), 3);
  make_parts(of("convert", "babylon", ""), 2);
  fails(2, {"merge", part(1), part(2), "out.exr"}, {"out.exr", "the parts are of a .dds file"});
  succeeds({"merge", part(1), part(2), "engine"});
  EXPECT_EQ(read("engine").substr(0, 4), "DDS ");
}

// Small levels lie whole in one part, the last first; large ones are divided.
TEST_F(Shards, OfAChainHoldABandOfEachLargeLevel) {
  dim_sun();
  make_parts({"", {"prefilter", "dim.exr", "--lobe", "ggx", "--roughnesses", "0,0.5,1", "--size", "32"}}, 3);
  for (const auto& [k, rows] : {std::pair{1, 64 + 32}, {2, 64 + 32}, {3, 64 + 32 + 48}}) {
    const Result r = shell("exrheader " + part(k));
    EXPECT_NE(r.out.find("(0 0) - (31 " + std::to_string(rows - 1) + ")"), std::string::npos) << r.out;
  }
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
  fails(2, {"merge", part(1), part(2), part(3)}, {"part-3.exr", "is a part: name the file to write after the parts"});
  EXPECT_EQ(envmap({"info", part(2)}).err,
            part(2) + ": is part 2/3 of a map, and the rest of it is black: merge the parts\n");
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

TEST_F(Shards, OfAChainThatAreMissingOrOfAnotherRunAreRefused) {
  const Job job{"", {"prefilter", "sun.exr", "--lobe", "ggx", "--levels", "3", "--size", "8"}};
  make_parts(job, 3);
  fails(3, {"merge", part(3), part(1), "out.ktx"}, {"of 3 parts these are missing: 2"});
  succeeds(
      {"prefilter", "sun.exr", "other.exr", "-q", "--lobe", "ggx", "--levels", "4", "--size", "8", "--shard", "2/3"});
  fails(3, {"merge", part(1), "other.exr", part(3), "out.ktx"},
        {"other.exr", "another map or command than part-1.exr"});
  const auto refused = [&](const std::string& attribute, const std::string& value,
                           const std::vector<std::string>& words) {
    SCOPED_TRACE(attribute + " " + value);
    for (int k = 1; k <= 3; ++k)
      ASSERT_EQ(shell("exrstdattr -string envmap:" + attribute + " " + value + " " + part(k) + " odd-" +
                      std::to_string(k) + ".exr")
                    .status,
                0);
    fails(3, {"merge", "odd-1.exr", "odd-2.exr", "odd-3.exr", "out.exr"}, words, {.memory = std::uint64_t{1} << 30});
  };
  refused("levels", "2", {"odd-", "damaged"});
  refused("levels", "2147483647", {"no 2147483647 levels", "damaged"});
  refused("whole-border", "4", {"damaged"});
  refused("whole-mirror", "y", {"damaged"});
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
  const std::vector<std::string> chain{"prefilter", "sun.exr", "--lobe", "ggx", "--levels", "3", "--shard", "1/2"};
  const auto no_chain = [&](const std::vector<std::string>& more, const std::vector<std::string>& words) {
    std::vector<std::string> command = chain;
    command.insert(command.end(), more.begin(), more.end());
    fails(2, command, words);
  };
  no_chain({"out-{level}.exr"}, {"one .exr file"});
  no_chain({"out.ktx"}, {"out.ktx", "one .exr file"});
  no_chain({"out.exr", "--to", "latlong", "--size", "9"}, {"level 1 is 8x4, not 9x4"});
  fails(2, {"prefilter", "sun.exr", "out.exr", "--max-error", "1e-2", "--depth", "half", "--shard", "1/2"},
        {"--depth float"});
  fails(2, {"mipmap", "sun.exr", "out.exr", "--keep", "--shard", "1/2"}, {"--keep"});
  succeeds({"convert", "sun.exr", part(1), "--size", "8", "--max-error", "1e-2", "--shard", "1/2", "-q"});
  succeeds({"convert", "sun.exr", part(2), "--size", "8", "--max-error", "1e-2", "--shard", "2/2", "-q"});
  fails(2, {"merge", part(1), part(2), "out.hdr"}, {"--max-error"});
}

}  // namespace
}  // namespace command_tests::shard_test

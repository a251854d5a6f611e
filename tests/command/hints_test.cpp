// Every hint of the program is followed: what it names is an option of the command, and the command then succeeds.
#include <algorithm>
#include <limits>
#include <regex>
#include <set>

#include "picture.h"
#include "run.h"

namespace command_tests::hints_test {
namespace {

using Lines = std::vector<std::string>;

// A command that ends with a hint, and the commands that it hints at: "+ OPTIONS" is the command with more options.
struct Hint {
  std::string command;
  int status;
  std::string hint;
  Lines hinted = {};
};

const std::string deepen = ": choose --depth float, lower --exposure or use --clamp",
                  dim = ": lower --exposure or use --clamp",
                  brighten = ": choose --depth float, raise --exposure or use --clamp",
                  encoded = ": choose a linear --output-space or use --encoded",
                  which = ": give its projection with --from", exact_file = ": use an .exr file with --depth float";

// The table. What the commands read is made by SetUp().
const Hint hints[] = {
    // Light that does not fit.
    {"bake bright.exr gltf --for gltf --chain-size 16 --size 8", 4, dim, {"+ --exposure -10", "+ --clamp"}},
    {"bake bright.exr env --for babylon-env --chain-size 16 --size 8", 4, dim, {"+ --exposure -10", "+ --clamp"}},
    {"bake bright.exr unity --for unity --size 8", 4, deepen, {"+ --depth float", "+ --exposure -10", "+ --clamp"}},
    {"bake brightest.exr unreal --for unreal --size 8", 4, dim, {"+ --exposure -10", "+ --clamp"}},
    {"convert bright.exr out.exr --depth half",
     4,
     deepen,
     {"convert bright.exr out.exr --depth float", "+ --exposure -10", "+ --clamp"}},
    {"convert brightest.exr out.hdr", 4, dim, {"+ --exposure -10", "+ --clamp"}},
    {"convert bright.exr out.exr --depth half --exposure 100",
     4,
     deepen,
     {"convert bright.exr out.exr --depth float --exposure 100"}},
    {"convert bright.exr out.exr --gain 1e38", 2, ": lower --gain", {"convert bright.exr out.exr --gain 1e30"}},
    {"convert bright.exr out.exr --scale-to lux=1e40",
     2,
     ": lower --scale-to",
     {"convert bright.exr out.exr --scale-to lux=1e30"}},
    {"convert huge.exr out.exr --white 2000", 2, ": lower --white"},
    {"convert huge.exr out.exr --saturation 2", 2, ": lower --saturation"},
    {"convert huge.exr out.exr --add huge.exr", 2, ": dim one of the maps first"},
    {"bake huge.exr three --for three --exposure 10", 2, ": lower the exposure"},
    {"convert bright.exr out.png",
     4,
     ": write .exr or .hdr, lower --exposure, use --display neutral for a picture or use --clamp",
     {"convert bright.exr out.exr", "+ --exposure -20", "+ --clamp"}},
    {"mipmap cube.exr out.env", 4, ": use --clamp", {"+ --clamp"}},
    {"prefilter bright.exr out.exr --size 4 --depth half",
     4,
     ": choose --depth float or use --clamp",
     {"prefilter bright.exr out.exr --size 4 --depth float", "+ --clamp"}},
    {"convert dark.exr out.exr --depth half",
     4,
     brighten,
     {"convert dark.exr out.exr --depth float", "+ --exposure 30", "+ --clamp"}},
    {"convert dark.exr out.ktx2 --depth rgb9e5",
     4,
     brighten,
     {"convert dark.exr out.ktx2 --depth float", "+ --exposure 30", "+ --clamp"}},
    // Reading.
    {"convert square.exr out.exr", 3, which, {"+ --from angular"}},
    {"info square.exr", 3, which, {"+ --from octahedral"}},
    {"convert alpha.exr out.exr", 3, ": use --drop-channels to ignore them", {"+ --drop-channels"}},
    {"convert nan.exr out.exr", 3, ": use --repair to replace them", {"+ --repair"}},
    {"info sky.exr --max-pixels 10", 3, ": raise --max-pixels", {"info sky.exr --max-pixels 1M"}},
    {"convert layers.exr out.exr", 3, ": choose one with --layer", {"+ --layer sun"}},
    {"convert cube.ktx2 out.exr --from-layout row", 2, ": remove --from-layout", {"convert cube.ktx2 out.exr"}},
    // Writing.
    {"convert grey.exr out", 2, "or .webp, or use --format", {"+ --format exr"}},
    {"convert grey.exr out_{face}.exr", 2, ": use --to cube", {"+ --to cube"}},
    {"mipmap grey.exr out.env", 2, ": use 'envmap convert --to cube' first"},
    {"convert grey.exr out.exr --to latlong --layout row",
     2,
     ": remove --layout",
     {"convert grey.exr out.exr --to latlong"}},
    {"convert grey.exr out.ktx2 --to cube --layout row",
     2,
     ": remove --layout",
     {"convert grey.exr out.ktx2 --to cube"}},
    {"convert grey.exr out_{face}.ktx2 --to cube", 2, ": remove {face}", {"convert grey.exr out_.ktx2 --to cube"}},
    {"convert grey.exr out.exr --openexr-envmap --forward -x",
     2,
     ": use --forward +z",
     {"convert grey.exr out.exr --openexr-envmap --forward +z"}},
    {"convert grey.exr out.exr --output-space display_p3",
     2,
     encoded,
     {"+ --encoded", "convert grey.exr out.exr --output-space lin_p3d65"}},
    {"mipmap grey.exr out.exr --output-space sRGB",
     2,
     encoded,
     {"+ --encoded", "mipmap grey.exr out.exr --output-space ACEScg"}},
    {"mipmap grey.exr out.exr --keep --level 1", 2, ": remove --level", {"mipmap grey.exr out.exr --keep"}},
    {"mipmap grey.exr out.exr --keep --for filament", 2, ": remove --keep", {"mipmap grey.exr out.ktx --for filament"}},
    // Errors that were asked for.
    {"bake sky.exr unity --for unity --size 8 --max-error 1e-4", 1, "or use --depth float", {"+ --depth float"}},
    {"bake sky.exr gltf --for gltf --chain-size 16 --max-error 1e-4", 1, ": raise --max-error"},
    {"convert sky.exr out.hdr --to cube --size 4 --max-error 2e-3",
     1,
     exact_file,
     {"convert sky.exr out.exr --to cube --size 4 --max-error 2e-3 --depth float"}},
    {"prefilter sky.exr out.exr --size 4 --depth half --max-error 1e-4",
     1,
     ": use --depth float",
     {"prefilter sky.exr out.exr --size 4 --depth float --max-error 1e-4"}},
    {"prefilter sky.exr out.hdr --size 4 --max-error 1e-4",
     1,
     exact_file,
     {"prefilter sky.exr out.exr --size 4 --depth float --max-error 1e-4"}},
    // What a command needs, and what does not go together.
    {"prefilter sky.exr out.exr --size 4 --lobe phong",
     2,
     ": needs --exponent M or --exponents A,B,...",
     {"+ --exponent 5", "+ --exponents 5,4"}},
    {"prefilter sky.exr out.exr --size 4 --lobe ggx",
     2,
     ": needs --roughness R, --roughnesses A,B,... or --levels N",
     {"+ --roughness 1", "+ --roughnesses 0.5,1", "+ --levels 2"}},
    {"prefilter sky.exr out.exr --size 4 --lobe phong --exponent 5 --brdf-table table.exr",
     2,
     ": remove --brdf-table",
     {"prefilter sky.exr out.exr --size 4 --lobe phong --exponent 5"}},
    {"prefilter --lobe blinn-phong --brdf-table table.exr",
     2,
     ": choose --lobe ggx or --lobe charlie",
     {"prefilter --lobe ggx --brdf-table table.exr --table-size 4",
      "prefilter --lobe charlie --brdf-table table.exr --table-size 4"}},
    {"bake", 2, "or --list", {"+ --list"}},
    {"compare sky.exr levels.exr --max-error 1", 1, "to compare one level", {"+ --level 0"}},
    {"info levels.exr --levels --level 1", 2, ": remove --level", {"info levels.exr --levels"}},
    {"prefilter sky.exr out.ktx --for filament --size 16 --scale 2",
     2,
     ": remove --scale",
     {"prefilter sky.exr out.ktx --for filament --size 16"}},
    {"convert sky.exr out.exr --for three --to cube", 2, ": remove --to cube", {"convert sky.exr out.exr --for three"}},
    {"convert sky.exr out.exr --to perspective --size 8 --display clip",
     2,
     ": remove --display",
     {"convert sky.exr out.exr --to perspective --size 8"}},
    {"preview levels.exr out.png --levels --level 1", 2, ": remove --level", {"preview levels.exr out.png --levels"}},
    {"convert levels.exr out.exr",
     0,
     ": use --level 0 to confirm, and 'envmap mipmap' to add levels",
     {"+ --level 0", "mipmap out.exr more.exr"}},
    // Scenes.
    {"render scene.obj out.exr --to cube --size 4 --method raycast",
     0,
     ": use --environment MAP or --ambient 1",
     {"+ --environment sky.exr", "+ --ambient 1"}},
    {"render scene.obj out.exr --to cube --size 4 --method raycast --at foo",
     2,
     "('envmap info SCENE' lists all)",
     {"info scene.obj"}},
    {"tradeoff scene.obj --task render:cube:4 --only raycast",
     2,
     ": give some with --environment MAP",
     {"+ --environment sky.exr"}},
    {"tradeoff sky.exr --task convert:cube:4 --budget 0",
     0,
     ": raise --budget",
     {"tradeoff sky.exr --task convert:cube:4 --budget 1000"}},
};

class Hints : public CommandTest {
 protected:
  void SetUp() override {
    succeeds({"generate", "sky", "sky.exr", "--size", "16"});
    for (const auto& [name, value] : {std::pair("grey", "0.5"),
                                      {"bright", "1e5"},
                                      {"brightest", "2e38"},
                                      {"huge", "3e38,2e38,1e38"},
                                      {"dark", "1e-9"}})
      succeeds({"generate", "constant", std::string(name) + ".exr", "--size", "8", "--value", value});
    succeeds({"generate", "constant", "cube.exr", "--size", "8", "--value", "1e5", "--to", "cube"});
    succeeds({"convert", "grey.exr", "grey-cube.exr", "--to", "cube", "--size", "8"});
    succeeds({"convert", "grey.exr", "cube.ktx2", "--to", "cube", "--size", "4"});
    succeeds({"mipmap", "sky.exr", "levels.exr"});
    save(path("square.exr"), Picture::filled(8, 8, 1));
    save(path("alpha.exr"), Picture::filled(8, 4, 1, 4));
    Picture flawed = Picture::filled(8, 4, 1);
    flawed.values[5] = std::numeric_limits<float>::quiet_NaN();
    save(path("nan.exr"), flawed);
    OIIO::ImageSpec spec;
    spec.channelnames = {"sun.R", "sun.G", "sun.B", "fog.R", "fog.G", "fog.B"};
    save(path("layers.exr"), Picture::filled(8, 4, 1, 6), OIIO::TypeDesc::FLOAT, spec);
    write("scene.obj", "v 0 0 -1\nv 1 0 -1\nv 0 1 -1\nf 1 2 3\n");
  }

  // The options that a message names are options of the command.
  void names_options(const std::string& command, const std::string& message) const {
    const std::string help = envmap({command, "--help"}).out;
    static const std::regex option("--[a-z][a-z0-9-]*");
    for (std::sregex_iterator m(message.begin(), message.end(), option), end; m != end; ++m)
      EXPECT_NE(help.find(m->str()), std::string::npos) << command << " has no " << m->str() << ": " << message;
  }
};

TEST_F(Hints, LeadOn) {
  for (const Hint& h : hints) {
    SCOPED_TRACE(h.command);
    const Result r = envmap(split(h.command));
    EXPECT_EQ(r.status, h.status) << r.err;
    EXPECT_TRUE(r.err.ends_with(h.hint + "\n")) << r.err;
    if (h.hint.find("'envmap convert") == std::string::npos) names_options(split(h.command)[0], h.hint);
    for (const std::string& hinted : h.hinted) {
      const Result done = envmap(split(hinted.starts_with("+") ? h.command + hinted.substr(1) : hinted));
      EXPECT_EQ(done.status, 0) << hinted << done.err;
      EXPECT_EQ(done.err.find(h.hint), std::string::npos) << done.err;
    }
  }
}

TEST_F(Hints, OfTheExposureThatFits) {
  for (const std::string command : {"convert bright.exr out.exr --depth half", "convert bright.exr out.png"}) {
    const std::string said = envmap(split(command)).err;
    const std::size_t at = said.find("by up to ") + 9;
    const double stops = std::stod(said.substr(at));
    EXPECT_EQ(envmap(split(command + " --exposure=" + std::to_string(-stops))).status, 0) << said;
    EXPECT_EQ(envmap(split(command + " --exposure=" + std::to_string(0.1 - stops))).status, 4) << said;
  }
}

// Each extension that is named is tried.
TEST_F(Hints, OfFileTypes) {
  for (const std::string command :
       {"convert grey.exr out", "convert grey-cube.exr out", "mipmap grey.exr out", "mipmap grey-cube.exr out"}) {
    std::set<std::string> known;
    for (const std::string type : {".xyz", ""}) {
      const Result r = envmap(split(command + type));
      EXPECT_EQ(r.status, 2);
      static const std::regex extension("\\.[a-z0-9]+(?=[ ,\n])");
      const std::string listed = r.err.substr(r.err.find(type.empty() ? "end the name in" : "try"));
      int tried = 0;
      for (std::sregex_iterator m(listed.begin(), listed.end(), extension), end; m != end; ++m, ++tried) {
        if (!known.insert(m->str()).second) continue;
        const Result done = envmap(split(command + m->str()));
        EXPECT_EQ(done.status, 0) << command << m->str() << ": " << done.err;
      }
      EXPECT_GT(tried, 3) << r.err;
    }
  }
}

TEST_F(Hints, OfABatchWithoutNinja) {
  write("jobs.txt", "convert sky.exr made.exr\n");
  const Result lacking = shell("PATH=/none \"$ENVMAP\" batch jobs.txt");
  EXPECT_NE(lacking.err.find("or use --make FILE"), std::string::npos) << lacking.err;
  EXPECT_EQ(shell("PATH=/none \"$ENVMAP\" batch jobs.txt --make jobs.mk").status, 0);
}

}  // namespace
}  // namespace command_tests::hints_test

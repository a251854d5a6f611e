// Every hint of the program is followed: what it names is an option of the command, and the command then succeeds.
#include <algorithm>
#include <limits>
#include <regex>
#include <set>

#include "picture.h"
#include "run.h"

namespace command_tests::hints_test {
namespace {

using Words = std::vector<std::string>;

// A command that ends with a hint, and the commands that it hints at.
struct Hint {
  Words command;
  int status;
  std::string hint;
  std::vector<Words> hinted;
};

Words with(Words words, const std::string& more) {
  for (const std::string& word : split(more)) words.push_back(word);
  return words;
}

class Hints : public CommandTest {
 protected:
  void SetUp() override {
    succeeds({"generate", "constant", "grey.exr", "--size", "8", "--value", "0.5"});
    succeeds({"generate", "sky", "sky.exr", "--size", "16"});
    succeeds({"generate", "constant", "bright.exr", "--size", "8", "--value", "1e5"});
    succeeds({"generate", "constant", "cube.exr", "--size", "8", "--value", "1e5", "--to", "cube"});
    succeeds({"generate", "constant", "brightest.exr", "--size", "8", "--value", "2e38"});
    succeeds({"generate", "constant", "dark.exr", "--size", "8", "--value", "1e-9"});
  }

  // The options that a message names are options of the command.
  void names_options(const std::string& command, const std::string& message) const {
    const std::string help = envmap({command, "--help"}).out;
    static const std::regex option("--[a-z][a-z0-9-]*");
    for (std::sregex_iterator m(message.begin(), message.end(), option), end; m != end; ++m)
      EXPECT_NE(help.find(m->str()), std::string::npos) << command << " has no " << m->str() << ": " << message;
  }

  void leads(const Hint& h) const {
    SCOPED_TRACE(::testing::PrintToString(h.command));
    const Result r = envmap(h.command);
    EXPECT_EQ(r.status, h.status) << r.err;
    EXPECT_TRUE(r.err.ends_with(h.hint + "\n")) << r.err;
    names_options(h.command[0], h.hint);
    for (const Words& hinted : h.hinted) {
      const Result done = envmap(hinted);
      EXPECT_EQ(done.status, 0) << ::testing::PrintToString(hinted) << done.err;
      EXPECT_EQ(done.err.find(h.hint), std::string::npos) << done.err;
    }
  }
};

TEST_F(Hints, OfLightThatDoesNotFit) {
  const std::string deepen = ": choose --depth float, lower --exposure or use --clamp",
                    dim = ": lower --exposure or use --clamp";
  for (const std::string engine : {"gltf", "babylon-env"}) {
    const Words bake = {"bake", "bright.exr", engine, "--for", engine, "--chain-size", "16", "--size", "8"};
    leads({bake, 4, dim, {with(bake, "--exposure -10"), with(bake, "--clamp")}});
  }
  const Words unity = split("bake bright.exr unity --for unity --size 8"),
              unreal = split("bake brightest.exr unreal --for unreal --size 8");
  leads({unity, 4, deepen, {with(unity, "--depth float"), with(unity, "--exposure -10"), with(unity, "--clamp")}});
  leads({unreal, 4, dim, {with(unreal, "--exposure -10"), with(unreal, "--clamp")}});
  const Words half = split("convert bright.exr out.exr --depth half");
  leads({half,
         4,
         deepen,
         {split("convert bright.exr out.exr --depth float"), with(half, "--exposure -10"), with(half, "--clamp")}});
  const Words hdr = split("convert brightest.exr out.hdr");
  leads({hdr, 4, dim, {with(hdr, "--exposure -10"), with(hdr, "--clamp")}});
  leads({split("convert bright.exr out.exr --depth half --exposure 100"),
         4,
         deepen,
         {split("convert bright.exr out.exr --depth float --exposure 100")}});
  leads({split("convert bright.exr out.exr --gain 1e38"),
         2,
         ": lower --gain",
         {split("convert bright.exr out.exr --gain 1e30")}});
  leads({split("convert bright.exr out.exr --scale-to lux=1e40"),
         2,
         ": lower --scale-to",
         {split("convert bright.exr out.exr --scale-to lux=1e30")}});
  succeeds({"generate", "constant", "huge.exr", "--size", "8", "--value", "3e38,2e38,1e38"});
  leads({split("convert huge.exr out.exr --white 2000"), 2, ": lower --white", {}});
  leads({split("convert huge.exr out.exr --saturation 2"), 2, ": lower --saturation", {}});
  leads({split("convert huge.exr out.exr --add huge.exr"), 2, ": dim one of the maps first", {}});
  leads({split("bake huge.exr three --for three --exposure 10"), 2, ": lower the exposure", {}});
  const Words png = split("convert bright.exr out.png");
  leads({png,
         4,
         ": write .exr or .hdr, lower --exposure, use --display neutral for a picture or use --clamp",
         {split("convert bright.exr out.exr"), with(png, "--exposure -20"), with(png, "--clamp")}});
  const Words env = split("mipmap cube.exr out.env"),
              diffuse = split("prefilter bright.exr out.exr --size 4 --depth half");
  leads({env, 4, ": use --clamp", {with(env, "--clamp")}});
  leads({diffuse,
         4,
         ": choose --depth float or use --clamp",
         {split("prefilter bright.exr out.exr --size 4 --depth float"), with(diffuse, "--clamp")}});
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

TEST_F(Hints, OfLightThatIsTooDark) {
  const Words dark = split("convert dark.exr out.exr --depth half"),
              bytes = split("convert dark.exr out.ktx2 --depth rgb9e5");
  leads({dark,
         4,
         ": choose --depth float, raise --exposure or use --clamp",
         {split("convert dark.exr out.exr --depth float"), with(dark, "--exposure 30"), with(dark, "--clamp")}});
  leads({bytes,
         4,
         ": choose --depth float, raise --exposure or use --clamp",
         {split("convert dark.exr out.ktx2 --depth float"), with(bytes, "--exposure 30"), with(bytes, "--clamp")}});
}

// Each extension that is named is tried.
TEST_F(Hints, OfFileTypes) {
  succeeds({"convert", "grey.exr", "grey-cube.exr", "--to", "cube", "--size", "8"});
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
  leads({split("convert grey.exr out"), 2, "or .webp, or use --format", {split("convert grey.exr out --format exr")}});
}

TEST_F(Hints, OfReading) {
  save(path("square.exr"), Picture::filled(8, 8, 1));
  const std::string which = ": give its projection with --from";
  leads({split("convert square.exr out.exr"), 3, which, {split("convert square.exr out.exr --from angular")}});
  leads({split("info square.exr"), 3, which, {split("info square.exr --from octahedral")}});
  save(path("alpha.exr"), Picture::filled(8, 4, 1, 4));
  leads({split("convert alpha.exr out.exr"),
         3,
         ": use --drop-channels to ignore them",
         {split("convert alpha.exr out.exr --drop-channels")}});
  Picture flawed = Picture::filled(8, 4, 1);
  flawed.values[5] = std::numeric_limits<float>::quiet_NaN();
  save(path("nan.exr"), flawed);
  leads({split("convert nan.exr out.exr"),
         3,
         ": use --repair to replace them",
         {split("convert nan.exr out.exr --repair")}});
  leads({split("info sky.exr --max-pixels 10"), 3, ": raise --max-pixels", {split("info sky.exr --max-pixels 1M")}});
  OIIO::ImageSpec spec;
  spec.channelnames = {"sun.R", "sun.G", "sun.B", "fog.R", "fog.G", "fog.B"};
  save(path("layers.exr"), Picture::filled(8, 4, 1, 6), OIIO::TypeDesc::FLOAT, spec);
  leads({split("convert layers.exr out.exr"),
         3,
         ": choose one with --layer",
         {split("convert layers.exr out.exr --layer sun")}});
  succeeds({"convert", "grey.exr", "cube.ktx2", "--to", "cube", "--size", "4"});
  leads({split("convert cube.ktx2 out.exr --from-layout row"),
         2,
         ": remove --from-layout",
         {split("convert cube.ktx2 out.exr")}});
}

TEST_F(Hints, OfMapsThatAreNoCubes) {
  leads({split("convert grey.exr out_{face}.exr"),
         2,
         ": use --to cube",
         {split("convert grey.exr out_{face}.exr --to cube")}});
  const Result r = envmap(split("mipmap grey.exr out.env"));
  EXPECT_EQ(r.status, 2);
  EXPECT_TRUE(r.err.ends_with(": use 'envmap convert --to cube' first\n")) << r.err;
}

TEST_F(Hints, OfWriting) {
  leads({split("convert grey.exr out.exr --to latlong --layout row"),
         2,
         ": remove --layout",
         {split("convert grey.exr out.exr --to latlong")}});
  leads({split("convert grey.exr out.ktx2 --to cube --layout row"),
         2,
         ": remove --layout",
         {split("convert grey.exr out.ktx2 --to cube")}});
  leads({split("convert grey.exr out_{face}.ktx2 --to cube"),
         2,
         ": remove {face}",
         {split("convert grey.exr out_.ktx2 --to cube")}});
  leads({split("convert grey.exr out.exr --openexr-envmap --forward -x"),
         2,
         ": use --forward +z",
         {split("convert grey.exr out.exr --openexr-envmap --forward +z")}});
  const std::string encoded = ": choose a linear --output-space or use --encoded";
  const Words p3 = with({"convert", "grey.exr", "out.exr", "--output-space"}, "display_p3");
  leads({p3, 2, encoded, {with(p3, "--encoded"), split("convert grey.exr out.exr --output-space lin_p3d65")}});
  const Words levels = with({"mipmap", "grey.exr", "out.exr", "--output-space"}, "sRGB");
  leads({levels, 2, encoded, {with(levels, "--encoded"), split("mipmap grey.exr out.exr --output-space ACEScg")}});
  leads({split("mipmap grey.exr out.exr --keep --level 1"),
         2,
         ": remove --level",
         {split("mipmap grey.exr out.exr --keep")}});
  leads({split("mipmap grey.exr out.exr --keep --for filament"),
         2,
         ": remove --keep",
         {split("mipmap grey.exr out.ktx --for filament")}});
}

TEST_F(Hints, OfErrorsAskedFor) {
  leads({split("bake sky.exr unity --for unity --size 8 --max-error 1e-4"),
         1,
         "or use --depth float",
         {split("bake sky.exr unity --for unity --size 8 --max-error 1e-4 --depth float")}});
  leads({split("bake sky.exr gltf --for gltf --chain-size 16 --max-error 1e-4"), 1, ": raise --max-error", {}});
  leads({split("convert sky.exr out.hdr --to cube --size 4 --max-error 2e-3"),
         1,
         ": use an .exr file with --depth float",
         {split("convert sky.exr out.exr --to cube --size 4 --max-error 2e-3 --depth float")}});
  leads({split("prefilter sky.exr out.exr --size 4 --depth half --max-error 1e-4"),
         1,
         ": use --depth float",
         {split("prefilter sky.exr out.exr --size 4 --depth float --max-error 1e-4")}});
  leads({split("prefilter sky.exr out.hdr --size 4 --max-error 1e-4"),
         1,
         ": use an .exr file with --depth float",
         {split("prefilter sky.exr out.exr --size 4 --depth float --max-error 1e-4")}});
}

TEST_F(Hints, OfCommands) {
  const Words phong = split("prefilter sky.exr out.exr --size 4 --lobe phong"),
              ggx = split("prefilter sky.exr out.exr --size 4 --lobe ggx");
  leads({phong,
         2,
         ": needs --exponent M or --exponents A,B,...",
         {with(phong, "--exponent 5"), with(phong, "--exponents 5,4")}});
  leads({ggx,
         2,
         ": needs --roughness R, --roughnesses A,B,... or --levels N",
         {with(ggx, "--roughness 1"), with(ggx, "--roughnesses 0.5,1"), with(ggx, "--levels 2")}});
  leads(
      {with(phong, "--exponent 5 --brdf-table table.exr"), 2, ": remove --brdf-table", {with(phong, "--exponent 5")}});
  leads({split("prefilter --lobe blinn-phong --brdf-table table.exr"),
         2,
         ": choose --lobe ggx or --lobe charlie",
         {split("prefilter --lobe ggx --brdf-table table.exr --table-size 4"),
          split("prefilter --lobe charlie --brdf-table table.exr --table-size 4")}});
  leads({split("bake"), 2, "or --list", {split("bake --list")}});
  succeeds({"mipmap", "sky.exr", "levels.exr"});
  leads({split("compare sky.exr levels.exr --max-error 1"),
         1,
         "to compare one level",
         {split("compare sky.exr levels.exr --max-error 1 --level 0")}});
  leads({split("info levels.exr --levels --level 1"), 2, ": remove --level", {split("info levels.exr --levels")}});
  write("jobs.txt", "convert sky.exr made.exr\n");
  const Result lacking = shell("PATH=/none \"$ENVMAP\" batch jobs.txt");
  EXPECT_NE(lacking.err.find("or use --make FILE"), std::string::npos) << lacking.err;
  EXPECT_EQ(shell("PATH=/none \"$ENVMAP\" batch jobs.txt --make jobs.mk").status, 0);
}

TEST_F(Hints, OfOptionsThatDoNotGoTogether) {
  succeeds({"mipmap", "sky.exr", "levels.exr"});
  const Words filament = split("prefilter sky.exr out.ktx --for filament --size 16"),
              three = split("convert sky.exr out.exr --for three");
  leads({with(filament, "--scale 2"), 2, ": remove --scale", {filament}});
  leads({with(three, "--to cube"), 2, ": remove --to cube", {three}});
  const Words picture = split("convert sky.exr out.exr --to perspective --size 8"),
              sheet = split("preview levels.exr out.png --levels");
  leads({with(picture, "--display clip"), 2, ": remove --display", {picture}});
  leads({with(sheet, "--level 1"), 2, ": remove --level", {sheet}});
  leads({split("convert levels.exr out.exr"),
         0,
         ": use --level 0 to confirm, and 'envmap mipmap' to add levels",
         {split("convert levels.exr out.exr --level 0"), split("mipmap out.exr more.exr")}});
}

TEST_F(Hints, OfScenes) {
  write("scene.obj", "v 0 0 -1\nv 1 0 -1\nv 0 1 -1\nf 1 2 3\n");
  const Words render = split("render scene.obj out.exr --to cube --size 4 --method raycast");
  leads({render,
         0,
         ": use --environment MAP or --ambient 1",
         {with(render, "--environment sky.exr"), with(render, "--ambient 1")}});
  leads({with(render, "--at foo"), 2, "('envmap info SCENE' lists all)", {split("info scene.obj")}});
  const Words tradeoff = split("tradeoff scene.obj --task render:cube:4 --only raycast");
  leads({tradeoff, 2, ": give some with --environment MAP", {with(tradeoff, "--environment sky.exr")}});
  const Words hurried = split("tradeoff sky.exr --task convert:cube:4");
  leads({with(hurried, "--budget 0"), 0, ": raise --budget", {with(hurried, "--budget 1000")}});
}

}  // namespace
}  // namespace command_tests::hints_test

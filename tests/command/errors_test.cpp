// What goes wrong ends with the right exit status and one line that names the file, and leaves nothing behind.
#include <fmt/format.h>

#include <cmath>
#include <csignal>
#include <limits>
#include <nlohmann/json.hpp>
#include <regex>

#include "picture.h"
#include "run.h"

namespace command_tests::errors_test {
namespace {

constexpr int usage = 2, bad_input = 3, not_written = 4;

// ---- 2: what was asked makes no sense -------------------------------------------------------------------------------

class Usage : public CommandTest {
 protected:
  Usage() { save(path("in.exr"), latlong_directions(4)); }
};

// The line, and words of the one line that refuses it.
struct Refusal {
  const char* line;
  std::vector<std::string> words;
};

const Refusal refusals[] = {
    // Words that were probably meant.
    {"convert in.exr out.exr --sise 4", {"'--sise'", "did you mean '--size'"}},
    {"convert in.exr out.exr --siez 4", {"did you mean '--size'"}},
    {"compare in.exr in.exr --max-eror=1", {"'--max-eror'", "did you mean '--max-error'"}},
    {"convert in.exr out.exr --lobe ggx", {"'--lobe' is an option of 'envmap prefilter'"}},
    {"convert in.exr out.exr --face three", {"did you mean '--faces'? '--face' is an option of 'envmap preview'"}},
    {"batch --for three in.exr --size 8", {"'--size' is an option of jobs"}},
    {"convert in.exr out.exr --zzzzzzzz", {"--zzzzzzzz"}},
    // Arguments and values that are missing or too many.
    {"convert in.exr out.exr more.exr", {"'more.exr'", "convert takes INPUT OUTPUT"}},
    {"sh in.exr out.txt", {"'out.txt'", "sh takes INPUT", "use > FILE"}},
    {"convert", {"INPUT"}},
    {"convert in.exr", {"OUTPUT"}},
    {"info", {"FILES"}},
    {"compare in.exr", {"B"}},
    {"generate sun", {"OUTPUT"}},
    {"manual", {"FOLDER"}},
    {"manual --schemas", {"FOLDER"}},
    {"manual . --samples", {"--samples", "neither FOLDER nor"}},
    {"info in.exr --from", {"--from"}},
    {"convert in.exr out.exr --size", {"--size needs a value"}},
    {"convert in.exr out.exr --clamp 100", {"--clamp takes no value: remove '100'"}},
    {"convert in.exr out.exr --clamp=100", {": --clamp takes no value"}},
    {"convert in.exr out.exr -v 100", {"-v takes no value: remove '100'"}},
    {"convert in.exr out.exr --size 8 --size 16", {"--size takes one value, and is given 2 times"}},
    // Values of another kind.
    {"convert in.exr out.exr --size 8x4", {"--size: must be a whole number from 1 to"}},
    {"convert in.exr out.exr --size 1.5", {"--size"}},
    {"compare in.exr in.exr --max-rms 1%", {"--max-rms: must be a number of at least 0"}},
    {"convert in.exr out.exr --rotate 90", {"90,0,0", "sun:+z"}},
    {"convert in.exr out.exr --to cubic", {"--to", "cubic", "paraboloid"}},
    {"convert in.exr out.exr --from cubic", {"--from", "cubic", "paraboloid"}},
    {"convert in.exr out.exr --filter cubic", {"--filter", "cubic", "bilinear"}},
    {"convert in.exr out.exr --layout cubic", {"--layout", "cubic", "vcross"}},
    {"convert in.exr out.exr --depth cubic", {"--depth", "cubic", "half"}},
    {"convert in.exr out.exr --forward cubic", {"--forward", "cubic", "-z"}},
    {"generate moon out.exr", {"moon", "directions"}},
    {"generate sh out.exr --order 3", {"--order: must be from -2 to 2 with --degree 2, not 3"}},
    {"view s.gltf out.png --near 5 --far 2", {"--near must be less than --far"}},
    // File types and depths that nothing writes.
    {"convert in.exr out.xyz", {"out.xyz", ".exr"}},
    {"convert in.exr out", {"out", "--format"}},
    {"generate sky - --format xyz", {"xyz"}},
    {"generate sky out.exr --format hdr", {"out.exr", "make the two agree"}},
    {"preview in.exr out.exr", {"out.exr", ".png"}},
    {"generate sky out_{fcae}.exr --to cube", {"{fcae}", "{face}"}},
    {"convert in.exr out.hdr --depth half", {"cannot store half", "choose"}},
    {"convert in.exr out.tif --depth half", {"cannot store half", "choose"}},
    {"convert in.exr out.exr --depth uint8", {"cannot store uint8", "choose"}},
    {"convert in.exr out.pfm --depth uint16", {"cannot store uint16", "choose"}},
    {"convert in.exr out.png --depth float", {"cannot store float", "choose"}},
    // Layouts of what is no cube.
    {"convert in.exr out.exr --layout row", {"--layout"}},
    {"convert in.exr {face}.exr --to latlong", {"{face}"}},
    {"convert in.exr out.exr --to cube --layout files", {"{face}"}},
    {"convert in.exr {face}.exr --to cube --layout row", {"{face}"}},
    {"info in.exr --from latlong --from-layout row", {"layout"}},
    // Photos of a ball are sphere maps.
    {"convert in.exr out.exr --ball-distance 3", {"--ball-distance", "--from sphere", "in.exr is a latlong map"}},
    {"convert in.exr out.exr --ball-fov 30", {"--ball-fov", "mirror ball", "in.exr"}},
    {"convert in.exr out.exr --ball-fov 30 --ball-distance 3", {"excludes"}},
    // Options that would do nothing.
    {"sh in.exr --size 8", {"--evaluate"}},
    {"generate sun out.exr --azimuth 30", {"--azimuth is for atmosphere: use --direction X,Y,Z"}},
    {"generate sky out.exr --azimuth 30", {"--azimuth is for atmosphere: remove it"}},
    {"sh in.exr --if-changed", {"--evaluate"}},
    {"compare in.exr b.exr --force", {"--difference"}},
    {"convert in.exr out.exr --towards 0,0,1", {"--scale-to"}},
    {"convert in.exr out.exr --max-error 0.1 --area-error 1e-5", {"remove --area-error"}},
    {"convert in.exr out.exr --filter ewa --samples 2", {"remove it or --filter ewa"}},
    {"preview in.exr out.png --size 64", {"--html"}},
    {"batch jobs.txt --into folder", {"--for"}},
    {"batch jobs.txt --make jobs.mk -j 2", {"--make"}},
    {"view s.gltf out.png --orbit 90", {"--frames"}},
    {"view s.gltf out.png --distance", {"--save-maps"}},
    {"view s.gltf out.png --reflection sampled", {"--environment"}},
    {"render s.gltf out.exr --fps 25", {"--frames"}},
    {"render s.gltf out.exr --occlusion 8", {"--environment"}},
    {"render s.gltf out_{frame}.exr", {"goes with --frames"}},
    {"view s.gltf out_%04d.png", {"goes with --frames"}},
    {"prefilter in.exr out.exr --table-size 64", {"--brdf-table"}},
};

TEST_F(Usage, IsRefusedInOneLineThatSaysWhatToDo) {
  for (const Refusal& r : refusals) fails(usage, split(r.line), r.words);
}

TEST_F(Usage, OfTheProgramItselfIsRefused) {
  EXPECT_EQ(envmap({"--hlep"}).err, "envmap: unknown option '--hlep'; did you mean '--help'? (see 'envmap --help')\n");
  for (const std::string unlike : {"--picture", "--sunny", "--zzz"})
    EXPECT_EQ(envmap({"compare", "in.exr", "in.exr", unlike}).err.find("did you mean"), std::string::npos) << unlike;
  const Result r = envmap({"convrt", "in.exr", "out.exr"});
  EXPECT_EQ(r.status, usage);
  EXPECT_NE(r.err.find("no command 'convrt'; did you mean 'convert'?"), std::string::npos) << r.err;
  EXPECT_EQ(envmap({"zzzzzzzz"}).status, usage);
  EXPECT_EQ(envmap({}).status, usage);
  EXPECT_EQ(names(), std::vector<std::string>{"in.exr"});
}

// The ranges of all options, as the pages state them. NaN is neither below nor above any limit: `compare --golden
// --max-rms nan` would find everything alike.
TEST_F(Usage, NumbersBeyondTheirRangesAreRefused) {
  std::filesystem::create_directory(path("pages"));
  succeeds({"manual", "pages"});
  const std::map<std::string, std::string> pages = files();
  std::filesystem::remove_all(path("pages"));
  static const std::regex option(
      R"(\\fB(--[a-z-]+)\\fR \\fI[^\n]*\n[^\n]*(Whole number|Number)(, 0 or more| from (\S+) to (\S+))\.\n)");
  int options = 0;
  for (const auto& [name, text] : pages) {
    if (!name.starts_with("pages/envmap-") || !name.ends_with(".1")) continue;
    const std::string command = name.substr(13, name.size() - 15);
    const std::string page = std::regex_replace(text, std::regex(R"(\\-)"), "-");
    for (std::sregex_iterator m(page.begin(), page.end(), option), end; m != end; ++m, ++options) {
      const double least = m->str(4).empty() ? 0 : std::stod(m->str(4)),
                   below = m->str(2) == "Number" ? 0.5 * std::max(1e-9, std::abs(least)) : 1;
      std::vector<std::string> beyond{"nan", "-NaN", fmt::format("{}", least - below)};
      if (!m->str(5).empty()) {
        const double most = std::stod(m->str(5));
        beyond.push_back(fmt::format("{:.0f}", std::floor(most) + std::max(1.0, 0.01 * most)));
      }
      for (const std::string& value : beyond) fails(usage, {command, m->str(1) + "=" + value}, {m->str(1), "must be "});
    }
  }
  EXPECT_GE(options, 100);
}

TEST_F(Usage, NamesTheArgumentThatIsEmptyOrAFolder) {
  fails(usage, {"convert", "", "out.exr"}, {"INPUT", "empty"});
  fails(usage, {"convert", "in.exr", ""}, {"OUTPUT", "empty"});
  fails(usage, {"info", "in.exr", ""}, {"FILES", "empty"});
  fails(not_written, {"convert", "in.exr", "."}, {".: is a folder: give a file name"});
}

TEST_F(Usage, TellsWhatThePhotoOfABallDoesNotShow) {
  succeeds({"convert", "in.exr", "ball.exr", "--to", "sphere"});
  const Result r = envmap({"convert", "ball.exr", "out.exr", "--to", "latlong", "--ball-fov", "60"});
  EXPECT_EQ(r.status, 0) << r.err;
  for (const char* word : {"ball.exr", "30 degrees of -Z", "6.7%", "rim"})
    EXPECT_NE(r.err.find(word), std::string::npos) << r.err;
}

TEST_F(Usage, NamesTheVariableThatIsWrong) {
  for (const std::string value : {"abc", "0", "-1", "1.5"}) {
    const Result r = shell("ENVMAP_THREADS=" + value + " \"$ENVMAP\" info in.exr");
    EXPECT_EQ(r.status, usage);
    EXPECT_NE(r.err.find("ENVMAP_THREADS"), std::string::npos) << r.err;
    EXPECT_EQ(r.err.find("--threads"), std::string::npos) << r.err;
  }
  const Result r = shell("ENVMAP_THREADS=2 \"$ENVMAP\" info in.exr --threads abc");
  EXPECT_EQ(r.status, usage);
  EXPECT_NE(r.err.find("--threads"), std::string::npos) << r.err;
}

TEST_F(Usage, RefusesRotationsThatAreNoAnglesOrDirections) {
  for (const char* angles : {"1,2", "a,b,c", "1,2,3,4", "1,2,nan", "", "sun", "sun:", ":+z", "sun:+w", "+x:0,0,0",
                             "+x:+y:+z", "sun:sun", "+x:nan,0,1"})
    fails(usage, {"convert", "in.exr", "out.exr", "--rotate", angles}, {"--rotate"});
}

TEST_F(Usage, MarksInOtherBracesAreNames) { succeeds({"generate", "sky", "{2024}{A-1}.exr", "--size", "2", "-q"}); }

TEST_F(Usage, TakesWordsInLettersOfEitherCase) {
  succeeds({"generate", "sky", "small.exr", "--to", "cube", "--size", "4", "-q"});
  succeeds({"generate", "Sky", "large.exr", "--to", "CUBE", "--size", "4", "-q"});
  EXPECT_EQ(read("small.exr"), read("large.exr"));
}

TEST_F(Usage, WritesNoMapToATerminal) {
  if (shell("command -v script").status != 0) GTEST_SKIP() << "script (of util-linux) is not installed";
  const Result r = shell("script -qec '\"$ENVMAP\" generate sky - --size 8' /dev/null < /dev/null");
  EXPECT_EQ(r.status, usage);
  EXPECT_NE(r.out.find("standard output is a terminal"), std::string::npos) << r.out;
}

// ---- 3: an input is unreadable or not what it claims ----------------------------------------------------------------

class Input : public CommandTest {
 protected:
  void refuses(const std::string& name, std::vector<std::string> words,
               const std::vector<std::string>& options = {}) const {
    words.push_back(name);
    std::vector<std::string> arguments{"convert", name, "out.exr"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    fails(bad_input, arguments, words);
  }
};

TEST_F(Input, RefusesWhatIsNoFile) {
  std::filesystem::create_directory(path("folder.exr"));
  write("empty.exr", "");
  write("empty.hdr", "");
  refuses("missing.exr", {"no such file"});
  refuses("missing/too.exr", {"no such file"});
  refuses("folder.exr", {"folder"});
  refuses("empty.exr", {"empty"});
  refuses("empty.hdr", {"empty"});
}

TEST_F(Input, RefusesTextThatCallsItselfAnImage) {
  for (const char* name : {"text.hdr", "text.exr", "text.pfm", "text.png", "text.tif"}) {
    write(name, "Dear reader,\nthis is no image.\n");
    refuses(name, {});
  }
}

// OpenImageIO 2.4 writes beyond its memory when it reads a sound icon.
TEST_F(Input, RefusesFormatsThatHoldNoMaps) {
  save(path("icon.ico"), Picture::filled(12, 6, 0.5), OIIO::TypeDesc::UINT8);
  write("icon.png", read("icon.ico"));
  for (const char* name : {"icon.ico", "icon.png"}) refuses(name, {"none of EXR"});
}

// Found by tests/fuzz: an RLE bitmap of 2686976 x 393216; what OpenImageIO throws passed it by.
TEST_F(Input, RefusesBitmapsThatPromiseTooMuch) {
  using namespace std::string_literals;
  write("huge.bmp",
        "BM\x0e\1\0\0\0\0\0\0\x36\0\0\0\x28\0\0\0\0\0\x29\0\0\0\6\0\1\0\x18\0\2\0\0\0"s + std::string(40, '\0'));
  refuses("huge.bmp", {"huge.bmp"});
}

TEST_F(Input, RefusesStandardInputThatIsNoImage) {
  fails(bad_input, {"info", "-"}, {"standard input", "empty"});
  fails(bad_input, {"info", "-"}, {"standard input"}, {.input = "no image\n"});
  fails(bad_input, {"convert", "-", "out.exr"}, {"standard input"}, {.input = "#?RADIANCE\n"});
}

TEST_F(Input, WantsExactlyRedGreenAndBlue) {
  OIIO::ImageSpec spec;
  spec.channelnames = {"R", "G"};
  save(path("two.exr"), Picture::filled(8, 4, 1, 2), OIIO::TypeDesc::FLOAT, spec);
  refuses("two.exr", {"R, G"});
  spec.channelnames = {"R", "G", "B", "A"};
  save(path("alpha.exr"), Picture::filled(8, 4, 1, 4), OIIO::TypeDesc::FLOAT, spec);
  refuses("alpha.exr", {"A", "--drop-channels"});
  succeeds({"convert", "alpha.exr", "out.exr", "--drop-channels"});
  EXPECT_EQ(load(path("out.exr")), Picture::filled(8, 4, 1));
}

// Found by tests/fuzz: what a file calls its channels went to the terminal as it was.
TEST_F(Input, SaysNamesOutOfFilesWithoutControlCharacters) {
  OIIO::ImageSpec spec;
  spec.channelnames = {"R", "G", "B", "Z\n\x1b[2J"};
  save(path("names.exr"), Picture::filled(8, 4, 1, 4), OIIO::TypeDesc::FLOAT, spec);
  refuses("names.exr", {"Z??[2J", "--drop-channels"});
}

// A name is said as it is, but for what a terminal would obey: ESC, and CSI of ISO 8859 as UTF-8 and as a byte.
TEST_F(Input, SaysNamesOfFilesWithoutControlCharacters) {
  const std::string names[] = {"a\x1b[2J.exr",
                               "\xc2\x9b"
                               "2J.exr",
                               "b\x9b"
                               "2J.exr",
                               "e\xcc\x81\x7f.exr"};
  const char* said[] = {"a?[2J.exr", "?2J.exr", "b?2J.exr", "e\xcc\x81?.exr"};
  for (int k = 0; k < 4; ++k) {
    fails(3, {"info", names[k]}, {said[k]});
    succeeds({"generate", "constant", names[k], "--size", "4"});
    const Result r = envmap({"info", names[k]}), j = envmap({"info", names[k], "--json"});
    EXPECT_NE(r.out.find(said[k]), std::string::npos) << r.out;
    for (const char c : r.out + j.out) EXPECT_TRUE(c == '\n' || c < 0 || (c >= ' ' && c != 0x7f));
  }
}

// Before memory is taken: by a map in any format, by six files, by an environment and by textures.
TEST_F(Input, RefusesMorePixelsThanAreAllowed) {
  for (const char* name : {"a.exr", "a.hdr", "a.png", "a.dds"}) {
    succeeds({"generate", "constant", name, "--to", "latlong", "--size", "16"});
    succeeds({"convert", name, "same.exr", "--max-pixels", "1k"});
    fails(3, {"convert", name, "out.exr", "--max-pixels", "511"}, {name, "32x16", "--max-pixels"});
  }
  succeeds({"generate", "constant", "{face}.exr", "--to", "cube", "--size", "8"});
  succeeds({"generate", "constant", "a.ktx2", "--to", "cube", "--size", "8"});
  for (const char* name : {"{face}.exr", "a.ktx2"}) {
    succeeds({"convert", name, "same.exr", "--max-pixels", "384"});
    fails(3, {"convert", name, "out.exr", "--max-pixels", "383"}, {"--max-pixels"});
  }
  write("scene.obj",
        "mtllib m.mtl\nv 0 0 -1\nv 1 0 -1\nv 0 1 -1\nvt 0 0\nusemtl a\nf 1/1 2/1 3/1\nusemtl b\nf 1/1 2/1 3/1\n");
  write("m.mtl", "newmtl a\nmap_Kd a.png\nnewmtl b\nmap_Kd a.png\nmap_Ke px.exr\n");
  const std::vector<std::string> render{"render", "scene.obj", "out.exr", "--size",
                                        "2",      "--method",  "raycast", "--max-pixels"};
  const auto with = [&](const char* most) {
    std::vector<std::string> all = render;
    all.emplace_back(most);
    return all;
  };
  fails(3, with("575"), {"scene.obj", "px.exr", "8x8", "--max-pixels"});  // 32 x 16 and 8 x 8.
  EXPECT_EQ(envmap(with("576")).status, 0);
}

TEST_F(Input, RefusesShapesThatNoProjectionHas) {
  save(path("wide.hdr"), Picture::filled(1000, 600, 1));
  refuses("wide.hdr", {"1000x600"});
  refuses("wide.hdr", {"1000x600", "2:1"}, {"--from", "latlong"});
  refuses("wide.hdr", {"1000x600", "cube"}, {"--from", "cube"});
  save(path("square.pfm"), Picture::filled(8, 8, 1));
  refuses("square.pfm", {"8x8", "sphere", "angular", "octahedral", "equal-area", "--from"});
  refuses("square.pfm", {"8x8", "2:1"}, {"--from", "latlong"});
  for (const char* from : {"angular", "octahedral", "equal-area"})
    succeeds({"convert", "square.pfm", "out.exr", "--from", from});
}

TEST_F(Input, TakesOnePixelAsASphere) {
  save(path("one.pfm"), Picture::filled(1, 1, 1));
  write("none.pfm", "PF\n0 0\n-1.0\n");
  refuses("none.pfm", {});
  refuses("one.pfm", {"--from"});
  refuses("one.pfm", {"1x1"}, {"--from", "latlong"});
  succeeds({"convert", "one.pfm", "out.exr", "--from", "sphere", "--to", "latlong", "--size", "2"});
  EXPECT_LT(difference(load(path("out.exr")), Picture::filled(4, 2, 1)), 1e-6);
}

// An image that lies three texels further right in its display window: what it leaves free is black, and that is said.
TEST_F(Input, SaysThatAnImageIsPartOfTheSphere) {
  OIIO::ImageSpec spec;
  spec.x = 3;
  save(path("window.exr"), latlong_directions(4), OIIO::TypeDesc::FLOAT, spec);
  const Result r = envmap({"convert", "window.exr", "out.exr", "--filter", "nearest"});
  EXPECT_EQ(r.status, 0) << r.err;
  EXPECT_NE(r.err.find("window"), std::string::npos) << r.err;
  const Picture made = load(path("out.exr")), whole = latlong_directions(4);
  for (int x = 0; x < 8; ++x) EXPECT_EQ(*made.at(x, 1), x < 3 ? 0 : *whole.at(x - 3, 1)) << x;
}

TEST_F(Input, RefusesAHeaderThatPromisesMoreThanTheFileHolds) {
  // Believed, each would take gigabytes and many seconds before the lie shows.
  write("huge.pfm", "PF\n1000000000000 4\n-1.0\n");
  refuses("huge.pfm", {"1000000000000 in its header is out of range"});
  write("lie.pfm", "PF\n40000 20000\n-1.0\nabcd");
  write("lie.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 20000 +X 40000\nabcd");
  for (const char* name : {"lie.pfm", "lie.hdr"})
    fails(bad_input, {"convert", name, "out.exr", "--threads", "2"}, {name}, {.memory = std::uint64_t{3} << 30});
}

TEST_F(Input, NamesTheFaceThatIsMissingOrDiffers) {
  for (const char* face : {"px", "nx", "py", "ny", "pz"})
    save(path(std::string("f_") + face + ".exr"), Picture::filled(4, 4, 1));
  fails(bad_input, {"convert", "f_{face}.exr", "out.exr"}, {"f_nz.exr", "no such file"});
  save(path("f_nz.exr"), Picture::filled(5, 5, 1));
  fails(bad_input, {"convert", "f_{face}.exr", "out.exr"}, {"f_nz.exr", "5x5", "4x4"});
  save(path("f_nz.exr"), Picture::filled(4, 3, 1));
  fails(bad_input, {"convert", "f_{face}.exr", "out.exr"}, {"f_nz.exr", "4x3"});
  fails(usage, {"convert", "f_{face}.exr", "out.exr", "--from", "latlong"}, {"{face}"});
}

TEST_F(Input, JudgesBothMapsOfACompare) {
  save(path("a.exr"), latlong_directions(4));
  write("b.exr", "no image");
  fails(bad_input, {"compare", "a.exr", "b.exr"}, {"b.exr"});
  fails(bad_input, {"compare", "b.exr", "a.exr"}, {"b.exr"});
  fails(bad_input, {"preview", "a.exr", "b.exr", "out.png"}, {"b.exr"});
}

// ---- radiance that is none ------------------------------------------------------------------------------------------

class Flaws : public Input {
 protected:
  static constexpr float nan = std::numeric_limits<float>::quiet_NaN(),
                         infinity = std::numeric_limits<float>::infinity();

  void save_flawed(const std::string& name) const {
    Picture p = Picture::filled(8, 4, 2);
    p.at(5, 1)[1] = nan;
    p.at(2, 2)[0] = infinity;
    p.at(3, 2)[2] = -1;
    save(path(name), p);
  }
};

TEST_F(Flaws, AreRefusedWithTheFirstPlaceAndTheCount) {
  for (const char* name : {"flawed.exr", "flawed.pfm", "flawed.tif"}) {
    save_flawed(name);
    refuses(name, {"3 of 32", "(5,1)", "1 NaN", "1 infinite", "1 negative", "--repair"});
    fails(bad_input, {"compare", name, name}, {name, "(5,1)"});
  }
}

TEST_F(Flaws, AreFoundOneByOne) {
  for (const auto& [value, word] :
       {std::pair{nan, "1 NaN"}, {infinity, "1 infinite"}, {-infinity, "1 infinite"}, {-1e-30F, "1 negative"}}) {
    Picture p = Picture::filled(8, 4, 2);
    p.at(7, 3)[2] = value;
    save(path("one.exr"), p);
    refuses("one.exr", {"1 of 32", "(7,3)", word});
  }
}

TEST_F(Flaws, OfACubeAreFoundByFace) {
  Picture p = cube_directions("cross", 4);
  p.at(2 * 4 + 1, 4 + 3)[0] = nan;  // Face +X.
  p.at(4 + 2, 8 + 1)[0] = nan;      // Face -Y.
  save(path("cube.exr"), p);
  refuses("cube.exr", {"2 of 96", "(1,3)", "face 0"});
}

TEST_F(Flaws, AreRepairedFromTheirNeighbours) {
  save_flawed("flawed.exr");
  const Result r = envmap({"convert", "flawed.exr", "out.exr", "--repair"});
  EXPECT_EQ(r.status, 0);
  EXPECT_EQ(r.err, "flawed.exr: repaired 3 texels\n");
  Picture expected = Picture::filled(8, 4, 2);
  expected.at(3, 2)[2] = 0;
  // The hole's neighbours include the negative texel's blue, then 0.
  expected.at(2, 2)[2] = load(path("out.exr")).at(2, 2)[2];
  EXPECT_LE(difference(load(path("out.exr")), expected), 1e-6);
  EXPECT_GT(expected.at(2, 2)[2], 1.5F);
  EXPECT_EQ(envmap({"convert", "flawed.exr", "out.exr", "--repair", "--quiet"}).err, r.err)
      << "what changes the result is always said";
}

TEST_F(Flaws, AreLeftAloneOutsideTheDisc) {
  Picture p = Picture::filled(8, 8, 1);
  p.at(0, 0)[0] = nan;
  p.at(7, 7)[1] = -1;
  save(path("ball.exr"), p);
  succeeds({"convert", "ball.exr", "out.exr", "--from", "sphere", "--to", "latlong", "--size", "8"});
  EXPECT_LT(difference(load(path("out.exr")), Picture::filled(16, 8, 1)), 1e-6);
}

TEST_F(Flaws, OfAllTexelsCannotBeRepaired) {
  save(path("all.exr"), Picture::filled(8, 4, nan));
  refuses("all.exr", {"32 of 32", "(0,0)"});
  refuses("all.exr", {"repair"}, {"--repair"});
}

// ---- 4: an output was not written -----------------------------------------------------------------------------------

class Output : public CommandTest {
 protected:
  Output() { save(path("in.exr"), latlong_directions(8)); }
};

TEST_F(Output, WantsAFolderThatIsThere) {
  fails(not_written, {"convert", "in.exr", "missing/out.exr"}, {"missing/out.exr"});
  fails(not_written, {"convert", "in.exr", "in.exr/out.exr"}, {"in.exr/out.exr"});
  fails(not_written, {"generate", "sky", "missing/out.hdr", "--size", "4"}, {"missing/out.hdr"});
  for (const std::vector<std::string>& command : {std::vector<std::string>{"preview", "in.exr"},
                                                  {"view", "no.gltf"},
                                                  {"convert", "in.exr", "--to", "cylinder"}}) {
    std::vector<std::string> words = command;
    words.insert(words.begin() + 2, "missing/out.png");
    fails(not_written, words, {"missing/out.png: no such folder: missing"});
  }
  fails(not_written, {"convert", "in.exr", "/proc/out.exr"}, {"/proc/out.exr: cannot write into /proc"});
  fails(not_written, {"manual", "missing"}, {"missing"});
  std::filesystem::create_directory(path("folder.exr"));
  fails(not_written, {"convert", "in.exr", "folder.exr"}, {"folder.exr"});
}

TEST_F(Output, IsNotThereWithoutItsDepfile) {
  fails(not_written, {"convert", "in.exr", "out.exr", "--depfile", "missing/out.d"}, {"missing/out.d"});
  fails(not_written, {"convert", "in.exr", "out.exr", "--depfile", std::string(256, 'd')},
        {"ddd: not written: ", "too long"});
}

TEST_F(Output, LeavesNothingWhereOneOfSixFilesFails) {
  std::filesystem::create_directory(path("out_pz.exr"));
  fails(not_written, {"convert", "in.exr", "out_{face}.exr", "--to", "cube"}, {"out_pz.exr"});
}

TEST_F(Output, SaysThatADeviceIsFull) {
  fails(not_written, {"convert", "in.exr", "/dev/full", "--format", "exr"}, {"/dev/full", "No space left"});
  for (const char* command : {"convert in.exr -", "info in.exr", "compare in.exr in.exr --json", "completion", "--help",
                              "convert --help", "--version"}) {
    SCOPED_TRACE(command);
    const Result full = shell(std::string("\"$ENVMAP\" ") + command + " > /dev/full");
    EXPECT_EQ(full.status, not_written);
    EXPECT_NE(full.err.find("standard output"), std::string::npos) << full.err;
  }
}

TEST_F(Output, SaysThatStandardOutputIsClosed) {
  for (const char* command : {"convert in.exr -", "info in.exr", "completion"}) {
    SCOPED_TRACE(command);
    const Result closed = shell(std::string("\"$ENVMAP\" ") + command + " >&-");
    EXPECT_EQ(closed.status, not_written);
    EXPECT_NE(closed.err.find("standard output"), std::string::npos) << closed.err;
  }
}

TEST_F(Output, RefusesValuesThatAHalfDoesNotHold) {
  save(path("bright.exr"), Picture::filled(8, 4, 1e5F));
  fails(not_written, {"convert", "bright.exr", "out.exr", "--depth", "half"},
        {"out.exr", "32 texels", "65504", "--clamp"});
  succeeds({"convert", "bright.exr", "out.exr"});
  const Result r = envmap({"convert", "bright.exr", "out.exr", "--depth", "half", "--clamp"});
  EXPECT_EQ(r.status, 0);
  EXPECT_EQ(r.err, "out.exr: clamped 32 texels, 34.5% of the flux lost\n");
  EXPECT_EQ(load(path("out.exr")), Picture::filled(8, 4, 65504));
}

TEST_F(Output, RefusesValuesOverOneInPictures) {
  save(path("bright.exr"), Picture::filled(8, 4, 1.25F));
  for (const char* depth : {"uint8", "uint16"})
    for (const char* name : {"out.png", "out.tif"})
      fails(not_written, {"convert", "bright.exr", name, "--depth", depth}, {name, "32 texels", "--clamp"});
  const Result r = envmap({"convert", "bright.exr", "out.png", "--depth", "uint8", "--clamp"});
  EXPECT_EQ(r.status, 0);
  EXPECT_EQ(r.err, "out.png: clamped 32 texels, 20% of the flux lost\n");
  EXPECT_EQ(load(path("out.png")), Picture::filled(8, 4, 1));
}

TEST_F(Output, OfAnInterruptedRunLeavesNothing) {
  const std::vector<std::string> before = names();
  for (const int signal : {SIGTERM, SIGINT, SIGQUIT, SIGKILL}) {
    Background run(*this, {ENVMAP_PROGRAM, "convert", "in.exr", "out.exr", "--to", "cube", "--size", "2048", "--filter",
                           "area"});
    interrupt(run, signal, [&] { return run.writes_in(path("")) || names() != before; });
    EXPECT_EQ(names(), before);
  }
}

}  // namespace
}  // namespace command_tests::errors_test

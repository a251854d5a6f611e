// The files that commands read and write: formats, pipes, links, the same bytes every time.
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <numbers>
#include <stdexcept>
#include <thread>

#include "picture.h"
#include "run.h"

namespace command_tests::files_test {
namespace {

namespace fs = std::filesystem;

// ---- accuracy -------------------------------------------------------------------------------------------------------

// What is written within --max-error is read within it. Colours with a dark channel lose much of it to a shared
// exponent.
// ITU-R BT.2100-2, table 4; 203 cd/m^2 are 1.
double pq(double v) {
  const double p = std::pow(v, 1 / 78.84375);
  return 10000 / 203.0 * std::pow((p - 0.8359375) / (18.8515625 - 18.6875 * p), 1 / 0.1593017578125);
}

// Pictures of phones, and the same values as those of a screen of high range.
TEST_F(CommandTest, ReadsHeifAndAvifWhereOpenImageIODoes) {
  Picture p = Picture::filled(64, 32, 0.75);
  std::fill_n(p.at(0, 16), 64 * 16 * 3, 0.25F);
  int read_back = 0;
  for (const std::string file : {"in.heic", "in.avif"}) {
    if (!OIIO::ImageOutput::create(file)) continue;
    try {
      save(path(file), p, OIIO::TypeDesc::UINT8);
    } catch (const std::runtime_error&) {
      continue;  // libheif without an encoder.
    }
    succeeds({"convert", file, "out.exr", "--depth", "float"});
    const Picture out = load(path("out.exr"));
    EXPECT_EQ(out.width, 64);
    // IEC 61966-2-1, decoding; the compression loses something.
    EXPECT_NEAR(*out.at(20, 8), std::pow((0.75 + 0.055) / 1.055, 2.4), 0.02) << file;
    EXPECT_NEAR(*out.at(20, 24), std::pow((0.25 + 0.055) / 1.055, 2.4), 0.02) << file;
    ++read_back;
    std::string bytes = read(file);
    const std::size_t box = bytes.find("colrnclx");
    if (box == bytes.npos) continue;
    bytes[box + 10] = 0, bytes[box + 11] = 16;
    write("pq." + file, bytes);
    const nlohmann::json told = report({"info", "pq." + file});
    EXPECT_EQ(told["white_luminance"], 203) << file;
    EXPECT_NEAR(told["maximum"][0].get<double>(), pq(0.75), 0.1 * pq(0.75)) << file;
    EXPECT_EQ(told["claims"][0]["name"], "nclx");
    EXPECT_EQ(told["claims"][0]["outcome"], "honoured");
    bytes[box + 11] = 9;
    write("log." + file, bytes);
    fails(3, {"info", "log." + file}, {"nclx", "transfer 9", "not supported", "--input-space"});
  }
  if (read_back == 0) GTEST_SKIP() << "this OpenImageIO writes no HEIF";
}

TEST_F(CommandTest, GreyMayHaveAlpha) {
  save(path("grey.png"), Picture::filled(8, 4, 0.5F, 2));
  fails(3, {"info", "grey.png"}, {"--drop-channels"});
  EXPECT_EQ(report({"info", "grey.png", "--drop-channels"})["format"], "png");
}

TEST_F(CommandTest, FilesOfOneColourAreReadBack) {
  succeeds({"generate", "constant", "one.exr", "--size", "2048", "--compression", "dwab"});
  EXPECT_EQ(report({"info", "one.exr"})["maximum"][0], 1);
}

TEST_F(CommandTest, AReportAndADepfileAreNotMixed) {
  succeeds({"generate", "sky", "in.exr", "--size", "4"});
  fails(2, {"convert", "in.exr", "out.exr", "--json", "--depfile", "-"}, {"standard output"});
}

TEST_F(CommandTest, AChannelMayBeReadMoreThanOnce) {
  succeeds({"generate", "directions", "in.exr", "--size", "16", "--depth", "float"});
  succeeds({"convert", "in.exr", "out.exr", "--channels", "B,G,B", "--depth", "float"});
  const Picture in = load(path("in.exr")), out = load(path("out.exr"));
  for (int j = 0; j < in.height; ++j)
    for (int i = 0; i < in.width; ++i)
      for (const auto& [to, from] : {std::pair(0, 2), {1, 1}, {2, 2}}) EXPECT_EQ(out.at(i, j)[to], in.at(i, j)[from]);
}

TEST_F(CommandTest, MaxErrorHoldsInEveryChannelOfAFile) {
  succeeds({"generate", "gradient", "in.exr", "--size", "64", "--value", "1,0.01,0.1", "--value2", "0.3,2,0.02"});
  succeeds({"convert", "in.exr", "truth.exr", "--to", "cube", "--size", "8", "--filter", "area", "--depth", "float"});
  int written = 0, refused = 0;
  for (const std::vector<std::string>& file : std::vector<std::vector<std::string>>{
           {"a.hdr"}, {"a.ktx2", "--depth", "rgb9e5"}, {"a.ktx2", "--depth", "half"}, {"a.ktx2", "--depth", "bc6h"}})
    for (const std::string error : {"6e-4", "5e-3", "2e-2", "0.3"}) {
      std::vector<std::string> words{"convert", "in.exr"};
      words.insert(words.end(), file.begin(), file.end());
      words.insert(words.end(), {"--to", "cube", "--size", "8", "--max-error", error, "-q"});
      const Result made = envmap(words);
      ASSERT_TRUE(made.status == 0 || made.status == 1) << made.err;
      (made.status == 0 ? written : refused) += 1;
      if (made.status == 1) continue;
      EXPECT_EQ(envmap({"compare", file.front(), "truth.exr", "--from", "cube", "--max-error", error}).status, 0)
          << file.front() << " " << error;
    }
  EXPECT_GT(written, 4);
  EXPECT_GT(refused, 4);
}

// ---- the axis at the centre -----------------------------------------------------------------------------------------

// --forward is the axis of the output; what a file without metadata shows stays where it is.
TEST_F(CommandTest, AnotherAxisAtTheCentreKeepsDirections) {
  succeeds({"generate", "directions", "in.hdr", "--size", "32"});
  succeeds({"convert", "in.hdr", "out.exr", "--forward", "+x"});
  succeeds({"convert", "in.hdr", "latlong.exr", "--to", "latlong", "--forward", "-z"});
  succeeds({"prefilter", "in.hdr", "ggx.exr", "--lobe", "ggx", "--roughness", "0", "--to", "latlong", "--forward", "+x",
            "--size", "32", "-q"});
  for (const std::string file : {"out.exr", "latlong.exr", "ggx.exr"})
    EXPECT_EQ(envmap({"compare", file, "in.hdr", "--max-rms", "0.02"}).status, 0) << file;
  // A cube has no axis to choose: then it is the input's.
  succeeds({"convert", "in.hdr", "cube.exr", "--to", "cube", "--forward", "+x"});
  EXPECT_EQ(envmap({"compare", "cube.exr", "in.hdr", "--from-b", "latlong", "--max-rms", "0.02"}).status, 1);
}

TEST_F(CommandTest, AFileThatCannotHoldItsAxisSaysSo) {
  succeeds({"generate", "directions", "in.exr", "--size", "16"});
  for (const std::string file : {"a.hdr", "a.pfm", "a.dds"}) {
    const Result made = envmap({"convert", "in.exr", file, "--forward", "+x"});
    EXPECT_EQ(made.status, 0);
    EXPECT_NE(made.err.find(file + ": "), std::string::npos) << made.err;
    EXPECT_NE(made.err.find("--from-forward +x"), std::string::npos) << made.err;
    succeeds({"convert", file, "back.exr", "--from-forward", "+x", "--forward", "+z"});
    EXPECT_EQ(envmap({"compare", "back.exr", "in.exr", "--max-rms", "0.02"}).status, 0) << file;
  }
  for (const std::string file : {"a.exr", "a.ktx2", "a.png"})
    EXPECT_EQ(envmap({"convert", "in.exr", file, "--forward", "+x"}).err, "") << file;
  EXPECT_EQ(envmap({"convert", "in.exr", "plus_z.hdr"}).err, "");
  fails(2, {"convert", "in.exr", "a.exr", "--max-error", "1e-2", "--filter", "ewa"}, {"--max-error", "--filter"});
}

// ---- formats --------------------------------------------------------------------------------------------------------

struct Format {
  const char* name;
  const char* depth;  // Or null: nothing is asked.
  double error;       // Largest of a value between 0 and 1 that the format can be blamed for.
};

// Half: 11 bits. HDR: 8 bits below the power of two of the largest channel. Integers: half a step, stretched by the
// slope of the sRGB curve, at most 2.3.
constexpr Format formats[] = {{"map.exr", "float", 1e-7},      {"map.exr", "half", 0.00025},
                              {"map.hdr", nullptr, 1.0 / 256}, {"map.pfm", nullptr, 1e-7},
                              {"map.tif", "float", 1e-7},      {"map.tif", "uint16", 2e-5},
                              {"map.tif", "uint8", 0.0046},    {"map.png", "uint16", 2e-5},
                              {"map.png", "uint8", 0.0046}};

std::vector<std::string> generate(const Format& f, const std::string& kind = "directions") {
  std::vector<std::string> arguments{"generate", kind, f.name, "--size", "16"};
  if (f.depth) arguments.insert(arguments.end(), {"--depth", f.depth});
  return arguments;
}

class Formats : public CommandTest {};

// Relative difference of the flux of two latlong maps, the largest of the channels.
double flux_error(const Picture& a, const Picture& b) {
  Vec sum{}, reference{};
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x)
      for (std::size_t k = 0; k < 3; ++k) {
        const double weight = std::sin(std::numbers::pi * (y + 0.5) / a.height);
        sum[k] += weight * a.at(x, y)[k];
        reference[k] += weight * b.at(x, y)[k];
      }
  double largest = 0;
  for (std::size_t k = 0; k < 3; ++k) largest = std::max(largest, std::abs(sum[k] / reference[k] - 1));
  return largest;
}

TEST_F(Formats, ComeBackWithinTheirPrecision) {
  for (const Format& f : formats) {
    SCOPED_TRACE(std::string(f.name) + " " + (f.depth ? f.depth : ""));
    succeeds(generate(f));
    succeeds({"convert", f.name, "back.exr", "--depth", "float", "--filter", "nearest"});
    const Picture back = load(path("back.exr"));
    EXPECT_LT(difference(back, latlong_directions(16)), f.error);
    // Rounding errs both ways; a format that always rounds down would darken the map.
    EXPECT_LT(flux_error(back, latlong_directions(16)), 2e-3);
  }
}

TEST_F(Formats, OfFloatHoldRadianceAndOfIntegersTheSrgbCurve) {
  const auto encoded = [](float x) { return x <= 0.0031308F ? 12.92F * x : 1.055F * std::pow(x, 1 / 2.4F) - 0.055F; };
  Picture curved = latlong_directions(16);
  std::ranges::transform(curved.values, curved.values.begin(), encoded);
  for (const Format& f : {Format{"map.tif", "float", 1e-7}, {"map.tif", "uint16", 1e-5}, {"map.png", "uint8", 0.002}}) {
    SCOPED_TRACE(std::string(f.name) + " " + f.depth);
    succeeds(generate(f));
    EXPECT_LT(difference(load(path(f.name)), f.error > 1e-6 ? curved : latlong_directions(16)), f.error);
  }
}

TEST_F(Formats, PfmIsLittleEndianWithTheBottomRowFirst) {
  succeeds({"generate", "directions", "map.pfm", "--size", "2"});
  const std::string bytes = read("map.pfm"), header = "PF\n4 2\n-1.0\n";
  ASSERT_EQ(bytes.size(), header.size() + 4 * 2 * 3 * sizeof(float));
  EXPECT_EQ(bytes.substr(0, header.size()), header);
  const Picture expected = latlong_directions(2);
  std::array<float, 12> bottom;
  std::memcpy(bottom.data(), bytes.data() + header.size(), sizeof bottom);
  for (std::size_t k = 0; k < bottom.size(); ++k) EXPECT_NEAR(bottom.at(k), expected.at(0, 1)[k], 1e-6);
}

TEST_F(Formats, KeepTheDepthOfTheInput) {
  succeeds({"generate", "directions", "half.exr", "--size", "4", "--depth", "half"});
  succeeds({"convert", "half.exr", "same.exr"});
  succeeds({"convert", "half.exr", "wider.tif"});
  EXPECT_NE(envmap({"info", "same.exr"}).out.find("half"), std::string::npos);
  EXPECT_NE(envmap({"info", "wider.tif"}).out.find("float"), std::string::npos);
}

TEST_F(Formats, TakeGreyAsEqualRedGreenAndBlue) {
  Picture grey = Picture::filled(8, 4, 0.5, 1);
  OIIO::ImageSpec spec;
  spec.channelnames = {"Y"};
  save(path("grey.exr"), grey, OIIO::TypeDesc::FLOAT, spec);
  succeeds({"convert", "grey.exr", "out.exr"});
  EXPECT_EQ(load(path("out.exr")), Picture::filled(8, 4, 0.5));
}

// TIFF 6.0: of 3 the first row is at the bottom and the first column on the right: half a turn.
TEST_F(Formats, AreTurnedUpright) {
  Picture picture = latlong_directions(8);
  save(path("upright.tif"), picture);
  OIIO::ImageSpec spec;
  spec.attribute("Orientation", 3);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 16; ++x) std::swap_ranges(picture.at(x, y), picture.at(x, y) + 3, picture.at(15 - x, 7 - y));
  save(path("turned.tif"), picture, OIIO::TypeDesc::FLOAT, spec);
  succeeds({"convert", "upright.tif", "a.exr", "--size", "8"});
  succeeds({"convert", "turned.tif", "b.exr", "--size", "8"});
  EXPECT_EQ(difference(load(path("a.exr")), load(path("b.exr"))), 0);
}

// XPosition and YPosition of TIFF say where its texels lie in an image whose size Pixar's tags tell.
TEST_F(Formats, TiffHasADataWindowAsExrHas) {
  const Picture whole = latlong_directions(16);
  Picture part = Picture::filled(12, 10);
  for (int j = 0; j < 10; ++j) std::copy(whole.at(5, j + 3), whole.at(17, j + 3), part.at(0, j));
  OIIO::ImageSpec spec(12, 10, 3, OIIO::TypeDesc::FLOAT);
  spec.x = 5, spec.y = 3, spec.full_width = 32, spec.full_height = 16;
  for (const int rows : {0, 16}) {  // In lines, or in tiles.
    spec.tile_width = spec.tile_height = rows, spec.tile_depth = rows > 0 ? 1 : 0;
    const auto out = OIIO::ImageOutput::create("w.tif");
    ASSERT_TRUE(out && out->open(path("w.tif"), spec) && out->write_image(OIIO::TypeDesc::FLOAT, part.values.data()) &&
                out->close());
    const Result r = envmap({"convert", "w.tif", "out.pfm", "--from", "latlong"});
    EXPECT_EQ(r.status, 0) << r.err;
    EXPECT_NE(r.err.find("what is missing is black"), r.err.npos) << r.err;
    const Picture read = load(path("out.pfm"));
    ASSERT_EQ(read.width, 32);
    for (int j = 0; j < 16; ++j)
      for (int i = 0; i < 32; ++i) {
        const bool there = i >= 5 && i < 17 && j >= 3 && j < 13;
        for (int c = 0; c < 3; ++c) EXPECT_EQ(read.at(i, j)[c], there ? whole.at(i, j)[c] : 0) << i << ' ' << j;
      }
  }
  // As a map of its own: a cube of 6 rows by 1.
  spec.width = spec.full_width = 1, spec.height = 6, spec.full_height = 16, spec.tile_width = spec.tile_height = 0;
  const Picture faces = Picture::filled(1, 6, 0.5F);
  const auto out = OIIO::ImageOutput::create("w.tif");
  ASSERT_TRUE(out && out->open(path("w.tif"), spec) && out->write_image(OIIO::TypeDesc::FLOAT, faces.values.data()) &&
              out->close());
  EXPECT_EQ(envmap({"convert", "w.tif", "out.exr", "--crop"}).status, 0);
  EXPECT_EQ(load(path("out.exr")), faces);
  save(path("a.hdr"), whole);
  fails(2, {"convert", "a.hdr", "b.exr", "--crop"}, {"a.hdr", "EXR and TIFF"});
}

TEST_F(Formats, GoThroughPipes) {
  succeeds({"generate", "directions", "in.exr", "--size", "8"});
  const std::string in = envmap({"info", "in.exr"}).out, facts = in.substr(in.find("projection"));
  const Result r = shell("\"$ENVMAP\" convert in.exr - | \"$ENVMAP\" info -");
  EXPECT_EQ(r.status, 0) << r.err;
  EXPECT_EQ(r.out.substr(r.out.find("projection")), facts);
  EXPECT_NE(r.out.find("openexr float, 16x8"), std::string::npos) << r.out;
  for (const std::string format : {"exr", "hdr", "pfm", "tif", "png"}) {
    SCOPED_TRACE(format);
    const Result piped = shell("\"$ENVMAP\" convert in.exr - --format " + format + " | \"$ENVMAP\" convert - back.exr");
    EXPECT_EQ(piped.status, 0) << piped.err;
    EXPECT_LT(difference(load(path("back.exr")), latlong_directions(8)), 1.0 / 127);
  }
  EXPECT_EQ(names(), (std::vector<std::string>{"back.exr", "in.exr"}));
}

TEST_F(Formats, AreKnownByTheirBytesNotByTheName) {
  for (const char* format : {"exr", "hdr", "pfm", "tif", "png", "jpg", "bmp", "webp", "ppm"}) {
    SCOPED_TRACE(format);
    const std::string name = std::string("map.") + format;
    succeeds({"generate", "constant", name, "--size", "8"});
    write("renamed.tga", read(name));
    succeeds({"info", "renamed.tga"});
  }
  succeeds({"generate", "constant", "map.tga", "--size", "8"});  // But for this, which has no mark.
  succeeds({"info", "map.tga"});
}

TEST_F(Formats, AreReadFromANamedPipe) {
  succeeds({"generate", "directions", "in.exr", "--size", "8"});
  const Result r = shell("mkfifo pipe && { cat in.exr >pipe & \"$ENVMAP\" info pipe; }");
  EXPECT_EQ(r.status, 0) << r.err;
  EXPECT_NE(r.out.find("openexr float, 16x8"), std::string::npos) << r.out;
}

TEST_F(Formats, WrittenToAPipeAreTheBytesOfTheFile) {
  for (const std::string format : {"exr", "hdr", "pfm", "tif", "png"}) {
    SCOPED_TRACE(format);
    succeeds({"generate", "directions", "map." + format, "--size", "8"});
    EXPECT_EQ(envmap({"generate", "directions", "-", "--size", "8", "--format", format}).out, read("map." + format));
  }
}

// ---- the same bytes every time --------------------------------------------------------------------------------------

class SameBytes : public CommandTest {};

TEST_F(SameBytes, AtAnotherTime) {
  const auto write_all = [&] {
    for (const Format& f : formats) {
      Format one = f;
      const std::string name = std::string(f.depth ? f.depth : "plain") + "_" + f.name;
      one.name = name.c_str();
      succeeds(generate(one));
    }
    succeeds({"preview", "plain_map.hdr", "preview.png"});
    return files();
  };
  const auto first = write_all();
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));
  EXPECT_TRUE(write_all() == first) << "a file changed from one second to the next";

  char host[256] = {};
  ASSERT_EQ(::gethostname(host, sizeof host - 1), 0);
  for (const auto& [name, bytes] : first) {
    // A short name may be in any file by chance.
    if (std::strlen(host) >= 5) {
      EXPECT_EQ(bytes.find(host), std::string::npos) << name << " holds the name of the host";
    }
    EXPECT_EQ(bytes.find(path("")), std::string::npos) << name << " holds a path";
  }
}

// ---- where outputs appear -------------------------------------------------------------------------------------------

class Places : public CommandTest {
 protected:
  Places() { save(path("in.exr"), latlong_directions(4)); }
};

TEST_F(Places, AnOldOutputIsReplaced) {
  write("out.exr", "old");
  succeeds({"convert", "in.exr", "out.exr", "--filter", "nearest"});
  EXPECT_EQ(load(path("out.exr")), latlong_directions(4));
  EXPECT_EQ(names(), (std::vector<std::string>{"in.exr", "out.exr"}));
}

TEST_F(Places, NoFileIsReadAndWritten) {
  fs::create_symlink("in.exr", path("link.exr"));
  fs::create_hard_link(path("in.exr"), path("hard.exr"));
  fs::copy_file(path("in.exr"), path("other.exr"));
  for (const char* output : {"in.exr", "./in.exr", "link.exr", "hard.exr"})
    fails(2, {"convert", "in.exr", output, "--to", "cube", "--size", "4"}, {output, "both input and output"});
  fails(2, {"mipmap", "in.exr", "in.exr"}, {"in.exr"});
  fails(2, {"convert", "in.exr", "out.exr", "--depfile", "in.exr"}, {"in.exr"});
  fails(2, {"convert", "in.exr", "out.exr", "--depfile", "./out.exr"}, {"out.exr", "twice"});
  fails(2, {"compare", "in.exr", "other.exr", "--difference", "other.exr"}, {"other.exr"});
  fails(2, {"preview", "in.exr", "in.png", "--depfile", "in.png"}, {"in.png"});
  fails(2, {"sh", "in.exr", "--evaluate", "in.exr"}, {"in.exr"});
}

TEST_F(Places, LinksAreKept) {
  fs::create_directory(path("store"));
  write("store/real.exr", "old");
  fs::create_symlink("store/real.exr", path("link.exr"));
  fs::create_symlink("store/new.exr", path("dangling.exr"));
  for (const char* name : {"link.exr", "dangling.exr"}) {
    succeeds({"convert", "in.exr", name, "--filter", "nearest"});
    EXPECT_TRUE(fs::is_symlink(path(name)));
    EXPECT_EQ(load(path(name)), latlong_directions(4));
  }
  EXPECT_EQ(names(), (std::vector<std::string>{"dangling.exr@", "in.exr", "link.exr@", "store/", "store/new.exr",
                                               "store/real.exr"}));
}

TEST_F(Places, NamesWithOddCharactersWork) {
  const std::string name = "a b'c$d#e\xc3\xa9.exr";
  succeeds({"convert", "in.exr", name, "--filter", "nearest"});
  EXPECT_EQ(load(path(name)), latlong_directions(4));
}

TEST_F(Places, NamesAsLongAsTheyCanBe) {
  const std::string longest = std::string(251, 'x') + ".exr";
  for (int k = 0; k < 2; ++k) succeeds({"generate", "sky", longest, "--size", "4"});
  EXPECT_EQ(names(), (std::vector<std::string>{"in.exr", longest}));
}

TEST_F(Places, WhatIsReplacedKeepsWhoMayReadIt) {
  succeeds({"generate", "sky", "a.exr", "--size", "4"});
  fs::permissions(path("a.exr"), fs::perms(0640));
  succeeds({"generate", "sky", "a.exr", "--size", "8"});
  EXPECT_EQ(fs::status(path("a.exr")).permissions(), fs::perms(0640));
}

// The bits decide, as tests and containers run as root, who may write all.
TEST_F(Places, ReadOnlyFilesAreReplacedByForceAlone) {
  for (const char* name : {"a.exr", "a.hdr", "a.d"}) write(name, "checked in");
  for (const char* name : {"a.exr", "a.hdr", "a.d"}) fs::permissions(path(name), fs::perms(0444));
  fs::create_symlink("a.exr", path("link.exr"));
  for (const char* name : {"a.exr", "a.hdr", "link.exr"})
    fails(4, {"convert", "in.exr", name}, {name, "read-only", "--force"});
  fails(4, {"convert", "in.exr", "b.exr", "--depfile", "a.d"}, {"a.d", "read-only"});
  fails(4, {"convert", "in.exr", "a.exr", "--if-changed"}, {"a.exr", "read-only"});
  succeeds({"convert", "in.exr", "a.exr", "--filter", "nearest", "--force"});
  EXPECT_EQ(load(path("a.exr")), latlong_directions(4));
  EXPECT_EQ(fs::status(path("a.exr")).permissions(), fs::perms(0444));
  succeeds({"convert", "in.exr", "a.exr", "--filter", "nearest", "--if-changed"});  // It would stay as it is.
}

TEST_F(Places, WhatIsReplacedKeepsItsOwner) {
  if (::geteuid() != 0) GTEST_SKIP() << "another owner needs root";
  write("a.exr", "old");
  ASSERT_EQ(::chown(path("a.exr").c_str(), 12345, 54321), 0);
  succeeds({"convert", "in.exr", "a.exr"});
  struct stat now = {};
  ASSERT_EQ(::stat(path("a.exr").c_str(), &now), 0);
  EXPECT_EQ(now.st_uid, 12345U);
  EXPECT_EQ(now.st_gid, 54321U);
}

TEST_F(Places, ALoopOfLinksIsNoPlace) {
  fs::create_symlink("b.exr", path("a.exr"));
  fs::create_symlink("a.exr", path("b.exr"));
  fails(4, {"convert", "in.exr", "a.exr"}, {"a.exr", "symbolic links"});
}

TEST_F(Places, TheTemporaryFolderIsNamedWhereItIsMissing) {
  const Result r = shell("TMPDIR=/nonexistent \"$ENVMAP\" generate sky - --size 4");
  EXPECT_EQ(r.status, 4);
  EXPECT_NE(r.err.find("/nonexistent"), std::string::npos) << r.err;
  EXPECT_NE(r.err.find("TMPDIR"), std::string::npos) << r.err;
}

// What is no image is refused at its first bytes, however much follows.
TEST_F(Places, EndlessInputThatIsNoImageIsRefused) {
  const Result r = shell("\"$ENVMAP\" info - </dev/zero");
  EXPECT_EQ(r.status, 3);
  EXPECT_NE(r.err.find("not an image"), std::string::npos) << r.err;
  EXPECT_EQ(shell("yes | \"$ENVMAP\" info -").status, 3);
}

// From a file the bytes are read where they are wanted, from where the shell left them.
TEST_F(Places, StandardInputMayBeAFileOrAPipe) {
  for (const char* name : {"a.exr", "a.hdr", "a.png", "a.ktx2"}) {
    succeeds({"generate", "directions", name, "--size", "16"});
    const std::string info = std::string("\"$ENVMAP\" info - ");
    const Result file = shell(info + "<" + name), pipe = shell("cat " + std::string(name) + " | " + info);
    const Result later = shell("(printf 12345; cat " + std::string(name) +
                               ") >b; (dd bs=1 count=5 of=/dev/null 2>/dev/null; " + info + ") <b");
    EXPECT_EQ(file.status, 0) << file.err;
    EXPECT_EQ(file.out, pipe.out);
    EXPECT_EQ(file.out, later.out) << later.err;
  }
}

TEST_F(Places, OutputsHaveTheUsualPermissions) {
  ASSERT_EQ(shell("umask 027; \"$ENVMAP\" convert in.exr out.exr").status, 0);
  EXPECT_EQ(fs::status(path("out.exr")).permissions(),
            fs::perms::owner_read | fs::perms::owner_write | fs::perms::group_read);
}

// A new file has another inode, whatever the clock.
TEST_F(Places, AnUnchangedOutputStaysAsItIs) {
  const auto inode = [&](const char* name) { return shell(std::string("stat -c %i ") + name).out; };
  for (const char* name : {"out.exr", "out.png", "d.d"}) {
    SCOPED_TRACE(name);
    const std::vector<std::string> make{"generate", "sky", name, "--size", "8", "--if-changed"};
    if (std::string(name) == "d.d") {
      succeeds({"convert", "in.exr", "x.exr", "--depfile", "d.d"});
      const std::string before = inode(name);
      succeeds({"convert", "in.exr", "x.exr", "--depfile", "d.d", "--if-changed"});
      EXPECT_EQ(inode(name), before);
      continue;
    }
    succeeds(make);
    const std::string before = inode(name);
    succeeds(make);
    EXPECT_EQ(inode(name), before);
    // One bit of the last byte, then one byte less.
    std::string bytes = read(name), whole = bytes;
    bytes.back() = static_cast<char>(bytes.back() ^ 1);
    for (const std::string& other : {bytes, whole.substr(0, whole.size() - 1)}) {
      write(name, other);
      succeeds(make);
      EXPECT_EQ(read(name), whole);
    }
  }
}

TEST_F(Places, OutputsAreOnTheDiskWhereThatIsAskedFor) {
  succeeds({"convert", "in.exr", "out.exr", "--fsync"});
  EXPECT_EQ(load(path("out.exr")), latlong_directions(4));
  if (shell("strace -o /dev/null true").status != 0) GTEST_SKIP() << "strace cannot be run";
  const auto count = [&](const std::string& more) {
    (void)shell("strace -f -e trace=fsync,fdatasync -o trace \"$ENVMAP\" convert in.exr out.exr " + more);
    const std::string lines = read("trace");
    std::size_t n = 0;
    for (std::size_t at = 0; (at = lines.find("sync(", at)) != std::string::npos; ++at) ++n;
    return n;
  };
  EXPECT_EQ(count(""), 0U);
  EXPECT_EQ(count("--fsync"), 3U);  // Its bytes, its name, the folder.
}

TEST_F(Places, StandardOutputByNameIsNotReplaced) {
  succeeds({"generate", "sky", "in.exr", "--size", "4"});
  EXPECT_EQ(shell("echo kept > log; \"$ENVMAP\" convert in.exr out.exr --depfile /dev/stdout >> log").status, 0);
  EXPECT_EQ(read("log"), "kept\nout.exr: in.exr\nin.exr:\n");
}

TEST_F(Places, StandardOutputTakesPictures) {
  succeeds({"preview", "in.exr", "a.png"});
  ASSERT_EQ(shell("\"$ENVMAP\" preview - - <in.exr >b.png").status, 0);
  EXPECT_EQ(load(path("b.png")).width, load(path("a.png")).width);
}

TEST_F(Places, StandardInputIsReadOnce) {
  fails(2, {"compare", "-", "-"}, {"standard input", "once"});
  fails(2, {"render", "-", "out.exr", "--environment", "-"}, {"standard input"});
  const Result r = shell("\"$ENVMAP\" convert missing.exr - 2>/dev/null | \"$ENVMAP\" info -");
  EXPECT_EQ(r.status, 3);
  EXPECT_NE(r.err.find("may have failed"), std::string::npos) << r.err;
}

// ---- memory and compression ----------------------------------------------------------------------------------------

class Memory : public CommandTest {};

TEST_F(Memory, ALimitOnMemoryChangesNoByte) {
  succeeds({"generate", "sky", "sky.exr", "--size", "1300", "--depth", "half"});  // 40 MB as it is worked on.
  for (const std::string to : {"cube", "sphere"})
    for (const std::string size : {"150", "700"}) {  // By the area filter, and by the bilinear one.
      succeeds({"convert", "sky.exr", "free.exr", "--to", to, "--size", size});
      succeeds({"convert", "sky.exr", "held.exr", "--to", to, "--size", size, "--max-memory", "64M"});
      EXPECT_EQ(read("free.exr"), read("held.exr")) << to << " " << size;
    }
  succeeds({"mipmap", "sky.exr", "free.exr"});
  succeeds({"mipmap", "sky.exr", "held.exr", "--max-memory", "64M"});
  EXPECT_EQ(read("free.exr"), read("held.exr"));
  for (const std::string from : {"sky.exr", "cube.exr"}) {
    if (from == "cube.exr") succeeds({"convert", "sky.exr", from, "--to", "cube", "--size", "700"});
    for (const std::string lobe : {"ggx", "charlie", "diffuse"}) {
      std::vector<std::string> job{"prefilter", from, "free.exr", "--lobe", lobe, "--size", "8", "-q"};
      if (lobe != "diffuse") job.insert(job.end(), {"--roughness", "0.25"});
      succeeds(job);
      job[2] = "held.exr", job.insert(job.end(), {"--max-memory", "64M"});
      succeeds(job);
      EXPECT_TRUE(read("free.exr") == read("held.exr")) << from << " " << lobe;
    }
  }
  fails(2, {"convert", "sky.exr", "none.exr", "--filter", "sat", "--max-memory", "64M"}, {"sat", "--max-memory"});
  fails(2, {"convert", "sky.exr", "none.exr", "--max-memory", "64X"}, {"--max-memory"});
  fails(2, {"convert", "sky.exr", "none.exr", "--max-memory", "1M"}, {"from 64M", "not 1M"});
  const Result nowhere = shell("TMPDIR=/nowhere \"$ENVMAP\" convert sky.exr none.exr --to cube --max-memory 64M");
  EXPECT_EQ(nowhere.status, 4);
  EXPECT_NE(nowhere.err.find("/nowhere"), std::string::npos) << nowhere.err;
  EXPECT_FALSE(files().contains("none.exr"));
}

TEST_F(Memory, CompressionIsChosen) {
  succeeds({"generate", "sun", "sun.exr", "--size", "64"});
  succeeds({"convert", "sun.exr", "none.exr", "--compression", "none"});
  for (const std::string kind : {"rle", "zips", "zip", "zip:9", "piz", "pxr24"}) {
    succeeds({"convert", "sun.exr", "small.exr", "--compression", kind});
    EXPECT_LE(read("small.exr").size(), read("none.exr").size() / (kind == "rle" ? 1 : 2)) << kind;
    succeeds({"compare", "small.exr", "none.exr", "--max-error", kind == "pxr24" ? "1e-4" : "0"});
  }
  for (const std::string kind : {"zip:0", "zip:10", "best", "piz:3", "dwaa:", "dwaa:x"})
    fails(2, {"convert", "sun.exr", "small.exr", "--compression", kind}, {"compression", "zip:9"});
  fails(2, {"convert", "sun.exr", "small.hdr", "--compression", "piz"}, {".exr"});
}

}  // namespace
}  // namespace command_tests::files_test

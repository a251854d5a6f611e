// Mip levels in files, judged from outside: read by OpenImageIO, weighed by formulae of the test's own.
#include <OpenImageIO/imageio.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "picture.h"
#include "run.h"

namespace command_tests::mipmap_test {
namespace {

constexpr double pi = std::numbers::pi;

Picture load_level(const std::string& path, int level) {
  const auto input = OIIO::ImageInput::open(path);
  if (!input || !input->seek_subimage(0, level)) return {};
  const OIIO::ImageSpec spec = input->spec();
  Picture p = Picture::filled(spec.width, spec.height, 0, 3);
  input->read_image(0, level, 0, 3, OIIO::TypeDesc::FLOAT, p.values.data());
  return p;
}

int count_levels(const std::string& path) {
  const auto input = OIIO::ImageInput::open(path);
  int levels = 0;
  while (input && input->seek_subimage(0, levels)) ++levels;
  return levels;
}

// Red x solid angle over a latlong image of any shape.
double latlong_flux(const Picture& p) {
  double sum = 0;
  for (int y = 0; y < p.height; ++y) {
    const double band = std::cos(pi * y / p.height) - std::cos(pi * (y + 1) / p.height);
    for (int x = 0; x < p.width; ++x) sum += 2 * pi / p.width * band * p.at(x, y)[0];
  }
  return sum;
}

// The same over the faces of a column, n texels wide. The integral from a face's centre to (s,t) is
// atan(s t / sqrt(1 + s^2 + t^2)).
double cube_flux(const Picture& p, int n) {
  const auto corner = [&](int i, int j) {
    const double s = 2.0 * i / n - 1, t = 2.0 * j / n - 1;
    return std::atan(s * t / std::sqrt(1 + s * s + t * t));
  };
  double sum = 0;
  for (int face = 0; face < 6; ++face)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i)
        sum += p.at(i, face * n + j)[0] * (corner(i + 1, j + 1) - corner(i, j + 1) - corner(i + 1, j) + corner(i, j));
  return sum;
}

class Mipmap : public CommandTest {};

TEST_F(Mipmap, KeepTheLightOfASunAtAPoleAndAtACorner) {
  for (const int size : {32, 45}) {
    const std::string n = std::to_string(size);
    Picture latlong = Picture::filled(2 * size, size, 1);
    latlong.at(3, 0)[0] = 1e6F;
    save(path("latlong.exr"), latlong);
    succeeds({"mipmap", "latlong.exr", "out.exr"});
    int w = 2 * size, h = size;
    for (int k = 0; k < count_levels(path("out.exr")); ++k, w = std::max(1, w / 2), h = std::max(1, h / 2)) {
      const Picture level = load_level(path("out.exr"), k);
      EXPECT_EQ(level.width, w);
      EXPECT_EQ(level.height, h);
      EXPECT_NEAR(latlong_flux(level) / latlong_flux(latlong), 1, 1e-6) << "level " << k;
    }
    EXPECT_EQ(w * h, 1);

    Picture cube = Picture::filled(size, 6 * size, 1);
    cube.at(0, 2 * size)[0] = 1e6F;  // A corner of the +Y face.
    save(path("cube.exr"), cube);
    succeeds({"mipmap", "cube.exr", "out.exr"});
    for (int k = 0, face = size; face >= 1; ++k, face /= 2) {
      const Picture level = load_level(path("out.exr"), k);
      EXPECT_EQ(level.width, face);
      EXPECT_EQ(level.height, (6 * size) >> k);
      EXPECT_NEAR(cube_flux(level, face) / cube_flux(cube, size), 1, 1e-6) << "level " << k;
    }
    // OpenEXR goes on where there is no place for faces: with their mean.
    const int last = count_levels(path("out.exr")) - 1;
    EXPECT_EQ(load_level(path("out.exr"), last).width, 1);
    EXPECT_EQ(load_level(path("out.exr"), last).height, 1);
    EXPECT_NEAR(4 * pi * load_level(path("out.exr"), last).values[0] / cube_flux(cube, size), 1, 1e-6);
  }
}

TEST_F(Mipmap, AreNoMoreThanTheSizeHas) {
  succeeds({"generate", "sky", "in.exr", "--size", "8"});
  const std::vector<std::string> roughnesses{"--lobe", "ggx", "--roughnesses", "0.5,0.6,0.7,0.8", "--size", "4", "-q"};
  const auto prefilter = [&](const std::string& name) {
    std::vector<std::string> words{"prefilter", "in.exr", name};
    words.insert(words.end(), roughnesses.begin(), roughnesses.end());
    return words;
  };
  fails(2, prefilter("out.ktx2"), {"--size 4 has at most 3 levels, not 4"});
  succeeds(prefilter("out_{level}.exr"));
}

TEST_F(Mipmap, AreReadFromEveryKindOfFile) {
  succeeds({"generate", "sky", "in.exr", "--to", "cube", "--size", "24"});
  succeeds({"mipmap", "in.exr", "chain.exr", "--levels", "3"});
  for (const std::string name :
       {"chain.exr", "chain.ktx2", "chain.dds", "chain_{level}.pfm", "chain_{level}_{face}.exr"}) {
    SCOPED_TRACE(name);
    if (name != "chain.exr") succeeds({"mipmap", "chain.exr", name, "--keep", "--levels", "3", "--depth", "float"});
    succeeds({"compare", name, "chain.exr", "--level", "2", "--max-error", "0"});
    fails(3, {"info", name, "--level", "3"}, {"0 to 2"});
    succeeds({"compare", name, "chain.exr", "--max-error", "0"});  // All levels.
    const Result r = envmap({"info", name, "--levels", "--json"});
    const auto facts = nlohmann::json::parse(r.out);
    EXPECT_EQ(facts["levels"], 3);
    EXPECT_EQ(facts["level_table"].size(), 3U);
    EXPECT_EQ(facts["level_table"][2]["face_width"], 6);
    for (const auto& level : facts["level_table"])
      for (const auto& channel : level["flux_difference"]) EXPECT_LT(std::abs(channel.get<double>()), 1e-6);
  }
}

TEST_F(Mipmap, InFilesOfTheirOwnAreOfOneMap) {
  succeeds({"generate", "sky", "sky_0.exr", "--size", "8"});
  succeeds({"generate", "sky", "sky_1.exr", "--size", "8"});
  fails(3, {"info", "sky_{level}.exr", "--level", "1"}, {"sky_1.exr", "16x8", "level 1 is 8x4"});
  succeeds({"convert", "sky_0.exr", "sky_1.exr", "--size", "4", "--output-space", "ACEScg"});
  fails(3, {"info", "sky_{level}.exr", "--level", "1"}, {"sky_1.exr", "ACEScg"});
  // Textures, too, which could hold all levels.
  succeeds({"mipmap", "sky_0.exr", "one_{level}.ktx2"});
  EXPECT_EQ(report({"info", "one_{level}.ktx2"})["levels"], 5);
}

TEST_F(Mipmap, ReplaceNoInput) {
  for (const std::string name : {"sky_1.exr", "sky_0.exr"}) succeeds({"generate", "sky", name, "--size", "4"});
  fails(2, {"mipmap", "sky_1.exr", "sky_{level}.exr"}, {"sky_1.exr", "is both input and output"});
  fails(2, {"mipmap", "sky_0.exr", "out_{level}.exr", "--depfile", "out_1.exr"}, {"out_1.exr", "written twice"});
}

TEST_F(Mipmap, LeaveFilesOfOtherLevelsAlone) {
  succeeds({"generate", "sky", "in.exr", "--size", "2"});
  write("out_9.exr", "kept");
  std::filesystem::permissions(path("out_9.exr"), std::filesystem::perms(0444));
  succeeds({"mipmap", "in.exr", "out_{level}.exr"});
  EXPECT_EQ(read("out_9.exr"), "kept");
}

TEST_F(Mipmap, OfLuminanceAndChromaAreOneLevel) {
  if (shell("oiiotool --pattern constant:color=.2,.4,.6 32x16 3 -d half --tile 16 16 --chnames Y,RY,BY -otex in.exr")
          .status != 0)
    GTEST_SKIP() << "no oiiotool";
  if (envmap({"info", "in.exr"}).status == 3) GTEST_SKIP() << "this OpenEXR refuses chroma in tiles";
  EXPECT_NEAR(report({"info", "in.exr"})["maximum"][0].get<double>(), 0.2 * 1.4, 1e-3);
  fails(3, {"info", "in.exr", "--level", "1"}, {"has no level 1"});
}

TEST_F(Mipmap, OfALobeDoNotBecomePlainUnnoticed) {
  succeeds({"generate", "sky", "in.exr", "--to", "cube", "--size", "16"});
  succeeds({"prefilter", "in.exr", "ggx.ktx2", "--lobe", "ggx", "--levels", "3", "-q"});
  succeeds({"mipmap", "ggx.ktx2", "kept.ktx2", "--keep"});
  EXPECT_EQ(report({"info", "kept.ktx2"})["levels"], 3);
  const auto says = [&](const std::vector<std::string>& arguments, const std::string& words) {
    EXPECT_NE(envmap(arguments).err.find("ggx.ktx2: has 3 levels" + words), std::string::npos) << words;
  };
  says({"mipmap", "ggx.ktx2", "out.ktx2"}, " of ggx, and plain levels replace them: use --keep");
  says({"mipmap", "ggx.ktx2", "out.ktx2", "--keep", "--levels", "4"}, " of ggx, and plain levels follow them");
  says({"prefilter", "ggx.ktx2", "out.ktx2"}, " of ggx, and only level 0 is filtered");
  says({"convert", "ggx.ktx2", "out.exr"}, ", and only level 0 is converted: use --level 0 to confirm, or 'envmap mip");
  succeeds({"mipmap", "ggx.ktx2", "out.ktx2", "--level", "0"});
}

TEST_F(Mipmap, OfOneFileEachAreNamedInTheDepfile) {
  succeeds({"generate", "sky", "in.exr", "--to", "cube", "--size", "4"});
  succeeds({"mipmap", "in.exr", "out_{level}.hdr", "--depfile", "out.d"});
  EXPECT_EQ(read("out.d"), "out_0.hdr out_1.hdr out_2.hdr: in.exr\nin.exr:\n");
  EXPECT_EQ(names(), (std::vector<std::string>{"in.exr", "out.d", "out_0.hdr", "out_1.hdr", "out_2.hdr"}));
}

TEST_F(Mipmap, OfPlainWeightsLoseLight) {
  Picture cube = Picture::filled(32, 192, 0);
  cube.at(0, 0)[0] = 1e6F;
  save(path("cube.exr"), cube);
  succeeds({"mipmap", "cube.exr", "plain.exr", "--weights", "uniform"});
  EXPECT_EQ(envmap({"compare", "plain.exr", "cube.exr", "--max-flux", "0.1"}).status, 1);
  EXPECT_NEAR(load_level(path("plain.exr"), 5).values[0], 1e6 / 1024, 0.1);  // As glGenerateMipmap has it.
}

TEST_F(Mipmap, NeedAPlaceInTheFile) {
  succeeds({"generate", "sky", "in.exr", "--size", "4"});
  fails(2, {"mipmap", "in.exr", "out.hdr"}, {"out.hdr", "{level}"});
  fails(2, {"info", "in.exr", "--levels", "--level", "1"}, {"--level"});
  fails(3, {"info", "in.exr", "--level", "1"}, {"in.exr", "level 1"});
  fails(3, {"info", "none_{level}.exr"}, {"none_0.exr", "no such file"});
  succeeds({"mipmap", "in.exr", "out.hdr", "--levels", "1"});
}

// ---- OpenEXR's own convention: samples on the border ----------------------------------------------------------------

// The largest angle between what a latlong or cube image shows and where it lies, in texels; samples on the border or
// at the centres of cells. Near the poles of a latlong image a filter may blur: `margin` rows are left out.
double worst_direction(const Picture& p, bool border, int margin = 0) {
  double worst = 0;
  const bool cube = p.height == 6 * p.width;
  const int n = cube ? p.width : p.height;
  const auto place = [&](int i, int count) { return border ? i / (count - 1.0) : (i + 0.5) / count; };
  for (int y = margin; y < p.height - margin; ++y)
    for (int x = 0; x < p.width; ++x) {
      Vec d;
      if (cube) {
        const double s = 2 * place(x, n) - 1, t = 1 - 2 * place(y % n, n);
        const Vec faces[] = {{1, t, s}, {-1, t, -s}, {s, 1, t}, {s, -1, -t}, {-s, t, 1}, {s, t, -1}};
        d = faces[y / n];
      } else {
        const double longitude = pi - 2 * pi * place(x, p.width), latitude = pi / 2 - pi * place(y, n);
        d = {std::cos(latitude) * std::sin(longitude), std::sin(latitude), std::cos(latitude) * std::cos(longitude)};
      }
      Vec shown{2.0 * p.at(x, y)[0] - 1, 2.0 * p.at(x, y)[1] - 1, 2.0 * p.at(x, y)[2] - 1};
      const double a = std::hypot(d[0], d[1], d[2]), b = std::hypot(shown[0], shown[1], shown[2]);
      const double chord = std::hypot(d[0] / a - shown[0] / b, d[1] / a - shown[1] / b, d[2] / a - shown[2] / b);
      worst = std::max(worst, chord * n / (cube ? pi / 2 : pi));
    }
  return worst;
}

class Border : public CommandTest {
 protected:
  void run(const std::string& line) const {
    const Result r = shell(line);
    EXPECT_EQ(r.status, 0) << line << ": " << r.err;
  }
};

TEST_F(Border, FilesAreReadRightByOpenExrAndOpenImageIo) {
  succeeds({"generate", "directions", "latlong.exr", "--size", "64"});
  succeeds({"generate", "directions", "cube.exr", "--to", "cube", "--size", "48"});
  succeeds({"convert", "latlong.exr", "border.exr", "--openexr-envmap"});
  EXPECT_LT(worst_direction(load(path("border.exr")), true), 0.05);
  EXPECT_GT(worst_direction(load(path("border.exr")), false), 0.4);
  run("exrenvmap -c -w 48 border.exr out.exr");
  EXPECT_LT(worst_direction(load(path("out.exr")), true), 0.05);
  run("maketx --envlatl border.exr -o out.exr");
  EXPECT_LT(worst_direction(load_level(path("out.exr"), 0), true), 0.05);
  succeeds({"convert", "cube.exr", "border.exr", "--openexr-envmap"});
  EXPECT_LT(worst_direction(load(path("border.exr")), true), 0.05);
  run("exrenvmap -l -w 128 border.exr out.exr");
  EXPECT_LT(worst_direction(load(path("out.exr")), true, 1), 0.05);
  // With levels: each the map at its size, and coarse texels interpolated.
  for (const std::string name : {"latlong", "cube"}) {
    succeeds({"mipmap", name + ".exr", "chain.exr", "--openexr-envmap"});
    for (int k = 0; k < 3; ++k)
      EXPECT_LT(worst_direction(load_level(path("chain.exr"), k), true), k == 0 ? 0.05 : 0.15) << name << k;
    run("exrenvmap -l -w 128 chain.exr out.exr");
    EXPECT_LT(worst_direction(load(path("out.exr")), true, 1), 0.05) << name;
  }
}

TEST_F(Border, FilesOfOpenExrAndOpenImageIoAreReadRight) {
  save(path("latlong.exr"), latlong_directions(64, true));
  const auto centres = [&](const std::string& name, int level = 0) {
    succeeds({"convert", name, "centres.exr", "--filter", "nearest", "--level", std::to_string(level)});
    return load(path("centres.exr"));
  };
  run("exrenvmap -li -c -m -w 48 latlong.exr cube.exr");  // With levels.
  for (int k = 0; k < 2; ++k) EXPECT_LT(worst_direction(centres("cube.exr", k), false), 0.05) << k;
  run("exrenvmap -c -w 48 latlong.exr one.exr");
  EXPECT_LT(worst_direction(centres("one.exr"), false), 0.05);
  run("exrenvmap -ci -l -w 128 one.exr again.exr");
  EXPECT_LT(worst_direction(centres("again.exr"), false, 1), 0.05);
  run("maketx --envlatl latlong.exr -o made.exr");
  EXPECT_LT(worst_direction(centres("made.exr"), false), 0.05);
  succeeds({"convert", "made.exr", "ignored.exr", "--level", "0", "--filter", "nearest", "--ignore-envmap-attribute"});
  EXPECT_GT(worst_direction(load(path("ignored.exr")), false), 0.4);
}

TEST_F(Border, IsThatOfOpenExrAlone) {
  succeeds({"generate", "directions", "in.exr", "--size", "16"});
  run("oiiotool in.exr -oenv in.tif");
  succeeds({"compare", "in.tif", "in.exr", "--max-error", "0", "--level", "0"});
}

TEST_F(Border, FilesKeepWhatTheySayOfThemselves) {
  succeeds({"generate", "sky", "in.exr", "--size", "8"});
  succeeds({"prefilter", "in.exr", "out.exr", "--lobe", "diffuse", "--to", "latlong", "--size", "8", "--openexr-envmap",
            "-q"});
  EXPECT_EQ(report({"info", "out.exr"})["metadata"]["lobe"], "diffuse");
}

TEST_F(Border, IsForLatlongAndCubesInAColumn) {
  succeeds({"generate", "directions", "in.exr", "--size", "8", "--forward", "-z"});
  fails(2, {"convert", "in.exr", "out.exr", "--openexr-envmap"}, {"--forward +z"});
  fails(2, {"convert", "in.exr", "out.exr", "--to", "cube", "--layout", "row", "--openexr-envmap"}, {"column"});
  fails(2, {"convert", "in.exr", "out.exr", "--to", "sphere", "--openexr-envmap"}, {"latlong"});
}

}  // namespace
}  // namespace command_tests::mipmap_test

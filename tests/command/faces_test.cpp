// Six files of a cube as other programs name and turn them: each convention by formulae of its source, both ways.
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "picture.h"
#include "run.h"

namespace command_tests::faces_test {
namespace {

constexpr int size = 5;

// Of a face: s runs right and t up in its picture, from -1 to 1. The direction is the map's.
using Direction = std::function<Vec(double s, double t)>;
using Files = std::map<std::string, Direction>;

// OpenGL 4.6, table 8.19: major axis, s_c and t_c; t_c grows downwards, as the first row that is uploaded has t = 0.
Vec opengl(int face, double s, double down) {
  const std::array<Vec, 6> all{
      {{1, -down, -s}, {-1, -down, s}, {s, 1, down}, {s, -1, -down}, {s, -down, 1}, {-s, -down, -1}}};
  return all.at(std::size_t(face));
}

Files gl_files(bool x_negated) {
  Files files;
  const char* const names[] = {"px", "nx", "py", "ny", "pz", "nz"};
  for (int face = 0; face < 6; ++face)
    files[names[face]] = [=](double s, double t) {
      const Vec d = opengl(face, s, -t);
      return Vec{x_negated ? -d[0] : d[0], d[1], d[2]};
    };
  return files;
}

// A point (s, t) of the picture of a camera that looks along `ahead` (1 or -1) on Z, pitched up and then turned about
// Y, in radians: right-handed, or left-handed with `ahead` 1.
Vec of_camera(double s, double t, double ahead, double pitch, double yaw) {
  const double y = t * std::cos(pitch) - ahead * std::sin(pitch), z = t * std::sin(pitch) + ahead * std::cos(pitch);
  return {s * std::cos(yaw) + z * std::sin(yaw), y, -s * std::sin(yaw) + z * std::cos(yaw)};
}
constexpr double quarter = std::numbers::pi / 2;

// A camera of OpenGL.
Files camera_files() {
  const auto turned = [](double pitch, double yaw) {
    return [=](double s, double t) { return of_camera(s, t, -1, pitch, yaw); };
  };
  return {{"front", turned(0, 0)},          {"right", turned(0, -quarter)}, {"left", turned(0, quarter)},
          {"back", turned(0, 2 * quarter)}, {"up", turned(quarter, 0)},     {"down", turned(-quarter, 0)}};
}

// Unity, whose world is left-handed and looks along +Z: Euler angles of SkyBoxGenerator's cameras. Its X is -X.
Files unity_files() {
  const auto turned = [](double pitch, double yaw) {
    return [=](double s, double t) {
      const Vec d = of_camera(s, t, 1, pitch, yaw);
      return Vec{-d[0], d[1], d[2]};
    };
  };
  return {{"front", turned(0, 0)},          {"right", turned(0, -quarter)}, {"left", turned(0, quarter)},
          {"back", turned(0, 2 * quarter)}, {"up", turned(-quarter, 0)},    {"down", turned(quarter, 0)}};
}

// Quake II: each axis of the sky has its image by skytexorder, and MakeSkyVec puts (s, t, 1) together.
Files quake_files() {
  const char* const suffixes[] = {"rt", "bk", "lf", "ft", "up", "dn"};
  const int order[] = {0, 2, 1, 3, 4, 5};
  static constexpr int st_to_vec[6][3] = {{3, -1, 2}, {-3, 1, 2}, {1, 3, 2}, {-1, -3, 2}, {-2, -1, 3}, {2, -1, -3}};
  Files files;
  for (int axis = 0; axis < 6; ++axis)
    files[suffixes[order[axis]]] = [axis](double s, double t) {
      const Vec b{s, t, 1};
      Vec v{};
      for (int j = 0; j < 3; ++j) {
        const int k = st_to_vec[axis][j];
        v.at(std::size_t(j)) = k < 0 ? -b.at(std::size_t(-k - 1)) : b.at(std::size_t(k - 1));
      }
      return Vec{v[0], v[2], -v[1]};  // Z is up there.
    };
  return files;
}

// Unreal's "Creating Cubemaps": upright pictures of a world that is left-handed with Z up, turned as its table says.
Files unreal_files() {
  struct Row {
    const char* name;
    Vec ahead, right, up;
    int clockwise;
  };
  static const Row rows[] = {{"px", {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, 270},
                             {"nx", {-1, 0, 0}, {0, -1, 0}, {0, 0, 1}, 90},
                             {"py", {0, 1, 0}, {-1, 0, 0}, {0, 0, 1}, 180},
                             {"ny", {0, -1, 0}, {1, 0, 0}, {0, 0, 1}, 0},
                             {"pz", {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, 0},
                             {"nz", {0, 0, -1}, {-1, 0, 0}, {0, 1, 0}, 0}};
  Files files;
  for (const Row& r : rows)
    files[r.name] = [&r](double s, double t) {
      const double a = r.clockwise == 90 ? -t : r.clockwise == 180 ? -s : r.clockwise == 270 ? t : s;
      const double b = r.clockwise == 90 ? s : r.clockwise == 180 ? -t : r.clockwise == 270 ? -s : t;
      Vec d{};
      for (std::size_t c = 0; c < 3; ++c) d.at(c) = r.ahead.at(c) + a * r.right.at(c) + b * r.up.at(c);
      return Vec{d[0], d[2], d[1]};
    };
  return files;
}

const std::map<std::string, Files>& conventions() {
  static const std::map<std::string, Files> all{{"babylon", gl_files(true)}, {"camera", camera_files()},
                                                {"gl", gl_files(false)},     {"quake", quake_files()},
                                                {"three", gl_files(true)},   {"unity", unity_files()},
                                                {"unreal", unreal_files()}};
  return all;
}

Picture shown(const Direction& direction) {
  Picture picture = Picture::filled(size, size);
  for (int j = 0; j < size; ++j)
    for (int i = 0; i < size; ++i) {
      const auto colour = colour_of(direction((2 * i + 1.0) / size - 1, 1 - (2 * j + 1.0) / size));
      std::copy(colour.begin(), colour.end(), picture.at(i, j));
    }
  return picture;
}

class Faces : public CommandTest {
 protected:
  void SetUp() override {
    succeeds({"generate", "directions", "map.exr", "--to", "cube", "--size", std::to_string(size)});
  }
  void reads_the_map(const std::string& name, const std::vector<std::string>& options) const {
    std::vector<std::string> arguments{"convert", name, "back.exr", "--layout", "column", "--filter", "nearest"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    succeeds(arguments);
    EXPECT_LT(difference(load(path("back.exr")), cube_directions("column", size)), 1e-6);
  }
};

TEST_F(Faces, OfTwoConventionsAreRefused) {
  succeeds({"convert", "map.exr", "a_{face}.exr", "--faces", "gl"});
  succeeds({"convert", "map.exr", "b_{face}.exr"});
  std::filesystem::copy_file(path("b_py.exr"), path("a_py.exr"), std::filesystem::copy_options::overwrite_existing);
  fails(3, {"convert", "a_{face}.exr", "back.exr"},
        {"a_py.exr", "upright", "the first face as gl has it", "--from-faces"});
  EXPECT_EQ(envmap({"info", "a_{face}.exr", "--from-faces", "gl"}).status, 0);
}

TEST_F(Faces, AreWrittenAsEachProgramShowsThem) {
  for (const auto& [name, files] : conventions()) {
    succeeds({"generate", "directions", name + "_{face}.exr", "--to", "cube", "--size", std::to_string(size), "--faces",
              name});
    for (const auto& [file, direction] : files) {
      SCOPED_TRACE(name + " " + file);
      EXPECT_LT(difference(load(path(name + "_" + file + ".exr")), shown(direction)), 1e-6);
    }
  }
}

// Files that this program did not write, and which say nothing of themselves.
TEST_F(Faces, AreReadAsEachProgramShowsThem) {
  for (const auto& [name, files] : conventions()) {
    SCOPED_TRACE(name);
    for (const auto& [file, direction] : files) save(path(name + "_" + file + ".pfm"), shown(direction));
    reads_the_map(name + "_{face}.pfm", {"--from-faces", name});
  }
}

TEST_F(Faces, GoThereAndBackWithoutAnyChange) {
  const Picture start = load(path("map.exr"));
  for (const std::string faces : {"babylon", "camera", "gl", "quake", "three", "unity", "unreal", "a,b,c,d,e,f",
                                  "a:90,b:180,c:270,d:mirror,e:mirror:90,f:mirror:270", "gl:r,l,u,d,f,b"}) {
    SCOPED_TRACE(faces);
    succeeds({"convert", "map.exr", "there_{face}.pfm", "--faces", faces});
    succeeds({"convert", "there_{face}.pfm", "back.exr", "--from-faces", faces, "--filter", "nearest"});
    EXPECT_EQ(load(path("back.exr")), start);
  }
}

// Each turn, by hand: the picture is mirrored left to right, and then turned clockwise.
TEST_F(Faces, AreTurnedAsTheirNamesSay) {
  const Picture upright = face_directions(0, size);
  for (const bool mirror : {false, true})
    for (int turns = 0; turns < 4; ++turns) {
      const std::string word = (mirror ? ":mirror" : "") + (turns > 0 ? ":" + std::to_string(90 * turns) : "");
      SCOPED_TRACE(word);
      succeeds({"convert", "map.exr", "t_{face}.pfm", "--faces", "a" + word + ",b,c,d,e,f"});
      Picture expected = Picture::filled(size, size);
      for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
          int i = mirror ? size - 1 - x : x, j = y;
          for (int k = 0; k < turns; ++k) {
            const int right_to_bottom = i;
            i = size - 1 - j, j = right_to_bottom;
          }
          std::copy_n(upright.at(x, y), 3, expected.at(i, j));
        }
      EXPECT_LT(difference(load(path("t_a.pfm")), expected), 1e-6);
    }
}

TEST_F(Faces, TakeOtherNamesAsSeenFromOutside) {
  succeeds({"convert", "map.exr", "s_{face}.exr", "--faces", "gl:right,left,top,bottom,front,back"});
  const Files gl = gl_files(false);
  EXPECT_LT(difference(load(path("s_right.exr")), shown(gl.at("px"))), 1e-6);
  EXPECT_LT(difference(load(path("s_bottom.exr")), shown(gl.at("ny"))), 1e-6);
  EXPECT_LT(difference(load(path("s_back.exr")), shown(gl.at("nz"))), 1e-6);
}

// EXR and PNG files keep the convention, so that they are not read mirrored.
TEST_F(Faces, SayHowTheyWereWritten) {
  for (const std::string faces : {"gl", "three", "unreal"}) {
    SCOPED_TRACE(faces);
    succeeds({"convert", "map.exr", "m_{face}.exr", "--faces", faces});
    reads_the_map("m_{face}.exr", {});
    reads_the_map("m_{face}.exr", {"--from-faces", faces});
    for (const std::string type : {"png", "tif"}) {
      succeeds({"convert", "map.exr", "m_{face}." + type, "--faces", faces});
      succeeds({"compare", "m_{face}." + type, "map.exr", "--max-error", "0.02", "-q"});
    }
  }
}

// One of two maps is in six files; parts of a map become six files.
TEST_F(Faces, StandBesideOtherFiles) {
  succeeds({"convert", "map.exr", "m_{face}.pfm", "--faces", "unity"});
  succeeds({"compare", "m_{face}.pfm", "map.exr", "--from-faces", "unity", "--golden", "-q"});
  succeeds({"compare", "map.exr", "m_{face}.pfm", "--from-faces", "unity", "--golden", "-q"});
  EXPECT_EQ(envmap({"compare", "m_{face}.pfm", "map.exr", "--from-faces", "camera", "--golden", "-q"}).status, 1);
  succeeds({"convert", "map.exr", "a.exr", "--shard", "1/2", "--filter", "nearest"});
  succeeds({"convert", "map.exr", "b.exr", "--shard", "2/2", "--filter", "nearest"});
  succeeds({"merge", "a.exr", "b.exr", "w_{face}.pfm", "--faces", "unity"});
  for (const std::string name : {"right", "left", "up", "down", "front", "back"})
    EXPECT_EQ(read("w_" + name + ".pfm"), read("m_" + name + ".pfm")) << name;
}

TEST_F(Faces, HaveLevelsAndRulesOfMake) {
  succeeds({"mipmap", "map.exr", "l{level}_{face}.exr", "--faces", "quake", "--depfile", "out.d"});
  EXPECT_NE(read("out.d").find("l0_rt.exr l0_lf.exr l0_up.exr l0_dn.exr l0_ft.exr l0_bk.exr l1_rt.exr"),
            std::string::npos)
      << read("out.d");
  succeeds({"mipmap", "map.exr", "chain.exr"});
  succeeds({"compare", "l{level}_{face}.exr", "chain.exr", "--from-faces", "quake", "--golden", "-q"});
  succeeds({"convert", "l{level}_{face}.exr", "one.exr", "--from-faces", "quake", "--level", "1", "--depfile", "in.d"});
  EXPECT_NE(read("in.d").find("l1_bk.exr"), std::string::npos) << read("in.d");
}

TEST_F(Faces, LieInFoldersOfTheirNames) {
  succeeds({"generate", "sky", "in.exr", "--to", "cube", "--size", "4"});
  fails(2, {"convert", "in.exr", "{face}_{face}.exr"}, {"{face} stands in it twice"});
  fails(4, {"convert", "in.exr", "{face}/sky.exr"}, {"px"});
  for (const char* face : {"px", "nx", "py", "ny", "pz", "nz"}) std::filesystem::create_directory(path(face));
  succeeds({"convert", "in.exr", "{face}/sky.exr"});
  succeeds({"compare", "{face}/sky.exr", "in.exr", "--max-error", "0"});
}

TEST_F(Faces, SayWhatTheyHoldAsOneFileDoes) {
  succeeds({"generate", "sky", "in.exr", "--size", "4"});
  succeeds({"prefilter", "in.exr", "{face}.exr", "--lobe", "diffuse", "--size", "4", "-q"});
  EXPECT_EQ(report({"info", "{face}.exr"})["metadata"]["lobe"], "diffuse");
}

TEST_F(Faces, HaveOneUnit) {
  for (int face = 0; face < 6; ++face) {
    OIIO::ImageSpec spec;
    spec.attribute("whiteLuminance", face == 3 ? 2.F : 1.F);
    save(path(std::string("unit_") + std::array{"px", "nx", "py", "ny", "pz", "nz"}.at(std::size_t(face)) + ".exr"),
         face_directions(face, size), OIIO::TypeDesc::FLOAT, spec);
  }
  fails(3, {"info", "unit_{face}.exr"}, {"unit_ny.exr", "whiteLuminance is 2", "first face 1"});
}

TEST_F(Faces, AreRefusedInOneLine) {
  const auto writes = [&](const std::string& faces, const std::vector<std::string>& words) {
    fails(2, {"convert", "map.exr", "x_{face}.exr", "--faces", faces}, words);
    fails(2, {"info", "x_{face}.exr", "--from-faces", faces}, words);
  };
  writes("directx9", {"directx9", "unreal", "six names"});
  writes("a,b,c,d,e", {"5 names"});
  writes("a,b,c,d,e,f,g", {"7 names"});
  writes("a,b,c,d,e,a", {"a is named twice"});
  writes("a,b,,d,e,f", {"no name"});
  writes("a:45,b,c,d,e,f", {"'45'", "mirror"});
  writes("a:mirror:,b,c,d,e,f", {"'mirror:'"});
  writes("gl:a:90,b,c,d,e,f", {"gl", "turn of a"});
  writes("gl:a,b", {"2 names"});
  writes("gl:", {"1 names"});
  fails(2, {"convert", "map.exr", "x.exr", "--faces", "gl"}, {"{face}"});
  fails(2, {"convert", "map.exr", "x.ktx2", "--faces", "gl"}, {"{face}"});
  fails(2, {"convert", "map.exr", "x_{half}.exr", "--to", "paraboloid", "--faces", "gl"}, {"{face}"});
  fails(2, {"sh", "map.exr", "--faces", "gl"}, {"--evaluate"});
  fails(2, {"info", "map.exr", "--from-faces", "a,b,c,d,e,f"}, {"'a'", "px, nx"});
  fails(3, {"info", "x_{face}.exr", "--from-faces", "quake"}, {"x_rt.exr"});
  fails(2, {"convert", "map.exr", "{face}.exr", "--faces", "map,b,c,d,e,f"}, {"map.exr", "both input and output"});
}

}  // namespace
}  // namespace command_tests::faces_test

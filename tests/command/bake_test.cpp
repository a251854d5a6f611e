// Folders for engines: each map is looked up as the engine's own shader does, written down here once more.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <functional>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "picture.h"
#include "run.h"

namespace command_tests::bake_test {
namespace {

const double pi = std::acos(-1.0);

struct Place {
  double u, v;  // v down.
};

Place equal_area(double x, double y, double z) {  // pbrt-v4's EqualAreaSphereToSquare, +Z in the middle.
  const double r = std::sqrt(1 - std::abs(z)), part = std::atan2(std::abs(y), std::abs(x)) * 2 / pi;
  const double b = part * r, a = r - b, u = z < 0 ? 1 - b : a, v = z < 0 ? 1 - a : b;
  return {0.5 * (std::copysign(u, x) + 1), 0.5 * (std::copysign(v, y) + 1)};
}

// Where each engine looks for the radiance from d, in the frame of the probe; sources are named in
// src/envmap/engine/engines.cpp.
struct Lookup {
  std::string engine, map, text;
  std::function<Place(const Vec&)> place;
};
// Cubes are looked at as the latlong map that they are for this program:
// their faces are held to the API's in texture_test.cpp.
bool is_cube(const std::string& map) { return !map.ends_with(".exr") && !map.ends_with(".hdr"); }
Place unfolded(double x, double y, double z) {
  return {0.5 - std::atan2(x, z) / (2 * pi), 0.5 - std::asin(y) / pi};
}

const Lookup lookups[] = {
    {"babylon", "background.dds", "", [](const Vec& d) { return unfolded(-d[0], d[1], d[2]); }},
    // Read back as they were written: what Babylon.js sees in them is looked at in tests/engines.
    {"babylon-env", "environment.env", "", [](const Vec& d) { return unfolded(d[0], d[1], d[2]); }},
    {"bevy", "skybox.ktx2", "", [](const Vec& d) { return unfolded(d[0], d[1], -d[2]); }},
    {"blender", "background.exr", "world.py",
     [](const Vec& d) {  // Its world: (x, -z, y).
       return Place{0.5 - std::atan2(-d[2], d[0]) / (2 * pi), 0.5 - std::atan2(d[1], std::hypot(d[0], d[2])) / pi};
     }},
    // (x, z, -y) of its Z-up world, which is (x, -z, y) of the probe, goes to a cube texture: the map's own axes.
    {"cesium", "specular.ktx2", "",
     [](const Vec& d) {
       const Vec world{d[0], -d[2], d[1]};
       return unfolded(world[0], world[2], -world[1]);
     }},
    {"filament", "sky.ktx", "", [](const Vec& d) { return unfolded(d[0], d[1], d[2]); }},
    // A cube texture takes the direction itself.
    {"glsl", "background.ktx2", "envmap.glsl", [](const Vec& d) { return unfolded(d[0], d[1], d[2]); }},
    {"gltf", "light.glb", "", [](const Vec& d) { return unfolded(d[0], d[1], d[2]); }},
    {"gltf-viewer", "ggx.ktx2", "", [](const Vec& d) { return unfolded(d[0], d[1], d[2]); }},
    {"godot", "background.exr", "environment.tres",
     [](const Vec& d) {
       const double turn = std::atan2(d[0], -d[2]) / (2 * pi);
       return Place{turn < 0 ? turn + 1 : turn, std::acos(d[1]) / pi};
     }},
    {"hlsl", "background.dds", "envmap.hlsl", [](const Vec& d) { return unfolded(d[0], d[1], d[2]); }},
    // `Rotate -90 1 0 0` from the light to the world: the light's +Z is +Y, its +Y is -Z.
    {"pbrt", "background.exr", "light.pbrt", [](const Vec& d) { return equal_area(d[0], -d[2], d[1]); }},
    {"playcanvas", "background.hdr", "", [](const Vec& d) { return unfolded(d[0], d[1], d[2]); }},
    // Cubes of files are looked up with x negated.
    {"three", "background.ktx2", "", [](const Vec& d) { return unfolded(-d[0], d[1], d[2]); }},
    {"three-latlong", "background.exr", "",
     [](const Vec& d) {
       return Place{0.5 + std::atan2(d[2], d[0]) / (2 * pi), 0.5 - std::asin(d[1]) / pi};
     }},
    // Unity's world: (-x, y, z). Unreal's: (x, z, y).
    {"unity", "background.exr", "",
     [](const Vec& d) {
       return Place{0.5 - std::atan2(d[2], -d[0]) / (2 * pi), std::acos(d[1]) / pi};
     }},
    {"unreal", "background.hdr", "",
     [](const Vec& d) {
       return Place{0.5 + std::atan2(d[0], -d[2]) / (2 * pi), std::acos(d[1]) / pi};
     }},
    {"usd", "background.exr", "light.usda",
     [](const Vec& d) {
       return Place{0.5 - std::atan2(d[0], d[2]) / (2 * pi), 0.5 - std::asin(d[1]) / pi};
     }},
};

class Bake : public CommandTest {
 protected:
  // An engine reads texels and not the word by which the program turns a mirrored map back.
  void forget_the_mirror(const std::string& name) const {
    std::string bytes = read(name);
    const std::string word = "envmap:mirrored";
    if (const auto at = bytes.find(word); at != std::string::npos) bytes.replace(at, word.size(), "engine:mirrored");
    write(name, bytes);
  }
};

TEST_F(Bake, EveryEngineFindsItsDirections) {
  succeeds({"generate", "directions", "probe.exr", "--to", "cube", "--size", "64"});
  for (const Lookup& l : lookups) {
    SCOPED_TRACE(l.engine);
    succeeds({"bake", "probe.exr", l.engine, "--for", l.engine, "--size", "128", "--chain-size", "64", "--quality",
              "draft", "-q"});
    std::string name = l.engine + "/" + l.map;
    forget_the_mirror(name);
    if (is_cube(l.map))
      succeeds({"convert", name, "unfolded.exr", "--to", "latlong", "--level", "0"}), name = "unfolded.exr";
    const Picture map = load(path(name));
    for (double x = -0.9; x < 1; x += 0.45)
      for (double y = -0.8; y < 1; y += 0.4)
        for (const double z : {-0.7, -0.3, 0.25, 0.6}) {
          const double length = std::sqrt(x * x + y * y + z * z);
          const Vec d{x / length, y / length, z / length};
          const Place at = l.place(d);
          const float* found = map.at(std::min(int(at.u * map.width), map.width - 1),
                                      std::min(int(at.v * map.height), map.height - 1));
          const auto wanted = colour_of(d);
          // Half the diagonal of a texel of 1.4 to 2.8 degrees, by half the range; a Radiance file rounds by 1/256.
          for (std::size_t c = 0; c < 3; ++c) ASSERT_NEAR(found[c], wanted[c], 0.025) << x << " " << y << " " << z;
        }
  }
}

TEST_F(Bake, MirroredFilesAreTurnedBackWhereTheyAreRead) {
  succeeds({"generate", "directions", "probe.exr", "--to", "cube", "--size", "64"});
  for (const auto& [engine, file] : {std::pair{"three", "background.ktx2"}, {"bevy", "skybox.ktx2"}}) {
    const std::string name = std::string(engine) + "/" + file;
    succeeds({"bake", "probe.exr", engine, "--for", engine, "--size", "64", "--chain-size", "32", "--quality", "draft",
              "-q"});
    succeeds({"compare", name, "probe.exr", "--max-rms", "0.02"});
    EXPECT_NE(envmap({"info", name}).out.find("mirrored: "), std::string::npos);
    succeeds({"convert", name, "straight.ktx2", "--force"});
    EXPECT_EQ(read("straight.ktx2").find("envmap:mirrored"), std::string::npos);
    forget_the_mirror(name);
    EXPECT_EQ(envmap({"compare", name, "probe.exr", "--max-rms", "0.5"}).status, 1);
  }
}

TEST_F(Bake, ListsWhatIsTestedHere) {
  const Result r = envmap({"bake", "--list", "--json"});
  ASSERT_EQ(r.status, 0) << r.err;
  std::vector<std::string> listed, tested;
  const auto report = nlohmann::json::parse(r.out);
  for (const auto& engine : report["engines"]) {
    listed.push_back(engine["name"]);
    // Words of src/envmap/engine/text.
    EXPECT_NE(engine["light"], "") << engine["name"];
    const std::string details = envmap({"bake", "--list", listed.back()}).out;
    EXPECT_LT(details.find("Use:\n") + 20, details.size()) << engine["name"];
  }
  for (const Lookup& l : lookups) tested.push_back(l.engine);
  EXPECT_EQ(listed, tested);
}

// Levels are GGX's lobes of the roughness that the shader looks for there, as `prefilter` makes them one by one.
TEST_F(Bake, ChainsHoldTheRoughnessOfEachLevel) {
  succeeds({"generate", "sun", "probe.exr", "--to", "cube", "--size", "32", "--radius", "8", "--direction", "1,2,3",
            "--value", "20"});
  struct Wanted {
    std::string engine, chain;
    int level, size;
    double roughness;
  };
  for (const Wanted& w : {Wanted{"filament", "ibl.ktx", 2, 8, 1 - std::sqrt(0.5)},
                          {"filament", "ibl.ktx", 4, 2, 1},
                          {"babylon", "environment.dds", 2, 8, std::sqrt(std::pow(2, 2.5) / 32)},
                          {"babylon", "environment.dds", 4, 2, 1},
                          {"cesium", "specular.ktx2", 2, 8, 0.5},
                          {"gltf-viewer", "ggx.ktx2", 3, 4, 0.75}}) {
    SCOPED_TRACE(w.engine + " " + std::to_string(w.level));
    succeeds({"bake", "probe.exr", w.engine, "--for", w.engine, "--chain-size", "32", "-q"});
    succeeds({"convert", w.engine + "/" + w.chain, "level.exr", "--level", std::to_string(w.level), "--filter",
              "nearest", "--depth", "float"});
    succeeds({"prefilter", "probe.exr", "wanted.exr", "--lobe", "ggx", "--roughness", std::to_string(w.roughness),
              "--size", std::to_string(w.size), "--method", "exact", "--depth", "float", "-q"});
    if (w.engine == "babylon") {  // A left-handed world: faces +X and -X changed, every row turned round.
      const Picture cube = load(path("wanted.exr"));
      Picture mirrored = cube;
      for (int face = 0; face < 6; ++face)
        for (int j = 0; j < w.size; ++j)
          for (int i = 0; i < w.size; ++i)
            std::copy_n(cube.at(w.size - 1 - i, (face < 2 ? 1 - face : face) * w.size + j), 3,
                        mirrored.at(i, face * w.size + j));
      save(path("wanted.exr"), mirrored);
    }
    succeeds({"compare", "level.exr", "wanted.exr", "--max-error", "4e-3"});
  }
}

TEST_F(Bake, BevysDiffuseMapIsTheIrradianceMirroredInZ) {
  succeeds({"generate", "sun", "probe.exr", "--to", "cube", "--size", "32", "--radius", "20", "--direction", "1,2,3",
            "--value", "20"});
  succeeds({"bake", "probe.exr", "lights", "--for", "bevy", "--chain-size", "32", "-q"});
  forget_the_mirror("lights/diffuse.ktx2");
  succeeds({"convert", "lights/diffuse.ktx2", "diffuse.exr", "--filter", "nearest", "--depth", "float"});
  succeeds({"prefilter", "probe.exr", "wanted.exr", "--lobe", "diffuse", "--depth", "float", "-q"});
  const Picture found = load(path("diffuse.exr")), wanted = load(path("wanted.exr"));
  // On faces of 64 in a column, whose texel holds the direction.
  const auto at = [](const Picture& p, double x, double y, double z) {
    const double most = std::max({std::abs(x), std::abs(y), std::abs(z)});
    const int face = most == std::abs(x) ? (x > 0 ? 0 : 1) : most == std::abs(y) ? (y > 0 ? 2 : 3) : (z > 0 ? 4 : 5);
    const double s[] = {z, -z, x, x, -x, x}, t[] = {y, y, z, -z, y, y};
    return p.at(int(32 * (1 + s[face] / most)), face * 64 + int(32 * (1 - t[face] / most)))[0];
  };
  for (const Vec d : {Vec{0.93, 0.2, 0.3},
                      {-0.83, 0.1, 0.5},
                      {0.3, 0.91, 0.2},
                      {-0.2, -0.73, 0.4},
                      {0.1, 0.3, 0.83},
                      {0.4, -0.2, -0.91}})
    EXPECT_NEAR(at(found, d[0], d[1], -d[2]), at(wanted, d[0], d[1], d[2]), 4e-3 * at(wanted, d[0], d[1], d[2]));
}

// What glTF-IBL-Sampler makes, by its definitions: a cosine, the sheen of each level, and two tables whose columns are
// cosines and whose rows are roughnesses.
TEST_F(Bake, TheViewerOfGltfGetsDiffuseLightSheenAndTables) {
  succeeds({"generate", "sun", "probe.exr", "--to", "cube", "--size", "32", "--radius", "20", "--direction", "1,2,3",
            "--value", "20"});
  succeeds({"bake", "probe.exr", "lights", "--for", "gltf-viewer", "--chain-size", "32", "-q"});
  const auto same = [&](const std::string& file, const std::string& level, const std::vector<std::string>& lobe) {
    succeeds({"convert", "lights/" + file, "found.exr", "--level", level, "--filter", "nearest", "--depth", "float"});
    std::vector<std::string> wanted{"prefilter", "probe.exr", "wanted.exr", "--method",
                                    "exact",     "--depth",   "float",      "-q"};
    wanted.insert(wanted.end(), lobe.begin(), lobe.end());
    succeeds(wanted);
    succeeds({"compare", "found.exr", "wanted.exr", "--max-error", "4e-3"});
  };
  same("lambertian.ktx2", "0", {"--lobe", "diffuse", "--size", "64"});
  same("charlie.ktx2", "2", {"--lobe", "charlie", "--roughness", "0.5", "--size", "8"});
  same("charlie.ktx2", "4", {"--lobe", "charlie", "--roughness", "1", "--size", "2"});
  const Picture ggx = load(path("lights/lut_ggx.exr")), sheen = load(path("lights/lut_sheen.exr"));
  ASSERT_EQ(ggx.width, 128);
  ASSERT_EQ(sheen.height, 128);
  for (const int column : {40, 90, 127}) {  // A mirror: Schlick's Fresnel term alone.
    const double cosine = (column + 0.5) / 128, grazing = std::pow(1 - cosine, 5);
    EXPECT_NEAR(ggx.at(column, 0)[0], 1 - grazing, 2e-3);
    EXPECT_NEAR(ggx.at(column, 0)[1], grazing, 2e-3);
  }
  // Estevez and Kulla's distribution (2 + p) sin(n,h)^p / (2 pi), p = 1 / roughness^2, with Neubelt and Pettineo's
  // visibility 1 / (4 (n.l + n.v - n.l n.v)), over the hemisphere.
  for (const int row : {64, 127}) {
    const double roughness = (row + 0.5) / 128, power = 1 / (roughness * roughness);
    const double nv = 127.5 / 128, across = std::sqrt(1 - nv * nv);
    double albedo = 0;
    constexpr int rings = 400, turns = 400;
    for (int k = 0; k < rings; ++k)
      for (int t = 0; t < turns; ++t) {
        const double nl = (k + 0.5) / rings, aside = std::sqrt(1 - nl * nl), turn = 2 * pi * (t + 0.5) / turns;
        const double hx = aside * std::cos(turn) + across, hy = aside * std::sin(turn), hz = nl + nv;
        const double sine = std::sqrt((hx * hx + hy * hy) / (hx * hx + hy * hy + hz * hz));
        albedo += (2 + power) / (2 * pi) * std::pow(sine, power) / (4 * (nl + nv - nl * nv)) * nl;
      }
    albedo *= 2 * pi / (rings * turns);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(sheen.at(127, row)[c], albedo, 0.01 * albedo);
  }
}

// A cube of irradiance behind the levels of an .env file, and the mean direction of the light with X negated. The faces
// are read by a header that says that they are the levels.
TEST_F(Bake, BabylonsIrradianceIsACubeWithTheDirectionOfTheLight) {
  const auto bake = [&](const std::string& folder) {
    succeeds({"bake", "probe.exr", folder, "--for", "babylon-env", "--chain-size", "16", "-q"});
    const std::string file = read(folder + "/environment.env");
    const std::size_t end = file.find('\0');
    return std::pair{nlohmann::ordered_json::parse(file.substr(8, end - 8)), file.substr(end + 1)};
  };
  succeeds({"generate", "sun", "probe.exr", "--to", "cube", "--size", "64", "--radius", "3", "--direction", "1,2,3",
            "--value", "200", "--zenith", "0", "--ground", "0"});
  auto [header, images] = bake("sun");
  const auto& cube = header["irradiance"]["irradianceTexture"];
  EXPECT_EQ(cube["size"], 64);
  ASSERT_EQ(cube["faces"].size(), 6);
  const auto& last = header["specular"]["mipmaps"].back();
  std::size_t position = last["position"].get<std::size_t>() + last["length"].get<std::size_t>();
  for (const auto& face : cube["faces"]) {
    EXPECT_EQ(face["position"], position);
    EXPECT_EQ(images.substr(position, 4), "\x89PNG");
    position += face["length"].get<std::size_t>();
  }
  EXPECT_EQ(position, images.size());
  const double length = std::sqrt(14);
  for (const auto& [k, wanted] : {std::pair{0, -1 / length}, {1, 2 / length}, {2, 3 / length}})
    EXPECT_NEAR(cube["dominantDirection"][std::size_t(k)].get<double>(), wanted, 3e-3);
  auto levels = header;
  levels["specular"]["mipmaps"] = cube["faces"];
  levels["irradiance"] = nullptr;
  write("faces.env", read("sun/environment.env").substr(0, 8) + levels.dump() + std::string(1, '\0') + images);
  succeeds({"convert", "faces.env", "found.exr", "--level", "0", "--filter", "nearest", "--depth", "float"});
  succeeds({"prefilter", "probe.exr", "wanted.exr", "--lobe", "diffuse", "--size", "64", "--depth", "float", "-q"});
  const Picture found = load(path("found.exr")), wanted = load(path("wanted.exr"));
  EXPECT_LT(difference(found, wanted), 0.01 * *std::max_element(wanted.values.begin(), wanted.values.end()));
  // Light from all sides has no direction, and a shader that divides by its length would show nothing.
  succeeds({"generate", "constant", "probe.exr", "--to", "cube", "--size", "16", "--value", "1"});
  EXPECT_FALSE(bake("white").first["irradiance"]["irradianceTexture"].contains("dominantDirection"));
}

TEST_F(Bake, StandardOutputHoldsNoFolder) {
  succeeds({"generate", "sky", "probe.exr", "--size", "8"});
  fails(2, {"bake", "probe.exr", "-", "--for", "unity"}, {"standard output", "name of a folder"});
}

// CesiumJS adds up the nine colours of irradiance.txt as czm_sphericalHarmonics() does, with its own order of terms:
// the irradiance over pi of the map, here a polynomial to degree 2. Its texels are halves in four channels.
TEST_F(Bake, CesiumsCoefficientsAreTheIrradiance) {
  succeeds({"generate", "sh", "probe.exr", "--to", "cube", "--size", "64", "--degree", "1", "--order", "-1",
            "--amplitude", "0.3"});
  succeeds({"bake", "probe.exr", "lights", "--for", "cesium", "--chain-size", "16", "-q"});
  std::istringstream numbers(read("lights/irradiance.txt"));
  std::array<std::array<double, 3>, 9> c{};
  for (auto& colour : c)
    for (double& number : colour) ASSERT_TRUE(numbers >> number);
  succeeds({"prefilter", "probe.exr", "diffuse.exr", "--lobe", "diffuse", "--size", "8", "--method", "exact", "--depth",
            "float", "-q"});
  const Picture wanted = load(path("diffuse.exr"));
  for (int j = 0; j < 8; ++j)
    for (int i = 0; i < 8; ++i) {  // Face +X: right is +Z, up is +Y.
      const double s = (i + 0.5) / 4 - 1, t = 1 - (j + 0.5) / 4, length = std::sqrt(1 + s * s + t * t);
      const double x = 1 / length, y = t / length, z = s / length;
      const double sum = c[0][0] + c[1][0] * y + c[2][0] * z + c[3][0] * x + c[4][0] * (y * x) + c[5][0] * (y * z) +
                         c[6][0] * (3 * z * z - 1) + c[7][0] * (z * x) + c[8][0] * (x * x - y * y);
      EXPECT_NEAR(sum, wanted.at(i, j)[0], 2e-3);
    }
  const std::string file = read("lights/specular.ktx2");
  std::uint32_t header[9];  // vkFormat, typeSize, width, height, depth, layers, faces, levels, supercompression.
  std::memcpy(header, file.data() + 12, sizeof header);
  EXPECT_EQ(header[0], 97);  // VK_FORMAT_R16G16B16A16_SFLOAT, which transcodeKTX2.js knows.
  EXPECT_EQ(header[1], 2);
  EXPECT_EQ(header[5], 0);
  EXPECT_EQ(header[6], 6);
  EXPECT_EQ(header[7], 5);
  EXPECT_EQ(header[8], 0);
}

// Of Filament's nine colours: what they give is the irradiance over pi of the map,
// here itself a polynomial to degree 2.
TEST_F(Bake, FilamentsHarmonicsAreTheIrradiance) {
  succeeds({"generate", "sh", "probe.exr", "--to", "cube", "--size", "64", "--degree", "2", "--order", "1",
            "--amplitude", "0.3"});
  succeeds({"bake", "probe.exr", "lights", "--for", "filament", "--chain-size", "16", "-q"});
  fails(2, {"bake", "probe.exr", "small", "--for", "filament", "--chain-size", "8"},
        {"--chain-size", "ibl.ktx", "5 levels"});
  succeeds({"prefilter", "probe.exr", "diffuse.exr", "--lobe", "diffuse", "--size", "8", "--method", "exact", "--depth",
            "float", "-q"});
  const std::string file = read("lights/ibl.ktx");
  const std::size_t at = file.find(std::string("sh\0", 3));
  ASSERT_NE(at, std::string::npos);
  std::istringstream numbers(file.substr(at + 3, 2000));
  double sh[27];
  for (double& number : sh) ASSERT_TRUE(numbers >> number);
  const Picture wanted = load(path("diffuse.exr"));
  for (int j = 0; j < 8; ++j)
    for (int i = 0; i < 8; ++i) {  // Face +X: right is +Z, up is +Y.
      const double s = (i + 0.5) / 4 - 1, t = 1 - (j + 0.5) / 4, length = std::sqrt(1 + s * s + t * t);
      const double x = 1 / length, y = t / length, z = s / length;
      const double basis[] = {1, y, z, x, x * y, y * z, 3 * z * z - 1, z * x, x * x - y * y};
      double sum = 0;
      for (std::size_t k = 0; k < 9; ++k) sum += sh[3 * k] * basis[k];
      EXPECT_NEAR(sum, wanted.at(i, j)[0], 2e-3) << x << " " << y << " " << z;
    }
}

TEST_F(Bake, TextsNameTheMapAndAreWellFormed) {
  succeeds({"generate", "constant", "probe.exr", "--size", "8"});
  for (const Lookup& l : lookups) {
    SCOPED_TRACE(l.engine);
    succeeds({"bake", "probe.exr", l.engine, "--for", l.engine, "--chain-size", "32", "--quality", "draft", "-q"});
    EXPECT_NE(read(l.engine + "/README.txt").find(l.map), std::string::npos);
    if (l.text.empty()) continue;
    const std::string text = read(l.engine + "/" + l.text);
    EXPECT_NE(text.find(l.map), std::string::npos);
    EXPECT_EQ(std::ranges::count(text, '{'), std::ranges::count(text, '}'));
    EXPECT_EQ(std::ranges::count(text, '"') % 2, 0);
  }
  EXPECT_EQ(shell("python3 -c 'import ast; ast.parse(open(\"blender/world.py\").read())'").status, 0);
}

TEST_F(Bake, FoldersAppearWholeOrNotAtAll) {
  succeeds({"generate", "sun", "probe.exr", "--size", "16"});
  succeeds({"bake", "probe.exr", "lights", "--for", "usd", "-q"});
  const std::string first = read("lights/background.exr");
  // Again, with another map: replaced whole; and nothing lies about.
  succeeds({"bake", "probe.exr", "lights", "--for", "usd", "--size", "8", "-q"});
  EXPECT_NE(read("lights/background.exr"), first);
  EXPECT_EQ(names(), (std::vector<std::string>{"lights/", "lights/README.txt", "lights/background.exr",
                                               "lights/light.usda", "probe.exr"}));
  // A folder with something else in it is left as it is, as where the input cannot be read.
  write("lights/mine.txt", "mine");
  fails(2, {"bake", "probe.exr", "lights", "--for", "usd"}, {"lights", "mine.txt", "move it out"});
  fails(3, {"bake", "none.exr", "other", "--for", "usd"}, {"none.exr"});
  fails(2, {"bake", "probe.exr", "other"}, {"--for", "bake --list"});
  fails(2, {"bake", "probe.exr"}, {"FOLDER"});
  fails(2, {"bake", "probe.exr", "probe.exr", "--for", "usd"}, {"probe.exr"});
  fails(4, {"bake", "probe.exr", "probe.exr/other", "--for", "usd"}, {"probe.exr/other"});
}

// What bake wrote for an engine the next bake for it replaces, whatever the files of either; but no file besides.
TEST_F(Bake, ReplacesWhatAnEarlierBakeOfItsEngineWrote) {
  succeeds({"generate", "sun", "probe.exr", "--size", "128", "--radius", "4", "--value", "50"});
  const std::vector<std::string> panorama{"lights/", "lights/README.txt", "lights/background.exr"},
      cubes{"lights/", "lights/README.txt", "lights/background.ktx2", "lights/environment.ktx2"};
  const auto holds = [&](std::vector<std::string> wanted) {
    wanted.emplace_back("probe.exr");
    EXPECT_EQ(names(), wanted);
  };
  const auto bake = [&](const std::vector<std::string>& more) {
    std::vector<std::string> command{"bake",      "probe.exr", "lights", "--for", "three",
                                     "--quality", "draft",     "--size", "16",    "-q"};
    command.insert(command.end(), more.begin(), more.end());
    return command;
  };
  succeeds(bake({"--latlong"}));
  write("lights/background.exr.import", "godot");
  succeeds(bake({}));
  holds(cubes);  // What lay beside the panorama went with it.
  succeeds(bake({"--suns"}));
  EXPECT_TRUE(std::filesystem::exists(path("lights/suns.js")));
  succeeds(bake({"--if-changed"}));
  holds(cubes);
  const auto before = std::filesystem::last_write_time(path("lights"));
  succeeds(bake({"--if-changed"}));
  EXPECT_EQ(std::filesystem::last_write_time(path("lights")), before);
  succeeds(bake({"--latlong", "--if-changed"}));
  holds(panorama);
  // Another engine's folder, a file that bake did not write, and a folder of the name of one are left.
  fails(2, {"bake", "probe.exr", "lights", "--for", "filament"}, {"lights", "contains background.exr"});
  std::filesystem::create_directory(path("lights/environment.ktx2"));
  fails(2, bake({}), {"lights", "contains environment.ktx2"});
  std::filesystem::remove(path("lights/environment.ktx2"));
  write("lights/README.txt", "mine");
  fails(2, bake({}), {"lights", "contains background.exr"});
  succeeds(bake({"--latlong"}));
  std::filesystem::permissions(path("lights/background.exr"), std::filesystem::perms(0444));
  fails(4, bake({}), {"lights/background.exr", "read-only", "--force"});
  succeeds(bake({"--force"}));
  holds(cubes);
}

TEST_F(Bake, KeepsWhatEnginesWriteBesideItsFiles) {
  succeeds({"generate", "sun", "probe.exr", "--size", "16"});
  succeeds({"bake", "probe.exr", "lights", "--for", "usd", "-q"});
  const std::string first = read("lights/background.exr");
  write("lights/background.exr.import", "godot"), write("lights/light.usda.meta", "unity");
  succeeds({"bake", "probe.exr", "lights", "--for", "usd", "--size", "8", "-q"});
  EXPECT_NE(read("lights/background.exr"), first);
  EXPECT_EQ(read("lights/background.exr.import"), "godot");
  EXPECT_EQ(read("lights/light.usda.meta"), "unity");
  write("lights/other.exr.import", "godot");
  fails(2, {"bake", "probe.exr", "lights", "--for", "usd"}, {"contains other.exr.import"});
}

TEST_F(Bake, MakesMissingParents) {
  succeeds({"generate", "sun", "probe.exr", "--size", "16"});
  const auto before = names();
  fails(1, {"bake", "probe.exr", "a/b/lights", "--for", "unreal", "--max-error", "1e-6"}, {"a/b/lights"});
  EXPECT_EQ(names(), before);
  succeeds({"bake", "probe.exr", "a/b/lights", "--for", "usd", "-q"});
  EXPECT_TRUE(std::filesystem::exists(path("a/b/lights/background.exr")));
}

TEST_F(Bake, ASignalLeavesNothing) {
  succeeds({"generate", "sun", "probe.exr", "--size", "512"});
  const auto before = names();
  for (const int signal : {SIGTERM, SIGINT, SIGXCPU, SIGUSR1}) {  // The last two by batch systems.
    Background run(*this, {ENVMAP_PROGRAM, "bake", "probe.exr", "a/b/lights", "--for", "pbrt", "--size", "8192"});
    interrupt(run, signal, [&] { return names() != before; });
    EXPECT_EQ(names(), before);
  }
}

TEST_F(Bake, WhatAKilledOneLeavesTheNextRemoves) {
  succeeds({"generate", "sun", "probe.exr", "--size", "64"});
  const auto before = names();
  const std::vector<std::string> long_bake{ENVMAP_PROGRAM, "bake", "probe.exr", "lights",
                                           "--for",        "pbrt", "--size",    "8192"};
  const auto hidden = [&] {
    return std::ranges::count_if(names(),
                                 [](const std::string& n) { return n.starts_with(".lights.") && n.ends_with('/'); });
  };
  {
    Background run(*this, long_bake);
    interrupt(run, SIGKILL, [&] { return hidden() == 1; });
    ASSERT_EQ(hidden(), 1);
  }
  Background alive(*this, long_bake);
  for (int k = 0; k < 500 && hidden() != 1 + (k < 5); ++k) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_EQ(hidden(), 1) << "that of the dead is gone, that of the living is there";
  std::this_thread::sleep_for(std::chrono::seconds(1));  // It locks its folder just after it made it.
  alive.send(SIGSTOP);
  // Folders of others, whatever they are called.
  std::filesystem::create_directory(path(".lights-backup"));
  std::filesystem::create_directories(path(".lights.envmap-abcdef/deeper"));
  EXPECT_EQ(envmap({"bake", "probe.exr", "lights", "--for", "pbrt", "-q"}).status, 0);
  EXPECT_EQ(hidden(), 3);  // That of the living, and the one with a folder in it.
  EXPECT_TRUE(std::filesystem::exists(path(".lights-backup")));
  alive.send(SIGCONT);
  alive.send(SIGTERM);
  EXPECT_EQ(alive.wait().signal, SIGTERM);
  EXPECT_EQ(hidden(), 2);
  for (const std::string& name : before) EXPECT_TRUE(std::filesystem::exists(path(name))) << name;
}

TEST_F(Bake, LeavesReadOnlyFilesAlone) {
  succeeds({"generate", "sun", "probe.exr", "--size", "16"});
  succeeds({"bake", "probe.exr", "lights", "--for", "pbrt", "-q"});
  std::filesystem::permissions(path("lights/background.exr"), std::filesystem::perms(0444));
  fails(4, {"bake", "probe.exr", "lights", "--for", "pbrt", "-q"}, {"lights/background.exr", "read-only", "--force"});
  succeeds({"bake", "probe.exr", "lights", "--for", "pbrt", "-q", "--if-changed"});
  succeeds({"bake", "probe.exr", "lights", "--for", "pbrt", "-q", "--force"});
}

TEST_F(Bake, GoesWhereALinkLeads) {
  succeeds({"generate", "sky", "probe.exr", "--size", "8"});
  std::filesystem::create_directory(path("lights"));
  std::filesystem::create_directory_symlink("lights", path("link"));
  succeeds({"bake", "probe.exr", "link", "--for", "pbrt", "-q"});
  EXPECT_TRUE(std::filesystem::is_symlink(path("link")));
  EXPECT_TRUE(std::filesystem::exists(path("lights/README.txt")));
  fails(2, {"bake", "probe.exr", ".", "--for", "pbrt", "-q"}, {"the current folder"});
}

TEST_F(Bake, NeedsNoFlagsOfTheFileSystem) {
  if (shell("strace -o /dev/null true").status != 0) GTEST_SKIP() << "strace cannot be run";
  succeeds({"generate", "sky", "probe.exr", "--size", "8"});
  for (int k = 0; k < 2; ++k)
    EXPECT_EQ(shell("strace -f -o /dev/null -e inject=renameat2:error=EINVAL "
                    "\"$ENVMAP\" bake probe.exr lights --for pbrt -q").status, 0);
  EXPECT_EQ(names(), (std::vector<std::string>{"lights/", "lights/README.txt", "lights/background.exr",
                                               "lights/light.pbrt", "probe.exr"}));
}

TEST_F(Bake, SaysWhatALoaderCutsOff) {
  succeeds({"generate", "sun", "probe.exr", "--size", "16", "--value", "1e6", "--radius", "20"});
  const Result r = envmap({"bake", "probe.exr", "three", "--for", "three", "--latlong", "-q"});
  EXPECT_EQ(r.status, 0);
  EXPECT_NE(r.err.find("65504"), std::string::npos) << r.err;
}

// Levels of faces of 256 to 8 texels, whose last is a cosine's; a panorama of the same name on request; one depth.
TEST_F(Bake, ForThreeAreCubesThatItTakesAsTheyAre) {
  succeeds({"generate", "sky", "probe.exr", "--size", "32"});
  succeeds({"bake", "probe.exr", "cubes", "--for", "three", "--quality", "draft", "-q"});
  const auto info = nlohmann::json::parse(envmap({"info", "cubes/environment.ktx2", "--json"}).out);
  EXPECT_EQ(info["depth"], "uastc-hdr");
  EXPECT_EQ(info["levels"], 5);  // 128 to 8.
  succeeds({"convert", "cubes/environment.ktx2", "last.exr", "--level", "4", "--filter", "nearest", "-q"});
  succeeds({"convert", "last.exr", "mirrored.exr", "--to", "latlong", "--size", "16", "-q"});
  succeeds({"prefilter", "probe.exr", "cosine.exr", "--to", "latlong", "--size", "16", "-q"});
  const Picture made = load(path("mirrored.exr")), wanted = load(path("cosine.exr"));
  double off = 0, all = 0;
  for (int j = 0; j < 16; ++j)
    for (int i = 0; i < 32; ++i)
      for (int c = 0; c < 3; ++c) {
        const double a = made.at(31 - i, j)[c], b = wanted.at(i, j)[c];
        off += (a - b) * (a - b), all += b * b;
      }
  EXPECT_LT(std::sqrt(off / all), 0.03);
  fails(2, {"bake", "probe.exr", "halves", "--for", "three", "--depth", "half"}, {"uastc-hdr", "half"});
  fails(2, {"bake", "probe.exr", "lights", "--for", "unity", "--latlong"}, {"--latlong", "Unity"});
  fails(2, {"bake", "probe.exr", "small", "--for", "three", "--chain-size", "4"}, {"--chain-size 4", "down to 8"});
  succeeds({"bake", "probe.exr", "panorama", "--for", "three", "--latlong", "-q"});
  succeeds({"convert", "probe.exr", "panorama.exr", "--for", "three", "-q"});
  succeeds({"compare", "panorama/background.exr", "panorama.exr", "--max-error", "0"});
}

// background.jpg as UltraHDRLoader's panorama is looked up, by the formula of three-latlong; a sun above white stays.
TEST_F(Bake, ForThreeWriteABackgroundWithAGainMap) {
  succeeds({"generate", "directions", "probe.exr", "--to", "cube", "--size", "64"});
  succeeds({"bake", "probe.exr", "jpeg", "--for", "three", "--size", "64", "--gain-map", "--quality", "draft", "-q"});
  EXPECT_EQ(names(), (std::vector<std::string>{"jpeg/", "jpeg/README.txt", "jpeg/background.jpg",
                                               "jpeg/environment.ktx2", "probe.exr"}));
  succeeds({"convert", "jpeg/background.jpg", "read.exr", "--forward", "+x", "--from-forward", "+x", "-q"});
  const Picture map = load(path("read.exr"));
  ASSERT_EQ(map.width, 128);
  for (const double y : {-0.8, -0.2, 0.3, 0.7})
    for (const double x : {-0.6, 0.5})
      for (const double z : {-0.4, 0.45}) {
        const double length = std::sqrt(x * x + y * y + z * z);
        const Vec d{x / length, y / length, z / length};
        const float* const found = map.at(int((0.5 + std::atan2(d[2], d[0]) / (2 * pi)) * map.width),
                                          int((0.5 - std::asin(d[1]) / pi) * map.height));
        const auto wanted = colour_of(d);
        for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(found[c], wanted[c], 0.04) << x << ' ' << y << ' ' << z;
      }
  succeeds({"generate", "sun", "sun.exr", "--size", "64", "--value", "50", "--radius", "10", "-q"});
  succeeds({"bake", "sun.exr", "jpeg", "--for", "three", "--gain-map", "--quality", "draft", "-q"});  // Replaces it.
  EXPECT_NEAR(nlohmann::json::parse(envmap({"info", "jpeg/background.jpg", "--json", "-q"}).out)["maximum"][0], 50, 2);
  EXPECT_NE(read("jpeg/README.txt").find("above white"), std::string::npos);
  succeeds({"generate", "sky", "sky.exr", "--size", "64", "-q"});
  succeeds({"bake", "sky.exr", "jpeg", "--for", "three", "--gain-map", "--quality", "draft", "--size", "64",
            "--max-error", "0.05", "-q"});
  succeeds({"convert", "sky.exr", "wanted.exr", "--forward", "+x", "-q"});
  succeeds({"compare", "jpeg/background.jpg", "wanted.exr", "--from-forward", "+x", "--max-error", "0.05", "-q"});
  fails(2, {"bake", "sun.exr", "a", "--for", "unity", "--gain-map"}, {"--gain-map", "Unity"});
  fails(1, {"bake", "sun.exr", "a", "--for", "three", "--gain-map", "--max-error", "1e-4", "-q"},
        {"a/background.jpg", "cannot be met"});
}

TEST_F(Bake, ItsDepfileNamesAllThatItReadsAndWrites) {
  succeeds({"generate", "sun", "probe.exr", "--size", "32"});
  succeeds({"bake", "probe.exr", "a", "--for", "pbrt", "-q", "--depfile", "a.d"});
  for (const std::string file : {"a/background.exr", "a/light.pbrt", "a/README.txt", "probe.exr"})
    EXPECT_NE(read("a.d").find(file), std::string::npos) << file;
  // --if-changed leaves the folder and its times.
  const auto before = std::filesystem::last_write_time(path("a/background.exr"));
  succeeds({"bake", "probe.exr", "a", "--for", "pbrt", "-q", "--if-changed"});
  EXPECT_EQ(std::filesystem::last_write_time(path("a/background.exr")), before);
}

}  // namespace
}  // namespace command_tests::bake_test

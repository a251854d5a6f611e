// KTX2 and DDS, byte by byte: faces as the APIs define them, what the containers demand, what others' files may hold.
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <nlohmann/json.hpp>

#include "picture.h"
#include "run.h"

namespace command_tests::texture_test {
namespace {

// OpenGL 4.6, table 8.19: of a direction with major axis m, s = (sc / |m| + 1) / 2 and t = (tc / |m| + 1) / 2 with
//   +X: sc = -z, tc = -y    +Y: sc = x, tc = z     +Z: sc = x, tc = -y
//   -X: sc = z, tc = -y     -Y: sc = x, tc = -z    -Z: sc = -x, tc = -y
// Direct3D and Vulkan say the same. Worked out by hand for the four texels of each face of 2x2.
struct Entry {
  Vec direction;
  int face, i, j;
};
constexpr Entry api_table[] = {{{1, .5, .5}, 0, 0, 0},    {{1, .5, -.5}, 0, 1, 0},  {{1, -.5, .5}, 0, 0, 1},
                               {{1, -.5, -.5}, 0, 1, 1},  {{-1, .5, -.5}, 1, 0, 0}, {{-1, .5, .5}, 1, 1, 0},
                               {{-1, -.5, -.5}, 1, 0, 1}, {{-1, -.5, .5}, 1, 1, 1}, {{-.5, 1, -.5}, 2, 0, 0},
                               {{.5, 1, -.5}, 2, 1, 0},   {{-.5, 1, .5}, 2, 0, 1},  {{.5, 1, .5}, 2, 1, 1},
                               {{-.5, -1, .5}, 3, 0, 0},  {{.5, -1, .5}, 3, 1, 0},  {{-.5, -1, -.5}, 3, 0, 1},
                               {{.5, -1, -.5}, 3, 1, 1},  {{-.5, .5, 1}, 4, 0, 0},  {{.5, .5, 1}, 4, 1, 0},
                               {{-.5, -.5, 1}, 4, 0, 1},  {{.5, -.5, 1}, 4, 1, 1},  {{.5, .5, -1}, 5, 0, 0},
                               {{-.5, .5, -1}, 5, 1, 0},  {{.5, -.5, -1}, 5, 0, 1}, {{-.5, -.5, -1}, 5, 1, 1}};

template <class T>
T value_at(const std::string& bytes, std::size_t offset) {
  T value{};
  if (offset + sizeof value <= bytes.size()) std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

class Texture : public CommandTest {
 protected:
  // Expects what `generate directions` shows towards each entry in float RGBA texels (or RGB), faces this far apart.
  static void expect_table(const std::string& bytes, std::size_t start, std::size_t face_bytes,
                           std::size_t texel = 16) {
    for (const Entry& e : api_table) {
      const auto colour = colour_of(e.direction);
      const std::size_t at =
          start + std::size_t(e.face) * face_bytes + std::size_t(2 * e.j + e.i) * texel;
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_NEAR(value_at<float>(bytes, at + 4 * k), colour[k], 1e-6)
            << "face " << e.face << ": " << e.i << "," << e.j;
      if (texel == 16) {
        EXPECT_EQ(value_at<float>(bytes, at + 12), 1);
      }
    }
  }

  [[nodiscard]] Result check(const std::string& name) const { return shell("python3 '" ENVMAP_KTX2_CHECK "' " + name); }
};

TEST_F(Texture, HasTheFacesThatTheApisLookUp) {
  succeeds({"generate", "directions", "cube.exr", "--to", "cube", "--size", "2"});
  succeeds({"mipmap", "cube.exr", "cube.ktx2", "--depth", "float"});
  const std::string ktx2 = read("cube.ktx2");
  expect_table(ktx2, value_at<std::uint64_t>(ktx2, 80), 64);  // The level index begins at 80, base first.
  succeeds({"mipmap", "cube.exr", "cube.dds", "--depth", "float"});
  const std::string dds = read("cube.dds");
  expect_table(dds, 148, 64 + 16);  // A face has all its levels.
  EXPECT_EQ(dds.size(), 148U + 6 * (64 + 16));
  succeeds({"mipmap", "cube.exr", "cube.ktx", "--depth", "float"});
  const std::string ktx = read("cube.ktx");
  expect_table(ktx, 64 + value_at<std::uint32_t>(ktx, 60) + 4, 48, 12);  // Behind the pairs and the size of a face.
  for (const char* name : {"cube.ktx2", "cube.dds", "cube.ktx"}) {
    EXPECT_NE(envmap({"convert", name, "back.exr"}).err.find("2 levels, and only level 0 is converted"),
              std::string::npos);
    succeeds({"convert", name, "back.exr", "--filter", "nearest", "--level", "0"});
    EXPECT_EQ(load(path("back.exr")), load(path("cube.exr"))) << name;
  }
}

TEST_F(Texture, OfKtx2IsWhatTheSpecificationDemands) {
  // Depth and largest rms of it.
  constexpr std::pair<const char*, const char*> depths[] = {{"half", "5e-4"},
                                                            {"float", "0"},
                                                            {"rgb9e5", "2e-3"},
                                                            {"bc6h", "0.3"},  // Few texels, and black beside discs.
                                                            {"uastc-hdr", "0.3"}};
  constexpr const char* sizes[] = {"16", "5", "1"};
  std::size_t turn = 0;
  for (const std::string projection : {"latlong", "cube", "sphere", "paraboloid", "angular", "cube", "latlong"}) {
    const auto& [depth, limit] = depths[turn % 5];
    const std::string size = sizes[turn++ / 2 % 3];
    SCOPED_TRACE(projection + " " + size + " " + depth);
    succeeds({"generate", "directions", "in.exr", "--to", projection, "--size", size});
    succeeds({"mipmap", "in.exr", "plain.ktx2", "--depth", depth});
    succeeds({"mipmap", "in.exr", "packed.ktx2", "--depth", depth, "--zstd"});
    const Result r = check("plain.ktx2 packed.ktx2");
    EXPECT_EQ(r.status, 0) << r.out << r.err;
    succeeds({"compare", "plain.ktx2", "in.exr", "--max-rms", limit, "--level", "0"});
    succeeds({"compare", "packed.ktx2", "plain.ktx2", "--max-error", "0"});
  }
}

TEST_F(Texture, IsFaultedByTheCheckWhereverAByteIsWrong) {
  succeeds({"generate", "directions", "in.exr", "--to", "cube", "--size", "4"});
  succeeds({"mipmap", "in.exr", "good.ktx2"});
  const std::string good = read("good.ktx2");
  // Format, type size, faces, scheme, offsets, a level's length, total size, version, model, bits of a sample, a key.
  for (const std::size_t at : {0, 12, 16, 36, 44, 48, 56, 88, 152, 160, 164, 180, 262}) {
    std::string bad = good;
    bad.at(at) = static_cast<char>(bad.at(at) ^ 0x40);
    write("bad.ktx2", bad);
    EXPECT_EQ(check("bad.ktx2").status, 1) << "byte " << at;
  }
}

// The header as Babylon.js' GetEnvInfo reads it; the faces' orientation is looked at in tests/engines.
TEST_F(Texture, OfBabylonHasItsHeaderAndAllLevels) {
  succeeds({"generate", "directions", "in.exr", "--to", "cube", "--size", "16"});
  succeeds({"mipmap", "in.exr", "map.env"});
  const std::string file = read("map.env");
  ASSERT_EQ(file.substr(0, 8), "\x86\x16\x87\x96\xf6\xd6\x96\x36");
  const std::size_t start = file.find('\0');
  const auto header = nlohmann::json::parse(file.substr(8, start - 8));
  EXPECT_EQ(header["version"], 2);
  EXPECT_EQ(header["width"], 16);
  EXPECT_EQ(header["specular"]["lodGenerationScale"], 0.8);
  const auto& images = header["specular"]["mipmaps"];
  ASSERT_EQ(images.size(), 6 * 5U);
  for (const auto& image : images)
    EXPECT_EQ(file.substr(start + 1 + image["position"].get<std::size_t>(), 4), "\x89PNG");
  EXPECT_EQ(start + 1 + images.back()["position"].get<std::size_t>() + images.back()["length"].get<std::size_t>(),
            file.size());
  // Back: RGBD's rounding, at the least values of 0.02.
  succeeds({"convert", "map.env", "back.exr", "--level", "0", "--filter", "nearest"});
  succeeds({"compare", "back.exr", "in.exr", "--max-error", "0.03"});
  fails(4, {"convert", "in.exr", "one.env"}, {"one.env", "5 here, not 1: use 'envmap mipmap'"});
  fails(4, {"mipmap", "in.exr", "few.env", "--levels", "3"}, {"few.env", "5 here, not 3: raise --levels"});
  succeeds({"generate", "constant", "twelve.exr", "--to", "cube", "--size", "12"});
  fails(4, {"mipmap", "twelve.exr", "twelve.env"}, {"power of two", "such as 8, not 12"});
  succeeds({"mipmap", "map.env", "again.env"});
  fails(2, {"convert", "in.exr", "one.env", "--to", "latlong"}, {".env"});
  fails(4, {"mipmap", "in.exr", "light.glb"}, {"light.glb", "irradiance"});
  succeeds({"generate", "constant", "bright.exr", "--to", "cube", "--size", "2", "--value", "300"});
  fails(4, {"mipmap", "bright.exr", "bright.env"}, {"255", "--clamp"});
  // What is not PNG, and glTF without a light.
  std::string webp = file;
  webp.replace(webp.find("image/png"), 9, "image/xyz");
  write("webp.env", webp);
  fails(3, {"info", "webp.env"}, {"image/xyz", "image/png"});
  write("cut.env", file.substr(0, 600));
  fails(3, {"info", "cut.env"}, {"truncated or damaged"});
  write("scene.glb", std::string("glTF\2\0\0\0\x34\0\0\0\x20\0\0\0JSON", 20) + R"({"asset":{"version":"2.0"}}     )");
  fails(3, {"info", "scene.glb"}, {"EXT_lights_image_based"});
}

TEST_F(Texture, OfDdsHasTheHeaderThatDirectXDemands) {
  succeeds({"generate", "directions", "in.exr", "--to", "cube", "--size", "8"});
  const std::pair<const char*, std::uint32_t> formats[] = {{"half", 10}, {"float", 2}, {"rgb9e5", 67}, {"bc6h", 95}};
  for (const auto& [depth, dxgi] : formats) {
    succeeds({"mipmap", "in.exr", "cube.dds", "--depth", depth});
    const std::string bytes = read("cube.dds");
    const auto word = [&](std::size_t at) { return value_at<std::uint32_t>(bytes, at); };
    EXPECT_EQ(bytes.substr(0, 4), "DDS ");
    EXPECT_EQ(word(4), 124U);                 // Size of the header.
    EXPECT_EQ(word(8) & 0x21007U, 0x21007U);  // Caps, height, width, pixel format, level count are there,
    if (dxgi == 95) {                         // and of blocks the size of the first image, else of its rows.
      EXPECT_EQ(word(8) & 0x80008U, 0x80000U);
      EXPECT_EQ(word(20), 4 * 16U);
    }
    EXPECT_EQ(word(12), 8U);
    EXPECT_EQ(word(16), 8U);
    EXPECT_EQ(word(28), 4U);   // Levels.
    EXPECT_EQ(word(76), 32U);  // Size of the pixel format.
    EXPECT_EQ(word(80), 4U);   // It is a FourCC:
    EXPECT_EQ(bytes.substr(84, 4), "DX10");
    EXPECT_EQ(word(108), 0x1000U | 0x8U | 0x400000U);  // Texture, complex, levels.
    EXPECT_EQ(word(112), 0x200U | 0xfc00U);            // Cube with all faces.
    EXPECT_EQ(word(128), dxgi);
    EXPECT_EQ(word(132), 3U);  // A 2D texture,
    EXPECT_EQ(word(136), 4U);  // and six of them a cube,
    EXPECT_EQ(word(140), 1U);  // of which there is one.
    const std::size_t texel = dxgi == 2 ? 16 : dxgi == 10 ? 8 : 4;
    EXPECT_EQ(bytes.size(), 148 + 6 * (dxgi == 95 ? (4 + 1 + 1 + 1) * 16 : (64 + 16 + 4 + 1) * texel));
  }
}

TEST_F(Texture, OfBlocksIsAsGoodAsItSays) {
  succeeds({"generate", "directions", "in.exr", "--to", "cube", "--size", "32"});
  succeeds({"prefilter", "in.exr", "exact.exr", "--size", "32", "--method", "exact", "--depth", "float", "-q"});
  succeeds({"prefilter", "in.exr", "p.ktx2", "--size", "32", "--depth", "bc6h", "--max-error", "6e-2", "-q"});
  succeeds({"compare", "p.ktx2", "exact.exr", "--max-error", "6e-2"});
  fails(1, {"prefilter", "in.exr", "q.ktx2", "--size", "32", "--depth", "bc6h", "--max-error", "2e-3", "-q"},
        {"bc6h", "--depth half"});
  succeeds({"convert", "in.exr", "c.dds", "--depth", "bc6h", "--filter", "nearest"});
  const Result coarse = envmap({"compare", "c.dds", "in.exr", "--max-error", "0.6", "--max-rms", "4e-2"});
  EXPECT_EQ(coarse.status, 0) << coarse.out;
  succeeds({"convert", "in.exr", "d.dds", "--depth", "bc6h", "--max-error", "1.2", "-q"});
  fails(1, {"convert", "in.exr", "e.dds", "--depth", "bc6h", "--max-error", "1e-3", "-q"},
        {"e.dds", "bc6h rounds by up to"});
}

TEST_F(Texture, OfBlocksRefusesWhatHalfRefuses) {
  succeeds({"generate", "constant", "sun.exr", "--value", "70000,1,1", "--to", "cube", "--size", "8"});
  fails(4, {"convert", "sun.exr", "out.dds", "--depth", "bc6h"},
        {"65504", "bc6h", "--depth float", "--exposure", "--clamp"});
  succeeds({"convert", "sun.exr", "out.dds", "--depth", "bc6h", "--exposure", "-1", "--filter", "nearest"});
  succeeds({"convert", "out.dds", "back.exr", "--exposure", "1", "--filter", "nearest", "--depth", "float"});
  succeeds({"compare", "back.exr", "sun.exr", "--max-error", "2e-3"});
  EXPECT_NE(envmap({"convert", "sun.exr", "out.dds", "--depth", "bc6h", "--clamp"}).err.find("flux lost"),
            std::string::npos);
}

// As another writer might have made it: float RGB, no key/value data, the first row at the bottom.
TEST_F(Texture, OfOtherWritersIsRead) {
  std::string file("\xabKTX 20\xbb\r\n\x1a\n", 12);
  const auto add = [&](auto value) { file.append(reinterpret_cast<const char*>(&value), sizeof value); };
  const std::string pair("KTXorientation\0ru\0\0\0", 20);
  for (const std::uint32_t word : {106U, 4U, 4U, 2U, 0U, 0U, 1U, 0U, 0U, 104U, 0U, 104U, 24U}) add(word);
  for (const std::uint64_t word : {0U, 0U, 128U, 96U, 96U}) add(word);
  add(std::uint32_t{18});
  file += pair;
  Picture upright = latlong_directions(2);
  for (int y = 2; y-- > 0;)
    for (int k = 0; k < 12; ++k) add(upright.at(0, y)[k]);
  write("other.ktx2", file);
  succeeds({"convert", "other.ktx2", "out.exr", "--filter", "nearest"});
  EXPECT_EQ(load(path("out.exr")), upright);
}

// Bytes are what their format says: linear, or sRGB; alpha counts only where it is not opaque.
TEST_F(Texture, OfBytesIsReadAsItsFormatSays) {
  const auto file = [](std::uint32_t format, std::size_t channels, unsigned char alpha) {
    std::string bytes("\xabKTX 20\xbb\r\n\x1a\n", 12);
    const auto add = [&](auto value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); };
    for (const std::uint32_t word : {format, 1U, 2U, 1U, 0U, 1U, 1U, 1U, 0U, 104U, 0U, 0U, 0U}) add(word);
    const std::uint64_t size = 2 * channels;
    for (const std::uint64_t word : {std::uint64_t{0}, std::uint64_t{0}, std::uint64_t{104}, size, size}) add(word);
    for (int k = 0; k < 2; ++k) bytes += std::string({0, '\x80', '\xff', static_cast<char>(alpha)}).substr(0, channels);
    return bytes;
  };
  const double linear = 128 / 255.0, srgb = std::pow((linear + 0.055) / 1.055, 2.4);  // IEC 61966-2-1.
  for (const auto& [format, channels, green] :
       {std::tuple{23U, 3U, linear}, {29U, 3U, srgb}, {37U, 4U, linear}, {43U, 4U, srgb}}) {
    write("bytes.ktx2", file(format, channels, 255));
    succeeds({"convert", "bytes.ktx2", "out.exr", "--filter", "nearest", "--depth", "float"});
    const Picture out = load(path("out.exr"));
    EXPECT_EQ(out.at(1, 0)[0], 0) << format;
    EXPECT_NEAR(out.at(1, 0)[1], green, 1e-6) << format;
    EXPECT_NEAR(out.at(1, 0)[2], 1, 1e-6) << format;
  }
  write("clear.ktx2", file(37, 4, 254));
  fails(3, {"info", "clear.ktx2"}, {"alpha", "--drop-channels"});
}

TEST_F(Texture, OfKtxHasTheHeaderThatOpenGlDemands) {
  succeeds({"generate", "directions", "in.exr", "--to", "cube", "--size", "8"});
  struct Names {
    const char* depth;
    std::uint32_t type, type_size, format, internal, base, texel;
  };
  for (const Names& n : {Names{"half", 0x140b, 2, 0x1907, 0x881b, 0x1907, 6},
                         {"float", 0x1406, 4, 0x1907, 0x8815, 0x1907, 12},
                         {"rgb9e5", 0x8c3e, 4, 0x1907, 0x8c3d, 0x1907, 4},
                         {"bc6h", 0, 1, 0, 0x8e8f, 0x1907, 1}}) {
    SCOPED_TRACE(n.depth);
    succeeds({"mipmap", "in.exr", "cube.ktx", "--depth", n.depth});
    const std::string bytes = read("cube.ktx");
    const auto word = [&](std::size_t at) { return value_at<std::uint32_t>(bytes, at); };
    EXPECT_EQ(bytes.substr(0, 12), std::string("\xabKTX 11\xbb\r\n\x1a\n", 12));
    EXPECT_EQ(word(12), 0x04030201U);
    const std::uint32_t wanted[] = {n.type, n.type_size, n.format, n.internal, n.base, 8, 8, 0, 0, 6, 4};
    for (std::size_t k = 0; k < std::size(wanted); ++k) EXPECT_EQ(word(16 + 4 * k), wanted[k]) << k;
    const std::string pairs = bytes.substr(64, word(60));
    EXPECT_EQ(pairs.size() % 4, 0U);
    EXPECT_NE(pairs.find(std::string("KTXorientation\0S=r,T=d\0", 23)), std::string::npos);
    std::size_t at = 64 + pairs.size();
    for (std::uint32_t side = 8; side > 0; side /= 2) {  // Of a cube the size is that of a face.
      const std::uint32_t blocks = (side + 3) / 4, row = (side * n.texel + 3) / 4 * 4,
                          size = n.texel == 1 ? 16 * blocks * blocks : side * row;
      EXPECT_EQ(word(at), size);
      at += 4 + 6 * size;
    }
    EXPECT_EQ(bytes.size(), at);
    succeeds({"mipmap", "in.exr", "cube.ktx2", "--depth", n.depth});
    succeeds({"compare", "cube.ktx", "cube.ktx2", "--max-error", "0"});
  }
}

// A KTX file of 3x2 texels as another writer might have made it: rows fill words, or are not padded.
class OtherKtx : public Texture {
 protected:
  static std::string file(std::array<std::uint32_t, 4> names, const std::vector<std::string>& rows, std::size_t padding,
                          const std::string& orientation = "") {
    std::string bytes("\xabKTX 11\xbb\r\n\x1a\n", 12), pair = std::string("KTXorientation") + '\0' + orientation + '\0',
                                                       image;
    const auto add = [&](std::uint32_t word) { bytes.append(reinterpret_cast<const char*>(&word), 4); };
    for (const std::string& row : rows) image += row + std::string(padding, '\x7f');
    const auto pairs = std::uint32_t(orientation.empty() ? 0 : 4 + (pair.size() + 3) / 4 * 4);
    for (const std::uint32_t word :
         {0x04030201U, names[0], 1U, names[1], names[2], names[3], 4U, 2U, 0U, 0U, 1U, 1U, pairs})
      add(word);
    if (pairs > 0) {
      add(std::uint32_t(pair.size()));
      bytes += pair + std::string(pairs - 4 - pair.size(), '\0');
    }
    add(std::uint32_t(image.size()));
    return bytes + image;
  }
};

TEST_F(OtherKtx, IsReadAsItsFormatSays) {
  // 0, 0.5 and 1 in turn, four texels a row; the second row is brighter where it can be: 2.
  const std::string half_row = [] {
    std::string row;
    for (int k = 0; k < 4; ++k) row += std::string("\0\0\0\x38\0\x3c", 6);
    return row;
  }();
  const std::string two(24, '\x40');  // Halves of 0x4040: 2.125.
  for (const bool up : {false, true}) {
    write("a.ktx", file({0x140b, 0x1907, 0x881b, 0x1907}, {half_row, two}, 0, up ? "S=r,T=u" : "S=r,T=d"));
    succeeds({"convert", "a.ktx", "a.exr", "--filter", "nearest", "--depth", "float"});
    const Picture a = load(path("a.exr"));
    EXPECT_EQ(a.at(3, up ? 1 : 0)[1], 0.5F);
    EXPECT_EQ(a.at(3, up ? 0 : 1)[1], 2.125F);
  }
  // R11F_G11F_B10F: red 1 = 15 << 6, green 0.5 = 14 << 6, blue 2 = 16 << 5.
  const std::uint32_t packed = 15U << 6 | (14U << 6) << 11 | (16U << 5) << 22;
  std::string row;
  for (int k = 0; k < 4; ++k) row.append(reinterpret_cast<const char*>(&packed), 4);
  for (const std::uint32_t format : {0x1907U, 0x8c3aU}) {  // The second as cmgen wrote it until Filament 1.8.
    write("b.ktx", file({0x8c3b, format, 0x8c3a, 0x1907}, {row, row}, 0));
    succeeds({"convert", "b.ktx", "b.exr", "--filter", "nearest", "--depth", "float"});
    const Picture b = load(path("b.exr"));
    EXPECT_EQ(b.at(2, 1)[0], 1);
    EXPECT_EQ(b.at(2, 1)[1], 0.5F);
    EXPECT_EQ(b.at(2, 1)[2], 2);
  }
  const double linear = 128 / 255.0, srgb = std::pow((linear + 0.055) / 1.055, 2.4);
  std::string bytes;
  for (int k = 0; k < 4; ++k) bytes += std::string("\0\x80\xff\xff", 4);
  for (const auto& [internal, green] : {std::pair{0x8058U, linear}, {0x8c43U, srgb}}) {
    write("c.ktx", file({0x1401, 0x1908, internal, 0x1908}, {bytes, bytes}, 0));
    succeeds({"convert", "c.ktx", "c.exr", "--filter", "nearest", "--depth", "float"});
    EXPECT_NEAR(load(path("c.exr")).at(1, 1)[1], green, 1e-6);
  }
}

TEST_F(OtherKtx, HasRowsThatFillWordsOrDoNot) {
  // Two texels of 3 bytes: rows of 6 bytes, or of 8.
  for (const std::size_t padding : {0, 2}) {
    std::string ktx = file({0x1401, 0x1907, 0x8051, 0x1907}, {std::string("\0\0\0\x33\x66\xff", 6)}, padding);
    ktx[36] = 2, ktx[40] = 1;  // 2x1 texels.
    write("rows.ktx", ktx + std::string(padding == 0 ? 2 : 0, '\0'));  // The level itself fills words.
    succeeds({"convert", "rows.ktx", "rows.exr", "--filter", "nearest", "--depth", "float"});
    EXPECT_NEAR(load(path("rows.exr")).at(1, 0)[0], 0.2, 1e-6) << padding;
  }
}

TEST_F(OtherKtx, IsRefusedWhereItIsNotWhatIsRead) {
  const std::string row(4 * 8, '\0'), sound = file({0x140b, 0x1908, 0x881a, 0x1908}, {row, row}, 0, "S=r,T=d");
  const auto refuse = [&](std::size_t at, std::uint32_t value, const std::string& why) {
    std::string bad = sound;
    std::memcpy(bad.data() + at, &value, 4);
    write("bad.ktx", bad);
    fails(3, {"info", "bad.ktx"}, {"bad.ktx", why});
  };
  write("sound.ktx", sound);
  EXPECT_EQ(envmap({"info", "sound.ktx", "--drop-channels"}).status, 0);
  refuse(12, 0x01020304, "big-endian");
  refuse(12, 7, "neither byte order");
  refuse(16, 0x1406, "64 bytes, not 128");  // Floats.
  refuse(16, 0x1405, "glType 0x1405");
  refuse(24, 0x80e1, "glFormat 0x80e1");  // GL_BGRA.
  refuse(28, 0x83f3, "glInternalFormat 0x83f3");  // DXT5.
  refuse(36, 0, "0x");
  refuse(40, 0, "x0");
  refuse(40, 0xffffffff, "x2147483647");
  refuse(44, 4, "depth 4");
  refuse(48, 2, "2 array elements");
  refuse(52, 2, "2 faces");
  refuse(52, 6, "not square");
  refuse(56, 9, "9 levels");
  refuse(60, 1 << 30, "beyond its end");
  refuse(64, 1000, "pair");
  refuse(64 + 4 + 24, 12, "not 64");
  std::string left = sound;
  left.replace(left.find("S=r"), 3, "S=l");
  write("left.ktx", left);
  fails(3, {"info", "left.ktx"}, {"S=l,T=d"});
}

// What OpenImageIO is left to read: 8-bit texels, here B G R, encoded; and never a channel without bits.
TEST_F(Texture, OfDdsWithBytesIsReadToo) {
  std::string file = "DDS ";
  const auto add = [&](std::initializer_list<std::uint32_t> words) {
    for (const std::uint32_t word : words) file.append(reinterpret_cast<const char*>(&word), sizeof word);
  };
  add({124, 0x1007, 2, 4, 0, 0, 0});
  file.append(44, '\0');
  add({32, 0x40, 0, 24, 0xff0000, 0xff00, 0xff, 0, 0x1000, 0, 0, 0, 0});
  for (int k = 0; k < 8; ++k) file += std::string("\x00\x00\xff", 3);
  write("red.dds", file);
  succeeds({"convert", "red.dds", "red.exr", "--filter", "nearest", "--depth", "float"});
  const Picture red = load(path("red.exr"));
  EXPECT_EQ(red.width, 4);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(red.at(3, 1)[k], k == 0 ? 1 : 0, 1e-6);
  for (const std::size_t word : {88, 92, 100}) {  // Bits of a texel, and of red and blue.
    std::string bad = file;
    bad.replace(word, 4, 4, '\0');
    write("bad.dds", bad);
    fails(3, {"info", "bad.dds"}, {"damaged", "bits"});
  }
}

TEST_F(Texture, SaysWhatItCannotBe) {
  succeeds({"generate", "directions", "in.exr", "--to", "cube", "--size", "4"});
  fails(2, {"mipmap", "in.exr", "out.ktx2", "--layout", "row"}, {"out.ktx2", "--layout"});
  fails(2, {"mipmap", "in.exr", "out_{face}.dds"}, {"{face}"});
  fails(2, {"mipmap", "in.exr", "out.dds", "--zstd"}, {"Zstandard", ".ktx2"});
  fails(2, {"mipmap", "in.exr", "out.ktx2", "--depth", "uint8"}, {"half or float or rgb9e5 or bc6h"});
  fails(2, {"mipmap", "in.exr", "out.ktx2", "--openexr-envmap"}, {".exr"});
  succeeds({"mipmap", "in.exr", "out.ktx2"});
  fails(3, {"info", "out.ktx2", "--from", "latlong"}, {"out.ktx2", "cube"});
  fails(2, {"info", "out.ktx2", "--from-layout", "row"}, {"--from-layout"});
  fails(3, {"info", "out.ktx2", "--level", "3"}, {"levels are 0 to 2"});
  std::string bytes = read("out.ktx2");
  for (const auto& [offset, value] : {std::pair{12, 145}, {44, 1}, {28, 2}, {32, 7}, {36, 5}}) {  // BC7, BasisLZ, ...
    std::string other = bytes;
    other.at(std::size_t(offset)) = static_cast<char>(value);
    write("other.ktx2", other);
    fails(3, {"info", "other.ktx2"}, {"other.ktx2"});
  }
}

}  // namespace
}  // namespace command_tests::texture_test

// Rows of the table of claims: orientation and place on the sphere.
#include "claims.h"

namespace command_tests {
namespace {

constexpr std::array<double, 3> light{0.5, 0.25, 0.125};

std::string words(const std::vector<unsigned>& numbers) {
  std::string all;
  for (const unsigned n : numbers) all += little(n, 4);
  return all;
}

std::string repeated(const std::string& bytes, int times) {
  std::string all;
  for (int k = 0; k < times; ++k) all += bytes;
  return all;
}

// A cube of one texel a face (Microsoft, "DDS_HEADER" and "DDS_HEADER_DXT10").
std::string dds(unsigned caps2, unsigned dxgi, unsigned alpha, const std::string& texel) {
  return "DDS " + words({124, 0x1007, 1, 1, 0, 0, 1}) + std::string(44, '\0') + words({32, 4}) + "DX10" +
         words({0, 0, 0, 0, 0, 0x1000, caps2, 0, 0, 0, dxgi, 3, 4, 1, alpha}) + repeated(texel, 6);
}

// KTX 1.0, section 2: a flat image of 2x1 float RGB.
std::string ktx(const std::string& orientation) {
  const std::string pair = "KTXorientation" + std::string(1, '\0') + orientation + std::string(1, '\0');
  const std::string pairs = little(pair.size(), 4) + pair + std::string((4 - pair.size() % 4) % 4, '\0');
  return std::string("\xabKTX 11\xbb\r\n\x1a\n", 12) +
         words({0x04030201, 0x1406, 4, 0x1907, 0x8815, 0x1907, 2, 1, 0, 0, 1, 1, unsigned(pairs.size())}) + pairs +
         little(24, 4) + repeated(little_float(0.5F) + little_float(0.25F) + little_float(0.125F), 2);
}

// EXT_lights_image_based with faces of 1 x 1 white texels in a data URI.
std::string gltf(const std::string& more) {
  constexpr const char* white =
      "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR4nGP4//8/"
      "AAX+Av4N70a4AAAAAElFTkSuQmCC";
  return std::string(R"({"asset":{"version":"2.0"},"images":[{"uri":")") + white +
         R"("}],"extensions":{"EXT_lights_image_based":{"lights":[{"specularImageSize":1,)"
         R"("specularImages":[[0,0,0,0,0,0]])" +
         more + "}]}}}";
}

void add_textures(std::vector<ClaimRow>& rows) {
  // 188/255 and the like would not be exact: 255 and 0 are.
  const std::string bgra("\0\0\xff\xff", 4),
      half = little(0x3800, 2) + little(0x3400, 2) + little(0x3000, 2) + little(0x3c00, 2);
  rows.push_back({"DDS",
                  "dxgiFormat",
                  Becomes::honoured,
                  "srgb.dds",
                  dds(0xfe00, 91, 0, bgra),
                  {1, 0, 0},
                  {"B8G8R8A8_UNORM_SRGB"}});
  rows.push_back({"DDS",
                  "dxgiFormat",
                  Becomes::refused,
                  "two.dds",
                  dds(0xfe00, 49, 0, bgra),
                  {},
                  {"not supported", "R8G8_UNORM"}});
  rows.push_back(
      {"DDS", "alpha mode", Becomes::honoured, "alpha.dds", dds(0xfe00, 10, 2, half), light, {"premultiplied"}});
  rows.push_back(
      {"DDS", "cube faces", Becomes::refused, "some.dds", dds(0x7e00, 10, 0, half), {}, {"not supported", "faces"}});
  rows.push_back({"KTX", "KTXorientation", Becomes::honoured, "up.ktx", ktx("S=r,T=u"), light, {"S=r,T=u"}});
  rows.push_back(
      {"KTX", "KTXorientation", Becomes::refused, "left.ktx", ktx("S=l,T=d"), {}, {"not supported", "S=l,T=d"}});
  rows.push_back({"glTF light",
                  "intensity",
                  Becomes::honoured,
                  "bright.gltf",
                  gltf(R"(,"intensity":2.5)"),
                  {2.5, 2.5, 2.5},
                  {"2.5"}});
  rows.push_back(
      {"glTF light", "intensity", Becomes::refused, "dark.gltf", gltf(R"(,"intensity":-1)"), {}, {"intensity"}});
  rows.push_back({"glTF light",
                  "rotation",
                  Becomes::honoured,
                  "turned.gltf",
                  gltf(R"(,"rotation":[0,0.6,0,0.8])"),
                  {1, 1, 1},
                  {"73.7398 degrees"}});
  rows.push_back(
      {"glTF light", "rotation", Becomes::refused, "none.gltf", gltf(R"(,"rotation":[0,0,0,0])"), {}, {"rotation"}});
  const std::string texel = little_float(0.25F) + little_float(0.125F) + little_float(0.0625F);
  rows.push_back({"PFM", "scale", Becomes::honoured, "scale.pfm", "PF\n2 1\n-2\n" + repeated(texel, 2), light, {"-2"}});
  rows.push_back(
      {"PFM", "scale", Becomes::refused, "zero.pfm", "PF\n2 1\n0\n" + repeated(texel, 2), {}, {"scale is 0"}});
}

}  // namespace

std::vector<ClaimRow> claims_of_place() {
  std::vector<ClaimRow> rows;
  // Orientation 3: the picture is turned by 180 degrees, which a single colour does not show; its rows do elsewhere.
  rows.push_back({"TIFF",
                  "orientation",
                  Becomes::honoured,
                  "turned.tif",
                  tiff(2, 1, 3, 32, repeated(little_float(0.5F) + little_float(0.25F) + little_float(0.125F), 2),
                       {{339, 3, 3, little(3, 2) + little(3, 2) + little(3, 2)}, {274, 3, 1, little(3, 2)}}),
                  light,
                  {"bottom"}});
  add_textures(rows);
  return rows;
}

}  // namespace command_tests

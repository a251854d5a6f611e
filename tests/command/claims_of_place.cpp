// Rows of the table of claims: orientation and place on the sphere.
#include <cmath>

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

// GPano in XMP (ISO 16684-1, section 7): an image that is the upper half of its panorama.
std::string upper_half(int width, int height) {
  const auto number = [](const std::string& name, int n) {
    return "GPano:" + name + "=\"" + std::to_string(n) + "\" ";
  };
  return "<x:xmpmeta xmlns:x=\"adobe:ns:meta/\"><rdf:RDF xmlns:rdf=\"http://www.w3.org/1999/02/22-rdf-syntax-ns#\">"
         "<rdf:Description rdf:about=\"\" xmlns:GPano=\"http://ns.google.com/photos/1.0/panorama/\" " +
         number("FullPanoWidthPixels", width) + number("FullPanoHeightPixels", 2 * height) +
         number("CroppedAreaImageWidthPixels", width) + number("CroppedAreaImageHeightPixels", height) +
         number("CroppedAreaLeftPixels", 0) + number("CroppedAreaTopPixels", 0) + "/></rdf:RDF></x:xmpmeta>";
}

// WebP with an extended header, and the chunk of XMP behind the texels (WebP container specification).
std::string webp_with_xmp(int width, int height, const std::string& xmp) {
  const std::string plain = written_by_openimageio("a.webp", width, height, {188, 188, 188}, 3);
  if (plain.empty()) return plain;
  const std::string chunks = "VP8X" + little(10, 4) + little(4, 4) + little(std::uint64_t(width - 1), 3) +
                             little(std::uint64_t(height - 1), 3) + plain.substr(12) + "XMP " + little(xmp.size(), 4) +
                             xmp + std::string(xmp.size() % 2, '\0');
  return "RIFF" + little(4 + chunks.size(), 4) + "WEBP" + chunks;
}

// The lower half is black: the mean is half of what the texels are.
void add_panoramas(std::vector<ClaimRow>& rows) {
  const auto add = [&](const std::string& format, const std::string& name, const std::string& bytes,
                       const std::array<double, 3>& colour, const std::vector<std::string>& said, double tolerance) {
    if (!bytes.empty())
      rows.push_back({format,
                      "GPano",
                      Becomes::honoured,
                      name,
                      bytes,
                      {colour[0] / 2, colour[1] / 2, colour[2] / 2},
                      said,
                      tolerance});
  };
  const std::string xmp = upper_half(8, 2), linear = png_chunk("gAMA", big(100000, 4));
  const std::array<double, 3> texel{32768 / 65535.0, 16384 / 65535.0, 6554 / 65535.0};
  const std::string keyword("XML:com.adobe.xmp\0", 18);
  const std::vector<std::string> whole{"8x2 of a panorama of 8x4, at 0,0"};
  const auto text = [&](const std::string& data) {
    return png(8, 2, 16, {32768, 16384, 6554}, linear + png_chunk("iTXt", keyword + data));
  };
  add("PNG", "pano.png", text(std::string(4, '\0') + xmp), texel, whole, 1e-4);
  add("PNG", "packed-pano.png", text(std::string("\1\0en\0\0", 6) + stored_zlib(xmp)), texel, whole, 1e-4);
  rows.push_back({"PNG",
                  "GPano",
                  Becomes::refused,
                  "broken-pano.png",
                  text(std::string("\1\0\0\0", 4) + "no zlib"),
                  {},
                  {"damaged", "iTXt"}});
  const std::string strip = repeated(little_float(0.5F) + little_float(0.25F) + little_float(0.125F), 16);
  add("TIFF", "pano.tif",
      tiff(8, 2, 3, 32, strip, {{339, 3, 3, little(3, 2) + little(3, 2) + little(3, 2)}, {700, 1, xmp.size(), xmp}}),
      light, whole, 1e-4);
  const double grey = std::pow((188 / 255.0 + 0.055) / 1.055, 2.4);
  const std::array<double, 3> greys{grey, grey, grey};
  const std::vector<std::string> larger{"32x8 of a panorama of 32x16, at 0,0"};
  add("JPEG", "pano.jpg",
      jpeg(32, 8, {188, 188, 188},
           jpeg_segment(1, std::string("http://ns.adobe.com/xap/1.0/\0", 29) + upper_half(32, 8))),
      greys, larger, 2e-3);
  add("WebP", "pano.webp", webp_with_xmp(32, 8, upper_half(32, 8)), greys, larger, 0.02);
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
  add_panoramas(rows);
  return rows;
}

}  // namespace command_tests

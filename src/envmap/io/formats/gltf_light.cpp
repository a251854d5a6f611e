#include "envmap/io/formats/gltf_light.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "envmap/base/error.h"
#include "envmap/io/formats/gltf_document.h"
#include "envmap/io/texels/rgbd.h"
#include "envmap/io/write_plan.h"
#include "envmap/maths/portable.h"

namespace envmap {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* extension_name = "EXT_lights_image_based";
constexpr std::uint32_t glb_mark = 0x46546c67, json_chunk = 0x4e4f534a, binary_chunk = 0x004e4942;

struct GlbHeader {
  std::uint32_t mark, version, size, json_size, json_type;
};
struct ChunkHeader {
  std::uint32_t size, type;
};

std::uint32_t padded(std::size_t size) { return std::uint32_t((size + 3) / 4 * 4); }

Json document(const std::vector<RgbdFaces>& levels, const Json& harmonics, int size) {
  Json images = Json::array(), views = Json::array(), specular = Json::array();
  std::size_t position = 0;
  for (const RgbdFaces& level : levels) {
    Json& faces = specular.emplace_back(Json::array());
    for (const std::vector<char>& image : level) {
      faces.push_back(images.size());
      images.push_back({{"bufferView", views.size()}, {"mimeType", "image/png"}});
      views.push_back({{"buffer", 0}, {"byteOffset", position}, {"byteLength", image.size()}});
      position += padded(image.size());
    }
  }
  const Json light{{"name", "probe"},
                   {"intensity", 1.0},
                   {"rotation", {0.0, 0.0, 0.0, 1.0}},
                   {"irradianceCoefficients", harmonics},
                   {"specularImageSize", size},
                   {"specularImages", specular}};
  return {{"asset", {{"version", "2.0"}, {"generator", "envmap"}}},
          {"extensionsUsed", {extension_name}},
          {"extensions", {{extension_name, {{"lights", {light}}}}}},
          {"scene", 0},
          {"scenes", {{{"extensions", {{extension_name, {{"light", 0}}}}}}}},
          {"images", images},
          {"bufferViews", views},
          {"buffers", {{{"byteLength", position}}}}};
}

}  // namespace

void write_gltf_light(OutputFile& file, std::span<const Atlas> levels, const TexturePlan& plan,
                      const Progress& progress) {
  const auto size = unsigned(levels[0].width());
  const auto harmonics = plan.pairs.find("irradianceCoefficients");
  if (!std::has_single_bit(size) || levels.size() < 2)
    throw OutputError(
        fmt::format(".glb files need several levels and a power-of-two face size, not {} level(s) of {}x{}",
                    levels.size(), size, size));
  if (harmonics == plan.pairs.end()) throw OutputError(".glb files need irradiance as well, which this map lacks");
  const std::vector<RgbdFaces> faces = rgbd_faces(levels, progress);
  std::string text = document(faces, Json::parse(harmonics->second), int(size)).dump();
  text.resize(padded(text.size()), ' ');
  std::size_t binary = 0;
  for (const RgbdFaces& level : faces)
    for (const std::vector<char>& image : level) binary += padded(image.size());
  const std::size_t all = sizeof(GlbHeader) + text.size() + sizeof(ChunkHeader) + binary;
  if (all > 0xffffffff) throw OutputError("a .glb file holds up to 4 GiB");
  const GlbHeader header{glb_mark, 2, std::uint32_t(all), std::uint32_t(text.size()), json_chunk};
  const ChunkHeader chunk{std::uint32_t(binary), binary_chunk};
  file.write(&header, sizeof header);
  file.write(text.data(), text.size());
  file.write(&chunk, sizeof chunk);
  for (const RgbdFaces& level : faces)
    for (const std::vector<char>& image : level) {
      file.write(image.data(), image.size());
      file.write("\0\0\0", padded(image.size()) - image.size());
    }
}

bool is_gltf(std::string_view head) {
  constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";
  if (head.starts_with(byte_order_mark)) head.remove_prefix(byte_order_mark.size());
  return head.starts_with("glTF") ||
         head.substr(std::min(head.find_first_not_of(" \t\r\n"), head.size())).starts_with('{');
}

namespace {

// The light that the scene shows, else the first.
Field light_in(const GltfDocument& document) {
  const Field root = document.root(), all = root["extensions"][extension_name]["lights"], scenes = root["scenes"];
  if (all.size() == 0)
    throw InputError(fmt::format("glTF without a light of {}: a scene is drawn by 'envmap render'", extension_name));
  if (scenes.size() == 0) return all[std::size_t{0}];
  const Field scene = scenes[root["scene"].index(scenes.size(), 0)];
  return all[scene["extensions"][extension_name]["light"].index(all.size(), 0)];
}

// The file of each face, in levels.
std::vector<std::vector<std::byte>> images_in(GltfDocument& document, const Field& light) {
  std::vector<std::vector<std::byte>> files;
  const Field levels = light["specularImages"];
  constexpr std::size_t most_levels = 32;  // A file can name one image again and again.
  if (levels.size() > most_levels) levels.fail(fmt::format("holds {} levels, more than any map", levels.size()));
  for (std::size_t k = 0; k < levels.size(); ++k) {
    if (levels[k].size() != 6) levels[k].fail(fmt::format("holds {} images, not six faces", levels[k].size()));
    for (std::size_t face = 0; face < 6; ++face) {
      const Field image = document.refer(levels[k][face], "images");
      if (image["uri"].there()) {
        Resource read = bytes_at(document, image["uri"]);
        files.push_back(std::move(read.bytes));
        if (!read.file.empty()) document.files.push_back(read.file);
        continue;
      }
      const auto bytes = view_bytes(document, image["bufferView"]);
      files.emplace_back(bytes.begin(), bytes.end());
    }
  }
  return files;
}

glm::dquat rotation_of(const Field& field) {
  const std::vector<double> q = field.numbers({0, 0, 0, 1});
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (std::abs(length - 1) > 0.01) field.fail(fmt::format("has the length {:g}: no unit quaternion", length));
  return glm::dquat(q[3], q[0], q[1], q[2]) / length;
}

void read_claims(const Field& light, TextureFile& texture) {
  texture.gain = light["intensity"].number(1, 0, 1e30);
  const glm::dquat turn = rotation_of(light["rotation"]);
  texture.rotation = glm::mat3_cast(turn);
  const Field size = light["specularImageSize"];
  if (size.there() && size.number() != texture.width)
    texture.notes.push_back(
        fmt::format("specularImageSize says {}: its images are {}x{}", size.number(), texture.width, texture.height));
  if (light["intensity"].there())
    texture.claims.push_back({.name = "intensity", .value = fmt::format("{:g}", texture.gain)});
  if (texture.gain != 1) texture.details.push_back(fmt::format("multiplied by its intensity of {:g}", texture.gain));
  const double axis = std::sqrt(turn.x * turn.x + turn.y * turn.y + turn.z * turn.z);
  const double degrees = 360 / pi * portable::atan2(axis, std::abs(turn.w));
  if (light["rotation"].there())
    texture.claims.push_back({.name = "rotation", .value = fmt::format("{:.6g} degrees", degrees)});
  if (degrees > 1e-6) texture.details.push_back(fmt::format("turned by {:.6g} degrees, as its rotation says", degrees));
}

}  // namespace

TextureFile open_gltf_light(const InputFile& file, const std::string& path) {
  const std::vector<std::byte> bytes = read_bytes(file, 0, file.size());
  std::optional<std::span<const std::byte>> bin;
  GltfDocument document = parse_gltf(bytes, SceneFolder(path), bin);
  const Field light = light_in(document);
  load_buffers(document, bin);
  const auto files = std::make_shared<const std::vector<std::vector<std::byte>>>(images_in(document, light));
  std::uint64_t size = 0;
  for (const auto& image : *files) size += image.size();
  TextureFile texture = rgbd_texture(
      file, "glb", files->size(), [files](const InputFile&, std::size_t k) { return (*files)[k]; }, size);
  read_claims(light, texture);
  texture.files = document.files;
  return texture;
}

}  // namespace envmap

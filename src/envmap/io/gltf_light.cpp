#include <fmt/format.h>

#include <bit>
#include <nlohmann/json.hpp>

#include "envmap/base/error.h"
#include "envmap/io/containers.h"
#include "envmap/io/rgbd.h"
#include "envmap/io/whole_number.h"
#include "envmap/io/write_plan.h"

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

bool is_glb(std::string_view head) { return head.starts_with("glTF"); }

TextureFile open_gltf_light(const InputFile& file) {
  const auto h = read_as<GlbHeader>(file, 0);
  if (h.version != 2 || h.json_type != json_chunk) throw InputError("damaged: not glTF 2.0");
  const std::vector<std::byte> text = read_bytes(file, sizeof h, h.json_size);
  const std::uint64_t start = sizeof h + std::uint64_t{h.json_size} + sizeof(ChunkHeader);
  try {
    const Json gltf = Json::parse(reinterpret_cast<const char*>(text.data()),
                                  reinterpret_cast<const char*>(text.data() + text.size()));
    if (!gltf.contains("extensions") || !gltf["extensions"].contains(extension_name))
      throw InputError(fmt::format("glTF without a light of {}: a scene is drawn by 'envmap render'", extension_name));
    std::vector<FilePart> parts;
    for (const Json& level : gltf["extensions"][extension_name].at("lights").at(0).at("specularImages"))
      for (const Json& index : level) {
        const Json& image = gltf.at("images").at(whole_number(index));
        const Json& view = gltf.at("bufferViews").at(whole_number(image.at("bufferView")));
        const std::uint64_t offset = view.contains("byteOffset") ? whole_number(view["byteOffset"]) : 0;
        if ((view.contains("buffer") && whole_number(view["buffer"]) != 0) || offset > file.size())
          throw InputError("damaged: an image lies beyond its end");
        parts.push_back({start + offset, whole_number(view.at("byteLength"))});
      }
    return rgbd_texture(file, "glb", std::move(parts));
  } catch (const Json::exception&) {
    throw InputError(fmt::format("damaged: its {} is not as that extension has it, with PNG images inside the file",
                                 extension_name));
  }
}

}  // namespace envmap

#include <algorithm>
#include <initializer_list>

#include "envmap/scene/read/gltf_reader.h"
#include "envmap/scene/read/read_texture.h"

namespace envmap {
namespace {

Texture::Wrap wrap_of(const Field& mode) {
  switch (mode.index(65536, 10497)) {
    case 10497: return Texture::Wrap::repeat;
    case 33648: return Texture::Wrap::mirror;
    case 33071: return Texture::Wrap::clamp;
    default: mode.fail("is no way to wrap");
  }
}

Texture open_texture(GltfReader& r, const Field& field) {
  const GltfDocument& document = r.document;
  const Field image = document.refer(field["source"], "images"), view = image["bufferView"];
  Resource read;
  if (!view.there()) read = bytes_at(document, image["uri"]);
  if (!read.file.empty()) r.scene.files.push_back(read.file);
  const std::span<const std::byte> bytes =
      view.there() ? view_bytes(document, view) : std::span<const std::byte>(read.bytes);
  const auto* first = reinterpret_cast<const char*>(bytes.data());
  const std::string text = image["uri"].text();
  const std::string name = text.empty() || text.starts_with("data:") ? "an image in the file" : text;
  return decode_texture(name, {first, first + bytes.size()}, r.pixels_left);
}

// @param info a textureInfo, may be absent. @return index into scene.textures or -1.
int texture(GltfReader& r, const Field& info, bool colour) {
  if (!info.there()) return -1;
  const Field field = r.document.refer(info["index"], "textures");
  if (info["texCoord"].index(64, 0) > 0) r.note_unsupported("a second set of texture coordinates");
  if (!field["source"].there()) {
    r.note_unsupported("images in other formats than PNG and JPEG");
    return -1;
  }
  const std::pair key(info["index"].index(1u << 31), colour);
  if (const auto found = r.textures.find(key); found != r.textures.end()) return found->second;
  Texture t;
  try {
    t = open_texture(r, field);
  } catch (const MissingFile& e) {
    if (!r.allow_missing) throw;
    note_once(r.scene.remarks, std::string(e.what()) + "; its surfaces have no texture");
    return r.textures[key] = -1;
  }
  t.srgb = colour;
  if (field["sampler"].there()) {
    const Field sampler = r.document.refer(field["sampler"], "samplers");
    t.wrap_u = wrap_of(sampler["wrapS"]);
    t.wrap_v = wrap_of(sampler["wrapT"]);
    if (sampler["magFilter"].index(65536, 9729) == 9728) r.note_unsupported("textures without interpolation");
  }
  r.scene.textures.push_back(std::move(t));
  return r.textures[key] = int(r.scene.textures.size()) - 1;
}

TextureTransform transform_of(GltfReader& r, const Field& info) {
  const Field extension = info["extensions"]["KHR_texture_transform"];
  if (extension["texCoord"].index(64, 0) > 0) r.note_unsupported("a second set of texture coordinates");
  const auto offset = extension["offset"].numbers({0, 0}), scale = extension["scale"].numbers({1, 1});
  return {{offset[0], offset[1]}, {scale[0], scale[1]}, extension["rotation"].number(0, -1e6, 1e6)};
}

// What all textures of a material share: coordinates are those of the mesh.
TextureTransform transform_of(GltfReader& r, std::initializer_list<Field> infos) {
  std::optional<TextureTransform> first;
  for (const Field& info : infos)
    if (info.there()) {
      const TextureTransform found = transform_of(r, info);
      if (first && *first != found) r.note_unsupported("a transform of each texture of a material");
      if (!first) first = found;
    }
  return first.value_or(TextureTransform{});
}

// KHR_materials_unlit: the base colour is what is seen. It becomes emission, and nothing is reflected.
void make_unlit(Material& m) {
  m.emissive = Colour(m.base_colour);
  m.emissive_texture = m.base_colour_texture;
  m.base_colour = {0, 0, 0, m.base_colour.w};
  m.metallic_roughness_texture = m.normal_texture = m.occlusion_texture = m.coat_normal_texture = -1;
  m.metallic = 0, m.roughness = 1, m.transmission = 0, m.ior = 1, m.coat = 0, m.sheen = Colour(0);
}

// KHR_materials_clearcoat.
void read_coat(GltfReader& r, const Field& coat, Material& m) {
  m.coat = float(coat["clearcoatFactor"].number(0, 0, 1));
  m.coat_roughness = float(coat["clearcoatRoughnessFactor"].number(0, 0, 1));
  if (m.coat == 0) return;
  m.coat_texture = texture(r, coat["clearcoatTexture"], false);
  m.coat_roughness_texture = texture(r, coat["clearcoatRoughnessTexture"], false);
  m.coat_normal_texture = texture(r, coat["clearcoatNormalTexture"], false);
  m.coat_normal_scale = float(coat["clearcoatNormalTexture"]["scale"].number(1, -1e6, 1e6));
}

// KHR_materials_sheen.
void read_sheen(GltfReader& r, const Field& sheen, Material& m) {
  const auto colour = sheen["sheenColorFactor"].numbers({0, 0, 0});
  for (int k = 0; k < 3; ++k) m.sheen[k] = float(std::clamp(colour[std::size_t(k)], 0.0, 1.0));
  m.sheen_roughness = float(sheen["sheenRoughnessFactor"].number(0, 0, 1));
  if (m.sheen == Colour(0)) return;
  m.sheen_texture = texture(r, sheen["sheenColorTexture"], true);
  m.sheen_roughness_texture = texture(r, sheen["sheenRoughnessTexture"], false);
}

Material material_from(GltfReader& r, const Field& field) {
  const Field metallic = field["pbrMetallicRoughness"], extensions = field["extensions"];
  Material m{.name = field["name"].text()};
  const auto base = metallic["baseColorFactor"].numbers({1, 1, 1, 1}, 0, 1);
  m.base_colour = glm::vec4(base[0], base[1], base[2], base[3]);
  m.base_colour_texture = texture(r, metallic["baseColorTexture"], true);
  m.metallic = float(metallic["metallicFactor"].number(1, 0, 1));
  m.roughness = float(metallic["roughnessFactor"].number(1, 0, 1));
  m.metallic_roughness_texture = texture(r, metallic["metallicRoughnessTexture"], false);
  const auto emissive = field["emissiveFactor"].numbers({0, 0, 0}, 0, most_light);
  const double strength = extensions["KHR_materials_emissive_strength"]["emissiveStrength"].number(1, 0, 1e30);
  m.emissive = Colour(Flux(emissive[0], emissive[1], emissive[2]) * strength);
  m.emissive_texture = texture(r, field["emissiveTexture"], true);
  const Field transmission = extensions["KHR_materials_transmission"];
  m.transmission = float(transmission["transmissionFactor"].number(0, 0, 1));
  if (transmission["transmissionTexture"].there()) r.note_unsupported("textures of transmission");
  // 0 stands for infinity there, the old metal-like workflow; it reflects everything.
  m.ior = float(extensions["KHR_materials_ior"]["ior"].number(1.5, 0, 1e6));
  if (m.ior < 1) m.ior = m.ior == 0 ? 1e6F : 1;
  const Field volume = extensions["KHR_materials_volume"];
  m.solid = volume["thicknessFactor"].number(0, 0, 1e30) > 0;
  if (m.solid && volume["attenuationDistance"].there()) r.note_unsupported("absorption inside glass");
  m.double_sided = field["doubleSided"].truth(false);
  const std::string mode = field["alphaMode"].text("OPAQUE");
  if (mode == "MASK") m.alpha_cutoff = float(field["alphaCutoff"].number(0.5, 0, 1e6));
  // Light passes or it does not: it takes half as the limit.
  if (mode == "BLEND") m.blended = true, m.alpha_cutoff = 0.5F;
  const Field normal = field["normalTexture"], occlusion = field["occlusionTexture"];
  m.normal_texture = texture(r, normal, false);
  m.normal_scale = float(normal["scale"].number(1, -1e6, 1e6));
  m.occlusion_texture = texture(r, occlusion, false);
  m.occlusion_strength = float(occlusion["strength"].number(1, 0, 1));
  const Field coat = extensions["KHR_materials_clearcoat"], sheen = extensions["KHR_materials_sheen"];
  read_coat(r, coat, m);
  read_sheen(r, sheen, m);
  r.transforms.push_back(
      transform_of(r, {metallic["baseColorTexture"], metallic["metallicRoughnessTexture"], field["emissiveTexture"],
                       normal, occlusion, coat["clearcoatTexture"], coat["clearcoatRoughnessTexture"],
                       coat["clearcoatNormalTexture"], sheen["sheenColorTexture"], sheen["sheenRoughnessTexture"]}));
  if (extensions["KHR_materials_unlit"].there()) make_unlit(m);
  return m;
}

}  // namespace

void read_material(GltfReader& r, const Field& field) { r.scene.materials.push_back(material_from(r, field)); }

int material_of(GltfReader& r, const Field& index) {
  if (index.there()) return int(index.index(r.document.root()["materials"].size()));
  if (r.plain_material < 0) {
    r.plain_material = int(r.scene.materials.size());
    r.scene.materials.push_back({.metallic = 1, .roughness = 1});
  }
  return r.plain_material;
}

}  // namespace envmap

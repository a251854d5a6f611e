#include "envmap/scene/read/read_obj.h"

#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cmath>
#include <filesystem>
#include <map>

#include "envmap/base/error.h"
#include "envmap/scene/mesh.h"
#include "envmap/scene/read/read_texture.h"

namespace envmap {
namespace {

struct Reader {
  std::filesystem::path folder;
  Scene scene = {};
  std::map<std::string, int> textures = {};  // By path.
};

int texture(Reader& r, const aiMaterial& from, aiTextureType type) {
  aiString name;
  aiTextureMapMode modes[3] = {aiTextureMapMode_Wrap, aiTextureMapMode_Wrap, aiTextureMapMode_Wrap};
  if (from.GetTexture(type, 0, &name, nullptr, nullptr, nullptr, nullptr, modes) != aiReturn_SUCCESS) return -1;
  std::string path = name.C_Str();
  std::ranges::replace(path, '\\', '/');  // As written on Windows.
  const auto [found, first] = r.textures.try_emplace(path, static_cast<int>(r.scene.textures.size()));
  if (!first) return found->second;
  Texture made = read_texture_file((r.folder / path).string());
  if (modes[0] == aiTextureMapMode_Clamp) made.wrap_u = made.wrap_v = Texture::Wrap::clamp;
  r.scene.textures.push_back(std::move(made));
  return found->second;
}

Material material(Reader& r, const aiMaterial& from) {
  Material m;
  aiString name;
  if (from.Get(AI_MATKEY_NAME, name) == aiReturn_SUCCESS) m.name = name.C_Str();
  const auto number = [&](float otherwise, float least, float most, const char* key, unsigned type, unsigned index) {
    float value = otherwise;
    if (from.Get(key, type, index, value) != aiReturn_SUCCESS || !std::isfinite(value)) value = otherwise;
    return std::clamp(value, least, most);
  };
  const auto colour = [&](const Colour& otherwise, const char* key, unsigned type, unsigned index) {
    aiColor3D value;
    if (from.Get(key, type, index, value) != aiReturn_SUCCESS) return otherwise;
    const Colour found(value.r, value.g, value.b);
    if (!(glm::all(glm::greaterThanEqual(found, Colour(0))) && glm::all(glm::lessThan(found, Colour(1e30F)))))
      throw InputError("material '" + m.name + "' holds a colour that is none");
    return found;
  };
  m.base_colour_texture = texture(r, from, aiTextureType_DIFFUSE);
  // assimp's grey of 0.6 stands where the file says nothing.
  m.base_colour = glm::vec4(colour(Colour(1), AI_MATKEY_COLOR_DIFFUSE), 1);
  m.emissive = colour(Colour(0), AI_MATKEY_COLOR_EMISSIVE);
  m.emissive_texture = texture(r, from, aiTextureType_EMISSIVE);
  if (m.emissive_texture >= 0 && m.emissive == Colour(0)) m.emissive = Colour(1);
  m.metallic = number(0, 0, 1, AI_MATKEY_METALLIC_FACTOR);
  // Blinn and Phong's exponent n and GGX's alpha fall off alike near the peak where n = 2 / alpha^2 - 2 (Walter et al. 2007).
  const float exponent = number(0, 0, 1e8F, AI_MATKEY_SHININESS);
  m.roughness = number(std::pow(2 / (exponent + 2), 0.25F), 0, 1, AI_MATKEY_ROUGHNESS_FACTOR);
  m.ior = number(1.5F, 1, 1e6F, AI_MATKEY_REFRACTI);
  m.double_sided = true;  // OBJ knows no inside.
  if (number(1, 0, 1, AI_MATKEY_OPACITY) < 1 || from.GetTextureCount(aiTextureType_OPACITY) > 0)
    note_unmodelled(r.scene, "alpha blending");
  if (from.GetTextureCount(aiTextureType_HEIGHT) > 0 || from.GetTextureCount(aiTextureType_NORMALS) > 0)
    note_unmodelled(r.scene, "normal maps");
  return m;
}

glm::vec3 vector(const aiVector3D& v, const char* what) {
  if (!(std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z)))
    throw InputError(fmt::format("holds {} that are NaN or infinite", what));
  return {v.x, v.y, v.z};
}

Mesh mesh(const aiMesh& from) {
  Mesh made{.material = static_cast<int>(from.mMaterialIndex)};
  for (unsigned k = 0; k < from.mNumVertices; ++k) {
    made.positions.push_back(vector(from.mVertices[k], "vertices"));
    if (from.HasNormals()) made.normals.push_back(vector(from.mNormals[k], "normals"));
    if (!from.HasTextureCoords(0)) continue;
    const glm::vec3 at = vector(from.mTextureCoords[0][k], "texture coordinates");
    made.coordinates.emplace_back(at.x, 1 - at.y);  // Down from the upper edge, as in glTF.
  }
  for (unsigned f = 0; f < from.mNumFaces; ++f) {
    const aiFace& face = from.mFaces[f];
    if (face.mNumIndices != 3) continue;
    for (unsigned c = 0; c < 3; ++c) {
      if (face.mIndices[c] >= from.mNumVertices)
        throw InputError(fmt::format("points to vertex {}, but there are {}", face.mIndices[c], from.mNumVertices));
      made.indices.push_back(face.mIndices[c]);
    }
  }
  complete(made);
  return made;
}

void read_node(Reader& r, const aiNode& from, int parent) {
  Node node{.name = from.mName.C_Str(), .parent = parent};
  const aiMatrix4x4& m = from.mTransformation;
  for (unsigned row = 0; row < 4; ++row)
    for (unsigned column = 0; column < 4; ++column)
      node.local[static_cast<int>(column)][static_cast<int>(row)] = m[row][column];
  for (unsigned k = 0; k < from.mNumMeshes; ++k) node.meshes.push_back(static_cast<int>(from.mMeshes[k]));
  const int index = static_cast<int>(r.scene.nodes.size());
  r.scene.nodes.push_back(std::move(node));
  for (unsigned k = 0; k < from.mNumChildren; ++k) read_node(r, *from.mChildren[k], index);  // OBJ: groups, one deep.
}

}  // namespace

Scene read_obj(const std::string& path) {
  Assimp::Importer importer;
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  const aiScene* from = importer.ReadFile(path, aiProcess_Triangulate | aiProcess_SortByPType);
  if (from == nullptr) {
    const std::string why = importer.GetErrorString();
    throw InputError("not a sound OBJ file: " + why.substr(0, why.find('\n')));
  }
  Reader r{std::filesystem::path(path).parent_path()};
  for (unsigned k = 0; k < from->mNumMaterials; ++k) r.scene.materials.push_back(material(r, *from->mMaterials[k]));
  for (unsigned k = 0; k < from->mNumMeshes; ++k) r.scene.meshes.push_back(mesh(*from->mMeshes[k]));
  if (from->mRootNode != nullptr) read_node(r, *from->mRootNode, -1);
  return std::move(r.scene);
}

}  // namespace envmap

/// @file
/// Reading scenes: glTF 2.0 (.gltf, .glb) and Wavefront OBJ.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "envmap/scenes/scene/scene_graph.h"

namespace envmap {

/// What is in glTF's default scene: nodes with their meshes, materials, textures, KHR_lights_punctual, cameras, the
/// movements of nodes, skins and morph targets (as of time 0: skin_and_morph.h); extensions:
/// KHR_materials_emissive_strength, _transmission, _ior, _volume, _clearcoat, _sheen, _unlit, KHR_texture_transform,
/// KHR_mesh_quantization, KHR_draco_mesh_compression. Normals are those of the triangles where the file has none. Of
/// OBJ files see read_obj.h. SceneGraph::unsupported names what else they use; a file that *requires* an extension not
/// named here is refused.
///
/// Every index, count and number is checked before it is used.
/// @param path `-` for standard input; then what the scene names lies in the current folder.
/// @param max_pixels of all textures together. @param allow_missing whether surfaces have no texture where its file is
/// not there, which SceneGraph::remarks then says. @throws InputError in one line, naming the file; MissingFile where
/// the file of a texture is not there.
SceneGraph read_scene(const std::string& path, std::uint64_t max_pixels = std::uint64_t{1} << 31,
                      bool allow_missing = false);

/// What errors call a scene that is no file.
inline constexpr const char* scene_in_memory = "scene in memory";

/// The same of a file in memory. @param folder where the files that it names lie; empty: then it may name none.
SceneGraph read_scene(std::span<const std::byte> file, const std::string& folder,
                      std::uint64_t max_pixels = std::uint64_t{1} << 31, bool allow_missing = false);

}  // namespace envmap

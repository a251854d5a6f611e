/// @file
/// Morph targets and skins of a glTF file.
#pragma once

#include <map>
#include <span>

#include "envmap/scene/read/gltf_document.h"
#include "envmap/scene/scene.h"

namespace envmap {

/// What moves the vertices of a primitive, as the file numbers them; `rest` is not there yet.
/// @param vertices as many as it has.
Deformation read_shape(const GltfDocument& document, const Field& primitive, std::size_t vertices, Scene& scene);

/// The same for a mesh made ready to be drawn, which may have repeated vertices.
/// @param before its corners as they were.
void finish_shape(Deformation& shape, const std::vector<std::uint32_t>& before, const Mesh& mesh);

/// Into scene.deformations, for each node whose mesh moves; a mesh of several nodes is repeated for them.
/// @param placed where in scene.nodes each node of the document is; -1: not in the scene.
/// @param shapes by mesh of the scene.
void read_deformations(const GltfDocument& document, std::span<const int> placed,
                       const std::map<int, Deformation>& shapes, Scene& scene);

}  // namespace envmap

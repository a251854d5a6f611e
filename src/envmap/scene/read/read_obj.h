/// @file
/// Wavefront OBJ with its MTL files, through assimp.
#pragma once

#include <string>

#include "envmap/scene/scene.h"

namespace envmap {

/// Phong's exponent becomes the roughness whose lobe is as wide; Pm and Pr are taken as they are.
/// @throws InputError without the name of the file.
Scene read_obj(const std::string& path);

}  // namespace envmap

/// @file
/// MTL, the materials of OBJ files. Source: Ramey, Rose and Tyerman, "MTL material format", Alias/Wavefront 1995, with
/// Exocortex's "PBR extension to MTL" (2015: Pr, Pm, Ke and the like).
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "envmap/scenes/scene/scene_graph.h"

namespace envmap {

/// An image that a material names.
struct MtlMap {
  std::string name;  ///< With / between folders; empty: none.
  bool clamp = false;
};

struct MtlMaterial {
  Material material;
  MtlMap colour, emission;
  std::vector<std::string> unsupported;  ///< As SceneGraph::unsupported.
};

/// The materials of a file by name. Kd and Ke are taken as they are, Pm and Pr, too. Without Pr Phong's exponent Ns
/// becomes the roughness whose lobe is as wide. The highlight is that of a dielectric of index Ni (1.5 where there is
/// none), and there is none where Ks is 0 or illum 0 or 1; other values of Ks, and Ka and Tf, have no counterpart and
/// are passed over.
/// @throws InputError("line N: ...") where the text is damaged.
std::map<std::string, MtlMaterial> read_mtl(std::string_view text);

}  // namespace envmap

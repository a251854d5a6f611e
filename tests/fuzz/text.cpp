// The readers of scenes, each alone and without other files; fuzz_scene goes on to what files name,
// and to the scene as a whole.
#include <cstdlib>
#include <span>
#include <string>

#include "envmap/base/error.h"
#include "envmap/scenes/read/read_gltf.h"
#include "envmap/scenes/read/read_mtl.h"
#include "envmap/scenes/read/read_obj.h"
#include "sound_scene.h"
#include "targets.h"

using namespace envmap;

void fuzz_text(std::string_view format, Bytes bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  static const SceneFolder nowhere("no such folder/scene");
  constexpr std::uint64_t pixels = 1 << 20;
  try {
    if (format == "mtl") {
      for (const auto& [name, m] : read_mtl(text))
        if (!(m.material.roughness >= 0 && m.material.roughness <= 1)) std::abort();
      return;
    }
    expect_sound(format == "obj" ? read_obj(bytes, nowhere, pixels) : read_gltf(bytes, nowhere, pixels));
  } catch (const InputError&) {  // Its words become harmless in read_scene().
  }
}

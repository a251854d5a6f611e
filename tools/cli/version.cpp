#include <fmt/format.h>

#include "cli/command_line.h"
#include "commit.h"
#include "envmap/base/error.h"
#include "envmap/scenes/render/context.h"

namespace tools {

std::string version_text() {
  const std::string commit = ENVMAP_COMMIT;
  return fmt::format("envmap {}{}\nwith {}", ENVMAP_VERSION_TEXT, commit.empty() ? "" : " (" + commit + ")",
                     ENVMAP_LIBRARIES);
}

std::string renderer_text() try {
  return "draws with " + envmap::Context(envmap::ContextKind::automatic).renderer();
} catch (const envmap::RendererError& e) {
  return std::string("draws with raycast alone: ") + e.what();
}

}  // namespace tools
